/* SPDX-License-Identifier: Apache-2.0 */
/* resync.c - from where the axes stand back to the path */
#include "path/resync.h"

#include "path/laws.h"
#include "path/place.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NEAR_PULSES	5		/* an axis that holds its place moves
					 * by less */
#define POINTS_MS	1000		/* of the search, in a ms of a period */

static int32_t plus(int32_t a, int32_t b)
{
	return (int32_t)((uint32_t)a + (uint32_t)b);
}

static int32_t minus(int32_t a, int32_t b)
{
	return (int32_t)((uint32_t)a - (uint32_t)b);
}

/* -- Where the axes stand -------------------------------------------------- */

static bool any(const int32_t off[INTERP_NAXES])
{
	int32_t some = 0;

	for (int i = 0; i < INTERP_NAXES; i++)
		some |= off[i];
	return some != 0;
}

void resync_set(struct resync *r, const int32_t off[INTERP_NAXES])
{
	memcpy(r->off, off, sizeof(r->off));
	r->is_off = any(r->off);
}

bool resync_is_off(const struct cycle *c)
{
	return c->resync.is_off || c->resync.walks;
}

/* Are the axes without power, or held where they stand? */
static bool stands(const struct cycle *c, const struct io_inputs *in)
{
	return in->axes_off && !in->starting && c->comp.begun &&
	       (!c->out.enable || axes_awaits(&c->axes));
}

static void measure(struct cycle *c, const struct io_inputs *in)
{
	struct resync *r = &c->resync;

	r->held = 0;
	r->slips = in->slips;
	for (int i = 0; i < INTERP_NAXES; i++) {
		r->off[i] = minus(in->stands_at[i],
				  comp_pulses(&c->comp.axis[i]));
		/* It may be stopped again on its way back. */
		if (in->ran_on[i] > r->ran_on[i])
			r->ran_on[i] = in->ran_on[i];
	}
	r->is_off = any(r->off);
}

/* An axis that is not there stands at 0, and is sent there. */
static bool is_near(const struct cycle *c, const struct io_inputs *in)
{
	uint32_t far = 0;

	for (int i = 0; i < INTERP_NAXES; i++)
		far |= (uint32_t)minus(in->actual[i], c->comp.sent[i]) +
		       NEAR_PULSES > 2 * NEAR_PULSES;
	return !far;
}

static void note_off(struct cycle *c, const struct io_inputs *in)
{
	for (int i = 0; i < INTERP_NAXES; i++)
		if (abs(minus(in->actual[i], c->comp.sent[i])) > NEAR_PULSES)
			c->resync.adrift |= 1u << i;
}

static bool is_far(const struct cycle *c)
{
	for (int i = 0; i < INTERP_NAXES; i++)
		if (abs(c->resync.off[i]) > NEAR_PULSES)
			return true;
	return false;
}

void resync_settle(struct cycle *c)
{
	struct resync *r = &c->resync;

	if (!resync_is_off(c))
		return;
	for (int i = 0; i < INTERP_NAXES; i++) {
		struct comp_axis *a = &c->comp.axis[i];

		c->out.target[i] = plus(c->out.target[i], r->off[i]);
		a->place = plus(a->place, r->off[i]);
	}
	if (cycle_is_manual(c))
		c->manual.from = plus(c->manual.from,
				      r->off[c->manual.axis]);
	memset(r->off, 0, sizeof(r->off));
	r->is_off = r->walks = false;
	memset(r->ran_on, 0, sizeof(r->ran_on));
	r->held = 0;
	c->comp.stale = true;
	c->comp.idle = false;
	c->manual.used = true;
}

void resync_begin(struct resync *r, double place_mm)
{
	r->sure_mm = place_mm;
	r->sure_beside = false;
	for (int i = 0; i < INTERP_NAXES; i++)
		r->moved_mm[i] = place_mm;
	memset(r->moved_way, 0, sizeof(r->moved_way));
	r->moved_beside = r->adrift = 0;
	r->unseen = true;
}

