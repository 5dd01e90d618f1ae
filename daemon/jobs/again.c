/* SPDX-License-Identifier: Apache-2.0 */
/* again.c - an interrupted job goes on */
#include "again.h"
#include "interrupt.h"
#include "jobs_log.h"

#include "interp/axis.h"

#include <errno.h>
#include <math.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

/* -- In the store ------------------------------------------------------------ */

int again_read(struct jobs *j, uint32_t n, struct again *ret)
{
	char *at = store_resume_at(j->store, n);
	size_t bytes = 0;
	const char *rest = NULL;

	memset(ret, 0, sizeof(*ret));
	if (!at)
		return -ENOENT;
	sodium_hex2bin((uint8_t *)&ret->base, sizeof(ret->base), at,
		       strlen(at), NULL, &bytes, &rest);
	if (rest && *rest == ';' &&
	    sscanf(rest, ";%lf;%lf;%u", &ret->from_mm, &ret->way_mm,
		   &ret->instance) != 3)
		ret->instance = 0;
	free(at);
	return bytes == sizeof(ret->base) ? 0 : -ENOENT;
}

int again_write(struct jobs *j, uint32_t n, const struct again *a)
{
	const size_t hex = 2 * sizeof(a->base) + 1, room = hex + 80;
	char *at = malloc(room);
	int err;

	if (!at)
		return -ENOMEM;
	sodium_bin2hex(at, hex, (const uint8_t *)&a->base, sizeof(a->base));
	snprintf(at + hex - 1, room - hex + 1, ";%.17g;%.17g;%u", a->from_mm,
		 a->way_mm, a->instance);
	err = store_interrupt(j->store, n, at);
	free(at);
	return err;
}

void again_whole(const struct again *a, struct shm_snapshot *s)
{
	const struct shm_snapshot *before = &a->base.snap;

	/* On the way in nothing is cut. */
	s->far_mm = fmax(before->far_mm, s->far_mm - a->way_mm + a->from_mm);
	s->place_mm = fmax(a->from_mm, s->place_mm - a->way_mm + a->from_mm);
	s->length_mm = before->length_mm;
	s->job_cycles += before->job_cycles;
	s->erode_cycles += before->erode_cycles;
	s->jump_cycles += before->jump_cycles;
	s->jumps += before->jumps;
	s->retracts += before->retracts;
	s->shorts += before->shorts;
}

void again_interrupted(struct jobs *j, uint32_t n,
		       const struct checkpoint_base *last, struct again *ret)
{
	static struct again before;

	*ret = (struct again) { .base = *last };
	if (again_read(j, n, &before) < 0)
		return;
	again_whole(&before, &ret->base.snap);
	memcpy(ret->base.job.start, before.base.job.start,
	       sizeof(ret->base.job.start));
}

/* -- The verb ------------------------------------------------------------------ */

/* Axes that @text names; those that the machine has not do not count. */
static uint32_t axes_named(const char *text)
{
	uint32_t axes = 0;

	for (; *text; text++) {
		const char *at = strchr(INTERP_AXIS_LETTERS, *text);

		if (at)
			axes |= 1u << (at - INTERP_AXIS_LETTERS);
	}
	return axes;
}

/* Why the axes are not good enough; "": they are.  An axis that can be homed
 * has to be. */
static void say_axes(struct jobs *j, const char *vouched, char reason[320])
{
	const uint32_t now = axes_named(vouched);
	char home[INTERP_NAXES + 1] = "", say[INTERP_NAXES + 1] = "";
	size_t nhome = 0, nsay = 0;

	for (const char *at = interrupt_lost(j); *at; at++) {
		const uint32_t axis = (uint32_t)(strchr(INTERP_AXIS_LETTERS,
							*at) -
						 INTERP_AXIS_LETTERS);

		if (j->link.snap.unhomed >> axis & 1)
			home[nhome++] = *at;
		else if (!(now >> axis & 1))
			say[nsay++] = *at;
	}
	reason[0] = '\0';
	if (nhome)
		snprintf(reason, 320, "the places of %s are not known; home "
			 "them, then resume", home);
	else if (nsay)
		snprintf(reason, 320, "the places of %s are not certain since "
			 "the power failed; see that the machine stands where "
			 "it shows, then name these axes: resume JOB %s", say,
			 say);
}

static bool is_same_file(const struct jobs *j, const struct again *a)
{
	return memcmp(a->base.job.config, j->config_hash,
		      sizeof(j->config_hash)) == 0;
}

static void why_not(struct jobs *j, const struct jobs_lcm_command *c,
		    const struct store_job *job, const struct again *a,
		    char reason[320])
{
	const char *now = NULL;

	if (job->state != JOB_INTERRUPTED)
		now = "this job was not interrupted; without a job, resume goes "
		      "on after a hold";
	else if (j->link.state != LINK_OK)
		now = "edmd is not there";
	else if (queue_is_faulted(j))
		now = "a fault is latched; reset first";
	else if (j->link.snap.state != SHM_IDLE)
		now = "the machine is not idle; wait, or stop what it does";
	else if (*store_why(j->store))
		now = store_why(j->store);
	else if (!a->base.job.n)
		now = "no checkpoint of this job is left; remove it, and submit "
		      "what is left of it";
	else if (!is_same_file(j, a))
		now = "the machine file is another than when the job began; put "
		      "that one back, and restart the services";
	if (now)
		snprintf(reason, 320, "%s", now);
	else
		say_axes(j, c->text, reason);
}

