/* SPDX-License-Identifier: Apache-2.0 */
/*
 * resume.c - from the last snapshot of a predecessor to a held cycle
 */
#include "resume.h"

#include "log.h"
#include "programs.h"
#include "timed.h"

#include <errno.h>
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

static void power_on(struct cycle *c, uint32_t arg)
{
	c->power_off = false;
	process_say(c, arg == INTERP_AUX_POWER_NEGATIVE);
}

/* What the program has switched on its way there. */
static void switches_restore(struct cycle *c, const struct shm_snapshot *s)
{
	const struct interp_program *p = &c->cursor.p;

	c->out.pump = s->pump;
	c->action_done = last_done(c);
	for (uint32_t i = 0; i <= c->action_done; i++) {
		/* How much of its time is over is not known: all of it again. */
		if (p->segs[i].kind == INTERP_TIMED &&
		    p->segs[i].arg > c->action_done) {
			timed_begin(c, p->segs[i].arg);
			c->timed_from_mm = p->segs[i].s_mm;
		}
		if (p->segs[i].kind == INTERP_TIMED_END)
			timed_over(c, i);
		if (p->segs[i].kind == INTERP_MCODE)
			mcode_over(c, i);
		if (p->segs[i].kind != INTERP_AUX)
			continue;
		if (p->segs[i].arg == INTERP_AUX_POWER_OFF)
			c->power_off = true;
		else if (p->segs[i].arg == INTERP_AUX_POWER_POSITIVE ||
			 p->segs[i].arg == INTERP_AUX_POWER_NEGATIVE)
			power_on(c, p->segs[i].arg);
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

/* Before anything is sent to the axes: it says where they stand. */
static void touch_restore(struct cycle *c, const struct shm_snapshot *s)
{
	struct touch *t = &c->touch;

	memcpy(t->shift, s->shift, sizeof(t->shift));
	memcpy(t->found, s->found, sizeof(t->found));
	t->once = s->found_once;
	t->twice = s->found_twice;
	touch_target(c, c->cursor.pos);
}

static bool stands_at(const struct cycle *c, const int32_t pos[SHM_NAXES])
{
	return memcmp(c->out.target, pos, sizeof(c->out.target)) == 0;
}

/* Beside the path it is on the escape that led there, or nobody knows where. */
static int pos_restore(struct cycle *c, const struct shm_snapshot *s)
{
	int32_t pos[SHM_NAXES];

	if (stands_at(c, s->pos))
		return 0;
	for (int i = 0; i < SHM_NAXES; i++)
		pos[i] = (int32_t)((uint32_t)s->pos[i] - (uint32_t)s->shift[i]);
	if (escape_find(c, pos))
		return 0;
	log_line(LOG_ERROR, "resume: the machine was at X %d Y %d Z %d pulses, "
		 "neither on the path at segment %u, tick %u (X %d Y %d Z %d) "
		 "nor on its way out from there", s->pos[INTERP_X],
		 s->pos[INTERP_Y], s->pos[INTERP_Z], s->seg, s->tick,
		 c->out.target[INTERP_X], c->out.target[INTERP_Y],
		 c->out.target[INTERP_Z]);
	return -ESTALE;
}

static int place_restore(struct loop *l, struct program *p,
			 const struct shm_snapshot *s)
{
	double far_mm = isfinite(s->far_mm) ? s->far_mm : s->place_mm;
	int err = interp_cursor_seek(&p->cursor, s->seg, s->tick);
	struct cycle held = l->cycle;
	enum cycle_answer answer;

	if (err < 0) {
		log_line(LOG_ERROR, "resume: segment %u, tick %u: %s; this is "
			 "not the program that ran", s->seg, s->tick,
			 strerror(-err));
		return err;
	}
	answer = cycle_load_at(&held, &p->cursor, far_mm);
	if (answer == ANSWER_DONE) {
		touch_restore(&held, s);
		err = pos_restore(&held, s);
		if (err == 0)
			l->cycle = held;
		return err;
	}
	log_line(LOG_ERROR, "resume: program %u: %s", p->n,
		 cycle_answer_text(answer));
	return -1;
}

static void tell(const struct loop *l, const struct shm_snapshot *s)
{
	log_line(LOG_WARNING, "resume: a job was under way; its program %u is "
		 "held at %.3f mm of %.3f, line %u, %.3f mm beside the path; it "
		 "was in %s; start goes on",
		 s->program, interp_cursor_place_mm(&l->cycle.cursor),
		 l->cycle.cursor.p.head->length_mm, l->cycle.cursor.seg.line,
		 l->cycle.escape.way_mm, shm_state_name(s->state));
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
	if (isfinite(before->back_mm))
		l->cycle.back_mm = fmax(l->cycle.back_mm, before->back_mm);
	sums_restore(&l->cycle, before);
	tell(l, before);
}
