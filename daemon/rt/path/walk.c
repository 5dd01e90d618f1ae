/* SPDX-License-Identifier: Apache-2.0 */
/*
 * walk.c - walk the cursor, count the pulses, do the actions
 *
 * An action is done when the walk first comes to it. If the walk goes back over
 * it and forward again, it is not done twice.
 */
#include "path/walk.h"
#include "path/place.h"
#include "path/timed.h"

#include <math.h>
#include <string.h>

/* Segments looked at, back from here. */
#define BEHIND_MAX	512

bool walk_rejoins(const struct cycle *c)
{
	return place_mm(c) < c->job.rejoin_mm - 2 * MOVER_ONTO_MM;
}

static bool is_written_as_cut(const struct cycle *c, const struct interp_seg *s)
{
	return !c->config.dry_run && !c->job.power_off &&
	       !(s->flags & INTERP_SEG_UNCUT);
}

bool walk_is_cut(const struct cycle *c, const struct interp_seg *s)
{
	return is_written_as_cut(c, s) &&
	       !(s->s_mm < c->job.rejoin_mm && walk_rejoins(c));
}

bool walk_is_due(const struct cycle *c, uint32_t i, const struct interp_seg *s)
{
	return i > c->job.action_done ||
	       (s->kind == INTERP_MCODE && mcode_again(c, i, s->arg));
}

static bool is_at_end(const struct interp_cursor *at)
{
	return at->s_mm >= at->seg.length_mm - MOVER_ONTO_MM &&
	       at->index + 1 < at->p.head->nsegs;
}

/* The segment that is under way; at its end, the next one. */
static const struct interp_seg *seg_ahead(const struct interp_cursor *at)
{
	return is_at_end(at) ? &at->p.segs[at->index + 1] : &at->seg;
}

bool walk_needs_wire(const struct cycle *c)
{
	const struct interp_seg *s = seg_ahead(&c->cursor);

	return s->kind < INTERP_BEGIN && is_written_as_cut(c, s);
}

enum walk_ahead walk_ahead(const struct cycle *c)
{
	const struct interp_seg *s = seg_ahead(&c->cursor);

	if (s->kind >= INTERP_BEGIN)
		return AHEAD_ACTION;
	if (s->flags & INTERP_SEG_SENSED)
		return AHEAD_PROBE;
	return walk_is_cut(c, s) ? AHEAD_CUT : AHEAD_FREE;
}

/* Was the motion that led to the actions it stands at no cut?  Nothing was cut
 * in front of the first motion. */
static bool was_positioned(const struct cycle *c)
{
	const struct interp_seg *s = &c->cursor.seg;
	uint32_t i = c->cursor.index;

	for (int n = 0; n < BEHIND_MAX && i > 0 && s->kind >= INTERP_BEGIN; n++)
		s = &c->cursor.p.segs[--i];
	return s->kind >= INTERP_BEGIN || s->flags & INTERP_SEG_UNCUT;
}

/* What is sensed is not cut either. */
bool walk_positions(const struct cycle *c)
{
	const struct interp_seg *s = seg_ahead(&c->cursor);

	return s->kind >= INTERP_BEGIN ? was_positioned(c) : !walk_is_cut(c, s);
}

double walk_cut_mm(const struct cycle *c, double least_mm)
{
	const struct interp_program *p = &c->cursor.p;
	uint32_t i = c->cursor.index + is_at_end(&c->cursor);

	for (int n = 0; n < BEHIND_MAX && i > 0 && p->segs[i].s_mm > least_mm;
	     n++) {
		const struct interp_seg *s = &p->segs[i - 1];

		if (!interp_program_seg_ok(p, i - 1, s) ||
		    (s->kind < INTERP_BEGIN && !walk_is_cut(c, s)))
			break;
		i--;
	}
	return p->segs[i].s_mm;
}

static bool beyond(const struct cycle *c)
{
	const struct interp_cursor *at = &c->cursor;

	for (uint32_t m = at->moved; m; m &= m - 1) {
		const int i = __builtin_ctz(m);

		if (!place_in_travel(c, i, at->pos[i]))
			return true;
	}
	return false;
}

static void count_point(struct cycle *c, uint32_t moved)
{
	for (uint32_t m = moved; m; m &= m - 1)
		c->totals.pulses[__builtin_ctz(m)]++;
}

