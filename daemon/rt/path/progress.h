/* SPDX-License-Identifier: Apache-2.0 */
/*
 * progress.h - does a motion that is under way go on?
 *
 * The cycle may be told to move, plan, and yet come to no further lattice
 * point: a path or a plan with a defect.  Nothing would ever end that, so it is
 * the fault `stuck`, after a second, or after the time of some lattice points
 * where the speed asked for is that low.  A plan that is followed and still
 * moves the place within a pulse is no defect: axes of little jerk begin and
 * end that slowly.
 *
 * A wait that has a name is none: a hold, a dwell, an M code, drives that are
 * enabled, a machine that is busy, an override of 0, axes that come to rest
 * (contouring.h), and a gap that lets the servo stand.
 *
 * Threads: RT-safe.
 */
#ifndef RT_PROGRESS_H
#define RT_PROGRESS_H

#include <stdint.h>

struct cycle;

struct progress {
	uint64_t at;			/* stands for a lattice point */
	double place_mm;		/* when it was looked at last */
	uint64_t still;			/* cycles without a point and a name */
	double points_s;		/* that it was to go by then */
};

#define PROGRESS_EVERY	16		/* cycles from look to look */

/** progress_look() - after the walk of a job, every so many periods. */
void progress_look(struct cycle *c);

#endif /* RT_PROGRESS_H */
