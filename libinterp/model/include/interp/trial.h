/* SPDX-License-Identifier: Apache-2.0 */
/*
 * trial.h - run a path through axis models with a compensation, and measure the
 * contour error
 *
 * The compensation sees the places through an encoder with steps and noise, so
 * that a trial is no better than the machine would be.  The contour error is
 * that of the true places, not of those that the encoder shows.
 *
 * Units: mm, s.
 * Threads: any thread, not in the cycle: the work grows with the path.
 */
#ifndef INTERP_TRIAL_H
#define INTERP_TRIAL_H

#include "interp/compensate.h"

struct interp_trial {
	const struct interp_contour_path *path;
	struct interp_compensate_preview set;	/* at the first set value */
	size_t n;			/* number of set values */
	const struct interp_compensate_config *compensate;
	struct interp_axis_loop truth[INTERP_NAXES];
	double encoder_mm;		/* step; 0: none */
	double noise_mm;		/* sigma, before the step */
	uint64_t seed;
	/* Where to keep what happened, @n each; NULL: nowhere. */
	double *u;
	double (*error_mm)[INTERP_NAXES];
	double (*actual_mm)[INTERP_NAXES];
	double (*measured_mm)[INTERP_NAXES];
};

struct interp_trial_result {
	double max_mm, mean_mm;		/* contour error */
};

/** interp_trial_run() - Return: 0 or as interp_compensate_begin(). */
int interp_trial_run(const struct interp_trial *t,
		     struct interp_trial_result *ret);

#endif /* INTERP_TRIAL_H */