/* The last point was one too many: go back to the one before. */
static void undo_point(struct cycle *c)
{
	interp_cursor_aim(&c->cursor, c->cursor.backward ? 1e9 : -1e9);
	interp_cursor_step(&c->cursor);
	interp_cursor_stop(&c->cursor);
}

/* -- Many points at once --------------------------------------------------- */

#define RUN	64
#define FEW	4			/* are counted one by one */

/* Is every axis so far inside its travel that no point of a run can be
 * outside? */
static bool well_inside(const struct cycle *c)
{
	const struct interp_cursor *at = &c->cursor;

	for (uint32_t j = 0; j < at->p.head->naxes; j++) {
		const uint8_t i = at->p.head->column[j];
		if (!place_in_travel(c, i, at->pos[i] - RUN) ||
		    !place_in_travel(c, i, at->pos[i] + RUN))
			return false;
	}
	return true;
}

/* Put bit i of @mask as a 1 into byte i. */
static uint64_t spread(uint64_t mask)
{
	const uint64_t ones = UINT64_C(0x0101010101010101);
	const uint64_t bits = mask * ones & UINT64_C(0x8040201008040201);

	return (bits + 0x7f * ones) >> 7 & ones;
}

/* Count the pulses of at most 255 points: a byte for each axis holds its
 * sum. */
static void count_run(struct cycle *c, const uint16_t *pulses, uint32_t n)
{
	uint64_t sums = 0;

	if (n < FEW) {
		for (uint32_t k = 0; k < n; k++)
			count_point(c, INTERP_PULSE_MOVED(pulses[k]));
		return;
	}
	for (uint32_t k = 0; k < n; k++)
		sums += spread(INTERP_PULSE_MOVED(pulses[k]));
	for (int i = 0; i < INTERP_NAXES; i++, sums >>= 8)
		c->totals.pulses[i] += sums & 0xff;
}

/* Make many points at once, if nobody looks at each point. Return: how many; 0
 * means that single steps have to be made. */
static uint32_t run(struct cycle *c, uint32_t max)
{
	uint16_t pulses[RUN];
	uint32_t n;

	if (!interp_cursor_is_due(&c->cursor) || c->on_point ||
	    !well_inside(c))
		return 0;
	n = interp_cursor_run(&c->cursor, pulses, max < RUN ? max : RUN);
	count_run(c, pulses, n);
	return n;
}

/* -- One by one ------------------------------------------------------------ */

/* @left: how many points this cycle may still make. */
static enum walk_result points(struct cycle *c, uint32_t *left)
{
	while (*left > 0) {
		const uint32_t ran = run(c, *left);

		*left -= ran > 0 ? ran : 1;
		if (ran > 0)
			continue;
		switch (interp_cursor_step(&c->cursor)) {
		case INTERP_MOVED:
			if (beyond(c)) {
				undo_point(c);
				return WALK_BEYOND;
			}
			count_point(c, c->cursor.moved);
			if (c->on_point)
				c->on_point(c->on_point_arg, c);
			break;
		case INTERP_ARRIVED:
			return WALK_ON;
		case INTERP_AT_ACTION:
		case INTERP_AT_END:
			return WALK_ACTION;
		case INTERP_AT_START:
			return WALK_START;
		default:
			return WALK_BROKEN;
		}
	}
	/* This cycle may make no more points: go on as far as possible without
	 * one. */
	if (!interp_cursor_slide(&c->cursor))
		c->cut_short = true;
	return WALK_ON;
}

/* An action that is already done is no reason to stop: the walk goes on behind
 * it. */
static bool pass_done(struct cycle *c)
{
	const uint32_t next = c->cursor.index + 1;
	const struct interp_seg s = c->cursor.p.segs[next];

	return !walk_is_due(c, next, &s) && s.kind != INTERP_END &&
	       interp_cursor_pass(&c->cursor) != INTERP_BAD_SEGMENT;
}

enum walk_result walk_by(struct cycle *c, double ds_mm)
{
	const double from = interp_cursor_place_mm(&c->cursor);
	uint32_t left = c->busy ? 0 : c->config.points_max;
	enum walk_result r;
	double to;

