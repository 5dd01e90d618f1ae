/* SPDX-License-Identifier: Apache-2.0 */
/*
 * apart.h - is a pair of triangles far enough apart, and for how long?
 *
 * For most pairs the answer needs no distance: any direction in which there is
 * a gap between them is enough.
 *
 * Units: mm; time is the block's parameter.  Any thread.
 */
#ifndef PLAN_APART_H
#define PLAN_APART_H

#include "tree.h"

#include <stdbool.h>

struct pose_rate;

/* What is asked: without a rate, a distance of least_mm; with one, that
 * keep_mm is kept for a time. */
struct apart {
	const struct pose_rate *rate;	/* NULL: only the distance is asked */
	double least_mm;		/* with a rate: a pair nearer than that
					 * is refused; more than keep_mm */
	double keep_mm, time;
	double rises;			/* by so much keep_mm grows in a unit of
					 * time */
};

/** apart_seen() - is a gap found that is enough?  @plane: of @part, as a tree
 *  has them; @tool is in the part's frame. */
bool apart_seen(const struct apart *a, const struct triangle *part,
		const double plane[4], const struct triangle *tool);

/** apart_time() - until @tool, at the distance @mm from the point @q on it to
 *  @p on the part, may be nearer than keep_mm. */
double apart_time(const struct apart *a, const struct triangle *tool, double mm,
		  const double p[3], const double q[3]);

#endif /* PLAN_APART_H */
