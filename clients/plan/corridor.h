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
	double reach_mm[INTERP_NAXES];	/* a unit of the axis moves no point
					 * farther */
	const double (*guess)[INTERP_NAXES];	/* begins and ends free */
	uint32_t nguess;
	double wide_mm;			/* how far round the guess */
	uint32_t tries;			/* poses drawn, at most */
	bool (*keeps)(void *arg, const double from[INTERP_NAXES],
		      const double to[INTERP_NAXES]);	/* a block; or a pose,
							 * with @to == @from */
	bool (*stop)(void *arg);	/* asked often */
	void *arg;
};

/**
 * corridor_find() - from guess[0] to guess[nguess - 1].
 *
 * Every block of @ret was answered with true by keeps().  What is drawn is the
 * same in every run of the program.
 * Return: how many nodes, the ends among them; 0: none was found, or not in
 * @max nodes; -ENOMEM.
 */
int corridor_find(const struct corridor *c, double (*ret)[INTERP_NAXES],
		  uint32_t max);

#ifdef __cplusplus
}
#endif

#endif /* PLAN_CORRIDOR_H */
