/* SPDX-License-Identifier: Apache-2.0 */
/*
 * shadow.h - models of the axes beside the running machine: predicted and
 * measured contour error
 *
 * It gets the target and the measured place of every axis in every period, as a
 * trace has them.  The axis models follow the same targets.  It measures how
 * far the machine and the models are from the path of the targets.  This path
 * is the row of the last targets, interp/row.h.
 *
 * Targets are lattice points.  So the path has steps of one pulse, and no error
 * is known more exactly.
 *
 * Units: mm, s.
 * Threads: one object, one thread; bounded work a period.
 */
#ifndef INTERP_SHADOW_H
#define INTERP_SHADOW_H

#include "interp/axis_model.h"
#include "interp/row.h"

#include <stdbool.h>
#include <stdint.h>

/* Placed by the caller; fields are private. */
struct interp_shadow {
	int naxes;
	double period_s;
	struct interp_axis_loop loop[INTERP_NAXES];
	struct interp_axis_model model[INTERP_NAXES];
	double before_mm[INTERP_NAXES];
	struct interp_row row;
	struct interp_contour measured, predicted;
	bool begun;
};

/* Contour errors of one period. */
struct interp_shadow_error {
	double measured_mm, predicted_mm;
	double missed_mm;		/* from the machine to the model */
};

/**
 * interp_shadow_init() - for @naxes axes.
 * Return: 0 or as interp_axis_model_init().
 */
int interp_shadow_init(struct interp_shadow *s,
		       const struct interp_axis_loop *loop, int naxes,
		       double period_s);

/** interp_shadow_forget() - periods were lost: begin anew with the next one. */
void interp_shadow_forget(struct interp_shadow *s);

/**
 * interp_shadow_step() - one period.
 *
 * @target_mm: the place on the path in this period; @sent_mm: what was sent to
 * the axes, which is @target_mm plus what a compensation added; @actual_mm: the
 * places that were measured before that.
 */
void interp_shadow_step(struct interp_shadow *s, const double *target_mm,
			const double *sent_mm, const double *actual_mm,
			struct interp_shadow_error *ret);

#endif /* INTERP_SHADOW_H */
