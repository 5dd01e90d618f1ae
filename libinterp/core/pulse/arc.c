/* SPDX-License-Identifier: Apache-2.0 */
/*
 * arc.c - circular and helical arcs, every axis at once
 *
 * Tick k of N stands at the angle theta + sweep*k/N; the lattice point is the
 * nearest one to the true point there, so each axis is within half a pulse.
 * N is the arc's length in pulses and a little more: two ticks are less than
 * a pulse apart, and no axis moves more than one.  A point is a function of k
 * alone, so there is nothing to undo.  The axes beside the plane run as a
 * line's do.
 */
#include "pulse/pulse.h"

#include <math.h>

struct plane {
	int64_t a, b;			/* pulses */
};

/*
 * Ticks are computed in blocks.  sin and cos give the place of the middle of a
 * block once.  From there its ticks are turned by a series: a few products
 * instead of a call of libm.  16 ticks are less than 16 pulses along the arc.
 * So with a radius of 160 pulses the angle is below 0.1, and the first omitted
 * term is below 3e-15.  The middle depends only on the tick, so a point still
 * does, too.  All ticks of a block are computed in one loop, two or more at a
 * time, and kept: the walk goes to and fro over them.
 */
#define BLOCK		INTERP_ARC_BLOCK
#define BLOCK_HALF	(BLOCK / 2)
#define BLOCK_ANGLE	0.1

struct turn {
	double cosine, sine;
};

static inline struct turn turned(struct turn middle, double x)
{
	const double x2 = x * x;
	const double s = x - x * x2 * (1.0 / 6 - x2 * (1.0 / 120 -
						       x2 * (1.0 / 5040)));
	const double k = 1 - x2 * (1.0 / 2 - x2 * (1.0 / 24 -
				   x2 * (1.0 / 720 - x2 * (1.0 / 40320))));

	return (struct turn) { middle.cosine * k - middle.sine * s,
			       middle.sine * k + middle.cosine * s };
}

static struct turn arc_direct(const struct interp_cursor *c, double tick)
{
	const double theta = c->arc.theta + c->arc_turn * tick;

	return (struct turn) { cos(theta), sin(theta) };
}

/* floor(x + 0.5), without a call. */
static int64_t nearest(double x)
{
	const int64_t i = (int64_t)(x + 0.5);

	return i - ((double)i > x + 0.5);
}

static void block_enter(struct interp_cursor *c, uint32_t block)
{
	const struct interp_arc *arc = &c->arc;
	const double first = (double)(block * BLOCK);
	const struct turn middle = arc_direct(c, first + BLOCK_HALF);
	const double a_mm = arc->a_mm, b_mm = arc->b_mm, r_mm = arc->r_mm;
	const double turn = c->arc_turn, grow_mm = c->arc_grow_mm;
	const double a_pulses_mm = c->pulses_mm[arc->axis_a];
	const double b_pulses_mm = c->pulses_mm[arc->axis_b];
	double a[BLOCK], b[BLOCK];

	for (int i = 0; i < BLOCK; i++) {
		const struct turn at = turned(middle, turn * (i - BLOCK_HALF));
		const double r = r_mm + grow_mm * (first + i);

		a[i] = (a_mm + r * at.cosine) * a_pulses_mm;
		b[i] = (b_mm + r * at.sine) * b_pulses_mm;
	}
	for (int i = 0; i < BLOCK; i++) {
		c->arc_at[0][i] = nearest(a[i]);
		c->arc_at[1][i] = nearest(b[i]);
	}
	c->arc_block = block;
}

/* Where the axes of the plane are at tick c->tick. */
static struct plane arc_at(struct interp_cursor *c)
{
	const struct interp_arc *arc = &c->arc;
	const uint32_t block = c->tick / BLOCK, i = c->tick % BLOCK;

	if (fabs(c->arc_turn) * BLOCK_HALF > BLOCK_ANGLE) {
		const struct turn at = arc_direct(c, c->tick);
		const double r = arc->r_mm + c->arc_grow_mm * c->tick;

		return (struct plane) {
			nearest((arc->a_mm + r * at.cosine) *
				c->pulses_mm[arc->axis_a]),
			nearest((arc->b_mm + r * at.sine) *
				c->pulses_mm[arc->axis_b]),
		};
	}
	if (block != c->arc_block)
		block_enter(c, block);
	return (struct plane) { c->arc_at[0][i], c->arc_at[1][i] };
}

/* At both ends, the pulses of the node itself: they are exact, whatever sin and
 * cos give. */
static struct plane arc_node(const struct interp_cursor *c, bool at_end)
{
	struct plane p = { 0, 0 };

