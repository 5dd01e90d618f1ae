/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sweep.h - follow a block from its start to its end, pair by pair of boxes
 *
 * A pair of boxes is looked at again only when it may have become too near.
 * For a wall that is far away, or that the electrode moves along, this is once
 * or twice in a block; for the narrowest place it is often.
 *
 * Units: mm; time is the block's parameter, 0 at its start and 1 at its end.
 * Threads: any, each with its own.
 */
#ifndef PLAN_SWEEP_H
#define PLAN_SWEEP_H

#include "motion.h"

#include <stdbool.h>

/* The distance to be kept from a moment on. */
struct sweep_keep {
	double most_mm;			/* anywhere on the block */
	double mm;			/* at this moment */
	double rises;			/* the most that it grows by in a unit
					 * of time */
};

struct sweep {
	const struct bodies *bodies;
	const struct block *block;
	double eps_mm;			/* a pair is too near if it is nearer
					 * than the distance to be kept plus
					 * this */
	/* The distance to be kept at a pose of the block. */
	void (*keep)(void *arg, const struct pose *pose,
		     struct sweep_keep *ret);
	/* A pair is too near at @t.  Return: true: go on, because keep() asks
	 * for less now.  NULL: always false. */
	bool (*lower)(void *arg, double t, const struct near_pair *pair);
	void *arg;
	uint64_t poses;			/* the number of poses that were looked
					 * at is added to this */
	/* Of a block that does not keep what is asked: */
	double t;			/* the first time */
	struct near_pair pair;
};

/**
 * sweep_block() - follow the block from its first pose to its last.
 *
 * Return: 1: all of it keeps the distance; 0: it does not; -ENOMEM; -ELOOP: it
 * took too many steps.
 */
int sweep_block(struct sweep *s);

#endif /* PLAN_SWEEP_H */
