/* SPDX-License-Identifier: Apache-2.0 */
/*
 * identify.h - the numbers of an axis model from a recorded trace
 *
 * Least squares of the actual places: the model is run beside the trace, and
 * its numbers are changed, by Levenberg and Marquardt's rule, until what it
 * misses of the next place is least.  Noise of the encoder therefore biases
 * nothing, as it would in a regression of the recorded places on each other.
 *
 * Where the drive closes its loop over the recorded encoder, the speed it
 * demanded is known from the trace, noise and all; so is each turn that noise
 * makes where the axis nearly stands.  Where it measures otherwise, the model
 * closes its own loop.  Which of the two, and by what part the model is drawn
 * to the encoder in a period (an axis that is pushed asks for it), is found
 * with the rest.
 *
 * Delay and feedforward look like a slower loop and are sought only if the
 * trace is not explained without them.  A number that the trace does not tell
 * is left out and the others are found anew.  A trace that does not excite a
 * number cannot tell it: one at constant speed tells the lag and nothing else,
 * one without a reversal no friction and no backlash.
 * examples/identify.ngc excites all of them.
 *
 * The confidence of a number is its standard deviation by the curvature at the
 * least.  It counts noise alone, and not what the model cannot be.
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
	void (*on_pass)(void *arg);	/* one pass over it begins, or NULL */
	void *on_pass_arg;
};

struct interp_identified {
	struct interp_axis_loop loop;
	double value[INTERP_NIDENTIFY];
	double sigma[INTERP_NIDENTIFY];	/* standard deviation */
	bool sought[INTERP_NIDENTIFY];	/* false: the trace needs none, 0 */
	bool told[INTERP_NIDENTIFY];	/* the trace tells this number */
	double left_mm;			/* rms of what the model misses */
	double varies_mm;		/* the following error, about its
					 * mean */
	unsigned int reversals;
};

/**
 * interp_identify() - Return: 0; -ENODATA if the trace is too short or its
 * axis stands; -EDOM if it moves but excites too little to tell gain and
 * velocity loop; -EINVAL for a number that is none.  @ret is filled but for
 * -EINVAL and -ENODATA.
 */
int interp_identify(const struct interp_identify_trace *t,
		    struct interp_identified *ret);

#endif /* INTERP_IDENTIFY_H */
