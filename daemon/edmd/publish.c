/* SPDX-License-Identifier: Apache-2.0 */
/*
 * publish.c - the state of the cycle in the words of shared memory
 *
 * This is the only file that knows both.  Their numbers are the same, so no
 * table is needed.
 */
#include "loop.h"

#include "axes/axis_state.h"
#include "path/mcode.h"
#include "path/place.h"
#include "path/probe_rest.h"

#include <string.h>

#define SAME(a, b)	_Static_assert((int)(a) == (int)(b), #a " is " #b)

SAME(SHM_IDLE, STATE_IDLE);
SAME(SHM_TRAVEL, STATE_TRAVEL);
SAME(SHM_APPROACH, STATE_APPROACH);
SAME(SHM_ERODE, STATE_ERODE);
SAME(SHM_RETRACT, STATE_RETRACT);
SAME(SHM_JUMP, STATE_JUMP);
SAME(SHM_HOLD, STATE_HOLD);
SAME(SHM_FAULT, STATE_FAULT);
SAME(SHM_JOG, STATE_JOG);
SAME(SHM_HOME, STATE_HOME);
SAME(SHM_PROBE, STATE_PROBE);
SAME(SHM_PROBE + 1, CYCLE_NSTATES);
SAME(SHM_NAXES, INTERP_NAXES);
SAME(SHM_NAXES, IO_NAXES);
SAME(SHM_NGENERATOR, INTERP_NGENERATOR);
SAME(SHM_NTOLD, PROCESS_NTOLD);
SAME(IO_NTOLD, PROCESS_NTOLD);
SAME(SHM_SETS_MAX, CONDITIONS_SETS_MAX);
SAME(SHM_DONE, ANSWER_DONE);
SAME(SHM_NO_PROGRAM, ANSWER_NO_PROGRAM);
SAME(SHM_WRONG_STATE, ANSWER_WRONG_STATE);
SAME(SHM_BAD_ARGUMENT, ANSWER_BAD_ARGUMENT);
SAME(SHM_NOT_HOMED, ANSWER_NOT_HOMED);
SAME(SHM_AT_LIMIT, ANSWER_AT_LIMIT);
SAME(SHM_BEYOND, ANSWER_BEYOND);
SAME(SHM_NO_NODE, ANSWER_NO_NODE);
SAME(SHM_NOT_PASSED, ANSWER_NOT_PASSED);
SAME(SHM_ELSEWHERE, ANSWER_ELSEWHERE);
SAME(SHM_NOT_UP, ANSWER_NOT_UP);
SAME(SHM_PLC_HOLDS, ANSWER_PLC_HOLDS);
SAME(SHM_SEEN, ANSWER_SEEN);
SAME(SHM_STILL_THERE, ANSWER_STILL_THERE);
SAME(SHM_NO_POWER, ANSWER_NO_POWER);
SAME(SHM_ASKS, ANSWER_ASKS);
SAME(SHM_NOT_ASKED, ANSWER_NOT_ASKED);
SAME(SHM_OVER, ANSWER_OVER);
SAME(SHM_OVER + 1, CYCLE_NANSWERS);
SAME(SHM_OUTCOME_NONE, OUTCOME_NONE);
SAME(SHM_OUTCOME_DONE, OUTCOME_DONE);
SAME(SHM_OUTCOME_FAULT, OUTCOME_FAULT);
SAME(SHM_OUTCOME_STOPPED, OUTCOME_STOPPED);
SAME(MOVED_FAULT, SHM_MOVED_FAULT);
_Static_assert((int)CYCLE_NVERBS <= (int)SHM_LOAD, "verbs do not overlap");

/* A job that has ended shows its last place until it is unloaded. */
static double told_place_mm(const struct loop *l)
{
	return l->program ? interp_cursor_place_mm(&l->cycle.cursor) : 0;
}

static struct shm_event event_of(const struct loop *l, uint32_t kind)
{
	return (struct shm_event) {
		.cycle = l->cycle.count,
		.time_ns = l->time_ns,
		.kind = kind,
		.program = l->program ? l->program->n : 0,
		.line = l->program ? mcode_line(&l->cycle) : 0,
		.place_mm = told_place_mm(l),
	};
}

