/* SPDX-License-Identifier: Apache-2.0 */
/*
 * limit.h - hard limit switches
 *
 * A switch that comes on while anything moves ends the motion at once and
 * latches the fault `limit-switch`.  An axis that stands on its switch may only
 * move away from it, back where it came from.  If a switch was on from the
 * start, nobody knows which direction that is; then a jog may go both ways,
 * slowly.  A switch bounces: one that comes on again beside where it went off
 * lies where it lay.
 *
 * Inputs of drives tell at which end they are.  Then only the motion toward
 * that end is barred.  One that comes on where its axis goes the other way is
 * at the wrong end, and bars both.
 *
 * Threads: RT-safe.
 */
#ifndef RT_LIMIT_H
#define RT_LIMIT_H

#include "interp/axis.h"

#include <stdbool.h>
#include <stdint.h>

struct limit {
	uint32_t on;			/* bit per axis */
	uint32_t low, high;		/* ... and it is told at which end */
	uint32_t wrong;			/* ... but its axis went the other
					 * way */
	int8_t side[INTERP_NAXES];	/* direction from the axis to its
					 * switch, +1 or -1; 0: not known */
	uint32_t met;			/* bit per axis; it was on: */
	int32_t at[INTERP_NAXES];	/* here last, pulses of the drive */
};

struct cycle;
struct io_inputs;

/** limit_guard() - look at the switches before anything moves. */
void limit_guard(struct cycle *c, const struct io_inputs *in);

/** limit_watch() - after the motion: did an axis go farther onto its switch? */
void limit_watch(struct cycle *c);

/** limit_recount() - the drive of @axis, which stands, counts its pulses from
 *  another place now: each is @more. */
void limit_recount(struct limit *l, uint32_t axis, uint32_t more);

/** limit_bars() - may @axis not move @toward +1 or -1? */
bool limit_bars(const struct limit *l, uint32_t axis, int toward);

#endif /* RT_LIMIT_H */
