/* SPDX-License-Identifier: Apache-2.0 */
/*
 * span.h - one knot span of an opened curve
 *
 * Private to libinterp.  For those who must say themselves which span they
 * mean: at a knot a curve's derivatives may differ from one side to the other.
 *
 * Threads: RT-safe.
 */
#ifndef CURVE_SPAN_H
#define CURVE_SPAN_H

#include "interp/nurbs.h"

/** nurbs_span_enter() - the span from knots[@span], which is not empty. */
void nurbs_span_enter(struct interp_nurbs_eval *e, uint32_t span);

/** nurbs_span_at() - as interp_nurbs_at(), by the span entered, wherever @u. */
void nurbs_span_at(const struct interp_nurbs_eval *e, double u, int derivs,
		   struct interp_nurbs_point *ret);

/**
 * nurbs_basis() - the degree + 1 basis functions at @u that are not 0.
 *
 * @n gets them, @d their first derivatives.  Only degree and knots of @c
 * count.  Return: the control point that n[0] belongs to.
 */
uint32_t nurbs_basis(const struct interp_nurbs *c, double u,
		     double n[INTERP_NURBS_ORDER_MAX],
		     double d[INTERP_NURBS_ORDER_MAX]);

/** nurbs_span_speed() - length per parameter at @u, by the span entered. */
double nurbs_span_speed(const struct interp_nurbs_eval *e, double u);

/** nurbs_span_next() - the next span that is not empty; false: no more. */
bool nurbs_span_next(struct interp_nurbs_eval *e);

#endif /* CURVE_SPAN_H */
