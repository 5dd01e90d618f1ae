/* SPDX-License-Identifier: Apache-2.0 */
/* manual.c - jogs, and the code that jogs and homing share */
#include "axes/manual.h"
#include "path/laws.h"
#include "verbs.h"

#include <math.h>

/* The lattice ends at this distance from 0. */
static bool in_lattice(double pulses)
{
	return fabs(pulses) <= INTERP_PULSES_MAX;
}

uint32_t manual_unhomed(const struct cycle *c)
{
	uint32_t axes = 0;

	for (uint32_t i = 0; i < INTERP_NAXES; i++)
		if (c->config.axis[i].present &&
		    c->config.axis[i].method != HOME_NONE)
			axes |= 1u << i;
	return (axes & ~c->manual.homed) | c->manual.unplaced;
}

/* Bits of the axes whose drives home by themselves. */
static uint32_t manual_by_drive(const struct cycle *c)
{
	uint32_t axes = 0;

	for (uint32_t i = 0; i < INTERP_NAXES; i++)
		if (c->config.axis[i].method == HOME_DRIVE)
			axes |= 1u << i;
	return axes;
}

uint32_t manual_in_phase(const struct cycle *c, enum home_phase phase)
{
	const struct manual *h = &c->manual;

	return c->state == STATE_HOME && h->phase == phase &&
	       !h->halt ? 1u << h->axis : 0;
}

const struct manual_axis *manual_axis(const struct cycle *c)
{
	return &c->config.axis[c->manual.axis];
}

void manual_begin(struct cycle *c, uint32_t axis)
{
	struct manual *h = &c->manual;

	h->axis = axis;
	h->from = c->out.target[axis];
	h->gone_mm = 0;
	h->halt = false;
	h->free_seen = false;
	h->pressed = false;
	h->used = true;
	mover_set(&h->mover, 0);
}

/* Pulses of the move that the machine could not put out yet. */
static int64_t left_pulses(const struct cycle *c)
{
	const struct manual *h = &c->manual;

	return h->from + llround(h->gone_mm / manual_axis(c)->pulse_mm) -
	       c->out.target[h->axis];
}

/* What waited while the machine was busy follows no faster than the axis may
 * go. */
static int64_t period_pulses(const struct cycle *c)
{
	const struct manual_axis *a = manual_axis(c);

	return (int64_t)fmin(c->config.points_max,
			     ceil(a->v_max_mm_s * law_period_s(c) /
				  a->pulse_mm));
}

void manual_move(struct cycle *c, double ds_mm)
{
	struct manual *h = &c->manual;
	const int64_t most = c->busy ? 0 : period_pulses(c);
	int64_t left;

	h->gone_mm += ds_mm;
	left = left_pulses(c);
	left = left > most ? most : left < -most ? -most : left;
	c->out.target[h->axis] += (int32_t)left;
	c->feed_mm_s = h->mover.v_mm_s;
}

/* No faster than the machine puts its pulses out: what it cannot put out would
 * be left behind, and come when the axis has to stand. */
struct mover_limits manual_limits(const struct cycle *c, double v_mm_s)
{
	const struct manual_axis *a = manual_axis(c);
	const double most = c->config.points_max * a->pulse_mm /
			    law_period_s(c);

	return (struct mover_limits) {
		.v_max_mm_s = fmin(v_mm_s, fmin(a->v_max_mm_s, most)),
		.a_max_mm_s2 = a->a_max_mm_s2,
		.j_max_mm_s3 = a->j_max_mm_s3,
		.period_s = law_period_s(c),
	};
}

bool manual_stop(struct cycle *c)
{
	const struct mover_limits l = manual_limits(c, INFINITY);

	manual_move(c, mover_stop(&c->manual.mover, &l));
	return c->manual.mover.v_mm_s == 0;
}

/* An axis whose place is not known yet goes no farther than the length of its
 * travel. */
static bool reaches(const struct cycle *c, uint32_t axis, double mm)
{
	const double pulses = mm / c->config.axis[axis].pulse_mm;
	const double to = c->out.target[axis] + pulses;
	const double min = c->config.travel_min[axis];
	const double max = c->config.travel_max[axis];

	if (manual_unhomed(c) >> axis & 1)
		return fabs(pulses) <= max - min && in_lattice(to);
	return to >= min && to <= max;
}

