/* SPDX-License-Identifier: Apache-2.0 */
/*
 * curve.c - one line or arc of a contour in a plane, and its parallels
 */
#include "wire/curve.h"

#include "interp/angle.h"

#include <math.h>

/* Two that nearly touch and are written to a micrometre may miss so far. */
#define MISS_MM		0.0015

static double dot(struct vec a, struct vec b)
{
	return a.x * b.x + a.y * b.y;
}

struct curve curve_line(struct vec from, struct vec to)
{
	return (struct curve) { .from = from, .to = to };
}

static double angle_of(struct vec at, struct vec centre)
{
	return atan2(at.y - centre.y, at.x - centre.x);
}

struct curve curve_arc(struct vec from, struct vec to, struct vec centre,
		       double sweep)
{
	struct curve c = {
		.arc = true, .from = from, .to = to, .centre = centre,
		.r = curve_distance(centre, from),
		.theta = angle_of(from, centre),
	};

	c.sweep = angle_nearest(angle_of(to, centre) - c.theta, sweep);
	return c;
}

struct curve curve_round(struct vec from, struct vec to, struct vec centre,
			 bool clockwise)
{
	const double by = angle_of(to, centre) - angle_of(from, centre);

	return curve_arc(from, to, centre, clockwise ? -angle_ahead(-by) :
						       angle_ahead(by));
}

/* A centre written to a micrometre is not as far from the one end as from the
 * other: the nearest place that is. */
struct curve curve_evened(const struct curve *c)
{
	const struct vec chord = vec_add(c->to, -1, c->from);
	const double len = curve_hypot(chord.x, chord.y);

	if (!c->arc || len < CURVE_SAME_MM)
		return *c;
	return curve_arc(c->from, c->to,
			 vec_add(c->centre, curve_uneven(c) / len, chord),
			 c->sweep);
}

double curve_uneven(const struct curve *c)
{
	const struct vec chord = vec_add(c->to, -1, c->from);
	const double len = curve_hypot(chord.x, chord.y);
	const struct vec off = {
		(c->from.x + c->to.x) / 2 - c->centre.x,
		(c->from.y + c->to.y) / 2 - c->centre.y,
	};

	return !c->arc || len < CURVE_SAME_MM ? 0 : dot(off, chord) / len;
}

void curve_halved(const struct curve *c, struct curve ret[2])
{
	const struct vec mid = curve_at(c, 0.5);
	const double r1 = curve_distance(c->centre, c->to);
	struct vec at;

	ret[0] = curve_part(c, 0, 0.5);
	ret[1] = curve_part(c, 0.5, 1);
	if (!c->arc || c->r == 0)
		return;
	at = vec_add(c->centre, (c->r + r1) / (2 * c->r),
		     vec_add(mid, -1, c->centre));
	ret[0] = curve_arc(c->from, at, c->centre, c->sweep / 2);
	ret[1] = curve_arc(at, c->to, c->centre, c->sweep / 2);
}

double curve_length(const struct curve *c)
{
	return c->arc ? fabs(c->sweep) * c->r : curve_distance(c->from, c->to);
}

struct vec curve_way(const struct curve *c, bool at_end)
{
	const double theta = c->theta + (at_end ? c->sweep : 0);
	const double turn = c->sweep < 0 ? -1 : 1;
	const double len = curve_distance(c->from, c->to);

	if (c->arc)
		return (struct vec) { -turn * sin(theta), turn * cos(theta) };
	return (struct vec) { (c->to.x - c->from.x) / len,
			      (c->to.y - c->from.y) / len };
}

struct vec curve_at(const struct curve *c, double t)
{
	const double theta = c->theta + c->sweep * t;

	if (t <= 0)
		return c->from;
	if (t >= 1)
		return c->to;
	if (c->arc)
		return (struct vec) { c->centre.x + c->r * cos(theta),
				      c->centre.y + c->r * sin(theta) };
	return (struct vec) { c->from.x + t * (c->to.x - c->from.x),
			      c->from.y + t * (c->to.y - c->from.y) };
}

struct curve curve_part(const struct curve *c, double t0, double t1)
{
	struct curve part = *c;

	part.from = curve_at(c, t0);
	part.to = curve_at(c, t1);
	part.theta = c->theta + c->sweep * t0;
	part.sweep = c->sweep * (t1 - t0);
	return part;
}

static struct vec left_of(struct vec way)
{
	return (struct vec) { -way.y, way.x };
}

bool curve_parallel(const struct curve *c, double d, struct curve *ret)
{
	*ret = *c;
	ret->from = vec_add(c->from, d, left_of(curve_way(c, false)));
	ret->to = vec_add(c->to, d, left_of(curve_way(c, true)));
	if (!c->arc)
		return true;
	if (curve_distance(c->from, c->to) < CURVE_SAME_MM)
		ret->to = ret->from;	/* a full circle stays one */
	/* The centre is on the left of a counter-clockwise arc. */
	ret->r = c->sweep > 0 ? c->r - d : c->r + d;
	if (fabs(ret->r) < CURVE_SAME_MM)
		ret->r = 0;
	return ret->r >= 0;
}

