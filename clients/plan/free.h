/* SPDX-License-Identifier: Apache-2.0 */
/*
 * free.h - inner nodes off the path, for more clearance
 *
 * Linear programs on the gradients of many small distances move all axes of the
 * inner nodes at once.  A step is only as long as distances are about linear.
 * The result has been tried at poses only, so it still has to be proved.
 *
 * Units: mm and degrees.  Threads: one.
 */
#ifndef PLAN_FREE_H
#define PLAN_FREE_H

#include "job.h"

#define FREE_NODES_MAX	32

struct free_way {
	const struct job *j;
	const struct clearance *c;	/* lent */
	uint32_t n;			/* nodes; first and last stay */
	double q[FREE_NODES_MAX][INTERP_NAXES];
	double least_mm;		/* the least distance at the poses that
					 * were tried; in an end zone, plus what
					 * the clearance falls there */
	double enough_mm;		/* more clearance is not looked for */
	double end_mm[2];		/* the distance at the first node, at
					 * the last */
	uint64_t queries, programs;	/* programs: linear ones */
};

/** free_init() - enough_mm is infinite at first. Return: 0, or -E2BIG with too
 *  many nodes. */
int free_init(struct free_way *w, const struct job *j,
	      const struct clearance *c, double (*q)[INTERP_NAXES],
	      uint32_t n);

/** free_widen() - find as much clearance as possible, in at most @rounds. */
void free_widen(struct free_way *w, int rounds);

/** free_round() - to whole pulses. */
void free_round(const struct machine_config *c, double q[INTERP_NAXES]);

#endif /* PLAN_FREE_H */