void loop_event(struct loop *l, uint32_t kind, uint64_t id, int32_t code)
{
	struct shm_event e = event_of(l, kind);

	e.id = id;
	e.code = code;
	shm_event(l->status, &e);
}

void loop_event_set(struct loop *l, uint32_t field, double was, double now)
{
	struct shm_event e = event_of(l, SHM_EV_SET);

	e.id = field;
	e.was = was;
	e.now = now;
	shm_event(l->status, &e);
}

void loop_sets(struct loop *l)
{
	const struct conditions *p = &l->cycle.conditions;
	struct shm_sets s = {
		.program_key = l->program ? l->program->key : 0,
		.n = p->nsets,
	};

	for (uint32_t i = 0; i < p->nsets; i++)
		s.set[i] = (struct shm_set) {
			.value = p->set[i].value, .cond = p->set[i].cond,
			.field = p->set[i].field,
		};
	shm_sets_put(l->status, &s);
}

void loop_answer(struct loop *l, uint64_t id, int32_t answer)
{
	shm_done_end(l->status, id, answer);
	loop_event(l, SHM_EV_ANSWER, id, answer);
}

/*
 * A condition is called when the walk first comes to it.  On the way back an
 * earlier condition is in force again, but that is not a call.
 */
static void notice_condition(struct loop *l)
{
	const struct cycle *c = &l->cycle;
	struct loop_told *t = &l->told;
	const uint32_t program = l->program ? l->program->n : 0;

	if (t->program != program) {
		t->program = program;
		t->letter = 0;
		t->number = 0;
	}
	if (!c->loaded || !c->out.cond_letter ||
	    (c->out.cond_letter == t->letter &&
	     c->out.cond_number == t->number) ||
	    told_place_mm(l) < c->far_mm)
		return;
	t->letter = c->out.cond_letter;
	t->number = c->out.cond_number;
	loop_event(l, SHM_EV_CONDITION, (uint8_t)t->letter,
		   (int32_t)t->number);
}

/* Report each fault that was latched, whatever came after it. */
static void notice_faults(struct loop *l)
{
	uint64_t f = l->cycle.fault.untold;

	for (l->cycle.fault.untold = 0; f; f &= f - 1) {
		const struct interp_seg *beyond = probe_rest_beyond(&l->cycle);
		struct shm_event e = event_of(l, SHM_EV_FAULT);

		e.code = __builtin_ctzll(f);
		if (beyond && e.code == FAULT_SOFT_LIMIT) {
			e.line = beyond->line;
			e.place_mm = beyond->s_mm;
		}
		shm_event(l->status, &e);
	}
}

/* A servo hunts many times a minute.  So it is reported the first time, the
 * tenth, the hundredth ... */
static bool is_power_of_ten(uint32_t n)
{
	while (n > 1 && n % 10 == 0)
		n /= 10;
	return n == 1;
}

static void notice_ended(const struct loop *l)
{
	struct shm_snapshot s;
	struct shm_ended e;

	if (!l->program)
		return;
	loop_snapshot(l, &s);
	e = (struct shm_ended) {
		.program = s.program, .outcome = s.outcome,
		.time_ns = s.time_ns, .period_ns = s.period_ns,
		.place_mm = s.place_mm, .far_mm = s.far_mm,
		.length_mm = s.length_mm, .depth_mm = s.depth_far_mm,
		.job_cycles = s.job_cycles, .jumps = s.jumps,
		.retracts = s.retracts, .shorts = s.shorts,
		.arcs = s.arcs, .erode_cycles = s.erode_cycles,
		.energy_j = s.energy_j,
	};
	memcpy(e.hash, l->cycle.cursor.p.head->hash, sizeof(e.hash));
	shm_ended_put(l->status, &e);
}

static void notice_stand(struct loop *l)
{
	const struct stand_now now = stand_now(&l->cycle);
	struct loop_told *t = &l->told;

	if (now.why == t->stand.why && now.of == t->stand.of)
		return;
	t->stand = now;
	t->stood = l->cycle.count;
	loop_event(l, SHM_EV_STAND,
		   (uint64_t)l->cycle.stand.n << 32 | now.of, (int32_t)now.why);
}