	interp_cursor_aim(&c->cursor, ds_mm);
	/* A cut has no new lattice point in most cycles. */
	r = left > 0 && interp_cursor_creep(&c->cursor) ? WALK_ON :
							  points(c, &left);
	for (int n = 0; n < INTERP_CROSS_MAX && r == WALK_ACTION &&
	     pass_done(c); n++) {
		interp_cursor_aim(&c->cursor,
				  from + ds_mm -
					  interp_cursor_place_mm(&c->cursor));
		r = points(c, &left);
	}
	if (r == WALK_BROKEN) {
		c->feed_mm_s = 0;
		return r;
	}
	place_target(c, c->cursor.pos);
	to = interp_cursor_place_mm(&c->cursor);
	c->feed_mm_s = (to - from) * 1e9 / (double)c->config.period_ns;
	if (to > c->far_mm)
		c->far_mm = to;
	return r;
}

/* -- Actions --------------------------------------------------------------- */

static bool dwell_over(struct cycle *c, const struct interp_seg *s)
{
	if (!c->job.dwelling) {
		c->job.dwelling = true;
		c->job.dwell_left = (uint64_t)s->arg * 1000000 /
				(uint64_t)c->config.period_ns;
	}
	if (c->job.dwell_left > 0) {
		c->job.dwell_left--;
		return false;
	}
	c->job.dwelling = false;
	return true;
}

static void switch_aux(struct cycle *c, uint32_t what)
{
	switch (what) {
	case INTERP_AUX_POWER_OFF:
		c->job.power_off = true;
		break;
	case INTERP_AUX_POWER_POSITIVE:
	case INTERP_AUX_POWER_NEGATIVE:
		c->job.power_off = false;
		break;
	case INTERP_AUX_PUMP_ON:
	case INTERP_AUX_PUMP_OFF:
		c->out.pump = what == INTERP_AUX_PUMP_ON;
		break;
	default:
		break;
	}
}

static bool is_change(const struct interp_seg *s)
{
	return s->kind == INTERP_ELECTRODE && s->arg & INTERP_ELECTRODE_STOP;
}

void walk_pass_change(struct cycle *c, const struct interp_seg *s)
{
	if (s->kind == INTERP_ELECTRODE)
		c->job.electrode = s->arg & ~INTERP_ELECTRODE_STOP;
	if (is_change(s))
		c->back_mm = fmax(c->back_mm, s->s_mm);
}

void walk_meet_change(struct cycle *c, uint32_t mcode)
{
	const struct interp_program *p = &c->cursor.p;

	if (mcode + 1 < p->head->nsegs &&
	    p->segs[mcode + 1].kind == INTERP_ELECTRODE)
		walk_pass_change(c, &p->segs[mcode + 1]);
}

static enum walk_deed stops_for(const struct cycle *c,
				const struct interp_seg *s)
{
	if (s->kind == INTERP_STOP)
		return ACTION_HOLD;
	if (s->kind == INTERP_OPTIONAL_STOP && c->config.optional_stop)
		return ACTION_OPTIONAL;
	return is_change(s) ? ACTION_ELECTRODE : ACTION_PASSED;
}

enum walk_deed walk_action(struct cycle *c)
{
	const uint32_t next = c->cursor.index + 1;
	const struct interp_seg s = c->cursor.p.segs[next];
	const bool first = next > c->job.action_done;

	if (s.kind == INTERP_END)
		return ACTION_END;
	if (first && s.kind == INTERP_DWELL && !dwell_over(c, &s))
		return ACTION_PASSED;
	if (s.kind == INTERP_MCODE)
		walk_meet_change(c, next);
	if (s.kind == INTERP_MCODE && !mcode_meet(c, next, s.arg))
		return ACTION_WAIT;
	if (first && s.kind == INTERP_AUX)
		switch_aux(c, INTERP_AUX_OF(s.arg));
	if (first && s.kind == INTERP_TIMED_END)
		timed_over(c, next);
	c->job.action_done = first ? next : c->job.action_done;
	if (interp_cursor_pass(&c->cursor) == INTERP_BAD_SEGMENT) {
		fault_latch(&c->fault, FAULT_PROGRAM);
		return ACTION_PASSED;
	}
	if (first && s.kind == INTERP_TIMED)
		timed_begin(c, s.arg);
	walk_pass_change(c, &s);
	return first ? stops_for(c, &s) : ACTION_PASSED;
}
