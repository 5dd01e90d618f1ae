/* SPDX-License-Identifier: Apache-2.0 */
/*
 * foot.h - contour error: how far a place is from the path, exactly
 *
 * The foot is the point of the path where a line to the actual place is square
 * to the path.  It is followed from its last place, and it never goes back
 * against the direction of travel.  At a sharp tip two branches of the path
 * come close to each other.  The nearest point of all may then lie on the
 * branch that was left already, and a controller that pulls toward it would
 * never get round the tip.  The foot jumps forward in one case only: the axes
 * cut the tip off, and a point that the set values have passed is nearer.
 *
 * A path is anything that can say where it is and in which direction it goes at
 * a parameter u: a spline, an arc, a table of points.  Inside the path per_u
 * must not be 0 in all axes.  The speed along u may vary.
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
	double back_mm;			/* so far the foot may go back */
	double u, far_u, set_u;
	int way;			/* of travel, +1 or -1 */
};

struct interp_contour_error {
	double u;			/* the foot */
	double mm;			/* its distance, 0 and more */
	double vector_mm[INTERP_NAXES];	/* from the actual place to the foot */
};

/**
 * interp_contour_begin() - begin with the foot at @u.
 *
 * @look_mm: how far to look along the path at a time.  About the radius of the
 * sharpest tip is right, for example 0.02.
 */
void interp_contour_begin(struct interp_contour *c,
			  const struct interp_contour_path *path, double u,
			  double look_mm);

/**
 * interp_contour_step() - find the foot of @actual_mm, from the last foot on.
 *
 * @set_u: where on the path the set values are.  If it grows, the travel is
 * forward; if it falls, backward.  In one step the foot moves at most
 * INTERP_CONTOUR_LOOKS looks.  If the place is farther away, the foot comes to
 * it in the next steps.
 */
void interp_contour_step(struct interp_contour *c, const double *actual_mm,
			 double set_u, struct interp_contour_error *ret);

#endif /* INTERP_FOOT_H */
