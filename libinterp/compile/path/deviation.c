/* SPDX-License-Identifier: Apache-2.0 */
/*
 * deviation.c - how far a lattice point lies from the programmed path
 */
#include "interp/cursor.h"
#include "pulse/strategy.h"

#include <math.h>

/* All linear axes; if none of them moves, all axes. */
static uint32_t length_axes(const struct interp_cursor *c)
{
	const uint32_t linear = 1u << INTERP_X | 1u << INTERP_Y |
				1u << INTERP_Z | 1u << INTERP_U |
				1u << INTERP_V;
	uint32_t moved = 0;

	for (uint32_t j = 0; j < c->p.head->naxes; j++) {
		if (pulse_node(c, j, false) != pulse_node(c, j, true))
			moved |= 1u << c->p.head->column[j];
	}
	if (c->seg.kind == INTERP_ARC)
		moved |= 1u << c->arc.axis_a | 1u << c->arc.axis_b;
	for (uint32_t j = 0; c->seg.kind == INTERP_CURVE &&
	     j < c->curve.eval.c.naxes; j++)
		moved |= 1u << c->curve.axis[j];
	return moved & linear ? linear : ~0u;
}

static double node_mm(const struct interp_cursor *c, uint32_t j, bool at_end)
{
	return (double)pulse_node(c, j, at_end) / INTERP_SUB *
	       c->p.head->pulse_mm[c->p.head->column[j]];
}

/* How far the point is from where an axis began. */
static inline double off_mm(const struct interp_cursor *c,
			    const struct interp_deviation_way *w)
{
	return c->pos[w->axis] * w->pulse_mm - w->from_mm;
}

/* Where the foot of the point is, as a share of the line. */
static inline double foot(const struct interp_deviation *d, double dr)
{
	return dr <= 0 ? 0 : dr >= d->way2 ? 1 : dr / d->way2;
}

/* The distance square to the line from node to node, axis by axis from the
 * foot, so that no large squares are subtracted. */
static double line_deviation(const struct interp_cursor *c,
			     const struct interp_deviation *d)
{
	double from[INTERP_NAXES], dr = 0, r2 = 0, t;

	for (uint32_t k = 0; k < d->nways; k++) {
		from[k] = off_mm(c, &d->way[k]);
		dr += d->way[k].mm * from[k];
	}
	t = d->way2 > 0 ? foot(d, dr) : 0;
	for (uint32_t k = 0; k < d->nways; k++) {
		const double r = from[k] - t * d->way[k].mm;

		r2 += r * r;
	}
	return sqrt(r2);
}

/* The same for a line of two axes, as most are: without loops, and with a root
 * beyond its ends only.  Its products are rounded by 1e-16 of themselves: of
 * a line of 1 m that is 2e-10 um. */
static double flat_deviation(const struct interp_cursor *c,
			     const struct interp_deviation *d)
{
	const double a_mm = d->way[0].mm, b_mm = d->way[1].mm;
	const double a = off_mm(c, &d->way[0]), b = off_mm(c, &d->way[1]);
	const double dr = a_mm * a + b_mm * b;

	if (dr <= 0)
		return sqrt(a * a + b * b);
	if (dr >= d->way2)
		return sqrt((a - a_mm) * (a - a_mm) + (b - b_mm) * (b - b_mm));
	return fabs(a * b_mm - b * a_mm) * d->per_mm;
}

/* An axis that stands where the line is adds nothing, so it is left out. */
static void set_line(const struct interp_cursor *c, uint32_t axes,
		     struct interp_deviation *d)
{
	for (uint32_t j = 0; j < c->p.head->naxes; j++) {
		const uint32_t axis = c->p.head->column[j];
		const double from = node_mm(c, j, false);
		const struct interp_deviation_way w = {
			axis, c->p.head->pulse_mm[axis], from,
			node_mm(c, j, true) - from,
		};
		const bool off = c->pos[axis] * w.pulse_mm != from;

		d->way2 += axes >> axis & 1 ? w.mm * w.mm : 0;
		if (axes >> axis & 1 && (w.mm != 0 || off))
			d->way[d->nways++] = w;
	}
	d->per_mm = 1 / sqrt(d->way2);
	d->of = d->nways == 2 && d->way2 > 0 ? flat_deviation : line_deviation;
}

/* Squared distance from the point at share @t of the arc. */
static double arc_gap2(const struct interp_cursor *c, uint32_t axes, double t)
{
	const struct interp_arc *arc = &c->arc;
	const double *pulse = c->p.head->pulse_mm;
	const double theta = arc->theta + arc->sweep * t;
	const double r = arc->r_mm + arc->dr_mm * t;
	const double a = c->pos[arc->axis_a] * pulse[arc->axis_a] -
			 arc->a_mm - r * cos(theta);
	const double b = c->pos[arc->axis_b] * pulse[arc->axis_b] -
			 arc->b_mm - r * sin(theta);
	double d2 = a * a + b * b;

	for (uint32_t j = 0; j < c->p.head->naxes; j++) {
		const uint32_t axis = c->p.head->column[j];
		const double from = node_mm(c, j, false);
		const double off = c->pos[axis] * pulse[axis] - from -
				   (node_mm(c, j, true) - from) * t;

		if (axis != arc->axis_a && axis != arc->axis_b &&
		    axes & 1u << axis)
			d2 += off * off;
	}
	return d2;
}

