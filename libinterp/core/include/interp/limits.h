/* SPDX-License-Identifier: Apache-2.0 */
/*
 * limits.h - how fast a finished program may be run through, place by place
 *
 * Written beside the segments once, when the program is laid out; a look
 * ahead then follows only what is slower than what it saw before, so its work
 * does not grow with the number of segments.
 *
 * A node that turns by the angle phi is taken as the arc of radius R that
 * leaves the corner by corner_mm (junction deviation), no smaller than
 * corner_mm:
 *
 *	R = corner * cos(phi/2) / (1 - cos(phi/2))
 *	v <= sqrt(a*R), v <= cbrt(j*R*R)
 *
 * with a and j what the axes can do in the directions they have there.  A
 * programmed arc is limited in the same way by its own radius.  An axis that
 * does not count in the path's length (a rotary one beside X Y Z) steps its
 * speed at a node; by the same corner_mm, in its own unit,
 *
 *	step <= sqrt(8*a*corner), step <= cbrt(j*(6*corner)^2)
 *
 * Nodes on a line are slowed by nothing.  Lines shorter than 100 corner_mm have
 * besides the radius of the curve they follow, from the chords of 20 corner_mm
 * to both sides of a node, no smaller than corner_mm; an axis beside the path
 * has the acceleration and jerk that its share changes by over those chords.
 *
 * What a rounding of nodes by tolerance_mm, or a pulse, can do is no change:
 * turns and steps of lines shorter than 20 tolerances are those of chords as
 * long, and what could be a rounding is taken off.  What that takes off a curve
 * is looked for over chords up to 32 times as long.
 *
 * Ceilings are rounded down to levels at most 1/32 apart (the speeds of the
 * axes are levels too), so no more than a few hundred can follow each other,
 * each slower than the one before.
 *
 * Units: in every name.
 */
#ifndef INTERP_LIMITS_H
#define INTERP_LIMITS_H

#include "interp/program.h"

#define INTERP_CORNER_MM	0.005	/* where none is given */
#define INTERP_TOLERANCE_MM	0.001
#define INTERP_ROTARY_MM	57.3	/* there 0.001 mm is 0.001 degrees */

/*
 * On a bend, shares of what an axis can do: to follow it, and to go along it.
 * Square to each other, together they are no more than all of it.
 */
#define INTERP_BEND_ACROSS	0.8
#define INTERP_BEND_ALONG	0.6

struct interp_limits {
	const struct interp_machine *machine;
	double corner_mm;		/* > 0 */
	double tolerance_mm;		/* >= 0: what is less is a rounding */
	double rotary_radius_mm;	/* > 0: where it is a rotary axis's, too */
};

/**
 * interp_limits_write() - node_mm_s, feed_max_mm_s and slower_* of @segs.
 *
 * @segs are those of @p, to be written.  Any thread; of no use in the cycle.
 */
void interp_limits_write(const struct interp_limits *l,
			 const struct interp_program *p,
			 struct interp_seg *segs);

/**
 * interp_limits_into() - the fastest into segment @i > 0 of no action, going
 * forward: over the node before it and on it.  RT-safe.
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
