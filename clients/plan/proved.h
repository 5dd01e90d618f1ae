/* SPDX-License-Identifier: Apache-2.0 */
/*
 * proved.h - blocks that were proved, and how much they keep
 *
 * The search for a way, the fewest blocks over it and the text that is read
 * back ask for the same blocks.  Of a tight screw each proof takes seconds.
 *
 * Units: mm and degrees.  Threads: any, at once.
 */
#ifndef PLAN_PROVED_H
#define PLAN_PROVED_H

#include "motion.h"

#include <pthread.h>

#define PROVED_MAX	512

/* Of one pair of bodies. */
struct proved {
	pthread_mutex_t lock;
	uint32_t n;			/* so many were put in */
	struct proved_block {
		double from[INTERP_NAXES], to[INTERP_NAXES];
		double mm;
	} block[PROVED_MAX];
};

void proved_init(struct proved *p);

/** proved_put() - @b keeps @mm everywhere.  @p may be NULL. */
void proved_put(struct proved *p, const struct block *b, double mm);

/** proved_keeps() - is it known that @b keeps @mm?  @p may be NULL: no. */
bool proved_keeps(struct proved *p, const struct block *b, double mm);

#endif /* PLAN_PROVED_H */
