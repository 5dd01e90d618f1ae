/* SPDX-License-Identifier: Apache-2.0 */
/*
 * along.h - how fast axes can follow a path, one formula for every move
 *
 * A place of a path has three derivatives of each column by the mm of path,
 * r', r'' and r'''.  With the speed v, the acceleration a and the jerk j along
 * the path a column asks its axis for
 *
 *	r' v,    r' a + r'' v^2    and    r' j + 3 r'' v a + r''' v^3
 *
 * each with its sign.  So at a place and a speed there is a least and a most
 * acceleration, and with that a least and a most jerk.  All of it is the same
 * on the way back: there r' and r''' have the other sign.
 *
 * A way is three numbers a column: r', r'', r''', one column behind the other.
 *
 * Units: in every name.
 * Threads: RT-safe.
 */
#ifndef SPEED_ALONG_H
#define SPEED_ALONG_H

#include "interp/axis.h"

#define INTERP_AXES_WAY		3	/* numbers a column */

/* What the axis of each column can do. */
struct interp_axes {
	uint32_t n;
	double v_mm_s[INTERP_NAXES];
	double a_mm_s2[INTERP_NAXES];
	double j_mm_s3[INTERP_NAXES];
	/* Written by interp_axes_round(): */
	double corner_mm;
	double step_mm_s[INTERP_NAXES];	/* the greatest step of its speed */
	double step_mm_s2[INTERP_NAXES];	/* of its acceleration */
};

/* Along a path that does not bend. */
struct interp_straight {
	double a_mm_s2, j_mm_s3;
};

struct interp_straight interp_axes_straight(const struct interp_axes *x,
					    const double *way);

/**
 * interp_axes_overlook() - take no notice of a bend of a curve whose radius is
 * less than a pulse.
 *
 * @way: of a column that makes the length.  One beside it goes on there.
 */
void interp_axes_overlook(double *way, double pulse_mm);

/**
 * interp_axes_mm_s() - the greatest speed at a place, at which the axes leave
 * @kept for going along.
 *
 * @kept: less than what they can do along a path that does not bend.
 * @ret_left: what they leave at that speed, or slower, to either side.  It is
 *	      no less than @kept.
 */
double interp_axes_mm_s(const struct interp_axes *x, const double *way,
			const struct interp_straight *kept,
			struct interp_straight *ret_left);

/** interp_axes_round() - each axis may be off by @corner_mm, in its unit. */
void interp_axes_round(struct interp_axes *x, double corner_mm);

/**
 * interp_axes_corner_mm_s() - the greatest speed over a node at which the path
 * turns from the way @before to the way @behind.
 *
 * Each axis changes its speed and its acceleration so fast that it is off by no
 * more than it may be.  @along, a bit for each column that makes the length,
 * turn as an arc that is so far from the node.
 */
double interp_axes_corner_mm_s(const struct interp_axes *x,
			       const double *before, const double *behind,
			       uint32_t along);

#endif /* SPEED_ALONG_H */
