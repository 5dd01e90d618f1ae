/* SPDX-License-Identifier: Apache-2.0 */
/*
 * near_set.h - some pairs of triangles that stand for all that are near
 *
 * Of all pairs in one cell of space only the nearest one is taken, to
 * NEAR_SET_SLACK_MM.  A search that knew the one nearest pair alone would
 * stall: what it moves away from one wall comes too near to the other.
 *
 * Units: mm.
 */
#ifndef PLAN_NEAR_SET_H
#define PLAN_NEAR_SET_H

#include "near.h"

#define NEAR_SET_MAX	128
#define NEAR_SET_SLACK_MM	0.005

struct near_set {
	uint32_t max;			/* the caller's, up to NEAR_SET_MAX */
	uint32_t n;
	struct near_pair pair[NEAR_SET_MAX];
};

/** near_set_collect() - collect the pairs that are nearer than @mm at @pose.
 *  Some are missing if there is no memory, so a way that is made from them
 *  must be proved. */
void near_set_collect(const struct bodies *b, const struct pose *pose,
		      double mm, struct near_set *ret);

#endif /* PLAN_NEAR_SET_H */
