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

/* All > 0; HUGE_VAL is no limit. */
struct interp_nurbs_limits {
	double chord_error_mm, period_s;
	double centripetal_mm_s2;
	double v_mm_s[INTERP_NAXES];	/* by the curve's columns */
	double a_mm_s2[INTERP_NAXES];
	double j_mm_s3[INTERP_NAXES];
};

/** interp_nurbs_feed_mm_s() - the fastest at @u; 0 at a point where the curve
 *  does not go on (a cusp). */
double interp_nurbs_feed_mm_s(struct interp_nurbs_eval *e, double u,
			      const struct interp_nurbs_limits *l);

/**
 * interp_nurbs_curvature() - 1/mm, in the counted axes; HUGE_VAL at a cusp.
 *
 * @bends: gets x_ss of every axis, but at a cusp; may be NULL.
 */
double interp_nurbs_curvature(struct interp_nurbs_eval *e, double u,
			      double bends[INTERP_NAXES]);

#endif /* INTERP_NURBS_FEED_H */
