/* SPDX-License-Identifier: Apache-2.0 */
/*
 * contouring.h - what is added to the targets so that axes that lag keep to the
 * path
 *
 * A drive that is sent to places follows them v / gain behind.  Axes that lag
 * by different amounts leave the path, and all of them cut corners.  The cycle
 * has two remedies of interp/compensate.h; either or both can be used.  Each
 * asks for a speed.  That speed, divided by the drive's position gain, is added
 * to the target:
 *
 * 	feedforward	of the commanded speed and acceleration.  The path
 * 			ahead is known exactly.  Its speed is taken from the
 * 			speed of this period and its change, over the lead and
 * 			the delay.  So nothing has to be delayed, as a preview
 * 			would do.
 * 	cross-coupled	of the contour error: the measured places are compared
 * 			with the row of the last commanded places, so that
 * 			their delay does not count.
 *
 * It works only while positioning, and while a held job brakes or moves: under
 * the gap servo speeds are small and noisy, and a gap of some micrometres has
 * no room for a lead of v / gain.  Nothing is added while an axis is homed or
 * jogged, while probing, beside the path, or while axes have no power.  At rest
 * nothing is added: the axes stand on their pulses.  A cut, a probing motion
 * and the end of a job wait for that.
 *
 * Two contours at once are not led; the addition fades out where they begin.
 *
 * The addition is never more than the lag of an axis at its v_max.  In a period
 * it changes by no more than the distance at v_max; only a fault takes all of
 * it off at once.  A target inside the travel stays inside.
 *
 * Units: mm, s; pulses.
 * Threads: RT-safe.  In a period a call looks at CONTOURING_AHEAD + 2 points of
 * the path at most, and does the work of interp_contour_step().
 */
#ifndef RT_CONTOURING_H
#define RT_CONTOURING_H

#include "interp/at.h"
#include "interp/axis.h"
#include "interp/feedforward.h"
#include "interp/row.h"

#include <stdbool.h>
#include <stdint.h>

/* Whole periods: lead, delay, and two more. */
#define CONTOURING_AHEAD	8
#define CONTOURING_LEAD_MAX	(CONTOURING_AHEAD - 2)

struct contouring_config {
	uint32_t methods;		/* of INTERP_COMPENSATE_FEEDFORWARD and
					 * _CROSS; 0: none */
	uint32_t axes;			/* bit per axis with a known loop */
	int ahead;			/* set values after the present one that
					 * are looked at: CONTOURING_AHEAD at
					 * most */
	struct interp_compensate_gains gains;
	struct interp_axis_loop loop[INTERP_NAXES];
	double pulse_mm[INTERP_NAXES];
	double most_mm[INTERP_NAXES];	/* the largest addition */
};

struct contouring {
	bool on;			/* it acted in the last period */
	bool stood;			/* the axes stood before this period */
	bool eases;			/* it goes off, until nothing is
					 * added */
	uint32_t path;			/* io_outputs.path in the last period */
	double place_mm, way_mm;	/* the place, and the distance gone, in
					 * the last period */
	double share;			/* of feedforward, 0 ... 1; it grows
					 * from 0 if the axes move already */
	double coupled;			/* share of cross-coupling; 0 at rest */
	double added_mm[INTERP_NAXES];
	int32_t added[INTERP_NAXES];	/* the same in pulses */
	struct interp_at_curve curve;	/* the last one that was looked at */
	struct interp_row row;		/* set places of the linear axes */
	struct interp_contour foot;
};

/** contouring_rests() - is nothing added? */
bool contouring_rests(const struct contouring *w);

struct cycle;
struct io_inputs;

/** contouring_step() - one period, after the walk. */
void contouring_step(struct cycle *c, const struct io_inputs *in);

#endif /* RT_CONTOURING_H */
