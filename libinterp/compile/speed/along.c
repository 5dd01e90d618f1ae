/* SPDX-License-Identifier: Apache-2.0 */
/* along.c - how fast axes can follow a path */
#include "speed/along.h"
#include "interp/smaller.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

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

/* From a stand to @v_mm_s no motion comes to more than that. */
static double comes_to_mm_s2(const struct interp_straight *s, double v_mm_s)
{
	return v_mm_s * s->j_mm_s3 < s->a_mm_s2 * s->a_mm_s2 ?
	       sqrt(v_mm_s * s->j_mm_s3) : s->a_mm_s2;
}

/*
 * The cube root of @x >= 0, within 10^-5 of it.
 *
 * Newton's steps begin there, and it costs a tenth of cbrt().  A third of the
 * bits of a float is within 4 %.
 */
static double root3(double x)
{
	const float near = (float)x;
	uint32_t bits;
	double y;
	float f;

	memcpy(&bits, &near, sizeof(bits));
	bits = bits / 3 + 709921077;
	memcpy(&f, &bits, sizeof(f));
	y = (double)f;
	y = (2 * y + x / (y * y)) / 3;
	return (2 * y + x / (y * y)) / 3;
}

/* The speed below @v at which a column leaves @left_mm_s3 of the jerk.  Where
 * its twist or its bend alone takes all of that, both take no more than twice
 * as much: from there Newton's steps are few. */
static double by_jerk_mm_s(const double *way,
			   const struct interp_straight *kept,
			   double left_mm_s3, double v)
{
	const double twist = fabs(way[2]), bend = 3 * fabs(way[1]);
	const double bent = left_mm_s3 / bend;

	if (twist * v * v * v > left_mm_s3)
		v = root3(left_mm_s3 / twist);
	if (bend * comes_to_mm_s2(kept, v) * v > left_mm_s3)
		v = larger(bent / kept->a_mm_s2,
			   root3(bent * bent / kept->j_mm_s3));
	for (int i = 0; i < ROOT_STEPS; i++) {
		const double a = comes_to_mm_s2(kept, v);
		const double is = (twist * v * v + bend * a) * v;
		const double slope = 3 * twist * v * v +
				     bend * a * (a < kept->a_mm_s2 ? 1.5 : 1);

		if (is <= left_mm_s3 * ROOT_NEAR)
			break;
		v -= (is - left_mm_s3) / slope;
	}
	return v;
}

/* Where they leave @go. */
static double speed_of(const struct interp_axes *x, const double *way,
		       const struct interp_straight *go)
{
	double v = INFINITY;

	for (uint32_t k = 0; k < x->n; k++) {
		const double by = fabs(way[k * INTERP_AXES_WAY]);

		if (by * v > x->v_mm_s[k])
			v = x->v_mm_s[k] / by;
	}
	for (uint32_t k = 0; k < x->n; k++, way += INTERP_AXES_WAY) {
		const double by = fabs(way[0]);
		const double a = x->a_mm_s2[k] -
				 (by > 0 ? by * go->a_mm_s2 : 0);
		const double j = x->j_mm_s3[k] -
				 (by > 0 ? by * go->j_mm_s3 : 0);

		if (fabs(way[1]) * v * v > a)
			v = sqrt(a / fabs(way[1]));
		if (way[1] != 0 || way[2] != 0)
			v = by_jerk_mm_s(way, go, j, v);
	}
	return v;
}

/* A motion that has a speed, and keeps something for going along. */
struct motion {
	const struct interp_axes *x;
	struct interp_straight go;
	double v_mm_s;
};

/* What column @k leaves beside its bend. */
static void leave(const struct motion *m, uint32_t k, const double *way,
		  struct interp_straight *ret)
{
	const struct interp_straight *go = &m->go;
	const struct interp_axes *x = m->x;
	const double by = fabs(way[0]), bend = fabs(way[1]), v = m->v_mm_s;
	const double a = x->a_mm_s2[k] - bend * v * v;
	const double j = x->j_mm_s3[k] - fabs(way[2]) * v * v * v -
			 (by > 0 ? by * go->j_mm_s3 : 0);

	if (by * ret->a_mm_s2 > a)
		ret->a_mm_s2 = a / by;
	if (!(3 * bend * v * ret->a_mm_s2 > j))
		return;
	if (3 * bend * v * comes_to_mm_s2(go, v) * ROOT_NEAR > j)
		ret->a_mm_s2 = smaller(ret->a_mm_s2, j / (3 * bend * v));
	else
		ret->j_mm_s3 = smaller(ret->j_mm_s3, go->j_mm_s3);
}

void interp_axes_overlook(double *way, double pulse_mm)
{
	const double most = 1 / pulse_mm;

	way[1] = larger(smaller(way[1], most), -most);
	way[2] = larger(smaller(way[2], most * most), -most * most);
}

double interp_axes_mm_s(const struct interp_axes *x, const double *way,
			const struct interp_straight *kept,
			struct interp_straight *ret_left)
{
	const struct interp_straight s = interp_axes_straight(x, way);
	const double v = speed_of(x, way, kept);
	const struct motion m = { x, *kept, v };
	double a;

	*ret_left = s;
	for (uint32_t k = 0; k < x->n; k++)
		leave(&m, k, way + k * INTERP_AXES_WAY, ret_left);
	ret_left->a_mm_s2 = larger(ret_left->a_mm_s2, kept->a_mm_s2);
	a = smaller(ret_left->a_mm_s2, comes_to_mm_s2(ret_left, v));
	for (uint32_t k = 0; k < x->n; k++, way += INTERP_AXES_WAY) {
		const double by = fabs(way[0]);
		const double j = x->j_mm_s3[k] -
				 (fabs(way[2]) * v * v +
				  3 * fabs(way[1]) * a) * v;

		if (by * ret_left->j_mm_s3 > j)
			ret_left->j_mm_s3 = j / by;
	}
	ret_left->j_mm_s3 = larger(ret_left->j_mm_s3, kept->j_mm_s3);
	return v;
}