/* Has any axis moved since it was noted? */
static bool has_moved(const struct resync *r, const struct io_inputs *in)
{
	uint32_t far = 0;

	for (int i = 0; i < INTERP_NAXES; i++)
		far |= (uint32_t)minus(in->actual[i], r->seen[i]) +
		       NEAR_PULSES > 2 * NEAR_PULSES;
	return far;
}

/* A move of @by pulses of axis @i that its target asks for?  What was blocked
 * springs back. */
static bool goes_where_sent(const struct cycle *c, const struct io_inputs *in,
			    int i, int32_t by)
{
	const int32_t lag = minus(c->comp.sent[i], in->actual[i]);

	return lag == 0 || (lag < 0) == (by < 0);
}

/* Where does the path have each axis while that axis moves? */
static void note_moves(struct cycle *c, const struct io_inputs *in)
{
	struct resync *r = &c->resync;
	const double mm = place_mm(c);
	uint32_t moved = 0;

	for (int i = 0; i < INTERP_NAXES; i++) {
		const int32_t by = minus(in->actual[i], r->seen[i]);

		if (abs(by) <= NEAR_PULSES)
			continue;
		r->seen[i] = in->actual[i];
		if (!goes_where_sent(c, in, i, by))
			continue;
		r->moved_mm[i] = mm;
		r->moved_way[i] = by < 0 ? -1 : 1;
		moved |= 1u << i;
	}
	if (!in->axes_off)
		r->adrift &= ~moved;
	r->moved_beside = (r->moved_beside & ~moved) |
			  (escape_is_out(&c->escape) ? moved : 0);
}

/* Where the path rests, what moves an axis without power is not its target. */
static void look_at_moves(struct cycle *c, const struct io_inputs *in)
{
	struct resync *r = &c->resync;
	const bool rested = r->rested;

	if (in->starting || !c->comp.begun)
		return;
	r->rested = in->axes_off && place_mm(c) == r->looked_mm;
	if (in->axes_off)
		r->looked_mm = place_mm(c);
	if (r->unseen || (rested && !in->axes_off))
		memcpy(r->seen, in->actual, sizeof(r->seen));
	r->unseen = false;
	if (c->loaded && !r->rested && has_moved(r, in))
		note_moves(c, in);
}

/* A program is compiled from where the machine stands.  Axes without power
 * tremble by a pulse or two, which must not make it begin elsewhere. */
void resync_look(struct cycle *c, const struct io_inputs *in)
{
	struct resync *r = &c->resync;

	look_at_moves(c, in);
	if (!in->axes_off && !is_near(c, in))
		note_off(c, in);
	if (stands(c, in)) {
		measure(c, in);
		if (!c->loaded && is_far(c))
			resync_settle(c);
	} else if (c->loaded && !in->axes_off && !resync_is_off(c) &&
		   !r->adrift) {
		r->sure_mm = place_mm(c);
		r->sure_beside = escape_is_out(&c->escape);
	}
}

/* -- The search ------------------------------------------------------------ */

/* Where does axis @i stand, in pulses of the drive? */
static int32_t stands_at(const struct cycle *c, int i)
{
	return plus(comp_pulses(&c->comp.axis[i]), c->resync.off[i]);
}

/* What axis @i may have moved by itself, pulses. */
static int64_t by_itself(const struct cycle *c, int i)
{
	return (int64_t)c->config.resync.max[i] + c->resync.ran_on[i] +
	       NEAR_PULSES;
}

/* Was axis @i blocked, and in which direction?  It was off while it had power.
 * Without, it may spring back; what goes far was pushed. */
static bool seek_axis(const struct cycle *c, struct resync *r, int i)
{
	const int beyond = r->off[i] < 0 ? 1 : -1;
	const int32_t went = minus(stands_at(c, i), r->seen[i]);

	r->way[i] = r->slips >> i & 1 || r->moved_way[i] == 0 ? beyond :
		    r->moved_way[i];
	return r->adrift >> i & 1 && abs(r->off[i]) > NEAR_PULSES &&
	       abs(went) <= by_itself(c, i) &&
	       (r->way[i] == beyond || r->way[i] * went <= NEAR_PULSES);
}

