/* SPDX-License-Identifier: Apache-2.0 */
/*
 * kalman.h - estimate place, speed and acceleration of an axis from its target
 * and its encoder
 *
 * The axis model predicts, and the encoder corrects.  This is the textbook
 * filter, with
 *
 *	process noise	an unknown part of the speed demanded, sigma drive_mm_s
 *	sensor noise	sigma sensor_mm
 *
 * With a large drive_mm_s the filter follows the encoder, with a small one the
 * model.
 *
 * Units: mm, s.
 * Threads: one object, one thread; all but _init() RT-safe.
 */
#ifndef INTERP_KALMAN_H
#define INTERP_KALMAN_H

#include "interp/axis_model.h"

/* All fields are private except model, which holds the estimate. */
struct interp_kalman {
	struct interp_axis_model model;
	double p[INTERP_AXIS_NSTATES][INTERP_AXIS_NSTATES];	/* covariance */
	double q_mm2_s2, r_mm2;
};

struct interp_kalman_noise {
	double drive_mm_s, sensor_mm;	/* sigmas, > 0 */
};

/** interp_kalman_init() - Return: as interp_axis_model_init(). */
int interp_kalman_init(struct interp_kalman *k,
		       const struct interp_axis_loop *loop, double period_s,
		       const struct interp_kalman_noise *noise,
		       double place_mm);

/** interp_kalman_correct() - the encoder says @measured_mm now. */
void interp_kalman_correct(struct interp_kalman *k, double measured_mm);

/** interp_kalman_predict() - go to the next period; @u_mm_s is demanded. */
void interp_kalman_predict(struct interp_kalman *k, double u_mm_s);

/** interp_kalman_place_mm() - the estimate. */
static inline double interp_kalman_place_mm(const struct interp_kalman *k)
{
	return k->model.x[0];
}

#endif /* INTERP_KALMAN_H */
