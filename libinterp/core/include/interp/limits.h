/* SPDX-License-Identifier: Apache-2.0 */
/*
 * limits.h - how fast each place of a finished program may be passed
 *
 * These speeds are written beside the segments once, when the program is laid
 * out.  With each one stands where the next slower one is.  Whoever looks ahead
 * follows these alone, so his work does not grow with the number of segments.
 *
 * A place of the path has three derivatives of each column by the mm of path,
 * r1, r2 and r3.  With the speed v, the acceleration a and the jerk j along the
 * path a column asks its axis for
 *
 *	r1 v,    r1 a + r2 v^2    and    r1 j + 3 r2 v a + r3 v^3
 *
 * That is so for lines, arcs, two contours and curves.  Lines shorter than 100
 * corner_mm stand for a curve: the smoothest one that keeps within a rounding
 * of their ends.  A move has the least acceleration and jerk of its way.  What
 * of its axes it keeps for them, and what is left for bends, is chosen so that
 * the move takes the least time.
 *
 * At a node each axis makes a step of its speed, and where a line becomes an
 * arc one of its acceleration.  They are so small that the axis is off by no
 * more than corner_mm, in its own unit:
 *
 *	step of v <= sqrt(8*a*corner), step of v <= cbrt(36*j*corner^2)
 *	step of a <= cbrt(24*j^2*corner)
 *
 * The axes that make the length turn at a node by the angle phi as an arc that
 * passes the corner at a distance of corner_mm.  R is not taken smaller than
 * corner_mm:
 *
 *	R = corner * cos(phi/2) / (1 - cos(phi/2))
 *	v <= sqrt(a*R), v <= cbrt(j*R*R)
 *
 * What a rounding by tolerance_mm, or by a pulse, can make of a turn does not
 * count.  A node on a straight line slows nothing down.
 *
 * No segment of many points is faster than the machine makes them.
 *
 * Speeds, accelerations and jerks one behind the other that are nearly alike
 * become the least of them.  So at most a few hundred can follow each other
 * with each less than the one before.
 *
 * Where the least of a whole way would take much longer, INTERP_SEG_STAND cuts
 * the way in two (compile/speed/stands.c).
 *
 * Units: in every name.
 */
#ifndef INTERP_LIMITS_H
#define INTERP_LIMITS_H

#include "interp/program.h"

#include <math.h>

#define INTERP_CORNER_MM	0.005	/* where none is given */
#define INTERP_TOLERANCE_MM	0.001
#define INTERP_ROTARY_MM	57.3	/* there 0.001 mm is 0.001 degrees */

struct interp_limits {
	const struct interp_machine *machine;
	double corner_mm;		/* > 0 */
	double tolerance_mm;		/* >= 0: what is less is a rounding */
	double rotary_radius_mm;	/* > 0: where it is a rotary axis's,
					 * too */
	double points_per_s;		/* lattice points; 0: no limit */
};

/**
 * interp_limits_write() - fill node_mm_s, feed_max_mm_s, a_mm_s2, j_mm_s3,
 * slower_*, softer_* and INTERP_SEG_STAND of @segs.
 *
 * @segs: the segments of @p; writable.
 * Return: 0, -ENOMEM.  Any thread, but not for the cycle.
 */
int interp_limits_write(const struct interp_limits *l,
			const struct interp_program *p,
			struct interp_seg *segs);

/**
 * interp_limits_into() - how fast segment @i may be entered, going forward:
 * over the node before it, and on it.  @i > 0 and is no action.  RT-safe.
 */
static inline double interp_limits_into(const struct interp_program *p,
					uint32_t i)
{
	const double node = (double)p->segs[i - 1].node_mm_s;
	const double on = (double)p->segs[i].feed_max_mm_s;

	return node < on ? node : on;
}

/** interp_limits_back_into() - the same, going back over its last node. */
static inline double interp_limits_back_into(const struct interp_program *p,
					     uint32_t i)
{
	const double node = (double)p->segs[i].node_mm_s;
	const double on = (double)p->segs[i].feed_max_mm_s;

	return node < on ? node : on;
}

#endif /* INTERP_LIMITS_H */