void resync_search(struct cycle *c)
{
	const bool beside = escape_is_out(&c->escape);
	struct resync *r = &c->resync;
	/* An escape begins and ends where it leaves the path. */
	const double sure_mm = beside == r->sure_beside ? r->sure_mm :
			       interp_cursor_place_mm(&c->cursor);

	r->held = r->seek = r->met = r->asked = r->passed = 0;
	r->walks = r->begun = false;
	for (int i = 0; i < INTERP_NAXES; i++)
		r->seek |= (uint32_t)seek_axis(c, r, i) << i;
	r->before = r->seek;
	if (r->seek == 0)
		return;
	r->toward = sure_mm > place_mm(c) ? 1 : -1;
	r->scout = c->cursor;
	r->beside = c->escape;
	interp_cursor_aim(&r->scout, r->toward * 1e9);
}

/* Actions that were done are passed; no other is. */
static bool step_on_path(const struct cycle *c, struct interp_cursor *at)
{
	for (int n = 0; n < INTERP_CROSS_MAX; n++) {
		switch (interp_cursor_step(at)) {
		case INTERP_MOVED:
			return true;
		case INTERP_AT_ACTION:
			if (at->index + 1 > c->job.action_done ||
			    interp_cursor_pass(at) == INTERP_BAD_SEGMENT)
				return false;
			interp_cursor_aim(at, 1e9);
			break;
		default:
			return false;
		}
	}
	return false;
}

static double scout_mm(const struct resync *r)
{
	const struct interp_cursor *at = &r->scout;
	const double part = at->whole > 0 ?
			    (double)at->measure / (double)at->whole : 0;

	return at->seg.s_mm + at->seg.length_mm * part - r->beside.way_mm;
}

static bool scout_step(const struct cycle *c, struct resync *r)
{
	return escape_is_out(&r->beside) ?
	       escape_scout(&r->beside, r->toward) :
	       step_on_path(c, &r->scout);
}

/* One lattice point; @left: from the path to where the axis stands. */
static void look_for(struct resync *r, int i, int64_t left)
{
	const int64_t before = r->way[i] * left;
	const uint32_t bit = 1u << i;

	if (before < 0) {
		r->passed &= ~bit;
		r->before &= ~bit;
		return;
	}
	if (!(r->before & bit) && !(r->passed & bit)) {
		r->passed |= bit;
		r->met_mm[i] = scout_mm(r);
	}
	if (before > 0)
		r->before |= bit;
}

/* In front of moved_mm it may still have moved by NEAR_PULSES. */
static void look_behind(const struct cycle *c, struct resync *r, int i,
			int64_t left)
{
	const uint32_t bit = 1u << i;

	if (!(r->asked & bit))
		r->left[i] = llabs(left);
	r->asked |= bit;
	if (r->passed & r->before & bit) {
		r->met |= bit;
		r->seek &= ~bit;
	} else if (llabs(left) > r->left[i] + by_itself(c, i)) {
		r->seek &= ~bit;
	}
}

static void scout_look(const struct cycle *c, struct resync *r)
{
	const bool beside = escape_is_out(&r->beside);
	const int32_t *pos = beside ? r->beside.pos : r->scout.pos;

	for (uint32_t m = r->seek; m; m &= m - 1) {
		const int i = __builtin_ctz(m);
		const int64_t left = (int64_t)c->out.target[i] + r->off[i] -
				     pos[i] - c->probe.shift[i];

		look_for(r, i, left);
		if (beside != (r->moved_beside >> i & 1) ||
		    r->toward * (r->moved_mm[i] - scout_mm(r)) <= 0)
			look_behind(c, r, i, left);
		else if (llabs(left) > NEAR_PULSES)
			r->passed &= ~(1u << i);
	}
}

static enum resync_answer judge(const struct cycle *c)
{
	const struct resync *r = &c->resync;

	for (int i = 0; i < INTERP_NAXES; i++)
		if (!(r->met >> i & 1) && llabs(r->off[i]) > by_itself(c, i))
			return RESYNC_TOO_FAR;
	return RESYNC_DONE;
}

/* Farther back it did not move. */
static void end_search(struct resync *r)
{
	r->met |= r->seek & r->passed;
	r->seek = 0;
}

