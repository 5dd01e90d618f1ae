/* SPDX-License-Identifier: Apache-2.0 */
/*
 * near_set.h - some pairs of triangles that stand for all that are near
 *
 * These are the pairs within a band over the least distance; of those in one
 * cell of space only the nearest.  With the nearest pair alone a search would
 * stall: what it moves away from one wall comes too near to the other.
 *
 * Units: mm.
 */
#ifndef PLAN_NEAR_SET_H
#define PLAN_NEAR_SET_H

#include "near.h"

#define NEAR_SET_MAX	128

struct near_set {
	uint32_t max;			/* the caller's, up to NEAR_SET_MAX */
	uint32_t n;
	struct near_pair pair[NEAR_SET_MAX];
};

/** near_set_collect() - all within @band_mm over @least_mm at @pose. */
void near_set_collect(const struct bodies *b, const struct pose *pose,
		      double least_mm, double band_mm, struct near_set *ret);

#endif /* PLAN_NEAR_SET_H */
