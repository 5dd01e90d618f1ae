/* SPDX-License-Identifier: Apache-2.0 */
/*
 * nurbs_feed.h - how fast a curve may be followed at a point
 *
 * At a constant feed v along the path, an axis at x(s) has the speed v x_s, the
 * acceleration v^2 x_ss and the jerk v^3 x_sss.  On a curve of curvature k
 * there is an acceleration of v^2 k across the path, and the straight way of
 * one period T is v^2 T^2 k / 8 away from the curve.  Each of these has a
 * limit, and the limit that allows the lowest feed counts.
 *
 * Units: mm, s.
 * Threads: any thread; nothing is allocated.
 */
#ifndef INTERP_NURBS_FEED_H
#define INTERP_NURBS_FEED_H

#include "interp/nurbs.h"

#include <stdbool.h>

/* All > 0; HUGE_VAL is no limit. */
struct interp_nurbs_limits {
	double chord_error_mm, period_s;
	double centripetal_mm_s2;
	double v_mm_s[INTERP_NAXES];	/* by the curve's columns */
	double a_mm_s2[INTERP_NAXES];
	double j_mm_s3[INTERP_NAXES];
};

/* A point of a curve, by the length of the path. */
struct interp_nurbs_way {
	bool cusp;			/* the curve does not go on here; then
					 * the rest says nothing */
	double by_u_mm;			/* length, by parameter */
	double curvature;		/* 1/mm, in the counted axes */
	double d[3][INTERP_NAXES];	/* x_s, x_ss and x_sss of each column */
};

/** interp_nurbs_way() - how the curve goes at @u. */
void interp_nurbs_way(struct interp_nurbs_eval *e, double u,
		      struct interp_nurbs_way *ret);

/** interp_nurbs_feed_mm_s() - the fastest at that point of @c; 0 at a cusp. */
double interp_nurbs_feed_mm_s(const struct interp_nurbs *c,
			      const struct interp_nurbs_way *w,
			      const struct interp_nurbs_limits *l);

#endif /* INTERP_NURBS_FEED_H */
