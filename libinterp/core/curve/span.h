/* SPDX-License-Identifier: Apache-2.0 */
/*
 * span.h - one knot span of an opened curve
 *
 * Private to libinterp.  It is for callers that must choose the span
 * themselves: at a knot, the derivatives of a curve may differ from one side to
 * the other.
 *
 * Threads: RT-safe.
 */
#ifndef CURVE_SPAN_H
#define CURVE_SPAN_H

#include "interp/nurbs.h"

/**
 * nurbs_span_enter() - use the span that begins at knots[@span]; it is not
 * empty.
 */
void nurbs_span_enter(struct interp_nurbs_eval *e, uint32_t span);

/**
 * nurbs_span_at() - as interp_nurbs_at(), but always in the span that was
 * entered, wherever @u is.
 */
void nurbs_span_at(const struct interp_nurbs_eval *e, double u, int derivs,
		   struct interp_nurbs_point *ret);

/**
 * nurbs_basis() - the degree + 1 basis functions that are not 0 at @u.
 *
 * @n gets them, and @d their first derivatives.  Of @c only degree and knots
 * are used.  Return: the control point to which n[0] belongs.
 */
uint32_t nurbs_basis(const struct interp_nurbs *c, double u,
		     double n[INTERP_NURBS_ORDER_MAX],
		     double d[INTERP_NURBS_ORDER_MAX]);

/**
 * nurbs_span_next() - go to the next span that is not empty; false: there is
 * none.
 */
bool nurbs_span_next(struct interp_nurbs_eval *e);

#endif /* CURVE_SPAN_H */
