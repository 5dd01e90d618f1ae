/* SPDX-License-Identifier: Apache-2.0 */
/*
 * compensate.h - contour compensation: what is added to the demanded speeds
 *
 *	none		nothing is added
 *	feedforward	the set speed, and the set acceleration times the lag of
 *			the velocity loop.  Both are read half a period and the
 *			drive's delay ahead, because the output is late by that
 *			time
 *	cross-coupled	cross_1_s times the contour error vector (Koren)
 *	predictive	predicted_1_s times the contour error that the axis
 *			models, begun at the Kalman estimate, will have within
 *			the horizon, and measured_1_s times the present error
 *			(u + Kff dy_pred + Kfb dy_meas)
 *	zpetc		the axis models inverted with zero phase (Tomizuka)
 *
 * They can be combined, except feedforward and zpetc, which correct the same
 * error.  For a drive that takes places, the result is divided by its gain.
 *
 * Units: mm, s.  Sign: + as the axis.
 * Threads: one object, one thread; _step() is RT-safe if the path's at() is.
 * Its work is bounded: the horizon times the axes, and two feet (foot.h).
 */
#ifndef INTERP_COMPENSATE_H
#define INTERP_COMPENSATE_H

#include "interp/axis_model.h"
#include "interp/feedforward.h"
#include "interp/foot.h"
#include "interp/kalman.h"
#include "interp/zpetc.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define INTERP_COMPENSATE_HORIZON_MAX	64	/* periods */

/* How many set values a step may read before and after the present one. */
#define INTERP_COMPENSATE_BEHIND	INTERP_ZPETC_BEHIND
#define INTERP_COMPENSATE_AHEAD \
	(INTERP_COMPENSATE_HORIZON_MAX + INTERP_AXIS_DELAY_MAX + 4)

struct interp_compensate_config {
	uint32_t methods;		/* INTERP_COMPENSATE_*, 0: none */
	struct interp_compensate_gains gains;
	int naxes;
	double period_s;
	struct interp_axis_loop loop[INTERP_NAXES];	/* as far as known */
	bool filtered;			/* the contour error is that of the
					 * Kalman estimate, not of the
					 * encoder */
	struct interp_kalman_noise noise;
	double look_mm;			/* see interp_contour_begin() */
};

/* Placed by the caller; fields are private. */
struct interp_compensate {
	struct interp_compensate_config config;
	bool estimates;
	int horizon;			/* periods */
	struct interp_contour foot, foot_ahead;
	struct interp_kalman kalman[INTERP_NAXES];
	struct interp_zpetc zpetc[INTERP_NAXES];
	struct interp_contour_error error;	/* the last one, measured */
	struct interp_contour_error ahead;	/* predicted */
};

/*
 * The set values of each axis.  at[i][0] is the present one; those from
 * -INTERP_COMPENSATE_BEHIND to INTERP_COMPENSATE_AHEAD can be read.  u says
 * where on the path they are.  u[0] is the present place; those up to the
 * horizon can be read.
 */
struct interp_compensate_preview {
	const double *at[INTERP_NAXES];
	const double *u;
};

/**
 * interp_compensate_begin() - begin at rest at @place_mm, the path's point @u.
 *
 * Return: 0; -EINVAL for numbers out of range or methods that exclude each
 * other; -ERANGE for a horizon or delay that is too long.  Startup only.
 */
int interp_compensate_begin(struct interp_compensate *c,
			    const struct interp_compensate_config *config,
			    const struct interp_contour_path *path, double u,
			    const double *place_mm);

/**
 * interp_compensate_step() - one period: find what to add to each demanded
 * speed.
 *
 * @measured_mm: the places that the encoders show.
 */
void interp_compensate_step(struct interp_compensate *c,
			    const struct interp_compensate_preview *set,
			    const double *measured_mm, double *ret_mm_s);

#endif /* INTERP_COMPENSATE_H */
