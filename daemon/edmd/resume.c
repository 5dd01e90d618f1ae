/* SPDX-License-Identifier: Apache-2.0 */
/*
 * resume.c - from the last snapshot of a predecessor to a held cycle
 *
 * First the axes: where they stand, and how certain that is.  Then the job,
 * completely or not at all: a job that goes on at another place, or with other
 * values, would be worse than a lost one.
 */
#include "resume.h"

#include "log.h"
#include "programs.h"
#include "restore.h"
#include "axes/axis_state.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static bool job_was_under_way(const struct shm_snapshot *s)
{
	return s->cycle != 0 && s->program != 0 && s->loaded;
}

/* -- The axes ------------------------------------------------------------- */

/* Otherwise a pulse means another distance, or belongs to another drive. */
static bool same_axes(const struct loop *l, const struct shm_snapshot *s)
{
	const bool pulses = memcmp(l->pulse_mm, s->pulse_mm,
				   sizeof(l->pulse_mm)) == 0;

	if (pulses && l->axes_key == s->axes_key)
		return true;
	log_line(LOG_ERROR,
		 "resume: %s of the machine file is not what it was; the "
		 "places of the edmd before mean nothing: the axes are taken "
		 "to stand at start_mm; move or home them",
		 pulses ? "the backend, or a drive's node or increments," :
			  "pulse_mm");
	return false;
}

/* If nothing measures the axes, their places are a guess once the drives were
 * alone. */
static bool is_sure(const struct loop *l, const struct shm_snapshot *s)
{
	return l->io.stays || (l->io.originate && s->has_origin);
}

/* An axis that was homed to other places does not count as homed. */
static uint32_t homed(const struct loop *l, const struct shm_snapshot *s)
{
	if (!is_sure(l, s))
		return 0;
	if (l->home_key == s->home_key || s->homed == 0)
		return s->homed;
	log_line(LOG_WARNING,
		 "resume: home_method or home_at_mm of the machine file is not "
		 "what it was; the axes keep their places, but count as not "
		 "homed: home them");
	return 0;
}

/* This is left as the machine file, or the crash, left it: nothing moves by
 * itself. */
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
		.homed = homed(l, s), .unplaced = s->unplaced,
		.limit.on = s->limit,
		.told_c = s->axes_c,
	};

	memcpy(at.place, s->pos, sizeof(at.place));
	memcpy(at.drive, s->drive, sizeof(at.drive));
	memcpy(at.off, s->off, sizeof(at.off));
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

/* A fault stays latched until an operator's reset, whichever edmd latched
 * it. */
static void fault_restore(struct cycle *c, const struct shm_snapshot *s)
{
	if (s->fault == FAULT_NONE || s->fault >= CYCLE_NFAULTS)
		return;
	cycle_restore_faults(c, (enum cycle_fault)s->fault, s->faults);
	log_line(LOG_WARNING, "resume: the fault was %s; it stays until a "
		 "reset", fault_name(s->fault));
}

/* -- The job -------------------------------------------------------------- */

static struct cycle_past past_of(const struct shm_snapshot *s)
{
	struct cycle_past past = {
		.far_mm = isfinite(s->far_mm) ? s->far_mm : s->place_mm,
		.back_mm = s->back_mm, .sure_mm = s->sure_mm,
		.moved_beside = s->moved_beside, .adrift = s->adrift,
		.found_once = s->found_once, .found_twice = s->found_twice,
		.depth = {
			.cut.far_mm = s->depth_far_mm,
			.cut.known_mm = s->depth_known_mm,
			.cut.counts = s->depth_counts,
			.now_mm = s->depth_mm, .met = s->depth_met,
		},
		.pump = s->pump, .mcode = s->mcode, .mcode_at = s->mcode_at,
		.stand = {
			.why = s->kept_stand < STAND_NREASONS ?
			       (enum stand_reason)s->kept_stand : STAND_NONE,
			.of = s->kept_of, .confirmed = s->confirmed,
			.n = s->stand_n,
		},
		.totals = {
			.cycles = s->job_cycles,
			.erode_cycles = s->erode_cycles,
			.jump_cycles = s->jump_cycles,
			.cut_cycles = s->cut_cycles,
			.moved_cycles = s->moved_cycles,
			.other_cycles = s->other_cycles,
			.retracts = s->retracts, .jumps = s->jumps,
			.shorts = s->shorts, .overruns = s->overruns,
			.hunts = s->hunts, .arcs = s->arcs,
			.energy_j = s->energy_j,
			.retract_mm_max = s->retract_mm_max,
		},
	};

