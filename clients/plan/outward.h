/* SPDX-License-Identifier: Apache-2.0 */
/*
 * outward.h - which way out of a cavity the air leads an electrode
 *
 * The air tells for each of some points of the electrode how far it is to the
 * open, and in which direction (air.h).
 *
 * Units: mm; q is mm or, of a rotary, degrees.  Threads: one.
 */
#ifndef PLAN_OUTWARD_H
#define PLAN_OUTWARD_H

#include "air.h"
#include "job.h"

struct outward {
	const struct job *j;		/* lent */
	struct air air;
};

/** outward_init() - the open is where the stem is at the axes @end; a channel
 *  may have two ends. Return: 0 or -ENOMEM. */
int outward_init(struct outward *o, const struct job *j,
		 const double end[INTERP_NAXES]);
void outward_free(struct outward *o);

/**
 * outward_at() - how each axis leads the points outward at @q.
 *
 * @ret: by axis, mm outward for a unit of it.  Return: how far it is to the
 * open, the mean of the points; 0: all of them are in the open.
 */
double outward_at(const struct outward *o, const double q[INTERP_NAXES],
		  double ret[INTERP_NAXES]);

/** outward_is_out() - is the electrode beside the box round the part at @q, on
 *  one of its sides? */
bool outward_is_out(const struct job *j, const double q[INTERP_NAXES]);

#endif /* PLAN_OUTWARD_H */
