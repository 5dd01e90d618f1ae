/* SPDX-License-Identifier: Apache-2.0 */
/*
 * contouring.h - what is added to the targets so that lagging axes keep to the
 * path
 *
 * A drive that takes places follows them v / gain behind.  Axes that lag unlike
 * leave the path, and all of them round corners off.  Two cures of
 * interp/compensate.h can be had in the cycle, one or both; the speed that they
 * ask for is divided by the drive's position gain and added to the target:
 *
 *	feedforward	of the set speed and acceleration.  The path ahead is
 *			known exactly; how fast it will be gone along is this
 *			period's speed and its change, held for the lead and
 *			the delay.  Nothing is delayed, as a preview would.
 *	cross-coupled	of the contour error: the measured places against the
 *			row of the last set ones, so that their age does not
 *			count.
 *
 * Only while it positions, and while it brakes or moves held: under the gap
 * servo speeds are small and noisy, and a lead of v / gain into a gap of some
 * um is no service.  Nothing while it homes, jogs or touches, beside the path,
 * and while axes are not under power; a fault takes it off at once.  At rest it
 * is zero: the axes stand on their pulses.  A cut and a touch are begun, and a
 * job ended, no sooner than that.
 *
 * Two contours at once are not led; it eases off where they begin.
 *
 * Never more than an axis lags at its v_max, and in a period never more of it
 * than the way at v_max; but a fault takes all of it off at once.  A target
 * inside the travel stays inside.
 *
 * Units: mm, s; pulses.
 * Threads: RT-safe.  At most CONTOURING_AHEAD + 2 points of the path and the
 * work of interp_contour_step() a period.
 */
#ifndef RT_CONTOURING_H
#define RT_CONTOURING_H

#include "interp/at.h"
#include "interp/axis.h"
#include "interp/feedforward.h"
#include "interp/row.h"

#include <stdbool.h>
#include <stdint.h>

/* The whole periods of lead and delay, and two. */
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
	double most_mm[INTERP_NAXES];	/* that is added */
};

struct contouring {
	bool on;			/* in the last period too */
	bool stood;			/* it did, before this period */
	bool eases;			/* off, until nothing is added */
	uint32_t path;			/* io_outputs.path then */
	double place_mm, way_mm;	/* on it, and gone in the last period */
	double share;			/* of feedforward; from 0 where it is
					 * moving already */
	double coupled;			/* of cross-coupling; 0 at rest */
	double added_mm[INTERP_NAXES];
	int32_t added[INTERP_NAXES];	/* the same in pulses */
	struct interp_at_curve curve;	/* looked at last */
	struct interp_row row;		/* of linear axes */
	struct interp_contour foot;
};

/** contouring_rests() - nothing is added. */
bool contouring_rests(const struct contouring *w);

struct cycle;
struct io_inputs;

/** contouring_step() - one period, after the walk. */
void contouring_step(struct cycle *c, const struct io_inputs *in);

#endif /* RT_CONTOURING_H */
