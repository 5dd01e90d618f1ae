/* SPDX-License-Identifier: Apache-2.0 */
/*
 * feedforward.h - the ways of compensation by name, and the one of them that
 * needs only the set values
 *
 * interp/compensate.h says what each way does.  The cycle knows the
 * feedforward and the cross coupling; the others need more of what comes than
 * a cycle has, and are tried in the model.
 *
 * Units: mm, s.  Threads: any; RT-safe.
 */
#ifndef INTERP_FEEDFORWARD_H
#define INTERP_FEEDFORWARD_H

#include "interp/axis_model.h"

enum {
	INTERP_COMPENSATE_FEEDFORWARD = 1 << 0,
	INTERP_COMPENSATE_CROSS = 1 << 1,
	INTERP_COMPENSATE_PREDICTIVE = 1 << 2,
	INTERP_COMPENSATE_ZPETC = 1 << 3,
};

/* Gains; those of methods not chosen are not read. */
struct interp_compensate_gains {
	double velocity;		/* of the set speed; 1: all of it */
	double acceleration;		/* of what the model asks for; 1 */
	double lead_periods;		/* beyond the delay; 0.5 */
	double cross_1_s;
	double predicted_1_s, measured_1_s;
	double horizon_s;
};

/**
 * interp_compensate_feedforward() - the feedforward of one axis, mm/s.
 *
 * @set: its set values, the present one; with m whole periods of lead and delay
 * together, set[m - 1] ... set[m + 2] are read.  RT-safe.
 */
double interp_compensate_feedforward(const struct interp_compensate_gains *g,
				     const struct interp_axis_loop *l,
				     double period_s, const double *set);

/**
 * interp_compensate_parse() - "cross-coupled+feedforward", "none".
 * Return: the methods, or -EINVAL.  Any thread.
 */
int interp_compensate_parse(const char *names);

/** interp_compensate_name() - of one method, by its bit's number; NULL. */
const char *interp_compensate_name(int bit);

#endif /* INTERP_FEEDFORWARD_H */
