/* SPDX-License-Identifier: Apache-2.0 */
/*
 * retract.h - how far, how long and how often it goes back along the path
 *
 * Each bound has a fault of its own: the distance `short-not-cleared`, the end
 * of the way back `retract-at-start`, the time `retract-time`, and too many
 * retracts with less than progress_mm of depth between them `retract-count`.
 *
 * Threads: RT-safe.
 */
#ifndef RT_RETRACT_H
#define RT_RETRACT_H

#include "settings.h"

#include <stdbool.h>
#include <stdint.h>

struct retract {
	double from_mm;			/* place it began */
	double floor_mm;		/* never farther back */
	double least_mm;		/* at least so far, out of an arc */
	uint64_t waited;		/* cycles stood at the limit */
	uint64_t cycles;		/* of it, in all */
	uint32_t in_row;		/* retracts without erosion between */
	double row_mm;			/* place the first of them began */
	bool leaves;			/* by the escape, once it stands */
};

struct cycle;

/** retract_begin() - where the state is entered. */
void retract_begin(struct cycle *c);

/**
 * retract_leave() - by the escape, if it stands now; false: it has to brake.
 */
bool retract_leave(struct cycle *c);

/** retract_is_clear() - the gap is wide again, and it went far enough. */
bool retract_is_clear(const struct cycle *c);

/** retract_watch() - after the walk: latch the fault of a bound that is met. */
void retract_watch(struct cycle *c);

/** retract_limit_mm() - distance a retract may go, by the process. */
double retract_limit_mm(const struct cycle *c);

/** retract_motion_mm() - place where the motion it is in begins. */
double retract_motion_mm(const struct cycle *c);

#endif /* RT_RETRACT_H */
