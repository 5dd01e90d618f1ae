/* SPDX-License-Identifier: Apache-2.0 */
/*
 * vector.h - three numbers
 *
 * Private to libinterp/compile/kinematics.
 */
#ifndef KINEMATICS_VECTOR_H
#define KINEMATICS_VECTOR_H

#include <math.h>

static inline double vec_dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double vec_length(const double a[3])
{
	return sqrt(vec_dot(a, a));
}

static inline void vec_cross(const double a[3], const double b[3],
			     double ret[3])
{
	ret[0] = a[1] * b[2] - a[2] * b[1];
	ret[1] = a[2] * b[0] - a[0] * b[2];
	ret[2] = a[0] * b[1] - a[1] * b[0];
}

/* Turn @v about @axis through the origin, in place (O. Rodrigues, 1840). */
static inline void vec_turn(const double axis[3], double angle, double v[3])
{
	const double c = cos(angle), s = sin(angle);
	const double along = vec_dot(axis, v) * (1 - c);
	double x[3];

	vec_cross(axis, v, x);
	for (int i = 0; i < 3; i++)
		v[i] = v[i] * c + x[i] * s + axis[i] * along;
}

#endif /* KINEMATICS_VECTOR_H */