/* The nearest place of a helix is near the place of the point: within a few
 * ticks or, where the helix is steep, less than a quarter of a radian. */
static double helix_deviation(const struct interp_cursor *c,
			      const struct interp_deviation *d)
{
	const double at = (double)c->measure / (double)c->whole;
	const double near = fmax(16.0 / c->seg.ticks,
				 fmin(0.25 / fabs(c->arc.sweep), 1));
	double lo = fmax(at - near, 0), hi = fmin(at + near, 1);

	for (int i = 0; i < 40; i++) {
		const double third = (hi - lo) / 3;

		if (arc_gap2(c, d->axes, lo + third) <
		    arc_gap2(c, d->axes, hi - third))
			hi -= third;
		else
			lo += third;
	}
	return sqrt(arc_gap2(c, d->axes, (lo + hi) / 2));
}

/* By how much the point is outside the circle of the start. */
static inline double outside(const struct interp_cursor *c,
			     const struct interp_deviation *d)
{
	const double a = off_mm(c, &d->way[0]), b = off_mm(c, &d->way[1]);

	/* hypot() would ask first whether squares overflow: no axis goes so
	 * far. */
	return sqrt(a * a + b * b) - d->arc.r_mm;
}

/* The distance from a circle, in its plane. */
static double circle_deviation(const struct interp_cursor *c,
			       const struct interp_deviation *d)
{
	return fabs(outside(c, d));
}

/*
 * If the two ends are not on one circle because of rounding, `simultaneous`
 * walks the spiral between them, and the other strategies stay on the circle of
 * the start.  A point between the two radii counts as on the arc.
 */
static double spiral_deviation(const struct interp_cursor *c,
			       const struct interp_deviation *d)
{
	const double at = c->whole ? (double)c->measure / (double)c->whole : 0;
	const double dr_mm = d->arc.dr_mm, r = outside(c, d);

	if (d->grows)
		return fabs(r - dr_mm * at);
	return fmax(fmax(r - fmax(dr_mm, 0), fmin(dr_mm, 0) - r), 0);
}

static void set_circle(const struct interp_cursor *c,
		       const struct interp_arc *arc, struct interp_deviation *d)
{
	const double *pulse = c->p.head->pulse_mm;

	d->of = arc->dr_mm != 0 ? spiral_deviation : circle_deviation;
	d->arc = *arc;
	d->way[0] = (struct interp_deviation_way) {
		arc->axis_a, pulse[arc->axis_a], arc->a_mm, 0
	};
	d->way[1] = (struct interp_deviation_way) {
		arc->axis_b, pulse[arc->axis_b], arc->b_mm, 0
	};
	d->grows = pulse_strategy(c->p.head->strategy)->at_once;
}

static bool is_helix(const struct interp_cursor *c, uint32_t axes)
{
	const struct interp_arc *arc = &c->arc;

	for (uint32_t j = 0; j < c->p.head->naxes; j++) {
		const uint32_t axis = c->p.head->column[j];

		if (axis != arc->axis_a && axis != arc->axis_b &&
		    axes & 1u << axis && c->whole &&
		    pulse_node(c, j, false) != pulse_node(c, j, true))
			return true;
	}
	return false;
}

/* Of a pair, the contour whose length is counted. */
static const struct interp_arc *counted(const struct interp_cursor *c,
					uint32_t axes)
{
	const uint32_t xy = 1u << INTERP_X | 1u << INTERP_Y;
	const struct interp_arc *xy_arc = &c->couple.side[0];

	return xy_arc->r_mm > 0 || axes & xy ? xy_arc : &c->couple.side[1];
}

/* The nearest place is a few pulses from the place of the point. */
static double curve_deviation(const struct interp_cursor *c,
			      const struct interp_deviation *d)
{
	struct interp_curve_walk k = c->curve;
	const double at = k.place_mm * c->tick / k.turns;
	double lo = fmax(at - 8 * k.place_mm, 0);
	double hi = fmin(at + 8 * k.place_mm, c->seg.length_mm);

	for (int i = 0; i < 32; i++) {
		const double third = (hi - lo) / 3;

		if (pulse_curve_gap2(c, &k, d->axes, lo + third) <
		    pulse_curve_gap2(c, &k, d->axes, hi - third))
			hi -= third;
		else
			lo += third;
	}
	return sqrt(pulse_curve_gap2(c, &k, d->axes, (lo + hi) / 2));
}

static void set_pair(const struct interp_cursor *c, struct interp_deviation *d)
{
	const struct interp_arc *arc = counted(c, d->axes);

	if (arc->r_mm > 0)
		set_circle(c, arc, d);
	else
		set_line(c, 1u << arc->axis_a | 1u << arc->axis_b, d);
}

double interp_deviation_first(const struct interp_cursor *c,
			      struct interp_deviation *d)
{
	*d = (struct interp_deviation) {
		.nodes = c->p.nodes, .index = c->index, .axes = length_axes(c),
	};
	if (c->seg.kind == INTERP_PAIR)
		set_pair(c, d);
	else if (c->seg.kind == INTERP_CURVE)
		d->of = curve_deviation;
	else if (c->seg.kind != INTERP_ARC)
		set_line(c, d->axes, d);
	else if (is_helix(c, d->axes))
		d->of = helix_deviation;
	else
		set_circle(c, &c->arc, d);
	return d->of(c, d);
}
