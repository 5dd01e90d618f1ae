/* SPDX-License-Identifier: Apache-2.0 */
/* nurbs_words.h - a curve that is put together: control points, knots, built */
#ifndef CODE_NURBS_H
#define CODE_NURBS_H

#include "code/reader.h"

#define NC_WEIGHT_MIN	1e-9

/**
 * nc_curve_open() - begin a curve of @kind: NC_NURBS, NC_NURBS_BLOCK, NC_BODY.
 */
void nc_curve_open(struct nc_reader *r, uint8_t kind, uint32_t order);

/**
 * nc_curve_point(), nc_curve_knot() - add one more.  Return: 0, -ENOMEM, or
 * -EINVAL if there are too many.
 */
int nc_curve_point(struct nc_reader *r, const double at_mm[INTERP_NAXES],
		   double weight);
int nc_curve_knot(struct nc_reader *r, double u);

/**
 * nc_curve_target() - as nc_target(), but counted from the last control point.
 */
void nc_curve_target(const struct nc_reader *r, double ret_mm[INTERP_NAXES]);

/** nc_curve_next_knot() - add the knot of the line, which is in @slot. */
int nc_curve_next_knot(struct nc_reader *r, enum nc_slot slot);

/** nc_curve_in_turn() - may a control point stand beside the knot in @slot? */
int nc_curve_in_turn(struct nc_reader *r, enum nc_slot slot);

/**
 * nc_curve_set_marks() - set the lines of its control points; its knots begin
 * at 0 from here on.
 */
void nc_curve_set_marks(struct nc_curve *c);

/**
 * nc_curve_check_points() - are there enough?  The word @at ended the curve.
 */
int nc_curve_check_points(struct nc_reader *r, const uint8_t *at);

/**
 * nc_curve_check_end() - does the curve, which ends @here, end at its last
 * control point?
 */
int nc_curve_check_end(struct nc_reader *r, const double here[INTERP_NAXES]);

/** nc_curve_build() - the curve is complete: move along it. */
int nc_curve_build(struct nc_reader *r);

int nc_curve_refuse_weight(struct nc_reader *r, enum nc_slot slot);
int nc_curve_refuse_plane(struct nc_reader *r);

/* The blocks of G5.2 and G5.3, G5 and G5.1. */
int nc_curve_block(struct nc_reader *r);
int nc_curve_end(struct nc_reader *r);
int nc_curve_spline(struct nc_reader *r);
int nc_curve_parabola(struct nc_reader *r);

#endif /* CODE_NURBS_H */
