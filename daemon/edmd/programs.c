/* SPDX-License-Identifier: Apache-2.0 */
/* programs.c - opens programs from shared memory */
#include "programs.h"

#include "key.h"
#include "log.h"
#include "shm.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

/* A program counts in the pulses of the machine for which it was compiled. */
static int pulses_check(const struct machine_config *c,
			const struct interp_program_head *h, uint32_t n)
{
	for (int a = 0; a < INTERP_NAXES; a++) {
		double have = c->axes.axis[a].pulse_mm;

		if (!(c->axes.present >> a & 1) || h->pulse_mm[a] == have)
			continue;
		log_line(LOG_ERROR, "program: %u is compiled for pulses of "
			 "%g mm on axis %c; this machine has %g mm", n,
			 h->pulse_mm[a], INTERP_AXIS_LETTERS[a], have);
		return -EINVAL;
	}
	return 0;
}

static int program_check(const struct machine_config *c, struct program *p)
{
	struct interp_program view;
	int err = interp_program_map(&view, p->block, p->bytes);

	if (err < 0) {
		log_line(LOG_ERROR, "program: %u is not a program of version "
			 "%d in %zu bytes", p->n, INTERP_PROGRAM_VERSION,
			 p->bytes);
		return err;
	}
	err = interp_cursor_init(&p->cursor, &view);
	if (err < 0) {
		log_line(LOG_ERROR, "program: %u: its first segment fails its "
			 "check", p->n);
		return err;
	}
	return pulses_check(c, view.head, p->n);
}

/* A page fault in the cycle would take longer than a period. */
static void program_keep(const struct program *p)
{
	if (mlock(p->block, p->bytes) == 0)
		return;
	log_line(LOG_WARNING, "program: %u, %zu bytes, not locked in memory: "
		 "%s; LimitMEMLOCK=infinity mends it", p->n, p->bytes,
		 strerror(errno));
	madvise((void *)(uintptr_t)p->block, p->bytes, MADV_WILLNEED);
}

struct program *program_open(const struct machine_config *c, uint32_t n)
{
	struct program *p = calloc(1, sizeof(*p));
	int err;

	if (!p) {
		log_line(LOG_ERROR, "program: %u: out of memory", n);
		return NULL;
	}
	p->n = n;
	p->stamp = shm_program_stamp(c->name, n);
	err = shm_program_open(&p->block, &p->bytes, c->name, n);
	if (err < 0) {
		log_line(LOG_ERROR, "program: %u of machine %s: %s", n,
			 c->name, strerror(-err));
		free(p);
		return NULL;
	}
	if (program_check(c, p) < 0) {
		program_close(p);
		return NULL;
	}
	if (!shm_is_stamp(&p->stamp, c->name, n))
		p->stamp.inode = 0;
	program_keep(p);
	p->key = key_of(p->block, p->bytes);
	return p;
}

void program_close(struct program *p)
{
	if (!p)
		return;
	shm_program_unmap(p->block, p->bytes);
	free(p);
}

/* There is never memory for more than the one that is loaded and this one. */
static void open_ahead(struct crossing *x, const struct machine_config *c,
		       struct program **ahead, uint32_t n)
{
	program_close(*ahead);
	*ahead = program_open(c, n);
	crossing_reply(x, &(struct reply) { .ahead = true });
}

static struct program *ahead_or_open(const struct machine_config *c,
				     struct program **ahead, uint32_t n)
{
	struct program *p = *ahead;

	*ahead = NULL;
	if (p && shm_is_stamp(&p->stamp, c->name, n)) {
		p->n = n;
		log_line(LOG_INFO, "program: %u was copied ahead", n);
		return p;
	}
	program_close(p);
	return program_open(c, n);
}

static void open_for(struct crossing *x, const struct machine_config *c,
		     struct program **ahead, const struct ask *a)
{
	struct reply r = { .id = a->id,
			   .program = ahead_or_open(c, ahead, a->n) };

	r.answer = r.program ? ANSWER_DONE : ANSWER_BAD_ARGUMENT;
	if (!crossing_reply(x, &r))
		program_close(r.program);
}

void programs_serve(struct crossing *x, const struct machine_config *c,
		    struct program **ahead)
{
	struct ask a;

	while (crossing_ask_take(x, &a)) {
		if (a.close)
			program_close(a.close);
		else if (a.ahead)
			open_ahead(x, c, ahead, a.n);
		else
			open_for(x, c, ahead, &a);
	}
}
