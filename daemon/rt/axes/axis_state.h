/* SPDX-License-Identifier: Apache-2.0 */
/*
 * axis_state.h - where the axes stand, and what that rests on
 *
 * Enough for a cycle to go on where another was killed: places, the pulses the
 * drives were sent to for them, which way each axis came, what homing found.
 * Without it the next one would take pitch error and backlash up anew, on top
 * of what the drives have already.
 *
 * Units: pulses.  Threads: axis_state_get() is RT-safe, axis_state_set() startup only.
 */
#ifndef RT_AXIS_STATE_H
#define RT_AXIS_STATE_H

#include "interp/axis.h"
#include "axes/limit.h"

#include <stdint.h>

struct cycle;

struct axis_state {
	int32_t place[INTERP_NAXES];
	int32_t drive[INTERP_NAXES];	/* where the drives were sent */
	int32_t shift[INTERP_NAXES];	/* what homing found; comp.h */
	int8_t toward[INTERP_NAXES];	/* of the last move; 0: none */
	uint32_t homed, unplaced;	/* bit per axis */
	struct limit limit;		/* switches they are on, and their sides */
	double told_c;			/* temperature of the axes, as a PLC told
					 * it; 0: not told */
};

/** axis_state_get() - after a period. */
void axis_state_get(const struct cycle *c, struct axis_state *ret);

/**
 * axis_state_set() - a cycle that never ran stands there, idle.
 *
 * A program that begins elsewhere is refused from then on, as after a jog.
 * Nothing is taken up, whatever the machine file says now, until a command
 * moves an axis; comp_left() says how much that is.
 */
void axis_state_set(struct cycle *c, const struct axis_state *s);

#endif /* RT_AXIS_STATE_H */
