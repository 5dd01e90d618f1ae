/* SPDX-License-Identifier: Apache-2.0 */
/*
 * walk.c - walk the cursor, count the pulses, meet the actions
 *
 * An action is done when the walk first comes to it; going back over it and
 * forward again does not do it twice.
 */
#include "walk.h"

#include <string.h>

#define AT_END_MM	1e-9

bool walk_is_cut(const struct cycle *c, const struct interp_seg *s)
{
	return !c->config.dry_run && !c->power_off &&
	       !(s->flags & INTERP_SEG_RAPID);
}

enum walk_ahead walk_ahead(const struct cycle *c)
{
	const struct interp_cursor *at = &c->cursor;
	const struct interp_seg *s = &at->seg;
	const uint32_t next = at->index + 1;

	if (at->s_mm >= s->length_mm - AT_END_MM && next < at->p.head->nsegs)
		s = &at->p.segs[next];
	if (s->kind >= INTERP_BEGIN)
		return AHEAD_ACTION;
	return walk_is_cut(c, s) ? AHEAD_CUT : AHEAD_FREE;
}

static bool beyond(const struct cycle *c)
{
	const struct interp_cursor *at = &c->cursor;

	for (uint32_t m = at->moved; m; m &= m - 1) {
		const int i = __builtin_ctz(m);

		if (at->pos[i] < c->config.travel_min[i] ||
		    at->pos[i] > c->config.travel_max[i])
			return true;
	}
	return false;
}

static void count_pulses(struct cycle *c)
{
	for (uint32_t m = c->cursor.moved; m; m &= m - 1)
		c->totals.pulses[__builtin_ctz(m)]++;
}

/* The last point was one too far: back to the one before. */
static void undo_point(struct cycle *c)
{
	interp_cursor_aim(&c->cursor, c->cursor.backward ? 1e9 : -1e9);
	interp_cursor_step(&c->cursor);
	interp_cursor_stop(&c->cursor);
}

static enum walk_result points(struct cycle *c)
{
	for (uint32_t n = 0; n < c->config.points_max; n++) {
		switch (interp_cursor_step(&c->cursor)) {
		case INTERP_MOVED:
			if (beyond(c)) {
				undo_point(c);
				return WALK_BEYOND;
			}
			count_pulses(c);
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
	/* More points than a cycle may have: the rest of the way is left. */
	interp_cursor_stop(&c->cursor);
	return WALK_ON;
}

enum walk_result walk_by(struct cycle *c, double ds_mm)
{
	const double from = interp_cursor_place_mm(&c->cursor);
	enum walk_result r;
	double to;

	interp_cursor_aim(&c->cursor, ds_mm);
	r = points(c);
	if (r == WALK_BROKEN) {
		c->feed_mm_s = 0;
		return r;
	}
	memcpy(c->out.target, c->cursor.pos, sizeof(c->out.target));
	to = interp_cursor_place_mm(&c->cursor);
	c->feed_mm_s = (to - from) * 1e9 / (double)c->config.period_ns;
	if (to > c->far_mm)
		c->far_mm = to;
	return r;
}

/* -- Actions ------------------------------------------------------------------ */

static bool dwell_over(struct cycle *c, const struct interp_seg *s)
{
	if (!c->dwelling) {
		c->dwelling = true;
		c->dwell_left = (uint64_t)s->arg * 1000000 /
				(uint64_t)c->config.period_ns;
	}
	if (c->dwell_left > 0) {
		c->dwell_left--;
		return false;
	}
	c->dwelling = false;
	return true;
}

static void switch_aux(struct cycle *c, uint32_t what)
{
	switch (what) {
	case INTERP_AUX_POWER_OFF:
		c->power_off = true;
		break;
	case INTERP_AUX_POWER_POSITIVE:
	case INTERP_AUX_POWER_NEGATIVE:
		c->power_off = false;
		c->out.negative = what == INTERP_AUX_POWER_NEGATIVE;
		break;
	case INTERP_AUX_PUMP_ON:
	case INTERP_AUX_PUMP_OFF:
		c->out.pump = what == INTERP_AUX_PUMP_ON;
		break;
	default:
		break;
	}
}

enum walk_deed walk_action(struct cycle *c)
{
	const uint32_t next = c->cursor.index + 1;
	const struct interp_seg s = c->cursor.p.segs[next];
	const bool first = next > c->action_done;

	if (s.kind == INTERP_END)
		return ACTION_END;
	if (first && s.kind == INTERP_DWELL && !dwell_over(c, &s))
		return ACTION_PASSED;
	if (first && s.kind == INTERP_AUX)
		switch_aux(c, s.arg);
	c->action_done = first ? next : c->action_done;
	if (interp_cursor_pass(&c->cursor) == INTERP_BAD_SEGMENT) {
		cycle_fail(c, FAULT_PROGRAM);
		return ACTION_PASSED;
	}
	if (first && (s.kind == INTERP_STOP ||
		      (s.kind == INTERP_OPTIONAL_STOP &&
		       c->config.optional_stop)))
		return ACTION_HOLD;
	return ACTION_PASSED;
}
