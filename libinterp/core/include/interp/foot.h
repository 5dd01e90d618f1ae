/* SPDX-License-Identifier: Apache-2.0 */
/*
 * foot.h - contour error: how far a place is from the path, exactly
 *
 * The foot is the point of the path that the actual place stands square to.
 * It is followed from where it was, and never goes back against the direction
 * of travel: where two branches of a path come close, at an acute tip, the
 * nearest point of all may lie on the branch already left, and a controller
 * that pulls toward it never gets round.  It leaps forward only to a nearer
 * point that the set values have come past, when the tip is cut off.
 *
 * The path is whatever can say where it is and where it goes at a parameter u:
 * a spline, an arc, a table of points.  per_u must not be all 0 inside the
 * path; the speed along u may vary.
 *
 * Units: mm; u is the path's own.  Sign: the error vector points from the
 * actual place to the path.
 * Threads: one object, one thread; RT-safe as far as the path's at() is.  At
 * most 3 LOOKS + 2 TRIES points of the path are looked at in a step.
 */
#ifndef INTERP_FOOT_H
#define INTERP_FOOT_H

#include "interp/axis.h"

#define INTERP_CONTOUR_LOOKS	24
#define INTERP_CONTOUR_TRIES	24

struct interp_contour_point {
	double mm[INTERP_NAXES];
	double per_u[INTERP_NAXES];	/* first derivative */
};

struct interp_contour_path {
	const void *arg;
	void (*at)(const void *arg, double u, struct interp_contour_point *ret);
	double u_min, u_max;
	int naxes;			/* 1 ... INTERP_NAXES */
};

/* Placed by the caller; fields are private. */
struct interp_contour {
	const struct interp_contour_path *path;
	double look_mm;			/* longest look along the path */
	double back_mm;			/* the foot may give way so far */
	double u, far_u, set_u;
	int way;			/* of travel, +1 or -1 */
};

struct interp_contour_error {
	double u;			/* the foot */
	double mm;			/* its distance, 0 and more */
	double vector_mm[INTERP_NAXES];	/* from the actual place to the foot */
};

/**
 * interp_contour_begin() - the foot is at @u.
 *
 * @look_mm: the longest look along the path, about the radius of the sharpest
 * tip; 0.02.
 */
void interp_contour_begin(struct interp_contour *c,
			  const struct interp_contour_path *path, double u,
			  double look_mm);

/**
 * interp_contour_step() - the foot of @actual_mm, from the last one on.
 *
 * @set_u: where on the path the set values are; whether it grows or falls is
 * the direction of travel.  The foot covers at most INTERP_CONTOUR_LOOKS looks
 * in a step; a place farther on is caught up with in the next.
 */
void interp_contour_step(struct interp_contour *c, const double *actual_mm,
			 double set_u, struct interp_contour_error *ret);

#endif /* INTERP_FOOT_H */
