/* SPDX-License-Identifier: Apache-2.0 */
/*
 * apart.h - is a pair of triangles far enough apart, and for how long?
 *
 * For most pairs the distance need not be computed: it is enough to find one
 * direction in which they are far enough apart.
 *
 * Units: mm; time is the block's parameter.  Any thread.
 */
#ifndef PLAN_APART_H
#define PLAN_APART_H

#include "tree.h"

#include <stdbool.h>

struct pose_rate;

/* The question: without a rate, are they least_mm apart now?  With a rate, do
 * they stay keep_mm apart for a time? */
struct apart {
	const struct pose_rate *rate;	/* NULL: only the distance is asked */
	double least_mm;		/* with a rate: a pair nearer than that
					 * is refused; more than keep_mm */
	double keep_mm, time;
	double rises;			/* how much keep_mm grows in a unit of
					 * time */
};

/** apart_seen() - look for a direction in which they are far enough apart.
 *  @plane: the plane of @part, as struct tree keeps it; @tool is in the part's
 *  frame.  Return: false if none was found; they may still be far apart. */
bool apart_seen(const struct apart *a, const struct triangle *part,
		const double plane[4], const struct triangle *tool);

/** apart_time() - the time until which @tool stays at least keep_mm away.  Its
 *  distance is @mm now, from its point @q to the point @p on the part. */
double apart_time(const struct apart *a, const struct triangle *tool, double mm,
		  const double p[3], const double q[3]);

#endif /* PLAN_APART_H */
