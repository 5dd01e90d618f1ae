/* SPDX-License-Identifier: Apache-2.0 */
/*
 * servo.c - the gap servo: feed from the state of the gap
 */
#include "gap/servo.h"
#include "path/laws.h"
#include "path/pace.h"
#include "path/place.h"
#include "path/timed.h"
#include "path/walk.h"

#include "interp/smaller.h"

#include <math.h>

#define FADE_S		0.1		/* of a change of gains */

static double seg_limit(const struct cycle *c, double v_mm_s)
{
	return smaller(v_mm_s, law_seg_speed(&c->cursor.seg));
}

/* A BEGIN or an action has no speed of its own. */
static double cut_limit(const struct cycle *c, double v_mm_s)
{
	return c->cursor.seg.kind < INTERP_BEGIN ? seg_limit(c, v_mm_s) :
						   v_mm_s;
}

/* Forward, as far as the path goes. */
static double go_toward(struct cycle *c, double v_mm_s)
{
	return pace_go(c, v_mm_s, INFINITY);
}

/* Go back to a place, and beyond it only if it came too fast out of another
 * state: then as far as the axes need to brake. */
static double go_back(struct cycle *c, double v_mm_s, double floor_mm)
{
	const bool is_there = place_mm(c) - floor_mm <= MOVER_ONTO_MM;

	return pace_go(c, is_there ? 0 : -v_mm_s, floor_mm);
}

bool servo_rests(const struct cycle *c)
{
	return fabs(c->mover.v_mm_s) <= pace_dv_mm_s(c);
}

/* It would go on from here beside the path, or back along it. */
static bool lifts(const struct cycle *c)
{
	return (c->state == STATE_ERODE && flush_due(c)) ||
	       (timed_is_up(c) && !escape_is_out(&c->escape));
}

/* -- Approach -------------------------------------------------------------- */

/*
 * While the gap is open, it goes at the approach speed.  When there are signs
 * of sparks, it goes no faster than the servo would feed.  At the window it
 * stands.  A sign is taken as it is read, without the filter.  Beside what is
 * positioned nothing sparks, and no spark would make a narrow gap wide.
 */
double law_approach(struct cycle *c)
{
	const struct cycle_gap_config *g = &c->gap;
	const double v = smaller(c->sensed.now_v, c->sensed.signal_v);
	const double feed = g->gain_mm_s_v * (v - gap_window_high_v(c));

	const bool sparks = !walk_positions(c);

	if (c->sensed.contact || c->sensed.blind || (feed < 0 && sparks) ||
	    lifts(c))
		return go_toward(c, 0);
	return go_toward(c, cut_limit(c, c->sensed.is_open || !sparks ?
					 g->approach_mm_s :
					 smaller(feed, g->approach_mm_s)));
}

/* -- Erode ----------------------------------------------------------------- */

void servo_reset(struct cycle *c)
{
	c->servo = (struct servo) { .integral_mm_s = 0 };
}

static double forward(const struct servo_law *l, double v)
{
	return l->gain_mm_s_v * (v - l->high_v);
}

/* A condition or `set` changed the values.  The feed goes on from where it
 * is. */
static void adopt(struct cycle *c, const struct servo_law *now, double v)
{
	struct servo *s = &c->servo;
	const struct servo_law *was = &s->law;

	if (was->gain_mm_s_v == now->gain_mm_s_v && was->low_v == now->low_v &&
	    was->high_v == now->high_v)
		return;
	if (was->gain_mm_s_v > 0)
		s->fade_mm_s += larger(0, forward(was, v)) -
				larger(0, forward(now, v));
	s->law = *now;
}

static void integrate(struct cycle *c, double error_mm_s, double limit_mm_s)
{
	struct servo *s = &c->servo;
	const double reset = c->gap.integral_s;

	if (reset <= 0) {
		s->fade_mm_s += s->integral_mm_s;
		s->integral_mm_s = 0;
		return;
	}
	/* The distance was asked for and not walked: an action or the end is
	 * ahead. */
	if (s->asked_mm_s > 0 && c->feed_mm_s <= 0 && error_mm_s > 0)
		error_mm_s = 0;
	/* The feed is already at its limit. */
	if (error_mm_s > 0 && error_mm_s + s->integral_mm_s > limit_mm_s)
		error_mm_s = 0;
	s->integral_mm_s += error_mm_s * law_period_s(c) / reset;
	s->integral_mm_s = smaller(larger(s->integral_mm_s, 0), limit_mm_s);
}

static double erode_forward(struct cycle *c, double error_mm_s)
{
	struct servo *s = &c->servo;
	const double limit = cut_limit(c, c->gap.feed_max_mm_s);

	integrate(c, error_mm_s, limit);
	s->asked_mm_s = error_mm_s + s->integral_mm_s + s->fade_mm_s;
	s->asked_mm_s = smaller(larger(s->asked_mm_s, 0), limit);
	if (c->sensed.contact)
		s->asked_mm_s = 0;
	return go_toward(c, s->asked_mm_s);
}

/* No farther than a retract may go, and not off the cut: there is no power. */
static double creep_to_mm(const struct cycle *c)
{
	const double least = c->far_mm - retract_limit_mm(c);

	return escape_is_out(&c->escape) ? least :
	       larger(least, walk_cut_mm(c, least) + MOVER_ONTO_MM);
}

static double erode_back(struct cycle *c, double error_mm_s)
{
	c->servo.asked_mm_s = 0;
	integrate(c, error_mm_s, cut_limit(c, c->gap.feed_max_mm_s));
	return go_back(c, smaller(-error_mm_s, c->gap.creep_mm_s),
		       creep_to_mm(c));
}

double law_erode(struct cycle *c)
{
	const struct servo_law l = {
		c->gap.gain_mm_s_v, gap_window_low_v(c), gap_window_high_v(c)
	};
	const double v = c->sensed.signal_v;

	c->servo.fade_mm_s *= larger(0, 1 - law_period_s(c) / FADE_S);
	adopt(c, &l, v);
	if (lifts(c) || c->sensed.blind) {
		c->servo.asked_mm_s = 0;
		return go_toward(c, 0);
	}
	if (v > l.high_v)
		return erode_forward(c, forward(&l, v));
	if (v < l.low_v)
		return erode_back(c, l.gain_mm_s_v * (v - l.low_v));
	c->servo.asked_mm_s = 0;
	return go_toward(c, 0);
}

/* -- Retract --------------------------------------------------------------- */

double law_retract(struct cycle *c)
{
	const bool waits = c->retract.leaves && !retract_leave(c);

	return go_back(c, waits ? 0 : c->gap.retract_mm_s,
		       c->retract.floor_mm);
}
