/* SPDX-License-Identifier: Apache-2.0 */
/*
 * comp.h - from a place on the path to pulses of the drives
 *
 * 	pulses = place + shift + map(places) + backlash(direction)
 *
 * shift is what homing found (home.c). The map compensates geometric errors of
 * the machine (interp/errormap.h): pitch, straightness, squareness and thermal
 * growth.  It depends only on the places of all axes.  The backlash is zero
 * after a move toward +, and all of it, downward, after a move toward -. So the
 * pulses are the same ones there and back.
 *
 * When one of these changes, the change is added a few pulses in each period,
 * while the path goes on or stands.  The pulses of the path and of the change
 * together are never more than the machine can put out in one period.
 *
 * Units: pulses.  Sign: + as the axis.
 * Threads: RT-safe.  If a place changed, a call does the work of
 * interp_errormap_apply().
 */
#ifndef RT_COMP_H
#define RT_COMP_H

#include "interp/errormap.h"

#include <stdbool.h>
#include <stdint.h>

#define COMP_OVER_K_MAX	50.0

struct comp_config {
	struct {
		int32_t backlash;	/* >= 0 */
		double take_up;		/* most pulses in a period; > 0 if
					 * there is anything to add */
		double pulse_mm;	/* > 0 if there are maps */
	} axis[INTERP_NAXES];
	double maps_c;			/* the temperature at which the maps
					 * were measured */
	bool mapped;			/* the maps are not empty */
	struct interp_errormap maps;
};

struct comp_axis {
	int32_t place;			/* of the last period */
	int32_t shift, added;
	int32_t map;			/* at that place */
	int8_t toward;			/* of the last move; 0: none yet */
	double room;			/* pulses that may be added now */
};

struct comp {
	bool begun;
	bool stale;			/* the maps changed */
	bool resting;			/* nothing is added until a command
					 * moves an axis */
	double told_c;			/* temperature of the axes; 0: not
					 * known */
	struct comp_axis axis[INTERP_NAXES];
	/* Of the last period: */
	bool idle;			/* there was nothing to add */
	int32_t place[INTERP_NAXES], sent[INTERP_NAXES];
};

/* One period, as it comes from the cycle. */
struct comp_period {
	const int32_t *place;		/* of INTERP_NAXES axes */
	bool frozen;			/* nothing is added */
	uint32_t edges;			/* most pulses of an axis; 0: any
					 * number */
};

/** comp_map() - what the maps add at @place, each axis to the nearest pulse. */
void comp_map(const struct comp_config *k, const int32_t place[INTERP_NAXES],
	      int32_t ret[INTERP_NAXES]);

/** comp_apply() - one period; @ret gets the pulses of the drives. */
void comp_apply(struct comp *c, const struct comp_config *k,
		const struct comp_period *p, int32_t ret[INTERP_NAXES]);

/**
 * comp_settle() - say that the drive of @axis is at its @place when it is at
 * @pulses.
 *
 * The axis must stand.  Nothing is left to be added to it there.  Its new place
 * may change the errors of other axes; this is added as in any move.
 */
void comp_settle(struct comp *c, const struct comp_config *k, uint32_t axis,
		 const int32_t place[INTERP_NAXES], int32_t pulses);

/**
 * comp_warm() - say that all axes are at @told_c, in degC.
 *
 * It counts up to COMP_OVER_K_MAX from the temperature of the maps.  The
 * thermal growth is added like any other change.
 */
void comp_warm(struct comp *c, struct comp_config *k, double told_c);

/** comp_left() - what is still to be added, for each axis. */
void comp_left(const struct comp *c, const struct comp_config *k,
	       int32_t ret[INTERP_NAXES]);

/** comp_pulses() - where the drive was sent last. */
static inline int32_t comp_pulses(const struct comp_axis *a)
{
	return a->place + a->shift + a->added;
}

/** comp_place() - the place of a drive that is at @pulses. */
static inline int32_t comp_place(const struct comp_axis *a, int32_t pulses)
{
	return (int32_t)((uint32_t)pulses - (uint32_t)a->shift -
			 (uint32_t)a->added);
}

#endif /* RT_COMP_H */
