/* SPDX-License-Identifier: Apache-2.0 */
/*
 * dda.c - digital differential analysers: an accumulator for each axis
 *
 * Line.  A clock of 2^n ticks, the least that is not under the longest axis's
 * pulses; every tick adds an axis's total to its accumulator, and each time
 * that overflows 2^n the axis pulses.  Accumulators start half full, so after
 * k ticks an axis stands at its total*k/2^n rounded: within half a pulse on
 * every axis, |e| <= (a + b)/2 between any two.  It is the walk of line.c
 * with another number of ticks, and as exactly undone.
 *
 * Arc.  Two accumulators of modulus R = 2^n above the radius feed each other,
 * counter-clockwise:
 *
 *	x gets -y/R, then y gets the new x/R
 *
 * Each half of a tick changes one coordinate by the other one, which stays;
 * so the halves are undone in the opposite order, exactly.  Using the new x
 * keeps x*x + y*y - x*y/R constant, where the old one would let the circle
 * open by pi pulses a turn; what is left is a quarter of a pulse of
 * ellipticity and the rounding of both coordinates, and the radius stays
 * within 3/2 pulses.  The clock stops when the angle is done, up to two
 * pulses from the end; those few, the tail, are forced, both axes at once.
 * The builder runs the arc once to learn where its tail begins.
 */
#include "pulse/pulse.h"

#include <math.h>
#include <stdlib.h>

#define DDA_SHIFT_MAX	28

/* -- Lines ---------------------------------------------------------------- */

int64_t pulse_dda_ticks(int64_t longest)
{
	int64_t ticks = 1;

	while (ticks < longest && ticks < INTERP_PULSES_MAX)
		ticks *= 2;
	return longest > INTERP_PULSES_MAX ? 0 : ticks;
}

static bool dda_line_enter(struct interp_cursor *c, bool at_end)
{
	return c->seg.ticks > 0 && pulse_dda_enter(c, at_end, 0) &&
	       c->seg.ticks == pulse_dda_ticks(pulse_longest(c, 0));
}

const struct interp_walk pulse_dda_line = {
	.enter = dda_line_enter,
	.forward = pulse_dda_forward,
	.back = pulse_dda_back,
	.seek = pulse_dda_seek,
};

/* -- Arcs ----------------------------------------------------------------- */

/* Add @v, at most the modulus either way.  Return: the pulse that this
 * makes. */
static int64_t rotor_add(int64_t *rest, int64_t v, uint32_t shift)
{
	const int64_t sum = *rest + v;
	const int64_t pulse = sum >> shift;

	*rest = sum & ((INT64_C(1) << shift) - 1);
	return pulse;
}

#define INLINE static inline __attribute__((always_inline))

INLINE void rotor_forward(struct interp_rotor *k)
{
	k->x += rotor_add(&k->rest_x, -k->ccw * k->y, k->shift);
	k->y += rotor_add(&k->rest_y, k->ccw * k->x, k->shift);
}

INLINE void rotor_back(struct interp_rotor *k)
{
	k->y += rotor_add(&k->rest_y, -k->ccw * k->x, k->shift);
	k->x += rotor_add(&k->rest_x, k->ccw * k->y, k->shift);
}

static bool rotor_in_range(const struct interp_rotor *k)
{
	const int64_t most = INT64_C(1) << k->shift;

	return (uint64_t)(k->x + most) <= (uint64_t)(2 * most) &&
	       (uint64_t)(k->y + most) <= (uint64_t)(2 * most);
}

/* Tick @u of the tail, counted from 1: does an axis with @forced pulses to go
 * make one? */
static int64_t tail_pulse(int64_t forced, int64_t u)
{
	return u > llabs(forced) ? 0 : forced > 0 ? 1 : -1;
}

static void rotor_set(struct interp_rotor *k, const struct interp_arc *arc,
		      const int64_t at[2])
{
	const int64_t half = (INT64_C(1) << arc->shift) / 2;

	*k = (struct interp_rotor) {
		.x = at[0], .y = at[1], .rest_x = half, .rest_y = half,
		.shift = arc->shift, .ccw = arc->sweep > 0 ? 1 : -1,
	};
}

