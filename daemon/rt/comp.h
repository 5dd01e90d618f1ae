/* SPDX-License-Identifier: Apache-2.0 */
/*
 * comp.h - from a place on the path to pulses of the drives
 *
 *	pulses = place + shift + compensation(place, direction)
 *
 * shift is what homing found (home.h).  The compensation is, per axis, a pitch
 * map (a function of the place alone, linear between its points, level beyond
 * them) and a backlash (all of it after a move toward -, none after one toward
 * +).  There and back the pulses are therefore the same ones.
 *
 * A change is taken up a few pulses a period, while the path goes on or stands;
 * never more than the machine can put out in one, the path's own included.
 *
 * Units: pulses.  Sign: + as the axis.
 * Threads: RT-safe; a binary search of at most COMP_POINTS.
 */
#ifndef RT_COMP_H
#define RT_COMP_H

#include "interp/axis.h"

#include <stdbool.h>
#include <stdint.h>

#define COMP_POINTS	128		/* of an axis's map */

struct comp_config {
	int32_t backlash;		/* >= 0 */
	double take_up;			/* pulses a period, > 0 where used */
	uint32_t n;			/* points of the map; 0: none */
	int32_t at[COMP_POINTS];	/* places, rising */
	double add[COMP_POINTS];	/* what to add there */
};

struct comp_axis {
	int32_t place;			/* of the last period */
	int32_t shift, added;
	int8_t toward;			/* of the last move; 0: none yet */
	double room;			/* pulses that may be taken up */
};

struct comp {
	bool begun;
	struct comp_axis axis[INTERP_NAXES];
};

/** comp_wanted() - the whole compensation at @place. */
int32_t comp_wanted(const struct comp_config *k, int32_t place, int toward);

/**
 * comp_apply() - one period.
 *
 * @frozen: nothing is taken up.
 * @edges: most pulses an axis may make in a period; 0: any.
 * @ret: pulses of the drives.
 */
void comp_apply(struct comp *c, const struct comp_config k[INTERP_NAXES],
		const int32_t place[INTERP_NAXES], bool frozen, uint32_t edges,
		int32_t ret[INTERP_NAXES]);

/**
 * comp_settle() - call the place where the drive is at @pulses @place.
 *
 * Whole: nothing is left to be taken up there.  The axis stands.
 */
void comp_settle(struct comp_axis *a, const struct comp_config *k,
		 int32_t place, int32_t pulses);

/** comp_pulses() - where the drive was sent last. */
static inline int32_t comp_pulses(const struct comp_axis *a)
{
	return a->place + a->shift + a->added;
}

#endif /* RT_COMP_H */
