/* SPDX-License-Identifier: Apache-2.0 */
/*
 * corridor.h - a way through a narrow place, by sampling round a guess
 *
 * OMPL grows two trees of proved blocks toward each other (RRT-Connect).  Poses
 * are drawn round the guess only: in a channel hardly any other pose is free.
 *
 * Units: mm and degrees; machine coordinates.  Threads: one.
 */
#ifndef PLAN_CORRIDOR_H
#define PLAN_CORRIDOR_H

#include "interp/axis.h"

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct corridor {
	uint32_t naxes;
	enum interp_axis axis[INTERP_NAXES];	/* those that may move */
	double low[INTERP_NAXES], high[INTERP_NAXES];	/* travel, by axis */
	double reach_mm[INTERP_NAXES];	/* the most that a unit of the axis
					 * moves any point */
	const double (*guess)[INTERP_NAXES];	/* its first and its last pose
						 * are free */
	uint32_t nguess;
	double wide_mm;			/* how far from the guess poses are
					 * drawn */
	uint32_t tries;			/* poses that are drawn, at most */
	/* Does the block keep its clearance?  With @to == @from: does the
	 * pose? */
	bool (*keeps)(void *arg, const double from[INTERP_NAXES],
		      const double to[INTERP_NAXES]);
	bool (*stop)(void *arg);	/* true ends the search; asked often */
	void *arg;
};

/**
 * corridor_find() - find a way from guess[0] to guess[nguess - 1].
 *
 * keeps() was true for every block of @ret.  The same poses are drawn in every
 * run of the program. Return: the number of nodes, with both ends; 0: no way
 * with at most @max nodes was found; -ENOMEM.
 */
int corridor_find(const struct corridor *c, double (*ret)[INTERP_NAXES],
		  uint32_t max);

#ifdef __cplusplus
}
#endif

#endif /* PLAN_CORRIDOR_H */
