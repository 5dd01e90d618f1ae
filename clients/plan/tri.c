/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tri.c - the distance of two triangles
 *
 * Two triangles that do not meet are nearest either between two edges or
 * between a corner and a face.  Two that meet have an edge of one that goes
 * through the other.  Those are nine, six and six questions.
 */
#include "tri.h"

#include "vec.h"

#include <float.h>
#include <stdbool.h>
#include <string.h>

struct nearest {
	double d2;
	double p[3], q[3];
};

static void offer(struct nearest *n, const double p[3], const double q[3])
{
	double d[3], d2;

	v_sub(p, q, d);
	d2 = v_dot(d, d);
	if (d2 >= n->d2)
		return;
	n->d2 = d2;
	memcpy(n->p, p, sizeof(n->p));
	memcpy(n->q, q, sizeof(n->q));
}

static double clamp01(double x)
{
	return x < 0 ? 0 : x > 1 ? 1 : x;
}

/*
 * The points are p = a + s u and q = b + t v, with s and t in 0..1.  For a
 * given s the best t is a projection, and the other way round.  If the lines
 * are not parallel, s begins at the optimum of the whole lines.
 */
static void edges(const double a[3], const double u[3], const double b[3],
		  const double v[3], struct nearest *n)
{
	const double uu = v_dot(u, u), vv = v_dot(v, v), uv = v_dot(u, v);
	double w[3], p[3], q[3], s = 0, t = 0, uw, vw, det;

	v_sub(a, b, w);
	uw = v_dot(u, w);
	vw = v_dot(v, w);
	det = uu * vv - uv * uv;
	if (det > 1e-14 * uu * vv)
		s = clamp01((uv * vw - uw * vv) / det);
	if (vv > 0)
		t = clamp01((vw + s * uv) / vv);
	if (uu > 0)
		s = clamp01((t * uv - uw) / uu);
	v_madd(a, s, u, p);
	v_madd(b, t, v, q);
	offer(n, p, q);
}

struct face {
	struct triangle at;
	double edge[3][3];		/* from corner i to the next */
	double normal[3];		/* not of length 1 */
	double area2;			/* its length, squared */
};

static void face_of(const struct triangle *at, struct face *f)
{
	f->at = *at;
	for (int i = 0; i < 3; i++)
		v_sub(at->at[(i + 1) % 3], at->at[i], f->edge[i]);
	v_cross(f->edge[0], f->edge[1], f->normal);
	f->area2 = v_dot(f->normal, f->normal);
}

/* It is so thin that rounding cannot tell it from a segment: its edges are all
 * there is. */
static bool is_flat(const struct face *f)
{
	const double e0 = v_dot(f->edge[0], f->edge[0]);
	const double e1 = v_dot(f->edge[1], f->edge[1]);

	return !(f->area2 > 1e-24 * e0 * e1) || f->area2 < DBL_MIN;
}

/* Is @p, a point of the plane, inside the edges? */
static bool is_inside(const struct face *f, const double p[3])
{
	for (int i = 0; i < 3; i++) {
		double to[3], side[3];

		v_sub(p, f->at.at[i], to);
		v_cross(f->edge[i], to, side);
		if (v_dot(side, f->normal) < 0)
			return false;
	}
	return true;
}

/* How far each corner of @g is above the plane of @f, times its normal's
 * length. */
static void heights(const struct face *f, const struct face *g, double ret[3])
{
	for (int i = 0; i < 3; i++) {
		double to[3];

		v_sub(g->at.at[i], f->at.at[0], to);
		ret[i] = v_dot(to, f->normal);
	}
}

/* Corners of @g over the face of @f; @swap: @g is the first triangle. */
static void corners(const struct face *f, const struct face *g,
		    const double h[3], bool swap, struct nearest *n)
{
	for (int i = 0; i < 3; i++) {
		double foot[3];

		if (h[i] * h[i] >= n->d2 * f->area2)
			continue;
		v_madd(g->at.at[i], -h[i] / f->area2, f->normal, foot);
		if (!is_inside(f, foot))
			continue;
		if (swap)
			offer(n, g->at.at[i], foot);
		else
			offer(n, foot, g->at.at[i]);
	}
}

/* Does an edge of @g go through @f?  Then @at is where. */
static bool pierces(const struct face *f, const struct face *g,
		    const double h[3], double at[3])
{
	for (int i = 0; i < 3; i++) {
		const double from = h[i], to = h[(i + 1) % 3];

		if ((from > 0 && to > 0) || (from < 0 && to < 0) || from == to)
			continue;
		v_madd(g->at.at[i], from / (from - to), g->edge[i], at);
		if (is_inside(f, at))
			return true;
	}
	return false;
}

static bool one_side(const double h[3])
{
	return (h[0] > 0 && h[1] > 0 && h[2] > 0) ||
	       (h[0] < 0 && h[1] < 0 && h[2] < 0);
}

static double meet(double at[3], double p[3], double q[3])
{
	memcpy(p, at, 3 * sizeof(*p));
	memcpy(q, at, 3 * sizeof(*q));
	return 0;
}

double tri_distance(const struct triangle *a, const struct triangle *b,
		    double p[3], double q[3])
{
	struct nearest n = { .d2 = DBL_MAX };
	struct face fa, fb;
	double ha[3] = { 1, 1, 1 }, hb[3] = { 1, 1, 1 }, at[3];
	bool solid_a, solid_b, apart;

	face_of(a, &fa);
	face_of(b, &fb);
	solid_a = !is_flat(&fa);
	solid_b = !is_flat(&fb);
	if (solid_a)
		heights(&fa, &fb, hb);
	if (solid_b)
		heights(&fb, &fa, ha);
	apart = (solid_a && one_side(hb)) || (solid_b && one_side(ha));
	if (!apart && solid_a && pierces(&fa, &fb, hb, at))
		return meet(at, p, q);
	if (!apart && solid_b && pierces(&fb, &fa, ha, at))
		return meet(at, p, q);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			edges(a->at[i], fa.edge[i], b->at[j], fb.edge[j],
			      &n);
	if (solid_a)
		corners(&fa, &fb, hb, false, &n);
	if (solid_b)
		corners(&fb, &fa, ha, true, &n);
	memcpy(p, n.p, sizeof(n.p));
	memcpy(q, n.q, sizeof(n.q));
	return sqrt(n.d2);
}
