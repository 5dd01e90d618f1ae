/* SPDX-License-Identifier: Apache-2.0 */
/*
 * free.h - inner nodes off the path, for more clearance
 *
 * All axes of the inner nodes are moved at once, by linear programs on the
 * gradients of many small distances, each step no longer than distances can be
 * trusted to be linear.  What comes out is tried at poses only: prove it.
 *
 * Units: mm and degrees.  Threads: one.
 */
#ifndef PLAN_FREE_H
#define PLAN_FREE_H

#include "job.h"

#define FREE_NODES_MAX	32

struct free_way {
	const struct job *j;
	const struct clearance *c;	/* lent: where it falls less is wanted */
	uint32_t n;			/* nodes; first and last stay */
	double q[FREE_NODES_MAX][INTERP_NAXES];
	double least_mm;		/* at the poses tried; in an end zone,
					 * and what the clearance falls there */
	double enough_mm;		/* more is not looked for */
	uint64_t queries, programs;	/* programs: linear ones */
};

/** free_init() - with no end to what is enough. Return: 0, or -E2BIG with too
 *  many nodes. */
int free_init(struct free_way *w, const struct job *j,
	      const struct clearance *c, double (*q)[INTERP_NAXES],
	      uint32_t n);

/** free_widen() - as much clearance as goes, in at most @rounds. */
void free_widen(struct free_way *w, int rounds);

/** free_round() - to whole pulses. */
void free_round(const struct machine_config *c, double q[INTERP_NAXES]);

#endif /* PLAN_FREE_H */
