/* SPDX-License-Identifier: Apache-2.0 */
/*
 * way_curve.h - a NURBS as short straight blocks, with a bound
 *
 * Units: as way.h.
 */
#ifndef PLAN_WAY_CURVE_H
#define PLAN_WAY_CURVE_H

#include "way.h"

/* Farther than that no axis strays from a block of a curve: 1 um, 0.001
 * degree. */
#define WAY_CURVE_STRAYS	0.001

struct way_curve {
	struct interp_nurbs curve;
	const uint8_t *axis;		/* of each column */
	double from, to;		/* part of its domain */
	struct way_node at;		/* its line; and where it begins */
};

/**
 * way_curve() - add the blocks of @k, that begin where @w ends.
 * Return: 0, -ENOMEM, -EINVAL if it cannot be cut.
 */
int way_curve(struct way *w, const struct way_curve *k);

#endif /* PLAN_WAY_CURVE_H */
