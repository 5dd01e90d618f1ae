/* SPDX-License-Identifier: Apache-2.0 */
/*
 * escape.h - out of the cut and back beside the path
 *
 * A segment's struct interp_escape says which way out is free.  It starts at
 * the lattice point where the electrode stands and has up to three straight
 * legs.  Each leg is a row of lattice points that depends on its two ends
 * alone, so the way back is the way out.  The cursor does not move meanwhile.
 *
 * Distances are signed as along the path: + leads back to the path, - away from
 * it.  Legs meet in corners.  A walk ends at a corner and goes on in the next
 * cycle, so whoever plans a motion plans to stop there.
 *
 * Units: mm of way from the path, positions in pulses.
 * Threads: RT-safe.  A call takes at most config.points_max lattice points.
 */
#ifndef RT_ESCAPE_H
#define RT_ESCAPE_H

#include "interp/axis.h"

#include <stdbool.h>
#include <stdint.h>

struct cycle;

#define ESCAPE_LEGS	3

struct escape_leg {
	int32_t from[INTERP_NAXES], to[INTERP_NAXES];	/* pulses */
	int64_t ticks;			/* of the axis with the most pulses */
	double start_mm, end_mm;	/* way from the path */
};

struct escape {
	struct escape_leg leg[ESCAPE_LEGS];
	uint32_t nlegs;			/* 0: on the path */
	uint32_t at;			/* the leg it is on */
	int64_t tick;			/* on it */
	double way_mm;			/* from the path, 0 ... length_mm */
	double length_mm;
	/* Its axes allow no more: */
	double v_max_mm_s, a_max_mm_s2, j_max_mm_s3;
	int32_t pos[INTERP_NAXES];	/* pulses */
	uint32_t moved;			/* bit per axis moved by the last
					 * point */
};

/** escape_is_out() - beside the path, or about to leave it? */
static inline bool escape_is_out(const struct escape *e)
{
	return e->nlegs > 0;
}

/**
 * escape_begin() - leave the path where the cursor stands.
 *
 * Return: false if the segment has no escape, or if it leads out of the travel.
 * Then the way out is the path.
 */
bool escape_begin(struct cycle *c);

/**
 * escape_find() - the same, and stand at @pos of it, as after a crash.
 *
 * Return: false, and on the path, if @pos is no point of it.  Startup only.
 */
bool escape_find(struct cycle *c, const int32_t pos[INTERP_NAXES]);

/**
 * escape_by() - @ds_mm along the escape; updates out.target, feed and sums.
 *
 * No farther than the next corner.  Back on the path the escape is over.
 * Return: false at its outer end.
 */
bool escape_by(struct cycle *c, double ds_mm);

/**
 * escape_scout() - @e, a copy, goes a lattice point on; @toward as ds_mm.
 * Return: false at its ends.
 */
bool escape_scout(struct escape *e, int toward);

/**
 * escape_stop_mm() - the place to plan for on the way to the place @to_mm.
 *
 * The next corner if one lies between; both as place_mm() counts.
 */
double escape_stop_mm(const struct cycle *c, double to_mm);

#endif /* RT_ESCAPE_H */
