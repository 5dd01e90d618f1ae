/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sweep.h - a block followed from its start to its end, pair of boxes by pair
 *
 * Each pair of boxes is looked at again only when it may be too near.  For a
 * wall that is far, or that the electrode moves along, that is once or twice
 * in a block; for the narrowest place it is often.
 *
 * Units: mm; time is the block's parameter, 0 at its start and 1 at its end.
 * Threads: any, each with its own.
 */
#ifndef PLAN_SWEEP_H
#define PLAN_SWEEP_H

#include "motion.h"

#include <stdbool.h>

/* What is to be kept from a moment on. */
struct sweep_keep {
	double most_mm;			/* anywhere on the block */
	double mm;			/* at this moment */
	double rises;			/* in a unit of time it grows by no more
					 * than that */
};

struct sweep {
	const struct bodies *bodies;
	const struct block *block;
	double eps_mm;			/* a pair nearer than what is to be kept
					 * plus this is too near */
	/* What is to be kept at a pose of the block. */
	void (*keep)(void *arg, const struct pose *pose,
		     struct sweep_keep *ret);
	/* Too near at @t.  True: keep() asks for less now, go on.  NULL: always
	 * false. */
	bool (*lower)(void *arg, double t, const struct near_pair *pair);
	void *arg;
	uint64_t poses;			/* looked at; added to */
	/* Of a block that does not keep what is asked: */
	double t;			/* the first time */
	struct near_pair pair;
};

/**
 * sweep_block() - follow the block from its first pose to its last.
 *
 * Return: 1 all of it keeps what is asked; 0 it does not; -ENOMEM, -ELOOP it is
 * given up.
 */
int sweep_block(struct sweep *s);

#endif /* PLAN_SWEEP_H */
