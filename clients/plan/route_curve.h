/* SPDX-License-Identifier: Apache-2.0 */
/*
 * route_curve.h - a NURBS as short straight blocks, with a bound
 *
 * Units: as route.h.
 */
#ifndef PLAN_ROUTE_CURVE_H
#define PLAN_ROUTE_CURVE_H

#include "route.h"

/* Farther than that no axis strays from a block of a curve: 1 um, 0.001
 * degree. */
#define ROUTE_CURVE_STRAYS	0.001

struct route_curve {
	struct interp_nurbs curve;
	const uint8_t *axis;		/* of each column */
	double from, to;		/* part of its domain */
	struct route_node at;		/* its line; and where it begins */
};

/**
 * route_curve() - add the blocks of @k, that begin where @w ends.
 * Return: 0, -ENOMEM, -EINVAL if it cannot be cut.
 */
int route_curve(struct route *w, const struct route_curve *k);

#endif /* PLAN_ROUTE_CURVE_H */
