/* SPDX-License-Identifier: Apache-2.0 */
/*
 * axis_state.h - where the axes stand, and how that is known
 *
 * It holds what a cycle needs to go on where another one was killed: places,
 * the pulses that the drives were sent to for them, the direction of each
 * axis's last move, and what homing found.  Without it the next cycle would add
 * pitch error and backlash a second time.
 *
 * Units: pulses.  Threads: axis_state_get() is RT-safe, axis_state_set()
 * startup only.
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
	int32_t off[INTERP_NAXES];	/* where they stand, less that */
	int32_t shift[INTERP_NAXES];	/* what homing found; comp.h */
	int8_t toward[INTERP_NAXES];	/* of the last move; 0: none */
	uint32_t homed, unplaced;	/* bit per axis */
	struct limit limit;		/* the switches that they are on */
	double told_c;			/* temperature of the axes, as the PLC
					 * said it; 0: it did not */
};

/** axis_state_get() - after a period. */
void axis_state_get(const struct cycle *c, struct axis_state *ret);

/**
 * axis_state_set() - put the axes of a new, idle cycle there.
 *
 * From then on a program that begins at another place is refused, as after a
 * jog.  Even if the machine file has changed, no axis moves for its
 * compensation until a command moves an axis; comp_left() says how much is
 * still to be added.
 */
void axis_state_set(struct cycle *c, const struct axis_state *s);

#endif /* RT_AXIS_STATE_H */