/* Faults come first, so that a reader of "state: fault" already knows which. */
void loop_notice(struct loop *l)
{
	const struct cycle *c = &l->cycle;
	struct loop_told was = l->told;

	l->told.state = c->state;
	l->told.outcome = c->outcome;
	l->told.hunts = c->totals.hunts;
	notice_faults(l);
	if (c->state != was.state)
		loop_event(l, SHM_EV_STATE, 0, (int32_t)c->state);
	if (c->outcome != was.outcome && c->outcome != OUTCOME_NONE) {
		notice_ended(l);
		loop_event(l, SHM_EV_ENDED, 0, (int32_t)c->outcome);
	}
	if (c->totals.hunts > was.hunts && is_power_of_ten(c->totals.hunts))
		loop_event(l, SHM_EV_HUNTING, 0, (int32_t)c->retract.in_row);
	notice_stand(l);
	notice_condition(l);
}

static void snapshot_place(const struct cycle *c, struct shm_snapshot *s)
{
	const struct interp_cursor *at = &c->cursor;
	const struct depth *d = &c->depth;

	s->seg = at->index;
	s->tick = at->tick;
	s->line = mcode_line(c);
	s->place_mm = interp_cursor_place_mm(at);
	s->far_mm = c->far_mm;
	s->length_mm = at->p.head->length_mm;
	s->depth_mm = d->now_mm;
	s->depth_far_mm = d->cut.far_mm;
	s->depth_known_mm = d->cut.known_mm;
	s->depth_counts = d->cut.counts;
	s->depth_met = d->met;
	memcpy(s->depth_from, d->cut.from, sizeof(s->depth_from));
	memcpy(s->depth_way, d->cut.way, sizeof(s->depth_way));
}

static void snapshot_probe(const struct cycle *c, struct shm_snapshot *s)
{
	const struct probe *t = &c->probe;

	memcpy(s->shift, t->shift, sizeof(s->shift));
	memcpy(s->found, t->found, sizeof(s->found));
	s->found_once = t->once;
	s->found_twice = t->twice;
	s->back_mm = c->back_mm;
}

/* What the next edmd needs if this one is killed. */
static void snapshot_stand(const struct loop *l, struct shm_snapshot *s)
{
	struct axis_state at;

	axis_state_get(&l->cycle, &at);
	memcpy(s->drive, at.drive, sizeof(s->drive));
	memcpy(s->off, at.off, sizeof(s->off));
	s->sure_mm = l->cycle.resync.sure_mm;
	memcpy(s->moved_mm, l->cycle.resync.moved_mm, sizeof(s->moved_mm));
	memcpy(s->seen, l->cycle.resync.seen, sizeof(s->seen));
	memcpy(s->moved_way, l->cycle.resync.moved_way, sizeof(s->moved_way));
	s->adrift = (uint8_t)l->cycle.resync.adrift;
	s->moved_beside = (uint8_t)l->cycle.resync.moved_beside;
	memcpy(s->home_shift, at.shift, sizeof(s->home_shift));
	memcpy(s->toward, at.toward, sizeof(s->toward));
	memcpy(s->limit_side, at.limit.side, sizeof(s->limit_side));
	s->homed = (uint8_t)at.homed;
	s->unplaced = (uint8_t)at.unplaced;
	s->axes_c = at.told_c;
	s->axes_key = l->axes_key;
	s->home_key = l->home_key;
	s->has_origin = l->io.origin &&
			l->io.origin(l->io.self, s->origin);
	s->program_key = l->program ? l->program->key : 0;
	s->override = l->cycle.override;
	s->plc_override = l->cycle.plc_override;
	s->mcode = l->cycle.mcode.number;
	s->mcode_at = l->cycle.mcode.at;
	s->kept_stand = l->cycle.stand.why;
	s->kept_of = l->cycle.stand.of;
	s->stand_n = l->cycle.stand.n;
	s->confirmed = l->cycle.stand.confirmed;
}

