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
#include "pulse/walk.h"

#include <math.h>

struct plane {
	int64_t a, b;			/* pulses */
};

/* Where the plane's axes stand at tick c->tick. */
static struct plane arc_at(const struct interp_cursor *c,
			   const struct interp_arc *arc)
{
	const double t = (double)c->tick / c->seg.ticks;
	const double theta = arc->theta + arc->sweep * t;
	const double r = arc->r_mm + arc->dr_mm * t;
	const double a = (arc->a_mm + r * cos(theta)) *
			 c->pulses_mm[arc->axis_a];
	const double b = (arc->b_mm + r * sin(theta)) *
			 c->pulses_mm[arc->axis_b];

	return (struct plane) { (int64_t)floor(a + 0.5),
				(int64_t)floor(b + 0.5) };
}

/* The node's own pulses at either end: exact, whatever sin and cos say. */
static struct plane arc_node(const struct interp_cursor *c,
			     const struct interp_arc *arc, bool at_end)
{
	struct plane p = { 0, 0 };

	for (uint32_t j = 0; j < c->p.head->naxes; j++) {
		const int32_t at = interp_round_sub(walk_node(c, j, at_end));

		if (c->p.head->column[j] == arc->axis_a)
			p.a = at;
		if (c->p.head->column[j] == arc->axis_b)
			p.b = at;
	}
	return p;
}

uint32_t walk_arc_settle(struct interp_cursor *c, const struct interp_arc *arc)
{
	const struct plane p = c->tick == 0 ? arc_node(c, arc, false) :
			       c->tick == c->seg.ticks ?
			       arc_node(c, arc, true) : arc_at(c, arc);
	int32_t *a = &c->pos[arc->axis_a], *b = &c->pos[arc->axis_b];
	uint32_t moved = (uint32_t)(p.a != *a) << arc->axis_a |
			 (uint32_t)(p.b != *b) << arc->axis_b;

	if (p.a - *a > 1 || *a - p.a > 1 || p.b - *b > 1 || *b - p.b > 1)
		return WALK_BAD;
	*a = (int32_t)p.a;
	*b = (int32_t)p.b;
	return moved;
}

static bool near(double mm, double pulses_mm)
{
	return fabs(mm) * pulses_mm < INTERP_PULSES_MAX;
}

bool walk_plane_ok(const struct interp_cursor *c, const struct interp_arc *arc)
{
	return arc->axis_a < INTERP_NAXES && arc->axis_b < INTERP_NAXES &&
	       arc->axis_a != arc->axis_b &&
	       near(arc->a_mm, c->pulses_mm[arc->axis_a]) &&
	       near(arc->b_mm, c->pulses_mm[arc->axis_b]) &&
	       near(arc->r_mm, c->pulses_mm[arc->axis_a]) &&
	       near(arc->r_mm, c->pulses_mm[arc->axis_b]) &&
	       fabs(arc->dr_mm) <= fabs(arc->r_mm) && isfinite(arc->theta) &&
	       isfinite(arc->sweep);
}

double walk_arc_ticks_max(const struct interp_cursor *c,
			  const struct interp_arc *arc)
{
	const double pulses_mm = fmax(c->pulses_mm[arc->axis_a],
				      c->pulses_mm[arc->axis_b]);
	const double r = fmax(arc->r_mm, arc->r_mm + arc->dr_mm);

	return (fabs(arc->sweep) * r + fabs(arc->dr_mm)) * pulses_mm;
}

/* As many ticks as the builder gives, no more: no walk on the spot. */
static bool ticks_ok(const struct interp_cursor *c, uint32_t plane)
{
	const double n = fmax(walk_arc_ticks_max(c, &c->arc),
			      (double)walk_longest(c, plane));

	return c->seg.ticks > 0 && c->seg.ticks <= n * 1.00001 + 3;
}

static bool arc_enter(struct interp_cursor *c, bool at_end)
{
	uint32_t plane;

	if (!walk_plane_ok(c, &c->arc))
		return false;
	plane = 1u << c->arc.axis_a | 1u << c->arc.axis_b;
	return walk_dda_enter(c, at_end, plane) && ticks_ok(c, plane);
}

static uint32_t arc_forward(struct interp_cursor *c)
{
	const uint32_t moved = walk_dda_forward(c);
	const uint32_t plane = walk_arc_settle(c, &c->arc);

	return plane == WALK_BAD ? WALK_BAD : moved | plane;
}

static uint32_t arc_back(struct interp_cursor *c)
{
	const uint32_t moved = walk_dda_back(c);
	const uint32_t plane = walk_arc_settle(c, &c->arc);

	return plane == WALK_BAD ? WALK_BAD : moved | plane;
}

const struct interp_walk walk_arc = {
	.enter = arc_enter,
	.forward = arc_forward,
	.back = arc_back,
	.last = walk_last_tick,
};
