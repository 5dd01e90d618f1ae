/* SPDX-License-Identifier: Apache-2.0 */
/*
 * nurbs_step.h - along a curve by steps of time: one point each period
 *
 * A stepper stands on a curve; each step takes it a signed way further, by a
 * method of choice:
 *
 *	equal-parameter	    du is the same share of the domain as the step is
 *			    of the length
 *	equal-chord	    the first point at the step's distance, bracketed
 *			    and halved
 *	taylor2		    du of second order, from C' and C''
 *	predictor-corrector taylor2, corrected until the chord is the step; it
 *			    is accepted only if it is the first such point, and
 *			    shortened until the curve is nowhere farther from
 *			    the chord than the limit
 *
 * The last one looks at the curve itself and believes no formula: no step is
 * farther off than the limit, none goes back, and a step back of the same
 * length leads to the point it came from.
 *
 * Units: mm, in the axes the curve counts.
 * Threads: RT-safe; each step is a bounded number of evaluations.
 * Source: predictor from the Taylor expansion of u(t); chord error against the
 * curve at the step's inner points.
 */
#ifndef INTERP_NURBS_STEP_H
#define INTERP_NURBS_STEP_H

#include "interp/nurbs.h"

enum interp_nurbs_method {
	INTERP_NURBS_EQUAL_PARAMETER,
	INTERP_NURBS_EQUAL_CHORD,
	INTERP_NURBS_TAYLOR2,
	INTERP_NURBS_PREDICTOR_CORRECTOR,
	INTERP_NURBS_NMETHODS
};

/** interp_nurbs_method_name() - "equal-parameter", ... Any thread. */
const char *interp_nurbs_method_name(enum interp_nurbs_method m);

/** interp_nurbs_method_parse() - the reverse; or -EINVAL.  Any thread. */
int interp_nurbs_method_parse(const char *name);

struct interp_nurbs_stepper {
	struct interp_nurbs_eval e;
	enum interp_nurbs_method method;
	double chord_error_mm;		/* limit; 0: none.  For the
					 * predictor-corrector alone */
	double mm_per_u;		/* for equal-parameter alone: length by
					 * domain, set by the caller */
	double u;
	struct interp_nurbs_point p;	/* the point there, two derivatives */
};

/** interp_nurbs_stepper_init() - stand at @u. */
void interp_nurbs_stepper_init(struct interp_nurbs_stepper *s,
			       const struct interp_nurbs *c, double u,
			       enum interp_nurbs_method m);

/* How a step went. */
struct interp_nurbs_step {
	double chord_mm;		/* how far it led, >= 0 */
	bool limited;			/* shortened by the chord error */
	bool ended;			/* by the end of the curve */
};

/**
 * interp_nurbs_step() - @step_mm further, + toward the end.
 */
struct interp_nurbs_step interp_nurbs_step(struct interp_nurbs_stepper *s,
					   double step_mm);

/**
 * interp_nurbs_chord_error_mm() - how far the curve is from the straight line
 * between @from and @to, at seven inner points of equal parameter and where it
 * turns back between two of them.
 */
double interp_nurbs_chord_error_mm(struct interp_nurbs_eval *e, double from,
				   double to);

#endif /* INTERP_NURBS_STEP_H */
