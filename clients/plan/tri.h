/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tri.h - the distance of two triangles
 *
 * A triangle without area counts as the segment or point it is.
 * Units: mm.  Any thread.
 */
#ifndef PLAN_TRI_H
#define PLAN_TRI_H

struct triangle {
	double at[3][3];		/* corners */
};

/**
 * tri_distance() - and where: @p on @a, @q on @b; 0 if they meet.
 *
 * Exact up to rounding.  With distance 0 both are a point of contact.
 */
double tri_distance(const struct triangle *a, const struct triangle *b,
		    double p[3], double q[3]);

#endif /* PLAN_TRI_H */
