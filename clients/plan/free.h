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