	memcpy(past.depth.cut.from, s->depth_from, sizeof(s->depth_from));
	memcpy(past.depth.cut.way, s->depth_way, sizeof(s->depth_way));
	memcpy(past.moved_mm, s->moved_mm, sizeof(past.moved_mm));
	memcpy(past.seen, s->seen, sizeof(past.seen));
	memcpy(past.moved_way, s->moved_way, sizeof(past.moved_way));
	memcpy(past.pos, s->pos, sizeof(past.pos));
	memcpy(past.shift, s->shift, sizeof(past.shift));
	memcpy(past.found, s->found, sizeof(past.found));
	return past;
}

/* Return: how many values were `set` in the job, or -ESTALE. */
static int sets_read(const struct shm_status *status, uint64_t key,
		     struct conditions_set set[CONDITIONS_SETS_MAX])
{
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
	return (int)s.n;
}

static int program_same(const struct program *p, const struct shm_snapshot *s)
{
	if (p->key == s->program_key)
		return 0;
	log_line(LOG_ERROR, "resume: program %u is not the one that ran", p->n);
	return -ESTALE;
}

/* Log why the cycle could not take the job up. */
static int tell_refusal(const struct cycle *c, enum cycle_restored why,
			enum cycle_answer answer, const struct shm_snapshot *s)
{
	switch (why) {
	case RESTORED:
		return 0;
	case RESTORE_ELSEWHERE:
		log_line(LOG_ERROR, "resume: the machine was at X %d Y %d Z %d "
			 "pulses, neither on the path at segment %u, tick %u "
			 "(X %d Y %d Z %d) nor on its way out from there",
			 s->pos[INTERP_X], s->pos[INTERP_Y], s->pos[INTERP_Z],
			 s->seg, s->tick, c->out.target[INTERP_X],
			 c->out.target[INTERP_Y], c->out.target[INTERP_Z]);
		return -ESTALE;
	case RESTORE_OTHER_VALUES:
		log_line(LOG_ERROR, "resume: what was set in the job does not "
			 "go with this machine file");
		return -EINVAL;
	default:
		log_line(LOG_ERROR, "resume: program %u: %s", s->program,
			 cycle_answer_text(answer));
		return -EINVAL;
	}
}

static int place_restore(struct loop *l, struct program *p,
			 const struct shm_snapshot *s)
{
	struct conditions_set sets[CONDITIONS_SETS_MAX];
	struct cycle_past past = past_of(s);
	int err = interp_cursor_seek(&p->cursor, s->seg, s->tick);
	struct cycle held = l->cycle;
	enum cycle_restored restored;
	enum cycle_answer answer;
	int n;

	if (err < 0) {
		log_line(LOG_ERROR, "resume: segment %u, tick %u: %s; this is "
			 "not the program that ran", s->seg, s->tick,
			 strerror(-err));
		return err;
	}
	n = sets_read(l->status, s->program_key, sets);
	if (n < 0)
		return n;
	past.sets = sets;
	past.nsets = (uint32_t)n;
	restored = cycle_restore(&held, &p->cursor, &past, &answer);
	err = tell_refusal(&held, restored, answer, s);
	if (err == 0)
		l->cycle = held;
	return err;
}

static void tell(const struct loop *l, const struct shm_snapshot *s)
{
	log_line(LOG_WARNING,
		 "resume: a job was under way; its program %u is held at %.3f "
		 "mm of %.3f, line %u, %.3f mm beside the path; it was in %s; "
		 "start goes on",
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
	/* If a PLC says the same as before, that is not a change. */
	l->cycle.plc_override = before->plc_override;
	if (job_was_under_way(before))
		job_restore(l, c, before);
	fault_restore(&l->cycle, before);
}
