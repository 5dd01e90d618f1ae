/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tri.h - the distance of two triangles
 *
 * A triangle without area counts as the segment or the point that it is.
 * Units: mm.  Any thread.
 */
#ifndef PLAN_TRI_H
#define PLAN_TRI_H

struct triangle {
	double at[3][3];		/* corners */
};

/**
 * tri_distance() - their distance, and the nearest points @p of @a and @q of
 * @b; 0 if they meet.
 *
 * It is exact up to rounding.  If it is 0, both points are one point of
 * contact.
 */
double tri_distance(const struct triangle *a, const struct triangle *b,
		    double p[3], double q[3]);

#endif /* PLAN_TRI_H */
