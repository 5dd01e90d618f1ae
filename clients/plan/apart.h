/* SPDX-License-Identifier: Apache-2.0 */
/*
 * apart.h - is a pair of triangles far enough apart, and for how long?
 *
 * Of most pairs this is seen without their distance: any direction in which
 * there is a gap between them will do.
 *
 * Units: mm; time is the block's parameter.  Any thread.
 */
#ifndef PLAN_APART_H
#define PLAN_APART_H

#include "tree.h"

#include <stdbool.h>

struct pose_rate;

/* What is enough: a distance of least_mm; or, with a rate, that keep_mm is kept
 * for a time. */
struct apart {
	const struct pose_rate *rate;	/* NULL: distances are asked for */
	double least_mm;		/* with a rate: nearer than that now is
					 * not enough for any time; > keep_mm */
	double keep_mm, rises, time;	/* rises: what is to be kept, by a unit of
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
