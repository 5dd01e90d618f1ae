/* SPDX-License-Identifier: Apache-2.0 */
/*
 * identify.h - the numbers of an axis model from a recorded trace
 *
 * This is a least-squares fit to the actual places.  The model is run beside
 * the trace, and its numbers are changed, by Levenberg and Marquardt's rule,
 * until the error of the places that it predicts is smallest.  So noise of the
 * encoder does not bias the numbers.  In a regression of the recorded places on
 * each other it would.
 *
 * If the drive closes its loop over the recorded encoder, the speed that it
 * demanded is known from the trace, with its noise; so is each reversal that
 * the noise makes where the axis nearly stands still.  If the drive measures
 * with something else, the model closes its own loop.  The fit finds which of
 * the two is the case.  It also finds by what share the model is corrected
 * toward the encoder in each period, which an axis needs if a force pushes it.
 *
 * Delay and feedforward look like a slower loop.  They are sought only if the
 * trace cannot be explained without them.  A number that the trace does not
 * determine is left out, and the others are found again.  A trace determines a
 * number only if the motion excites it: at constant speed it determines the lag
 * and nothing else, without a reversal neither friction nor backlash.
 * examples/identify.ngc excites all of them.
 *
 * The confidence of a number is its standard deviation, from the curvature of
 * the sum of squares at its minimum.  It covers noise.  It does not cover what
 * this kind of model cannot describe.
 *
 * Units: in every name.
 * Threads: any thread, not in the cycle.
 */
#ifndef INTERP_IDENTIFY_H
#define INTERP_IDENTIFY_H

#include "interp/axis_model.h"

#include <stdbool.h>
#include <stddef.h>

enum interp_identify_id {
	INTERP_IDENTIFY_GAIN, INTERP_IDENTIFY_VELOCITY,
	INTERP_IDENTIFY_DAMPING, INTERP_IDENTIFY_DELAY,
	INTERP_IDENTIFY_FEEDFORWARD, INTERP_IDENTIFY_KICK,
	INTERP_IDENTIFY_KICK_TIME, INTERP_IDENTIFY_BACKLASH,
	INTERP_NIDENTIFY
};

/* What is known of a number beside its value. */
struct interp_identify_field {
	const char *name, *unit;
};

extern const struct interp_identify_field
	interp_identify_field[INTERP_NIDENTIFY];

struct interp_identify_trace {
	const double *target_mm, *actual_mm;
	size_t n;
	double period_s;
	void (*on_pass)(void *arg);	/* called when a pass over the trace
					 * begins; may be NULL */
	void *on_pass_arg;
};

struct interp_identified {
	struct interp_axis_loop loop;
	double value[INTERP_NIDENTIFY];
	double sigma[INTERP_NIDENTIFY];	/* standard deviation */
	bool sought[INTERP_NIDENTIFY];	/* false: the trace is explained
					 * without this number, which is 0 */
	bool told[INTERP_NIDENTIFY];	/* the trace determines this number */
	double left_mm;			/* error of the model, rms */
	double varies_mm;		/* rms of the following error about its
					 * mean */
	unsigned int reversals;
};

/**
 * interp_identify() - Return: 0; -ENODATA if the trace is too short or its
 * axis stands still; -EDOM if it moves but does not determine the gain and the
 * velocity loop; -EINVAL if the period is not above 0 or a place is not
 * finite.  @ret is filled, except after -EINVAL and -ENODATA.
 */
int interp_identify(const struct interp_identify_trace *t,
		    struct interp_identified *ret);

#endif /* INTERP_IDENTIFY_H */
