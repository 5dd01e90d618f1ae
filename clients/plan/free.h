/* SPDX-License-Identifier: Apache-2.0 */
/*
 * free.h - move the inner nodes of a way off the path, for more clearance
 *
 * Linear programs move all axes of the inner nodes at once, along the gradients
 * of many small distances.  A step is so short that the distances are nearly
 * linear in it.  The result has been tried at some poses only, so it still has
 * to be proved.
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
	uint32_t n;			/* nodes; the last one stays */
	bool mouth;			/* the first one may move, too */
	double q[FREE_NODES_MAX][INTERP_NAXES];
	double least_mm;		/* the least distance at the poses that
					 * were tried; in an end zone, plus as
					 * much as the clearance falls there */
	double enough_mm;		/* the search ends at this clearance */
	double end_mm[2];		/* the distance at the first node and at
					 * the last one */
	uint64_t queries, programs;	/* programs: linear programs solved */
};

/** free_init() - enough_mm is infinite at first. Return: 0; -E2BIG: too many
 *  nodes. */
int free_init(struct free_way *w, const struct job *j,
	      const struct clearance *c, double (*q)[INTERP_NAXES],
	      uint32_t n);

/** free_widen() - find as much clearance as possible in at most @rounds. */
void free_widen(struct free_way *w, int rounds);

/**
 * free_straighten() - take the inner node @node away, if the bend there can be
 * straightened while the way keeps about @keep_mm.
 *
 * All nodes may move for it.  The way that is left has one node less and has to
 * be widened and proved.  Return: is it away?  If not, the way is as it was.
 */
bool free_straighten(struct free_way *w, uint32_t node, double keep_mm,
		     int rounds);

/** free_round() - round @q to whole pulses. */
void free_round(const struct machine_config *c, double q[INTERP_NAXES]);

#endif /* PLAN_FREE_H */