bool dda_measure(struct interp_arc *arc, const int64_t start[2],
		 const int64_t end[2], int64_t others)
{
	const double r = hypot((double)start[0], (double)start[1]);
	const double turn = fabs(arc->sweep);
	const double least = fmax(r + 2, (double)(others + 1) / turn);
	struct interp_rotor k;
	double modulus = 4, ticks;

	arc->shift = 2;
	while (arc->shift < DDA_SHIFT_MAX && modulus < least) {
		arc->shift++;
		modulus *= 2;
	}
	ticks = turn / (2 * asin(0.5 / modulus));
	if (modulus < least || ticks > INTERP_PULSES_MAX / 2.0)
		return false;
	rotor_set(&k, arc, start);
	arc->tail = (uint32_t)llround(ticks);
	for (uint32_t i = 0; i < arc->tail; i++)
		rotor_forward(&k);
	arc->tail_a = (int32_t)(end[0] - k.x);
	arc->tail_b = (int32_t)(end[1] - k.y);
	arc->rest_a = k.rest_x;
	arc->rest_b = k.rest_y;
	arc->circle_ticks = arc->tail +
		(uint32_t)fmax(abs(arc->tail_a), abs(arc->tail_b));
	return arc->circle_ticks >= others;
}

static bool arc_ok(const struct interp_cursor *c)
{
	const struct interp_arc *arc = &c->arc;
	const int64_t forced = (int64_t)arc->circle_ticks - arc->tail;
	int64_t most;

	if (arc->shift < 2 || arc->shift > DDA_SHIFT_MAX ||
	    arc->circle_ticks != c->seg.ticks ||
	    arc->circle_ticks >= INTERP_PULSES_MAX)
		return false;
	most = INT64_C(1) << arc->shift;
	return arc->rest_a >= 0 && arc->rest_a < most &&
	       arc->rest_b >= 0 && arc->rest_b < most && forced >= 0 &&
	       llabs(arc->tail_a) <= forced && llabs(arc->tail_b) <= forced;
}

/* As the tail left it, from the end; walking back begins with the tail. */
static void rotor_set_tail(struct interp_rotor *k, const struct interp_arc *arc)
{
	k->rest_x = arc->rest_a;
	k->rest_y = arc->rest_b;
	k->x -= arc->tail_a;
	k->y -= arc->tail_b;
}

static bool dda_arc_enter(struct interp_cursor *c, bool at_end)
{
	const struct interp_arc *arc = &c->arc;
	struct interp_rotor *k = &c->rotor;
	int64_t at[2] = { 0, 0 };

	if (!pulse_plane_ok(c) || !arc_ok(c) ||
	    !pulse_dda_enter(c, at_end, 1u << arc->axis_a | 1u << arc->axis_b))
		return false;
	pulse_circle_node(c, at_end, at);
	rotor_set(k, arc, at);
	if (at_end)
		rotor_set_tail(k, arc);
	return rotor_in_range(k);
}

/* Tick u of the tail, forward or back; the rotor stays where it stopped. */
static uint32_t arc_tail(struct interp_cursor *c, int64_t u, int dir)
{
	const int64_t dx = tail_pulse(c->arc.tail_a, u) * dir;
	const int64_t dy = tail_pulse(c->arc.tail_b, u) * dir;

	c->pos[c->arc.axis_a] += (int32_t)dx;
	c->pos[c->arc.axis_b] += (int32_t)dy;
	return pulse_plane_move(c, (int32_t)dx, (int32_t)dy);
}

static uint32_t arc_turn(struct interp_cursor *c, int dir)
{
	struct interp_rotor *k = &c->rotor;
	const int64_t x = k->x, y = k->y;

	if (dir > 0)
		rotor_forward(k);
	else
		rotor_back(k);
	if (!rotor_in_range(k))
		return PULSE_BAD;
	c->pos[c->arc.axis_a] += (int32_t)(k->x - x);
	c->pos[c->arc.axis_b] += (int32_t)(k->y - y);
	return pulse_plane_move(c, (int32_t)(k->x - x), (int32_t)(k->y - y));
}

static uint32_t dda_arc_tick(struct interp_cursor *c)
{
	const uint32_t others = pulse_dda_tick(c);
	const uint32_t plane = c->tick <= c->arc.tail ? arc_turn(c, 1) :
			       arc_tail(c, (int64_t)c->tick - c->arc.tail, 1);

	return plane == PULSE_BAD ? PULSE_BAD : others | plane;
}

