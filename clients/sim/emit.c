/* SPDX-License-Identifier: Apache-2.0 */
/* emit.c - writes the compiled job as text again */
#include "sim.h"

#include <errno.h>
#include <string.h>
#include <sysexits.h>

static int put(void *arg, const char *text, size_t bytes)
{
	return fwrite(text, 1, bytes, arg) == bytes ? 0 : -EIO;
}

static int put_nowhere(void *arg, const char *text, size_t bytes)
{
	(void)arg, (void)text, (void)bytes;
	return 0;
}

/* Say what was left out because records have no word for it. */
static void say_left(const struct interp_threeb_left *l)
{
	const struct {
		uint32_t n;
		const char *what;
	} left[] = {
		{ l->rapids, "rapid moves became lines that cut" },
		{ l->outputs, "switched outputs were left out" },
		{ l->waits, "dwells and optional stops were left out" },
		{ l->conditions, "calls of conditions were left out" },
	};

	for (size_t i = 0; i < sizeof(left) / sizeof(left[0]); i++) {
		if (left[i].n)
			fprintf(stderr, "edmsim: %u %s: 3B has no word for "
				"them\n", left[i].n, left[i].what);
	}
}

static int write_to(const struct interp_sink *to, const struct sim_job *job,
		    const struct sim_options *o, const struct machine_config *c,
		    struct interp_threeb_left *left)
{
	const struct interp_threeb_options threeb = {
		.unit_um = c->threeb_unit_um,
		.fourb = strcmp(o->emit, "4b") == 0,
	};
	struct interp_diag d = { 0 };
	int r;

	*left = (struct interp_threeb_left) { 0 };
	if (strcmp(o->emit, "iso") != 0)
		r = interp_threeb_write(&job->program, &threeb, to, left, &d);
	else
		r = interp_iso_write(&job->program, to, &d);
	if (r == -EINVAL)
		interp_diag_tell(&d, o->job);
	return r;
}

/* Half a program on stdout could be taken for a whole one.  So it is written
 * nowhere first: nothing comes out of one that is refused. */
int job_emit(const struct sim_job *job, const struct sim_options *o,
	     const struct machine_config *c)
{
	const struct interp_sink nowhere = { put_nowhere, NULL };
	const struct interp_sink to = { put, stdout };
	struct interp_threeb_left left;
	int r = write_to(&nowhere, job, o, c, &left);

	if (!r)
		r = write_to(&to, job, o, c, &left);
	if (r == -EINVAL)
		return EX_DATAERR;
	if (r)
		return EX_IOERR;	/* standard_guard() says why */
	say_left(&left);
	return 0;
}
