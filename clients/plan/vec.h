/* SPDX-License-Identifier: Apache-2.0 */
/*
 * vec.h - vectors of three and rotation matrices
 *
 * rot_apply() turns a vector from the inner frame into the outer one.  Units
 * are the caller's.  Any thread.
 */
#ifndef PLAN_VEC_H
#define PLAN_VEC_H

#include <math.h>

#define PLAN_RADIAN	(M_PI / 180)

static inline double v_dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void v_sub(const double a[3], const double b[3], double ret[3])
{
	for (int i = 0; i < 3; i++)
		ret[i] = a[i] - b[i];
}

static inline void v_add(const double a[3], const double b[3], double ret[3])
{
	for (int i = 0; i < 3; i++)
		ret[i] = a[i] + b[i];
}

/* ret = a + s b */
static inline void v_madd(const double a[3], double s, const double b[3],
			  double ret[3])
{
	for (int i = 0; i < 3; i++)
		ret[i] = a[i] + s * b[i];
}

static inline void v_cross(const double a[3], const double b[3], double ret[3])
{
	ret[0] = a[1] * b[2] - a[2] * b[1];
	ret[1] = a[2] * b[0] - a[0] * b[2];
	ret[2] = a[0] * b[1] - a[1] * b[0];
}

static inline double v_length(const double a[3])
{
	return sqrt(v_dot(a, a));
}

static inline double v_distance(const double a[3], const double b[3])
{
	double d[3];

	v_sub(a, b, d);
	return v_length(d);
}

/* Three rows. */
struct rot {
	double m[3][3];
};

/* ret = R v; ret is not v */
static inline void rot_apply(const struct rot *r, const double v[3],
			     double ret[3])
{
	for (int i = 0; i < 3; i++)
		ret[i] = v_dot(r->m[i], v);
}

/* ret = transpose(R) v; ret is not v */
static inline void rot_back(const struct rot *r, const double v[3],
			    double ret[3])
{
	for (int i = 0; i < 3; i++)
		ret[i] = r->m[0][i] * v[0] + r->m[1][i] * v[1] +
			 r->m[2][i] * v[2];
}

/* A B */
static inline struct rot rot_mul(const struct rot *a, const struct rot *b)
{
	struct rot ret;

	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			ret.m[i][j] = a->m[i][0] * b->m[0][j] +
				      a->m[i][1] * b->m[1][j] +
				      a->m[i][2] * b->m[2][j];
	return ret;
}

/* About the unit vector @d by @angle radian, by Rodrigues' formula. */
static inline struct rot rot_about(const double d[3], double angle)
{
	const double c = cos(angle), s = sin(angle);
	struct rot ret;

	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			ret.m[i][j] = (1 - c) * d[i] * d[j] +
				      (i == j ? c : 0);
	ret.m[0][1] -= s * d[2];
	ret.m[0][2] += s * d[1];
	ret.m[1][0] += s * d[2];
	ret.m[1][2] -= s * d[0];
	ret.m[2][0] -= s * d[1];
	ret.m[2][1] += s * d[0];
	return ret;
}

#endif /* PLAN_VEC_H */