enum resync_answer resync_seek(struct cycle *c)
{
	struct resync *r = &c->resync;
	int64_t n = c->config.period_ns * POINTS_MS / 1000000;

	while (r->seek && n-- > 0) {
		if (scout_step(c, r))
			scout_look(c, r);
		else
			end_search(r);
	}
	return r->seek ? RESYNC_BUSY : judge(c);
}

/* -- The way --------------------------------------------------------------- */

void resync_leave(struct cycle *c)
{
	struct resync *r = &c->resync;

	r->held = r->met;
	for (int i = 0; i < INTERP_NAXES; i++)
		r->hold[i] = stands_at(c, i);
}

/* Along the path, to the next place where an axis is met. */
static enum resync_answer walk(struct cycle *c)
{
	struct resync *r = &c->resync;

	if (r->walks && c->hold.moving)
		return RESYNC_WALKS;
	if (r->walks && fabs(place_mm(c) - c->hold.to_mm) > 2 * MOVER_ONTO_MM)
		return RESYNC_GIVEN_UP;
	for (uint32_t m = r->walks ? r->held : 0; m; m &= m - 1) {
		const int i = __builtin_ctz(m);

		if (r->toward * (r->met_mm[i] - c->hold.to_mm) <= 0)
			r->held &= ~(1u << i);
	}
	r->walks = r->held != 0;
	if (!r->walks)
		return RESYNC_DONE;
	c->hold.moving = true;
	c->hold.to_mm = r->met_mm[__builtin_ctz(r->held)];
	for (uint32_t m = r->held; m; m &= m - 1) {
		const double met = r->met_mm[__builtin_ctz(m)];

		if (r->toward * (met - c->hold.to_mm) < 0)
			c->hold.to_mm = met;
	}
	return RESYNC_WALKS;
}

static void straight_begin(struct cycle *c)
{
	struct resync *r = &c->resync;

	r->begun = true;
	r->way_mm = r->gone_mm = 0;
	mover_set(&r->mover, 0);
	memcpy(r->from, r->off, sizeof(r->from));
	for (int i = 0; i < INTERP_NAXES; i++)
		r->way_mm = fmax(r->way_mm, fabs(r->off[i] *
						 c->config.axis[i].pulse_mm));
}

/* No faster than the machine puts its pulses out. */
static int32_t take_off(const struct cycle *c, int32_t off, int32_t want)
{
	const int32_t most = c->busy ? 0 : (int32_t)c->config.points_max;
	const int32_t by = want - off;

	return off + (by > most ? most : by < -most ? -most : by);
}

static enum resync_answer straight(struct cycle *c)
{
	struct resync *r = &c->resync;
	const struct mover_limits l =
		law_travel_limits(c, c->config.resync.v_mm_s);
	double left;

	if (!r->begun)
		straight_begin(c);
	r->gone_mm += mover_step(&r->mover, &l, r->way_mm - r->gone_mm);
	left = fmax(r->way_mm - r->gone_mm, 0);
	left = left > MOVER_ONTO_MM ? left / r->way_mm : 0;
	for (int i = 0; i < INTERP_NAXES; i++)
		r->off[i] = take_off(c, r->off[i],
				     (int32_t)llround(r->from[i] * left));
	r->is_off = any(r->off);
	if (resync_is_off(c) || r->mover.v_mm_s != 0)
		return RESYNC_BUSY;
	memset(r->ran_on, 0, sizeof(r->ran_on));
	return RESYNC_DONE;
}

enum resync_answer resync_go(struct cycle *c)
{
	const enum resync_answer a = c->resync.held || c->resync.walks ?
				     walk(c) : RESYNC_DONE;

	return a == RESYNC_DONE ? straight(c) : a;
}

void resync_apply(struct cycle *c, int32_t target[INTERP_NAXES])
{
	struct resync *r = &c->resync;

	if (!r->walks && !r->is_off)
		return;
	for (uint32_t m = r->walks ? r->held : 0; m; m &= m - 1) {
		const int i = __builtin_ctz(m);

		r->off[i] = minus(r->hold[i], target[i]);
	}
	r->is_off = any(r->off);
	for (int i = 0; i < INTERP_NAXES; i++)
		target[i] = plus(target[i], r->off[i]);
}
