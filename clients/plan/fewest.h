/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fewest.h - the fewest blocks over given nodes
 *
 * Nodes are poses of a way in, in its order.  A block may go from any of them
 * to any later one, if it can be proved.  Proofs are made when they are asked
 * for and kept.
 *
 * Proofs run on all processors.
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
	const struct clearance *c;	/* lent; each call gives its mm anew */
	uint32_t n;
	double (*q)[INTERP_NAXES];	/* own */
	double lattice[INTERP_NAXES];
	double *proved, *refuted;	/* of block i * n + k: that clearance is
					 * kept, that one is not */
	const char *what;		/* is being done; for the bar */
	double share;			/* of it */
	pthread_mutex_t lock;		/* of what follows */
	uint64_t queries, blocks;	/* tried */
	struct near_pair nearest;	/* of the last refusal */
};

/** fewest_init() - Return: 0 or -ENOMEM. @q is copied. */
int fewest_init(struct fewest *f, const struct job *j,
		double (*q)[INTERP_NAXES], uint32_t n);
void fewest_free(struct fewest *f);

/** fewest_keeps() - does the block from node @i to node @k keep @mm?  It may be
 *  asked of several blocks at once. */
bool fewest_keeps(struct fewest *f, uint32_t i, uint32_t k, double mm);

/**
 * fewest_greedy() - from each node as far as goes, from the far end.
 *
 * @ret: room for f->n numbers of nodes, the first and the last among them.
 * Return: how many blocks; 0: there is no way; UINT32_MAX: interrupted.
 */
uint32_t fewest_greedy(struct fewest *f, double mm, uint32_t *ret);

/** fewest_search() - the same with the fewest blocks there are, at most @most;
 *  0 if there is none. */
uint32_t fewest_search(struct fewest *f, double mm, uint32_t most,
		       uint32_t *ret);

/** fewest_widest() - the most clearance at which @blocks suffice, within 5 um,
 *  and its nodes.  @mm: that it is known for. */
double fewest_widest(struct fewest *f, double mm, uint32_t blocks,
		     uint32_t *ret);

#endif /* PLAN_FEWEST_H */