/* Feet of up to two crossings; the number of them. */
static int line_line(const struct curve *a, const struct curve *b,
		     struct vec ret[2])
{
	const struct vec p = curve_way(a, false), q = curve_way(b, false);
	const double cross = p.x * q.y - p.y * q.x;
	const double dx = b->from.x - a->from.x, dy = b->from.y - a->from.y;

	if (fabs(cross) < 1e-12)
		return 0;
	ret[0] = vec_add(a->from, (dx * q.y - dy * q.x) / cross, p);
	return 1;
}

static int line_circle(const struct curve *l, const struct curve *c,
		       struct vec ret[2])
{
	const struct vec way = curve_way(l, false);
	const struct vec to = { c->centre.x - l->from.x,
				c->centre.y - l->from.y };
	const double along = dot(to, way);
	const double h2 = c->r * c->r - dot(to, to) + along * along;
	const double h = h2 > 0 ? sqrt(h2) : 0;

	if (h2 < -2 * c->r * MISS_MM)
		return 0;
	ret[0] = vec_add(l->from, along - h, way);
	ret[1] = vec_add(l->from, along + h, way);
	return 2;
}

static int circle_circle(const struct curve *a, const struct curve *b,
			 struct vec ret[2])
{
	const double d = curve_distance(a->centre, b->centre);
	const struct vec way = { (b->centre.x - a->centre.x) / d,
				 (b->centre.y - a->centre.y) / d };
	double x, h2, h;
	struct vec foot;

	if (d < CURVE_SAME_MM)
		return 0;
	x = (d * d + a->r * a->r - b->r * b->r) / (2 * d);
	h2 = a->r * a->r - x * x;
	if (h2 < -2 * a->r * MISS_MM)
		return 0;
	h = h2 > 0 ? sqrt(h2) : 0;
	foot = vec_add(a->centre, x, way);
	ret[0] = vec_add(foot, h, left_of(way));
	ret[1] = vec_add(foot, -h, left_of(way));
	return 2;
}

int curve_meets(const struct curve *a, const struct curve *b, struct vec ret[2])
{
	return a->arc && b->arc ? circle_circle(a, b, ret) :
	       a->arc ? line_circle(b, a, ret) :
	       b->arc ? line_circle(a, b, ret) : line_line(a, b, ret);
}

bool curve_meet(const struct curve *a, const struct curve *b, struct vec near,
		struct vec *ret)
{
	struct vec at[2];
	const int n = curve_meets(a, b, at);

	if (n == 0)
		return false;
	*ret = n == 2 && curve_distance(at[1], near) <
			 curve_distance(at[0], near) ? at[1] : at[0];
	return true;
}

/* How far @at lies ahead of @theta in the arc's own sense, in (-pi, pi]. */
static double past(const struct curve *c, double theta, struct vec at)
{
	const double by = atan2(at.y - c->centre.y, at.x - c->centre.x) - theta;
	const double near = angle_nearest(by, 0);

	return c->sweep < 0 ? -near : near;
}

static bool trim_arc(struct curve *c, struct vec from, struct vec to)
{
	const double start = past(c, c->theta, from);
	const double end = past(c, c->theta + c->sweep, to);
	const double left = fabs(c->sweep) - start + end;

	c->from = from;
	c->to = to;
	if (c->r == 0)
		return true;
	if (left * c->r < CURVE_SAME_MM)
		return false;
	c->theta += c->sweep < 0 ? -start : start;
	c->sweep = c->sweep < 0 ? -left : left;
	return true;
}

bool curve_trim(struct curve *c, struct vec from, struct vec to)
{
	const struct vec way = curve_way(c, false);
	const struct vec left = { to.x - from.x, to.y - from.y };

	if (c->arc)
		return trim_arc(c, from, to);
	*c = curve_line(from, to);
	return dot(way, left) > CURVE_SAME_MM;
}

struct curve curve_reversed(const struct curve *c)
{
	struct curve back = *c;

	back.from = c->to;
	back.to = c->from;
	back.theta = c->theta + c->sweep;
	back.sweep = -c->sweep;
	return back;
}

double curve_turn(const struct curve *a, const struct curve *b)
{
	const struct vec v = curve_way(a, true), w = curve_way(b, false);

	return atan2(v.x * w.y - v.y * w.x, v.x * w.x + v.y * w.y);
}

/* Of the two turns by which a place on a circle may be named the one nearer
 * to the middle of the arc is meant. */
double curve_share(const struct curve *c, struct vec at)
{
	const struct vec way = curve_way(c, false);
	const struct vec to = { at.x - c->from.x, at.y - c->from.y };

	if (!c->arc)
		return dot(to, way) / curve_distance(c->from, c->to);
	if (c->sweep == 0)
		return 0;
	return 0.5 + past(c, c->theta + c->sweep / 2, at) / fabs(c->sweep);
}
