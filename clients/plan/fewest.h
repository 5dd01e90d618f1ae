/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fewest.h - the fewest blocks over given nodes
 *
 * Nodes are poses of a way in, in its order.  A block may lead from any node to
 * any later one, if it can be proved.  A block is proved when it is first
 * needed, and the answer is kept.  Proofs run on all processors.
 *
 * Units: mm and degrees.  Threads: one caller.
 */
#ifndef PLAN_FEWEST_H
#define PLAN_FEWEST_H

#include "job.h"

#include <pthread.h>

#define FEWEST_NODES_MAX	240

struct fewest {
	const struct job *j;
	const struct clearance *c;	/* lent; each call has its own mm */
	uint32_t n;
	double (*q)[INTERP_NAXES];	/* own */
	double lattice[INTERP_NAXES];
	double *proved, *refuted;	/* of block i * n + k: a clearance that
					 * it keeps, and one that it does not */
	const char *what;		/* what is being done, for the bar */
	double share;			/* how much of it is done */
	pthread_mutex_t lock;		/* guards what follows */
	uint64_t queries, blocks;	/* how many were tried */
	struct near_pair nearest;	/* of the last refusal */
};

/** fewest_init() - Return: 0 or -ENOMEM. @q is copied. */
int fewest_init(struct fewest *f, const struct job *j,
		double (*q)[INTERP_NAXES], uint32_t n);
void fewest_free(struct fewest *f);

/**
 * fewest_greedy() - from each node take the longest block that is proved.
 *
 * @ret: room for f->n numbers of nodes, the first and the last among them.
 * Return: how many blocks; 0: there is no way; UINT32_MAX: interrupted.
 */
uint32_t fewest_greedy(struct fewest *f, double mm, uint32_t *ret);

/** fewest_search() - the same with as few blocks as possible, at most @most;
 *  0 if there is no such way. */
uint32_t fewest_search(struct fewest *f, double mm, uint32_t most,
		       uint32_t *ret);

/** fewest_widest() - the largest clearance at which @blocks suffice, to 5 um,
 *  and the nodes of that way.  @mm: a clearance at which they are known to. */
double fewest_widest(struct fewest *f, double mm, uint32_t blocks,
		     uint32_t *ret);

#endif /* PLAN_FEWEST_H */