static void snapshot_stand_now(const struct loop *l, struct shm_snapshot *s)
{
	const struct stand_now now = stand_now(&l->cycle);

	s->stand = now.why;
	s->stand_of = now.of;
	s->stand_cycles = now.why ? l->cycle.count - l->told.stood : 0;
}

static void snapshot_generator(const struct cycle *c, struct shm_snapshot *s)
{
	const struct asking *a = &c->asking;

	memcpy(s->asked, a->now, sizeof(s->asked));
	for (int i = 0; i < SHM_NTOLD; i++)
		s->told[i] = a->says.tells >> i & 1 ? a->says.told[i] :
						      (double)NAN;
	s->tells = a->says.tells;
	s->has_asked = a->has;
}

static void snapshot_sums(const struct cycle *c, struct shm_snapshot *s)
{
	const struct cycle_totals *t = &c->totals;

	s->job_cycles = t->cycles;
	s->erode_cycles = t->erode_cycles;
	s->jump_cycles = t->jump_cycles;
	s->cut_cycles = t->cut_cycles;
	s->moved_cycles = t->moved_cycles;
	s->other_cycles = t->other_cycles;
	s->retracts = t->retracts;
	s->hunts = t->hunts;
	s->in_row = c->retract.in_row;
	s->jumps = t->jumps;
	s->shorts = t->shorts;
	s->arcs = t->arcs;
	s->energy_j = t->energy_j;
	s->overruns = t->overruns;
	s->retract_mm_max = t->retract_mm_max;
}

static void snapshot_timing(const struct loop *l, struct shm_snapshot *s)
{
	const struct loop_timing *t = &l->timing;

	s->period_ns = l->cycle.config.period_ns;
	s->wake_late_ns = t->late_ns;
	s->wake_late_max_ns = t->late_max_ns;
	s->took_ns = t->took_ns;
	s->took_max_ns = t->took_max_ns;
}

void loop_snapshot(const struct loop *l, struct shm_snapshot *ret)
{
	const struct cycle *c = &l->cycle;

	*ret = (struct shm_snapshot) {
		.cycle = c->count,
		.time_ns = l->time_ns,
		.state = c->state,
		.fault = c->fault.first,
		.faults = c->fault.latched,
		.moved_by = l->moved_by, .moved = c->moved.how,
		.outcome = c->outcome,
		.program = l->program ? l->program->n : 0,
		.cond_number = c->out.cond_number,
		.cond_letter = c->out.cond_letter,
		.power = c->out.power,
		.pump = c->out.pump,
		.negative = io_is_negative(&c->out),
		.loaded = c->loaded,
		.unhomed = (uint8_t)manual_unhomed(c),
		.limit = (uint8_t)c->limit.on,
		.feed_mm_s = c->feed_mm_s,
		.gap_v = c->gap_v,
	};
	memcpy(ret->pos, c->out.target, sizeof(ret->pos));
	memcpy(ret->pulse_mm, l->pulse_mm, sizeof(ret->pulse_mm));
	if (l->program)
		snapshot_place(c, ret);
	snapshot_probe(c, ret);
	snapshot_stand(l, ret);
	snapshot_stand_now(l, ret);
	snapshot_generator(c, ret);
	snapshot_sums(c, ret);
	snapshot_timing(l, ret);
}

void loop_trace(const struct loop *l, const struct io_inputs *in,
		struct shm_trace *ret)
{
	const struct cycle *c = &l->cycle;

	*ret = (struct shm_trace) {
		.cycle = c->count,
		.place_mm = l->program ? place_mm(c) : 0,
		.feed_mm_s = c->feed_mm_s,
		.gap_v = c->gap_v,
		.line = l->program ? c->cursor.seg.line : 0,
		.state = c->state,
	};
	memcpy(ret->pos, c->out.target, sizeof(ret->pos));
	/* Without shift and compensation, as pos is. */
	for (int i = 0; i < INTERP_NAXES; i++) {
		ret->sent[i] = c->out.target[i] + c->contouring.added[i];
		ret->actual[i] = comp_place(&c->comp.axis[i], in->actual[i]);
	}
}
