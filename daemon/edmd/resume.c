/* SPDX-License-Identifier: Apache-2.0 */
/*
 * resume.c - from the last snapshot of a predecessor to a held cycle
 *
 * First the axes: where they stand and what that rests on.  Then the job, whole
 * or not at all: one that went on in another place, or with other values, would
 * be worse than one that is lost.
 */
#include "resume.h"

#include "log.h"
#include "programs.h"
#include "axes/axis_state.h"
#include "path/timed.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static bool job_was_under_way(const struct shm_snapshot *s)
{
	return s->cycle != 0 && s->program != 0 && s->loaded;
}

/* -- The axes ----------------------------------------------------------------- */

/* Else a pulse is another way, or of another drive. */
static bool same_axes(const struct loop *l, const struct shm_snapshot *s)
{
	const bool pulses = memcmp(l->pulse_mm, s->pulse_mm,
				   sizeof(l->pulse_mm)) == 0;

	if (pulses && l->axes_key == s->axes_key)
		return true;
	log_line(LOG_ERROR, "resume: %s of the machine file is not what it was; "
		 "the places of the edmd before mean nothing: the axes are "
		 "taken to stand at start_mm; move or home them",
		 pulses ? "the backend, or a drive's node or increments," :
			  "pulse_mm");
	return false;
}

/* Pulses that nothing measures are a guess once the drives were alone. */
static bool is_sure(const struct loop *l, const struct shm_snapshot *s)
{
	return l->io.stays || (l->io.originate && s->has_origin);
}

/* Homed to other places is not homed. */
static uint32_t homed(const struct loop *l, const struct shm_snapshot *s)
{
	if (!is_sure(l, s))
		return 0;
	if (l->home_key == s->home_key || s->homed == 0)
		return s->homed;
	log_line(LOG_WARNING, "resume: home_method or home_at_mm of the machine "
		 "file is not what it was; the axes keep their places, but "
		 "count as not homed: home them");
	return 0;
}

/* Where the machine file, or the crash, left it: it does not move by itself. */
static void tell_left(const struct cycle *c)
{
	static const char names[] = INTERP_AXIS_LETTERS;
	char text[INTERP_NAXES * 16] = "";
	int32_t left[INTERP_NAXES];
	size_t n = 0;

	comp_left(&c->comp, &c->config.comp, left);
	for (int i = 0; i < INTERP_NAXES; i++)
		if (left[i] != 0)
			n += (size_t)snprintf(text + n, sizeof(text) - n,
					      " %c %d", names[i], left[i]);
	if (n > 0)
		log_line(LOG_WARNING, "resume: backlash and maps ask for other "
			 "pulses than the drives have, by%s; taken up when "
			 "a command moves an axis", text);
}

static void axes_restore(struct loop *l, const struct shm_snapshot *s)
{
	struct axis_state at = {
		.homed = homed(l, s), .limit.on = s->limit,
		.told_c = s->axes_c,
	};

	memcpy(at.place, s->pos, sizeof(at.place));
	memcpy(at.drive, s->drive, sizeof(at.drive));
	memcpy(at.shift, s->home_shift, sizeof(at.shift));
	memcpy(at.toward, s->toward, sizeof(at.toward));
	memcpy(at.limit.side, s->limit_side, sizeof(at.limit.side));
	axis_state_set(&l->cycle, &at);
	if (l->io.originate && s->has_origin)
		l->io.originate(l->io.self, s->origin);
	log_line(LOG_WARNING, "resume: the axes are taken to stand where the "
		 "edmd before sent them, X %d Y %d Z %d pulses%s",
		 s->pos[INTERP_X], s->pos[INTERP_Y], s->pos[INTERP_Z],
		 is_sure(l, s) ? "" :
				 "; nothing measures that: look before start");
	tell_left(&l->cycle);
}

/* Latched until an operator's reset, whoever latched it. */
static void fault_restore(struct cycle *c, uint32_t fault, uint64_t faults)
{
	if (fault == FAULT_NONE || fault >= CYCLE_NFAULTS)
		return;
	fault_latch(&c->fault, (enum cycle_fault)fault);
	for (uint32_t i = FAULT_NONE + 1; i < CYCLE_NFAULTS; i++)
		if (faults >> i & 1)
			fault_latch(&c->fault, (enum cycle_fault)i);
	c->fault.fresh = c->fault.untold = 0;
	c->outcome = c->loaded ? OUTCOME_FAULT : c->outcome;
	c->state = STATE_FAULT;
	log_line(LOG_WARNING, "resume: the fault was %s; it stays until a "
		 "reset", fault_name(fault));
}

