/* SPDX-License-Identifier: Apache-2.0 */
/*
 * gap.c - where two curves cross, and how far they are apart
 */
#include "wire/curve.h"

#include "interp/angle.h"

#include <math.h>

static void box_add(struct curve_box *b, struct vec at)
{
	b->lo.x = curve_min(b->lo.x, at.x);
	b->lo.y = curve_min(b->lo.y, at.y);
	b->hi.x = curve_max(b->hi.x, at.x);
	b->hi.y = curve_max(b->hi.y, at.y);
}

struct curve_box curve_bounds(const struct curve *c)
{
	struct curve_box b = { c->from, c->from };
	double first, last;

	box_add(&b, c->to);
	if (!c->arc || c->r == 0)
		return b;
	/* The arc comes by the ends of the circle's two diameters. */
	first = ceil(curve_min(c->theta, c->theta + c->sweep) / ANGLE_RIGHT);
	last = floor(curve_max(c->theta, c->theta + c->sweep) / ANGLE_RIGHT);
	for (int i = 0; i < 4 && first + i <= last; i++) {
		const double a = (first + i) * ANGLE_RIGHT;

		box_add(&b, (struct vec) { c->centre.x + c->r * cos(a),
					   c->centre.y + c->r * sin(a) });
	}
	return b;
}

static bool boxes_touch(const struct curve *a, const struct curve *b)
{
	const struct curve_box p = curve_bounds(a), q = curve_bounds(b);

	return p.lo.x - q.hi.x <= CURVE_SAME_MM &&
	       q.lo.x - p.hi.x <= CURVE_SAME_MM &&
	       p.lo.y - q.hi.y <= CURVE_SAME_MM &&
	       q.lo.y - p.hi.y <= CURVE_SAME_MM;
}

static bool is_dot(const struct curve *c)
{
	return c->arc ? c->r == 0 || c->sweep == 0 :
			curve_distance(c->from, c->to) < CURVE_SAME_MM;
}

/* Is share @t on the curve, but for the rounding of its ends? */
static bool is_on(const struct curve *c, double *t)
{
	const double slack = CURVE_SAME_MM / curve_length(c);

	if (!(*t >= -slack && *t <= 1 + slack))
		return false;
	*t = curve_min(curve_max(*t, 0), 1);
	return true;
}

int curve_cross(const struct curve *a, const struct curve *b,
		struct curve_hit ret[2])
{
	struct vec at[2];
	int n, kept = 0;

	if (is_dot(a) || is_dot(b) || !boxes_touch(a, b))
		return 0;
	n = curve_meets(a, b, at);
	for (int i = 0; i < n; i++) {
		struct curve_hit h = { .at = at[i] };

		h.t[0] = curve_share(a, at[i]);
		h.t[1] = curve_share(b, at[i]);
		if (is_on(a, &h.t[0]) && is_on(b, &h.t[1]))
			ret[kept++] = h;
	}
	return kept;
}

bool curve_cross_near(const struct curve *a, const struct curve *b,
		      struct vec near, struct vec *ret)
{
	struct curve_hit hit[2];
	const int n = curve_cross(a, b, hit);

	if (n == 0)
		return false;
	*ret = n == 2 && curve_distance(hit[1].at, near) <
			 curve_distance(hit[0].at, near) ? hit[1].at :
							   hit[0].at;
	return true;
}

/* A part of an arc that has no length faces nothing. */
static bool arc_faces(const struct curve *c, struct vec at)
{
	const double t = curve_share(c, at);

	return c->sweep != 0 && t >= 0 && t <= 1;
}

static double from_line(const struct curve *c, struct vec at)
{
	const double dx = c->to.x - c->from.x, dy = c->to.y - c->from.y;
	const double len2 = dx * dx + dy * dy;
	const double t = len2 > 0 ? ((at.x - c->from.x) * dx +
				     (at.y - c->from.y) * dy) / len2 : 0;
	const double on = curve_min(curve_max(t, 0), 1);

	return curve_hypot(at.x - c->from.x - on * dx,
			   at.y - c->from.y - on * dy);
}

double curve_from(const struct curve *c, struct vec at)
{
	double ends;

	if (!c->arc)
		return from_line(c, at);
	ends = curve_min(curve_distance(c->from, at),
			 curve_distance(c->to, at));
	if (c->r > 0 && arc_faces(c, at))
		return curve_min(ends,
				 fabs(curve_distance(c->centre, at) - c->r));
	return ends;
}

/* The foot of an arc's centre on a line. */
static double line_to_arc(const struct curve *l, const struct curve *c)
{
	const double t = curve_share(l, c->centre);
	const struct vec foot = curve_at(l, t);

	if (!(t > 0 && t < 1) || !arc_faces(c, foot))
		return INFINITY;
	return fabs(curve_distance(foot, c->centre) - c->r);
}

/* The ends of the diameters that lie on one line. */
static double arc_to_arc(const struct curve *a, const struct curve *b)
{
	const double d = curve_distance(a->centre, b->centre);
	const struct vec way = { (b->centre.x - a->centre.x) / d,
				 (b->centre.y - a->centre.y) / d };
	double best = INFINITY;

	if (d < CURVE_SAME_MM)
		return best;
	for (int i = 0; i < 4; i++) {
		const struct vec p = vec_add(a->centre, i & 1 ? a->r : -a->r,
					     way);
		const struct vec q = vec_add(b->centre, i & 2 ? b->r : -b->r,
					     way);

		if (arc_faces(a, p) && arc_faces(b, q))
			best = curve_min(best, curve_distance(p, q));
	}
	return best;
}

double curve_gap(const struct curve *a, const struct curve *b)
{
	struct curve_hit hit[2];
	double best;

	if (curve_cross(a, b, hit))
		return 0;
	best = curve_min(
		curve_min(curve_from(a, b->from), curve_from(a, b->to)),
		curve_min(curve_from(b, a->from), curve_from(b, a->to)));
	if (is_dot(a) || is_dot(b) || (!a->arc && !b->arc))
		return best;
	if (a->arc && b->arc)
		return curve_min(best, arc_to_arc(a, b));
	return curve_min(best, a->arc ? line_to_arc(b, a) : line_to_arc(a, b));
}
