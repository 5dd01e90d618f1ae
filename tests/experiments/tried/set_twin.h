/* SPDX-License-Identifier: Apache-2.0 */
/*
 * set_twin.h - correct a path beforehand by a run of its twin, the model
 *
 * The set values are run through the axis models.  The contour error that is
 * found at a place of the path is multiplied by a gain and added to the set
 * values of that place.  This is repeated.  What is left is what the models do
 * not know.
 *
 * Units: mm.  Threads: any thread, but not in the cycle: the work grows with
 * the path.
 */
#ifndef TRIED_SET_TWIN_H
#define TRIED_SET_TWIN_H

#include "interp/foot.h"

#include <stddef.h>

/* A run of the twin: where its feet were, and how far off. */
struct interp_twin_run {
	const double *u;		/* feet, one a period, in order */
	const double (*error_mm)[INTERP_NAXES];
	size_t n;
};

/* Set values and what is added to them. */
struct interp_twin_set {
	const double *u;		/* their place, never falling */
	double (*offset_mm)[INTERP_NAXES];
	size_t n;
};

/**
 * interp_twin_correct() - add @gain times the errors of a run, each where its
 * foot was, to the offsets.
 */
void interp_twin_correct(const struct interp_twin_set *set,
			 const struct interp_twin_run *run, double gain,
			 int naxes);

#endif /* TRIED_SET_TWIN_H */