void again_resume(struct jobs *j, const struct jobs_lcm_command *c,
		  const struct store_job *job)
{
	char reason[320];
	struct again a;
	int err;

	again_read(j, job->n, &a);
	why_not(j, c, job, &a, reason);
	if (reason[0]) {
		verbs_answer(j, c, REFUSED, reason);
		return;
	}
	a.instance = j->link.instance;
	a.from_mm = a.way_mm = 0;
	err = again_write(j, job->n, &a);
	if (err == 0)
		err = store_again(j->store, job->n);
	if (err != 0) {
		verbs_answer(j, c, EX_IOERR, "the store failed");
		return;
	}
	store_set_number(j->store, "selected", job->n);
	interrupt_init(j);
	queue_recount(j);
	verbs_answer(j, c, 0, "it is read again; an event says which way it "
		     "will go in; then it waits for start");
}

/* -- Loading ---------------------------------------------------------------------- */

/* A sinker comes in from above; a wire stands in its kerf. */
static int way_out(const struct machine_config *c)
{
	const bool wire = c->wire.guides != INTERP_GUIDES_OFF ||
			  c->sim.process == SIM_WIRE;

	return wire || !(c->axes.present >> INTERP_Z & 1) ? -1 : INTERP_Z;
}

int again_request(struct jobs *j, const struct store_job *job,
		  struct compiler_request *ret)
{
	const struct shm_snapshot *s = &j->link.snap;
	static struct again a;

	if (again_read(j, job->n, &a) < 0)
		return 0;
	if (a.instance != j->link.instance) {
		log_warning("load: job %s: edmd was started anew since it was "
			    "resumed, so its axes have to be looked at again",
			    job->id);
		store_set_state(j->store, job->n, JOB_INTERRUPTED);
		interrupt_init(j);
		queue_recount(j);
		return -ESTALE;
	}
	ret->goes_on = true;
	ret->sets = a.base.sets;
	ret->from.far_mm = a.base.snap.far_mm;
	ret->from.up = way_out(j->config);
	memcpy(ret->from.now_mm, ret->start_mm, sizeof(ret->from.now_mm));
	for (int i = 0; i < INTERP_NAXES; i++)
		ret->start_mm[i] = a.base.job.start[i] * s->pulse_mm[i];
	return 0;
}

static void say_way(const struct jobs *j, const struct interp_build_entry *e,
		    char *to, size_t size)
{
	size_t n = 0;

	for (int i = 0; i < INTERP_NAXES && n < size; i++)
		if (j->config->axes.present >> i & 1)
			n += (size_t)snprintf(to + n, size - n, " %c%.3f",
					      INTERP_AXIS_LETTERS[i],
					      e->entry_mm[i]);
	if (e->npassed && n < size)
		n += (size_t)snprintf(to + n, size - n, "; not done again:");
	for (uint32_t i = 0; i < e->npassed && n < size; i++)
		n += (size_t)snprintf(to + n, size - n, " M%u",
				      e->passed[i] & 0xffu);
}

const char *again_loaded(struct jobs *j, const struct compiler_result *r)
{
	const struct store_job *job = &j->queue.job;
	uint8_t tech[sizeof(((struct checkpoint_job *)0)->tech)] = { 0 };
	char way[400], in[160];
	static struct again a;

	if (again_read(j, job->n, &a) < 0)
		return NULL;
	sodium_hex2bin(tech, sizeof(tech), r->tech_sha256,
		       strlen(r->tech_sha256), NULL, NULL, NULL);
	if (memcmp(tech, a.base.job.tech, sizeof(tech)) != 0)
		return "the technology table is another than when the job "
		       "began; put that one back, and submit what is left";
	a.from_mm = r->entry.from_mm;
	a.way_mm = r->entry.way_mm;
	if (again_write(j, job->n, &a) != 0)
		return "where it goes on cannot be stored";
	say_way(j, &r->entry, way, sizeof(way));
	if (a.base.snap.far_mm > a.from_mm)
		snprintf(in, sizeof(in), "comes in along its path, %.3f mm up to "
			 "line %u, and cuts on from the first spark",
			 a.base.snap.far_mm - a.from_mm, r->entry.line);
	else
		snprintf(in, sizeof(in), "goes on behind line %u",
			 r->entry.line);
	jobs_note(j, &(struct jobs_note) {
		.kind = "waits", .job = job->id,
	}, "job %s: start positions it to%s, off the work; then it %s",
		  job->name, way, in);
	return NULL;
}
