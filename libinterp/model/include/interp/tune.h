/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tune.h - find the gains of a compensation on the models of the axes
 *
 * The cost of a set of gains is the largest contour error of a trial plus
 * INTERP_TUNE_MEAN times the mean one, in um.  A gain that is tried has
 * INTERP_TUNE_DIGITS significant digits, so a gain that is printed with as many
 * is exactly one that was tried.  This matters because a little rounding can
 * change the largest error a lot: it decides whether an axis at rest begins to
 * creep in its friction.
 *
 * Threads: any thread, not in the cycle.
 */
#ifndef INTERP_TUNE_H
#define INTERP_TUNE_H

#include "interp/minimise.h"
#include "interp/trial.h"

#define INTERP_TUNE_MEAN	10
#define INTERP_TUNE_DIGITS	4

enum interp_tune_method { INTERP_TUNE_LOCAL, INTERP_TUNE_GLOBAL };

struct interp_tune {
	struct interp_trial trial;	/* its gains are the first ones
					 * tried */
	enum interp_tune_method method;
	unsigned int budget;		/* trials */
	/* Called after each trial, with the number of trials so far and the
	 * least cost; may be NULL. */
	void (*on_trial)(void *arg, unsigned int used, double best);
	void *on_trial_arg;
};

/**
 * interp_tune_run() - find the gains of the methods in the trial's
 * configuration.
 *
 * @ret_cost: the least cost.
 * Return: 0; -EINVAL: no method has a gain to find; -ENOMEM; or what
 * interp_compensate_begin() returns for the first gains.
 */
int interp_tune_run(const struct interp_tune *t,
		    struct interp_compensate_gains *ret, double *ret_cost);

#endif /* INTERP_TUNE_H */