int manual_jog(struct cycle *c, uint32_t axis, double mm)
{
	if (c->state != STATE_IDLE || c->loaded)
		return ANSWER_WRONG_STATE;
	if (axis >= INTERP_NAXES || !c->config.axis[axis].present ||
	    !isfinite(mm) || mm == 0)
		return ANSWER_BAD_ARGUMENT;
	if (limit_bars(&c->limit, axis, mm < 0 ? -1 : 1))
		return ANSWER_AT_LIMIT;
	if (!reaches(c, axis, mm))
		return ANSWER_BEYOND;
	manual_begin(c, axis);
	c->manual.goal_mm = mm;
	return ANSWER_DONE;
}

/* -- Jogs that last as long as a press ------------------------------------- */

/* The longest time that an axis needs to brake from @v. It may still be
 * speeding up, and that has to end first. */
static double press_brake_s(const struct manual_axis *a, double v_mm_s)
{
	const double rise_s = a->a_max_mm_s2 / a->j_max_mm_s3;

	if (v_mm_s <= a->a_max_mm_s2 * rise_s)
		return 3 * sqrt(v_mm_s / a->j_max_mm_s3);
	return v_mm_s / a->a_max_mm_s2 + 2 * rise_s;
}

/* The inverse: the speed from which braking takes MANUAL_BRAKE_S. */
static double press_max_mm_s(const struct manual_axis *a)
{
	const double t_s = MANUAL_BRAKE_S;

	if (a->j_max_mm_s3 * t_s / 3 <= a->a_max_mm_s2)
		return a->j_max_mm_s3 * t_s * t_s / 9;
	return a->a_max_mm_s2 * (t_s - 2 * a->a_max_mm_s2 / a->j_max_mm_s3);
}

/* If its place is not known, an axis moves as slowly as in homing. */
static double jog_mm_s(const struct cycle *c)
{
	const struct manual_axis *a = manual_axis(c);
	double v_mm_s = a->jog_mm_s;

	if ((manual_unhomed(c) | c->limit.on) >> c->manual.axis & 1)
		v_mm_s = fmin(v_mm_s, a->home_slow_mm_s);
	if (c->manual.pressed)
		v_mm_s = fmin(fmin(v_mm_s, c->manual.press_mm_s),
			      press_max_mm_s(a));
	return v_mm_s;
}

/* The distance to the end of the travel, or the whole travel if the place is
 * not known. */
static double press_goal_mm(const struct cycle *c, uint32_t axis, bool forward)
{
	const double min = c->config.travel_min[axis];
	const double max = c->config.travel_max[axis];
	const double at = c->out.target[axis];
	double pulses = forward ? max - at : min - at;

	if (manual_unhomed(c) >> axis & 1) {
		pulses = forward ? max - min : min - max;
		pulses = fmax(fmin(pulses, INTERP_PULSES_MAX - at),
			      -INTERP_PULSES_MAX - at);
	}
	return pulses * c->config.axis[axis].pulse_mm;
}

/* A sign of the press came. Set when the axis has to brake if no other sign
 * comes. */
static void press_felt(struct cycle *c, double mm_s)
{
	struct manual *h = &c->manual;
	double fast, brake;

	h->press_mm_s = fabs(mm_s);
	fast = fmax(jog_mm_s(c), fabs(h->mover.v_mm_s));
	brake = press_brake_s(manual_axis(c), fast) / law_period_s(c);
	h->until = c->count + c->config.press_cycles -
		   (uint64_t)fmin(ceil(brake), (double)c->config.press_cycles);
}

static int press_begin(struct cycle *c, uint32_t arg, double mm_s)
{
	struct manual *h = &c->manual;
	const uint32_t axis = VERB_PRESS_AXIS(arg);
	double goal_mm;

	if (c->state != STATE_IDLE || c->loaded ||
	    !(arg & VERB_PRESS_BEGINS) || VERB_PRESS(arg) == h->press)
		return ANSWER_WRONG_STATE;
	if (axis >= INTERP_NAXES || !c->config.axis[axis].present)
		return ANSWER_BAD_ARGUMENT;
	if (limit_bars(&c->limit, axis, mm_s < 0 ? -1 : 1))
		return ANSWER_AT_LIMIT;
	goal_mm = press_goal_mm(c, axis, mm_s > 0);
	if (!(goal_mm * mm_s > 0))
		return ANSWER_BEYOND;
	manual_begin(c, axis);
	h->goal_mm = goal_mm;
	h->pressed = true;
	h->press = VERB_PRESS(arg);
	press_felt(c, mm_s);
	return ANSWER_DONE;
}

/* Does this sign belong to the press that is under way? It must have the same
 * axis and direction, and the axis must not be braking yet. */