	for (uint32_t j = 0; j < c->p.head->naxes; j++) {
		const int32_t at = interp_round_sub(pulse_node(c, j, at_end));

		if (c->p.head->column[j] == c->arc.axis_a)
			p.a = at;
		if (c->p.head->column[j] == c->arc.axis_b)
			p.b = at;
	}
	return p;
}

static struct plane arc_here(struct interp_cursor *c)
{
	return c->tick == 0 ? arc_node(c, false) :
	       c->tick == c->seg.ticks ? arc_node(c, true) : arc_at(c);
}

static uint32_t arc_settle(struct interp_cursor *c)
{
	const struct plane p = arc_here(c);
	int32_t *a = &c->pos[c->arc.axis_a], *b = &c->pos[c->arc.axis_b];
	const int64_t da = p.a - *a, db = p.b - *b;

	if (da > 1 || da < -1 || db > 1 || db < -1)
		return PULSE_BAD;
	*a = (int32_t)p.a;
	*b = (int32_t)p.b;
	return pulse_plane_move(c, (int32_t)da, (int32_t)db);
}

static bool near(double mm, double pulses_mm)
{
	return fabs(mm) * pulses_mm < INTERP_PULSES_MAX;
}

bool pulse_plane_ok(const struct interp_cursor *c)
{
	const struct interp_arc *arc = &c->arc;

	return arc->axis_a < INTERP_NAXES && arc->axis_b < INTERP_NAXES &&
	       arc->axis_a != arc->axis_b &&
	       near(arc->a_mm, c->pulses_mm[arc->axis_a]) &&
	       near(arc->b_mm, c->pulses_mm[arc->axis_b]) &&
	       near(arc->r_mm, c->pulses_mm[arc->axis_a]) &&
	       near(arc->r_mm, c->pulses_mm[arc->axis_b]) &&
	       fabs(arc->dr_mm) <= fabs(arc->r_mm) && isfinite(arc->theta) &&
	       isfinite(arc->sweep);
}

/* Not more ticks than the builder gives: otherwise it would walk on the
 * spot. */
static bool ticks_ok(const struct interp_cursor *c, uint32_t plane)
{
	const struct interp_arc *arc = &c->arc;
	const double pulses_mm = fmax(c->pulses_mm[arc->axis_a],
				      c->pulses_mm[arc->axis_b]);
	const double r = fmax(arc->r_mm, arc->r_mm + arc->dr_mm);
	const double n = fmax((fabs(arc->sweep) * r + fabs(arc->dr_mm)) *
			      pulses_mm, (double)pulse_longest(c, plane));

	return c->seg.ticks > 0 && c->seg.ticks <= n * 1.00001 + 3;
}

static bool arc_enter(struct interp_cursor *c, bool at_end)
{
	uint32_t plane;

	if (!pulse_plane_ok(c))
		return false;
	plane = 1u << c->arc.axis_a | 1u << c->arc.axis_b;
	if (!pulse_dda_enter(c, at_end, plane) || !ticks_ok(c, plane))
		return false;
	c->arc_turn = c->arc.sweep / c->seg.ticks;
	c->arc_grow_mm = c->arc.dr_mm / c->seg.ticks;
	c->arc_block = UINT32_MAX;
	return true;
}

static uint32_t arc_tick(struct interp_cursor *c)
{
	const uint32_t others = pulse_dda_tick(c);
	const uint32_t plane = arc_settle(c);

	return plane == PULSE_BAD ? PULSE_BAD : others | plane;
}

static uint32_t arc_tick_back(struct interp_cursor *c)
{
	const uint32_t others = pulse_dda_tick_back(c);
	const uint32_t plane = arc_settle(c);

	return plane == PULSE_BAD ? PULSE_BAD : others | plane;
}

static uint32_t arc_forward(struct interp_cursor *c, uint32_t ticks,
			    uint16_t *ret)
{
	return pulse_ticks(c, arc_tick, ticks, ret);
}

static uint32_t arc_back(struct interp_cursor *c, uint32_t ticks,
			 uint16_t *ret)
{
	return pulse_ticks(c, arc_tick_back, ticks, ret);
}

static bool fits(int64_t pulses)
{
	return pulses >= INT32_MIN && pulses <= INT32_MAX;
}

static bool arc_seek(struct interp_cursor *c, uint32_t tick)
{
	struct plane p;

	pulse_dda_seek(c, tick);
	p = arc_here(c);
	c->pos[c->arc.axis_a] = (int32_t)p.a;
	c->pos[c->arc.axis_b] = (int32_t)p.b;
	return fits(p.a) && fits(p.b);
}

const struct interp_walk pulse_arc = {
	.enter = arc_enter,
	.forward = arc_forward,
	.back = arc_back,
	.seek = arc_seek,
};
