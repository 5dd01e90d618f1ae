/* SPDX-License-Identifier: Apache-2.0 */
/*
 * resume.c - from the last snapshot of a predecessor to a held cycle
 */
#include "resume.h"

#include "log.h"
#include "programs.h"

#include <math.h>
#include <string.h>

static bool job_was_under_way(const struct shm_snapshot *s)
{
	return s->cycle != 0 && s->program != 0 && s->loaded;
}

/* Actions behind the farthest place are done, wherever the walk stands. */
static uint32_t last_done(const struct cycle *c)
{
	const struct interp_program *p = &c->cursor.p;
	uint32_t i = c->cursor.index;

	while (i + 1 < p->head->nsegs && p->segs[i + 1].s_mm < c->far_mm)
		i++;
	return i;
}

/* What the program has switched on its way there. */
static void switches_restore(struct cycle *c, const struct shm_snapshot *s)
{
	const struct interp_program *p = &c->cursor.p;

	c->out.pump = s->pump;
	c->out.negative = s->negative;
	c->action_done = last_done(c);
	for (uint32_t i = 0; i <= c->action_done; i++) {
		if (p->segs[i].kind != INTERP_AUX)
			continue;
		if (p->segs[i].arg == INTERP_AUX_POWER_OFF)
			c->power_off = true;
		else if (p->segs[i].arg == INTERP_AUX_POWER_POSITIVE ||
			 p->segs[i].arg == INTERP_AUX_POWER_NEGATIVE)
			c->power_off = false;
	}
}

/* The sums of the job go on. */
static void sums_restore(struct cycle *c, const struct shm_snapshot *s)
{
	c->totals.cycles = s->job_cycles;
	c->totals.erode_cycles = s->erode_cycles;
	c->totals.jump_cycles = s->jump_cycles;
	c->totals.retracts = s->retracts;
	c->totals.jumps = s->jumps;
	c->totals.shorts = s->shorts;
	c->totals.overruns = s->overruns;
	c->totals.retract_mm_max = s->retract_mm_max;
}

static int place_restore(struct loop *l, struct program *p,
			 const struct shm_snapshot *s)
{
	double far_mm = isfinite(s->far_mm) ? s->far_mm : s->place_mm;
	int err = interp_cursor_seek(&p->cursor, s->seg, s->tick);
	enum cycle_answer answer;

	if (err < 0) {
		log_line(LOG_ERROR, "resume: segment %u, tick %u: %s; this is "
			 "not the program that ran", s->seg, s->tick,
			 strerror(-err));
		return err;
	}
	answer = cycle_load_at(&l->cycle, &p->cursor, far_mm);
	if (answer == ANSWER_DONE)
		return 0;
	log_line(LOG_ERROR, "resume: program %u: %s", p->n,
		 cycle_answer_text(answer));
	return -1;
}

static void tell(const struct loop *l, const struct shm_snapshot *s)
{
	log_line(LOG_WARNING, "resume: a job was under way; its program %u is "
		 "held at %.3f mm of %.3f, line %u; it was in %s; start goes "
		 "on",
		 s->program, interp_cursor_place_mm(&l->cycle.cursor),
		 l->cycle.cursor.p.head->length_mm, l->cycle.cursor.seg.line,
		 shm_state_name(s->state));
	if (s->state == SHM_FAULT)
		log_line(LOG_WARNING, "resume: the fault was %s; see that its "
			 "cause is gone before start",
			 shm_fault_name(s->fault));
}

void resume(struct loop *l, const struct machine_config *c,
	    const struct shm_snapshot *before)
{
	struct program *p;

	if (!job_was_under_way(before))
		return;
	p = program_open(c, before->program);
	if (!p || place_restore(l, p, before) < 0) {
		log_line(LOG_ERROR, "resume: job of program %u not restored; "
			 "it was at %.3f mm, line %u", before->program,
			 before->place_mm, before->line);
		program_close(p);
		return;
	}
	l->program = p;
	switches_restore(&l->cycle, before);
	sums_restore(&l->cycle, before);
	tell(l, before);
}