/* -- The job ------------------------------------------------------------------ */

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
	conditions_say(c, arg == INTERP_AUX_POWER_NEGATIVE);
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

/* One that the PLC was told, and has not answered, it is told still. */
static void mcode_restore(struct cycle *c, const struct shm_snapshot *s)
{
	c->mcode.number = s->mcode;
	c->mcode.at = s->mcode_at;
	/* It was answered while the job stood. */
	c->mcode.done = s->mcode == 0 && s->mcode_at != 0;
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
static void probe_restore(struct cycle *c, const struct shm_snapshot *s)
{
	struct probe *t = &c->probe;

	memcpy(t->shift, s->shift, sizeof(t->shift));
	memcpy(t->found, s->found, sizeof(t->found));
	t->once = s->found_once;
	t->twice = s->found_twice;
	probe_target(c, c->cursor.pos);
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

/* All of them, or it would be another cut. */
static int sets_restore(struct cycle *c, const struct shm_status *status,
			uint64_t key)
{
	struct conditions_set set[CONDITIONS_SETS_MAX];
	struct shm_sets s;

	if (!shm_sets(status, &s) || s.program_key != key ||
	    s.n > CONDITIONS_SETS_MAX) {
		log_line(LOG_ERROR, "resume: what was set in the job is lost");
		return -ESTALE;
	}
	for (uint64_t i = 0; i < s.n; i++)
		set[i] = (struct conditions_set) {
			s.set[i].value, (uint16_t)s.set[i].cond,
			(uint8_t)s.set[i].field
		};
	if (conditions_restore(c, set, (uint32_t)s.n))
		return 0;
	log_line(LOG_ERROR, "resume: what was set in the job does not go with "
		 "this machine file");
	return -EINVAL;
}

static int program_same(const struct program *p, const struct shm_snapshot *s)
{
	if (p->key == s->program_key)
		return 0;
	log_line(LOG_ERROR, "resume: program %u is not the one that ran", p->n);
	return -ESTALE;
}

static int place_restore(struct loop *l, struct program *p,
			 const struct shm_snapshot *s)
{
	double far_mm = isfinite(s->far_mm) ? s->far_mm : s->place_mm;
	int err = interp_cursor_seek(&p->cursor, s->seg, s->tick);
	struct cycle held = l->cycle;
	enum cycle_answer answer;

	/* Where a touch was, axes and program differ; pos_restore() compares. */
	held.manual.used = false;
	if (err < 0) {
		log_line(LOG_ERROR, "resume: segment %u, tick %u: %s; this is "
			 "not the program that ran", s->seg, s->tick,
			 strerror(-err));
		return err;
	}
	answer = cycle_load_at(&held, &p->cursor, far_mm);
	if (answer == ANSWER_DONE) {
		probe_restore(&held, s);
		held.manual.used = true;
		err = pos_restore(&held, s);
		if (err == 0)
			err = sets_restore(&held, l->status, s->program_key);
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
}

static void job_restore(struct loop *l, const struct machine_config *c,
			const struct shm_snapshot *before)
{
	struct program *p = program_open(c, before->program);

	if (!p || program_same(p, before) < 0 ||
	    place_restore(l, p, before) < 0) {
		log_line(LOG_ERROR, "resume: job of program %u not restored; "
			 "it was at %.3f mm, line %u", before->program,
			 before->place_mm, before->line);
		program_close(p);
		return;
	}
	l->program = p;
	switches_restore(&l->cycle, before);
	mcode_restore(&l->cycle, before);
	if (isfinite(before->back_mm))
		l->cycle.back_mm = fmax(l->cycle.back_mm, before->back_mm);
	sums_restore(&l->cycle, before);
	tell(l, before);
}

void resume(struct loop *l, const struct machine_config *c,
	    const struct shm_snapshot *before)
{
	if (before->cycle == 0 || !same_axes(l, before))
		return;
	axes_restore(l, before);
	if (before->override >= 0 && before->override <= 2)
		l->cycle.override = before->override;
	/* Said once more, it is no change. */
	l->cycle.plc_override = before->plc_override;
	if (job_was_under_way(before))
		job_restore(l, c, before);
	fault_restore(&l->cycle, before->fault, before->faults);
}
