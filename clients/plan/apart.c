/* SPDX-License-Identifier: Apache-2.0 */
/*
 * apart.c - gaps between two triangles
 */
#include "apart.h"

#include "near.h"

#include <float.h>

/* Taken off the gap of two triangles: far more than its rounding error. */
#define ROUNDING_MM	1e-9

/* Directions in which a gap of two triangles is looked for. */
#define BESIDE_STEPS	4

/* The time x at which s x + A x^2 / 2 reaches @gap, which is more than 0. */
static double root(double gap, double s, double accel)
{
	double b;

	if (accel <= 0)
		return s > 0 ? gap / s : DBL_MAX;
	b = sqrt(s * s + 2 * accel * gap);
	return s > 0 ? 2 * gap / (s + b) : (b - s) / accel;
}

/* How long the gap along @n, a unit vector from the tool to the part, is
 * enough. */
static double time_along(const struct apart *a, const struct triangle *tool,
			 const double n[3], double gap)
{
	double m[3], s = -DBL_MAX;

	v_cross(n, a->rate->w, m);
	for (int k = 0; k < 3; k++)
		s = fmax(s, v_dot(m, tool->at[k]));
	return root(gap - a->keep_mm, s + v_dot(n, a->rate->v) + a->rises,
		    a->rate->accel);
}

static bool is_enough(const struct apart *a, const struct triangle *tool,
		      const double n[3], double gap)
{
	if (!a->rate || gap <= a->least_mm)
		return a->rate ? false : gap >= a->least_mm;
	return time_along(a, tool, n, gap) >= a->time;
}

/* Is the gap to the plane of the part's triangle enough?  Where two walls face
 * each other it mostly is. */
static bool is_over(const struct apart *a, const double plane[4],
		    const struct triangle *tool)
{
	double h[3], n[3], side, gap;

	for (int k = 0; k < 3; k++)
		h[k] = v_dot(plane, tool->at[k]) - plane[3];
	side = h[0] > 0 ? 1 : -1;
	gap = fmin(side * h[0], fmin(side * h[1], side * h[2])) - ROUNDING_MM;
	if (gap <= 0)
		return false;
	for (int k = 0; k < 3; k++)
		n[k] = -side * plane[k];
	return is_enough(a, tool, n, gap);
}

static void middle(const struct triangle *t, double ret[3])
{
	for (int i = 0; i < 3; i++)
		ret[i] = (t->at[0][i] + t->at[1][i] + t->at[2][i]) / 3;
}

/* The vector between the corners of @a and @b that are nearest along @v. */
static void nearest_along(const struct triangle *a, const struct triangle *b,
			  const double v[3], double ret[3])
{
	int i = 0, j = 0;

	for (int k = 1; k < 3; k++) {
		if (v_dot(a->at[k], v) > v_dot(a->at[i], v))
			i = k;
		if (v_dot(b->at[k], v) < v_dot(b->at[j], v))
			j = k;
	}
	v_sub(b->at[j], a->at[i], ret);
}

/*
 * For a triangle that stands beside the other, not over it.  The gap can be
 * measured along any vector v from one to the other.  The steps of Frank and
 * Wolfe turn v toward the shortest one; a step costs a tenth of the distance.
 */
static bool is_beside(const struct apart *a, const struct triangle *part,
		      const struct triangle *tool)
{
	double from[3], v[3];

	middle(part, from);
	middle(tool, v);
	v_sub(v, from, v);
	for (int i = 0; i < BESIDE_STEPS; i++) {
		const double d = v_length(v);
		double to[3], n[3], share;

		if (!(d > 0) || (!a->rate && d < a->least_mm))
			return false;
		nearest_along(part, tool, v, to);
		for (int k = 0; k < 3; k++)
			n[k] = -v[k] / d;
		if (is_enough(a, tool, n, -v_dot(n, to) - ROUNDING_MM))
			return true;
		v_sub(to, v, to);
		share = -v_dot(v, to) / v_dot(to, to);
		if (!(share > 0))
			return false;
		v_madd(v, fmin(share, 1), to, v);
	}
	return false;
}

bool apart_seen(const struct apart *a, const struct triangle *part,
		const double plane[4], const struct triangle *tool)
{
	return is_over(a, plane, tool) || is_beside(a, part, tool);
}

double apart_time(const struct apart *a, const struct triangle *tool, double mm,
		  const double p[3], const double q[3])
{
	double n[3];

	for (int i = 0; i < 3; i++)
		n[i] = (p[i] - q[i]) / mm;
	return time_along(a, tool, n, mm);
}
