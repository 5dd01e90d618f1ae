/* SPDX-License-Identifier: Apache-2.0 */
/*
 * home.c - homing: a table with one function for each phase
 *
 * Each function does one period and says which phase the next period is in.
 * Where a search ends is fixed when it begins; beyond that the fault is
 * home-not-found.
 *
 * A phase that ends still moves in its last period: a period without motion
 * would be a jolt.
 */
#include "axes/manual.h"
#include "io.h"
#include "path/laws.h"

#include <math.h>

/* What the drive reports, from the inputs of this period. */
static int32_t pulses(const struct cycle *c)
{
	return comp_pulses(&c->comp.axis[c->manual.axis]);
}

static bool is_on(const struct cycle *c, uint32_t bits)
{
	return bits >> c->manual.axis & 1;
}

static void run(struct cycle *c, int toward, double v_mm_s)
{
	const struct mover_limits l = manual_limits(c, v_mm_s);

	manual_move(c, mover_run(&c->manual.mover, &l, toward * l.v_max_mm_s));
}

/* Pulses, as the mm of an axis. */
static int64_t in_pulses(const struct manual_axis *a, double mm)
{
	return llround(mm / a->pulse_mm);
}

/* The way from the far end of the travel to the switch or mark. */
static int64_t reach(const struct cycle *c, uint32_t axis)
{
	const struct manual_axis *a = &c->config.axis[axis];
	const int64_t at = in_pulses(a, a->home_at_mm);
	const int64_t way = a->home_toward < 0 ?
			    c->config.travel_max[axis] - at :
			    at - c->config.travel_min[axis];

	return way > 0 ? way : 0;
}

/*
 * Where the switch or mark is at last, and home_search_mm beyond.  An axis
 * whose place is known knows how far that is; another one may stand at the far
 * end of its travel.  Nothing is searched beyond that when homing begins again:
 * the place is still unknown, but the drive has counted how far it went.
 */
void home_aim(struct cycle *c, uint32_t axis)
{
	struct manual *h = &c->manual;
	const struct manual_axis *a = &c->config.axis[axis];
	const int64_t at = in_pulses(a, a->home_at_mm);
	const bool known = h->homed >> axis & 1;

	if (h->aimed >> axis & 1 && !known)
		return;
	h->aimed |= 1u << axis;
	h->end[axis] = comp_pulses(&c->comp.axis[axis]) +
		       (known ? at - c->out.target[axis] :
				a->home_toward * reach(c, axis)) +
		       a->home_toward * in_pulses(a, a->home_search_mm);
}

/* It stands on its switch: it comes back to here at most, and has no more than
 * the whole travel behind it. */
static void aim_off(struct cycle *c)
{
	struct manual *h = &c->manual;
	const struct manual_axis *a = manual_axis(c);
	const int64_t more = a->home_toward * in_pulses(a, a->home_search_mm);
	int64_t *end = &h->end[h->axis];

	h->end_off = pulses(c) - a->home_toward * reach(c, h->axis) - more;
	if (a->home_toward * (pulses(c) - *end) > 0)
		*end = pulses(c) + more;
}

static void watch_way(struct cycle *c)
{
	const struct manual *h = &c->manual;
	const int toward = manual_axis(c)->home_toward;
	const bool off = h->phase == HOME_LEAVE || h->phase == HOME_CLEAR;
	const bool onto = h->phase == HOME_SEEK || h->phase == HOME_ONTO ||
			  h->phase == HOME_INDEX;

	if ((onto && toward * (pulses(c) - h->end[h->axis]) > 0) ||
	    (off && toward * (pulses(c) - h->end_off) < 0))
		fault_latch(&c->fault, FAULT_HOME);
}

/* The axis that comes first in the order; if several have the same order, the
 * first by name. */
static uint32_t next_axis(const struct cycle *c)
{
	uint32_t best = INTERP_NAXES;

	for (uint32_t m = c->manual.todo; m; m &= m - 1) {
		const uint32_t i = (uint32_t)__builtin_ctz(m);

		if (best == INTERP_NAXES || c->config.axis[i].home_order <
					    c->config.axis[best].home_order)
			best = i;
	}
	return best;
}

void home_place(struct cycle *c, uint32_t axis, int32_t place, int32_t drive)
{
	const int32_t was = comp_pulses(&c->comp.axis[axis]);

	limit_recount(&c->limit, axis, (uint32_t)drive - (uint32_t)was);
	c->out.target[axis] = place;
	comp_settle(&c->comp, &c->config.comp, axis, c->out.target, drive);
	c->manual.unplaced &= ~(1u << axis);
}

/* The place that lies @beyond pulses beyond home_at_mm. */
static void call(struct cycle *c, int32_t beyond, int32_t drive)
{
	struct manual *h = &c->manual;
	const double at = manual_axis(c)->home_at_mm / manual_axis(c)->pulse_mm;

	home_place(c, h->axis, (int32_t)((uint32_t)llround(at) +
					 (uint32_t)beyond), drive);
	h->homed |= 1u << h->axis;
	h->todo &= ~(1u << h->axis);
	h->aimed &= ~(1u << h->axis);
}

/* A drive that has lost its own zero says something, too. */
static void call_own(struct cycle *c, const struct io_inputs *in)
{
	const uint32_t i = c->manual.axis;
	const struct manual_axis *a = manual_axis(c);
	const int64_t at = in_pulses(a, a->home_at_mm) + in->own[i];
	const int64_t over = in_pulses(a, a->home_search_mm);

	if (at < c->config.travel_min[i] - over ||
	    at > c->config.travel_max[i] + over)
		fault_latch(&c->fault, FAULT_HOME);
	else
		call(c, in->own[i], in->actual[i]);
}