static uint32_t dda_arc_tick_back(struct interp_cursor *c)
{
	const uint32_t tick = c->tick;
	const uint32_t others = pulse_dda_tick_back(c);
	const uint32_t plane = tick <= c->arc.tail ? arc_turn(c, -1) :
			       arc_tail(c, (int64_t)tick - c->arc.tail, -1);

	return plane == PULSE_BAD ? PULSE_BAD : others | plane;
}

static uint32_t dda_arc_forward(struct interp_cursor *c, uint32_t ticks,
				uint16_t *ret)
{
	return pulse_ticks(c, dda_arc_tick, ticks, ret);
}

static uint32_t dda_arc_back(struct interp_cursor *c, uint32_t ticks,
			     uint16_t *ret)
{
	return pulse_ticks(c, dda_arc_tick_back, ticks, ret);
}

/* @a, @b: a coordinate and what is left of it as one number.  Those above
 * @shift are the coordinate. */
INLINE bool turn(int64_t *a, int64_t *b, uint32_t shift, uint32_t ticks,
		 int64_t ccw)
{
	const int64_t most = INT64_C(1) << 2 * shift;
	const uint64_t range = (uint64_t)(2 * most + (INT64_C(1) << shift));
	int64_t x = *a, y = *b;

	for (; ticks > 0 && (uint64_t)(x + most) < range &&
	       (uint64_t)(y + most) < range; ticks--) {
		x -= ccw * (y >> shift);
		y += ccw * (x >> shift);
	}
	*a = x;
	*b = y;
	return (uint64_t)(x + most) < range && (uint64_t)(y + most) < range;
}

/* To go back is to go forward with the coordinates exchanged. */
static bool rotor_turn(struct interp_rotor *k, uint32_t ticks, bool back)
{
	const int64_t mask = (INT64_C(1) << k->shift) - 1;
	int64_t x = k->x * (mask + 1) + k->rest_x;
	int64_t y = k->y * (mask + 1) + k->rest_y;
	int64_t *a = back ? &y : &x, *b = back ? &x : &y;
	const bool ok = k->ccw > 0 ? turn(a, b, k->shift, ticks, 1) :
				     turn(a, b, k->shift, ticks, -1);

	k->x = x >> k->shift;
	k->y = y >> k->shift;
	k->rest_x = x & mask;
	k->rest_y = y & mask;
	return ok;
}

bool dda_turn(struct interp_rotor *k, uint32_t ticks)
{
	return rotor_turn(k, ticks, false);
}

/*
 * A rotor's rounding follows from all of its ticks, so they are made one by
 * one, from the nearer end.
 */
static bool rotor_seek(struct interp_cursor *c, uint32_t tick)
{
	const struct interp_arc *arc = &c->arc;
	struct interp_rotor *k = &c->rotor;
	int64_t at[2] = { 0, 0 };

	if (tick <= arc->tail / 2)
		return rotor_turn(k, tick, false);
	pulse_circle_node(c, true, at);
	rotor_set(k, arc, at);
	rotor_set_tail(k, arc);
	return rotor_turn(k, tick < arc->tail ? arc->tail - tick : 0, true);
}

static int64_t tail_pulses(int64_t forced, int64_t u)
{
	return forced > 0 ? (u < forced ? u : forced) :
			    (-u > forced ? -u : forced);
}

static bool dda_arc_seek(struct interp_cursor *c, uint32_t tick)
{
	const struct interp_arc *arc = &c->arc;
	const int64_t u = tick > arc->tail ? tick - arc->tail : 0;
	const struct interp_rotor *k = &c->rotor;
	int64_t x = k->x, y = k->y;

	if (!rotor_seek(c, tick))
		return false;
	x = k->x - x + tail_pulses(arc->tail_a, u);
	y = k->y - y + tail_pulses(arc->tail_b, u);
	c->pos[arc->axis_a] += (int32_t)x;
	c->pos[arc->axis_b] += (int32_t)y;
	return pulse_dda_seek(c, tick);
}

const struct interp_walk pulse_dda_arc = {
	.enter = dda_arc_enter,
	.forward = dda_arc_forward,
	.back = dda_arc_back,
	.seek = dda_arc_seek,
};
