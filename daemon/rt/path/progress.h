/* SPDX-License-Identifier: Apache-2.0 */
/*
 * progress.h - does a motion that is under way go on?
 *
 * The cycle may be told to move, plan, and yet come to no further lattice
 * point: a path or a plan with a defect.  Nothing would ever end that, so it is
 * the fault `stuck`, after a second, or after the time of some lattice points
 * where the speed asked for is that low.
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

/* Where it was when it last came to another lattice point. */
struct progress {
	uint32_t index;			/* segment */
	int64_t tick, out_tick;		/* on it; on the way out beside it */
	double place_mm;		/* a cycle ago */
	uint64_t still;			/* cycles without a point and a name */
};

/** progress_watch() - once a period, after the walk of a job. */
void progress_watch(struct cycle *c);

#endif /* RT_PROGRESS_H */