static bool goes_on(const struct cycle *c, uint32_t arg, double mm_s)
{
	const struct manual *h = &c->manual;

	return c->state == STATE_JOG && h->pressed && !h->halt &&
	       c->count < h->until && h->press == VERB_PRESS(arg) &&
	       h->axis == VERB_PRESS_AXIS(arg) && h->goal_mm * mm_s >= 0;
}

int manual_press(struct cycle *c, uint32_t arg, double mm_s, int may,
		 bool *ret_begun)
{
	struct manual *h = &c->manual;
	int answer;

	*ret_begun = false;
	if (!isfinite(mm_s) || VERB_PRESS(arg) == 0)
		return ANSWER_BAD_ARGUMENT;
	if (goes_on(c, arg, mm_s)) {
		h->halt = mm_s == 0;
		press_felt(c, mm_s);
		return ANSWER_DONE;
	}
	if (mm_s == 0) {
		/* The first sign of this press may still be on its way. */
		if (c->state != STATE_JOG)
			h->press = VERB_PRESS(arg);
		return ANSWER_DONE;
	}
	if (may != ANSWER_DONE)
		return may;
	answer = press_begin(c, arg, mm_s);
	*ret_begun = answer == ANSWER_DONE;
	return answer;
}

int manual_home(struct cycle *c, uint32_t axis)
{
	uint32_t todo = 0;

	if (c->state != STATE_IDLE || c->loaded)
		return ANSWER_WRONG_STATE;
	for (uint32_t i = 0; i < INTERP_NAXES; i++)
		if ((axis == i || axis == MANUAL_ALL_AXES) &&
		    c->config.axis[i].present &&
		    (c->config.axis[i].method != HOME_NONE ||
		     c->manual.unplaced >> i & 1))
			todo |= 1u << i;
	if (todo == 0)
		return ANSWER_BAD_ARGUMENT;
	if (c->limit.on & todo & ~manual_by_drive(c))
		return ANSWER_AT_LIMIT;
	for (uint32_t left = todo; left; left &= left - 1)
		home_aim(c, (uint32_t)__builtin_ctz(left));
	c->manual.todo = todo;
	c->manual.homed &= ~todo;
	c->manual.halt = false;
	c->manual.phase = HOME_BEGIN;
	mover_set(&c->manual.mover, 0);
	return ANSWER_DONE;
}

int manual_place(struct cycle *c, uint32_t axis, double mm)
{
	const struct manual_axis *a = &c->config.axis[axis < INTERP_NAXES ?
						      axis : 0];
	double place;

	if (c->state != STATE_IDLE || c->loaded ||
	    c->axes.phase != AXES_FREE)
		return ANSWER_WRONG_STATE;
	if (c->axes.starting)
		return ANSWER_NOT_UP;
	if (axis >= INTERP_NAXES || !a->present || a->method != HOME_NONE ||
	    !isfinite(mm))
		return ANSWER_BAD_ARGUMENT;
	place = mm / a->pulse_mm;
	if (place < c->config.travel_min[axis] ||
	    place > c->config.travel_max[axis])
		return ANSWER_BEYOND;
	home_place(c, axis, (int32_t)llround(place),
		   comp_pulses(&c->comp.axis[axis]));
	c->manual.used = true;
	return ANSWER_DONE;
}

static bool jog_go(struct cycle *c)
{
	struct manual *h = &c->manual;
	const struct mover_limits l = manual_limits(c, jog_mm_s(c));

	if (c->sensed.contact && h->free_seen && !c->config.dry_run) {
		fault_latch(&c->fault, FAULT_CONTACT);
		return false;
	}
	h->free_seen = h->free_seen || c->sensed.is_open;
	manual_move(c, mover_step(&h->mover, &l, h->goal_mm - h->gone_mm));
	return h->mover.v_mm_s == 0 && left_pulses(c) == 0 &&
	       fabs(h->goal_mm - h->gone_mm) < MOVER_ONTO_MM * 2;
}

/* The time of a press goes on counting while the axes wait for power. */
bool manual_ends(const struct cycle *c)
{
	const struct manual *h = &c->manual;

	return h->halt || (c->state == STATE_JOG && h->pressed &&
			   c->count >= h->until);
}

bool manual_go(struct cycle *c, const struct io_inputs *in)
{
	struct manual *h = &c->manual;

	h->halt = manual_ends(c);
	if (!h->halt)
		return c->state == STATE_HOME ? home_go(c, in) : jog_go(c);
	return !in->homing && (h->mover.v_mm_s == 0 || manual_stop(c));
}
