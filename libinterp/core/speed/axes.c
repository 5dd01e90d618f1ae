/* SPDX-License-Identifier: Apache-2.0 */
/* axes.c - how fast axes can follow a path */
#include "interp/axes.h"
#include "interp/smaller.h"

#include <math.h>

#define ROOT_STEPS	4	/* of Newton: to a thousandth */
#define ROOT_NEAR	1.001

struct interp_straight interp_axes_straight(const struct interp_axes *x,
					    const double *way)
{
	struct interp_straight ret = { INFINITY, INFINITY };

	for (uint32_t k = 0; k < x->n; k++, way += INTERP_AXES_WAY) {
		const double by = fabs(way[0]);

		if (by * ret.a_mm_s2 > x->a_mm_s2[k] && by > 0)
			ret.a_mm_s2 = x->a_mm_s2[k] / by;
		if (by * ret.j_mm_s3 > x->j_mm_s3[k] && by > 0)
			ret.j_mm_s3 = x->j_mm_s3[k] / by;
	}
	return ret;
}

/* What a motion has kept that speeds up from a stand to @v_mm_s. */
static double kept_mm_s2(const struct interp_straight *s, double v_mm_s)
{
	return v_mm_s * s->j_mm_s3 < s->a_mm_s2 * s->a_mm_s2 ?
	       sqrt(v_mm_s * s->j_mm_s3) : s->a_mm_s2;
}

/* The speed below @v at which a column leaves the jerk that is kept. */
static double by_jerk_mm_s(const double *way, const struct interp_straight *s,
			   double left_mm_s3, double v)
{
	const double twist = fabs(way[2]);
	const double bend = 3 * fabs(way[1]) * INTERP_AXES_KEPT;

	for (int i = 0; i < ROOT_STEPS; i++) {
		const double a = kept_mm_s2(s, v);
		const double is = (twist * v * v + bend * a) * v;
		const double slope = 3 * twist * v * v +
				     bend * a * (a < s->a_mm_s2 ? 1.5 : 1);

		if (is <= left_mm_s3 * ROOT_NEAR)
			break;
		v = larger(v - (is - left_mm_s3) / slope, 0.3 * v);
	}
	return v;
}

double interp_axes_mm_s(const struct interp_axes *x, const double *way)
{
	const struct interp_straight s = interp_axes_straight(x, way);
	double v = INFINITY;

	for (uint32_t k = 0; k < x->n; k++) {
		const double by = fabs(way[k * INTERP_AXES_WAY]);

		if (by * v > x->v_mm_s[k])
			v = x->v_mm_s[k] / by;
	}
	for (uint32_t k = 0; k < x->n; k++, way += INTERP_AXES_WAY) {
		const double kept = INTERP_AXES_KEPT * fabs(way[0]);
		const double a = x->a_mm_s2[k] - (kept > 0 ?
						  kept * s.a_mm_s2 : 0);
		const double j = x->j_mm_s3[k] - (kept > 0 ?
						  kept * s.j_mm_s3 : 0);

		if (fabs(way[1]) * v * v > a)
			v = sqrt(a / fabs(way[1]));
		v = by_jerk_mm_s(way, &s, j, v);
	}
	return v;
}

/* What is left of @all beside @other, by so much along the path. */
static void narrow(struct interp_range *r, double by, double all, double other)
{
	const double up = ((by < 0 ? -all : all) - other) / by;
	const double down = ((by < 0 ? all : -all) - other) / by;

	r->most = smaller(r->most, up);
	r->least = larger(r->least, down);
}

struct interp_range interp_axes_mm_s2(const struct interp_axes *x,
				      const double *way, double v_mm_s)
{
	struct interp_range r = { -INFINITY, INFINITY };
	const double v2 = v_mm_s * v_mm_s;

	for (uint32_t k = 0; k < x->n; k++, way += INTERP_AXES_WAY) {
		const double bend = 3 * fabs(way[1]) * v_mm_s;

		if (way[0] != 0)
			narrow(&r, way[0], x->a_mm_s2[k], way[1] * v2);
		if (bend > 0)
			narrow(&r, bend, larger((1 - INTERP_AXES_KEPT) *
							x->j_mm_s3[k] -
						fabs(way[2]) * v2 * v_mm_s, 0),
			       0);
	}
	return r;
}

struct interp_range interp_axes_mm_s3(const struct interp_axes *x,
				      const double *way, double v_mm_s,
				      double a_mm_s2)
{
	struct interp_range r = { -INFINITY, INFINITY };

	for (uint32_t k = 0; k < x->n; k++, way += INTERP_AXES_WAY)
		if (way[0] != 0)
			narrow(&r, way[0], x->j_mm_s3[k],
			       (3 * way[1] * a_mm_s2 +
				way[2] * v_mm_s * v_mm_s) * v_mm_s);
	return r;
}
