/* SPDX-License-Identifier: Apache-2.0 */
/*
 * route_curve.h - a NURBS as short straight blocks, with a bound
 *
 * Units: as route.h.
 */
#ifndef PLAN_ROUTE_CURVE_H
#define PLAN_ROUTE_CURVE_H

#include "route.h"

/* The most that any axis strays from a block of a curve: 1 um, or 0.001
 * degrees. */
#define ROUTE_CURVE_STRAYS	0.001

struct route_curve {
	struct interp_nurbs curve;
	const uint8_t *axis;		/* of each column */
	double from, to;		/* part of its domain */
	struct route_node at;		/* where it begins, and its line */
};

/**
 * route_curve() - add the blocks of @k, which begins where @w ends.
 * Return: 0; -ENOMEM; -EINVAL: it cannot be divided into blocks.
 */
int route_curve(struct route *w, const struct route_curve *k);

#endif /* PLAN_ROUTE_CURVE_H */