static enum home_phase begin(struct cycle *c, const struct io_inputs *in)
{
	struct manual *h = &c->manual;

	manual_begin(c, next_axis(c));
	if (manual_axis(c)->method == HOME_NONE) {
		h->unplaced &= ~(1u << h->axis);
		h->todo &= ~(1u << h->axis);
		return HOME_BEGIN;
	}
	if (manual_axis(c)->method == HOME_ABSOLUTE) {
		call_own(c, in);
		return HOME_BEGIN;
	}
	if (manual_axis(c)->method == HOME_DRIVE) {
		h->unplaced |= 1u << h->axis;
		return HOME_BY_DRIVE;
	}
	return is_on(c, in->home) ? HOME_LEAVE : HOME_SEEK;
}

/* Where its zero is it counts anew, so what was known of its place is gone from
 * the moment on in which it begins. */
static enum home_phase by_drive(struct cycle *c, const struct io_inputs *in)
{
	if (is_on(c, in->unfound))
		fault_latch(&c->fault, FAULT_HOME);
	if (!is_on(c, in->homed))
		return HOME_BY_DRIVE;
	call_own(c, in);
	return HOME_BEGIN;
}

static enum home_phase seek(struct cycle *c, const struct io_inputs *in)
{
	const struct manual_axis *a = manual_axis(c);

	run(c, a->home_toward, a->home_fast_mm_s);
	return is_on(c, in->home) ? HOME_BRAKE : HOME_SEEK;
}

static enum home_phase brake(struct cycle *c, const struct io_inputs *in)
{
	(void)in;
	return manual_stop(c) ? HOME_LEAVE : HOME_BRAKE;
}

static enum home_phase leave(struct cycle *c, const struct io_inputs *in)
{
	const struct manual_axis *a = manual_axis(c);

	run(c, -a->home_toward, a->home_slow_mm_s);
	return is_on(c, in->home) ? HOME_LEAVE : HOME_CLEAR;
}

/* If the switch bounces, this phase begins anew. */
static enum home_phase clear(struct cycle *c, const struct io_inputs *in)
{
	struct manual *h = &c->manual;
	const struct manual_axis *a = manual_axis(c);
	const struct mover_limits l = manual_limits(c, a->home_slow_mm_s);
	const double goal = h->phase_mm - a->home_toward * a->home_back_mm;

	if (is_on(c, in->home))
		return leave(c, in);
	manual_move(c, mover_step(&h->mover, &l, goal - h->gone_mm));
	return h->mover.v_mm_s == 0 &&
	       fabs(goal - h->gone_mm) < 2 * MOVER_ONTO_MM ? HOME_ONTO :
							    HOME_CLEAR;
}

/* What homing looks for is here. */
static enum home_phase meet(struct cycle *c, int32_t at)
{
	c->manual.met = at;
	manual_stop(c);
	return HOME_STAND;
}

static enum home_phase go_onto(struct cycle *c, const struct io_inputs *in)
{
	const struct manual_axis *a = manual_axis(c);

	if (is_on(c, in->home) && a->method != HOME_SWITCH_INDEX)
		return meet(c, pulses(c));
	run(c, a->home_toward, a->home_slow_mm_s);
	return is_on(c, in->home) ? HOME_INDEX : HOME_ONTO;
}

/* It goes on only when no mark can be missed any more. */
static enum home_phase seek_index(struct cycle *c, const struct io_inputs *in)
{
	const struct manual_axis *a = manual_axis(c);

	if (is_on(c, in->latched))
		return meet(c, in->latched_at[c->manual.axis]);
	if (is_on(c, in->unfound))
		fault_latch(&c->fault, FAULT_HOME);
	run(c, a->home_toward, is_on(c, in->latching) ? a->home_slow_mm_s : 0);
	return HOME_INDEX;
}

/* The way of the last period has gone out before the place is called. */
static enum home_phase stand(struct cycle *c, const struct io_inputs *in)
{
	(void)in;
	if (!mover_is_standing(&c->manual.mover)) {
		manual_stop(c);
		return HOME_STAND;
	}
	call(c, pulses(c) - c->manual.met, pulses(c));
	return HOME_BEGIN;
}

typedef enum home_phase (*home_step)(struct cycle *, const struct io_inputs *);

static const home_step phases[HOME_NPHASES] = {
	[HOME_BEGIN]	= begin,
	[HOME_SEEK]	= seek,
	[HOME_BRAKE]	= brake,
	[HOME_LEAVE]	= leave,
	[HOME_CLEAR]	= clear,
	[HOME_ONTO]	= go_onto,
	[HOME_INDEX]	= seek_index,
	[HOME_STAND]	= stand,
	[HOME_BY_DRIVE]	= by_drive,
};

bool home_go(struct cycle *c, const struct io_inputs *in)
{
	struct manual *h = &c->manual;
	const enum home_phase was = h->phase;

	if (was == HOME_BEGIN && h->todo == 0)
		return true;
	h->phase = phases[was](c, in);
	if (h->phase != was)
		h->phase_mm = h->gone_mm;
	if (h->phase == HOME_LEAVE && (was == HOME_BEGIN || was == HOME_BRAKE))
		aim_off(c);
	watch_way(c);
	return false;
}
