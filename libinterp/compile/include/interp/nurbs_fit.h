/* SPDX-License-Identifier: Apache-2.0 */
/*
 * nurbs_fit.h - one curve for many points, within a tolerance
 *
 * A cubic of weights 1 through the first and the last point, by least squares
 * over the length of the polygon; knots are added where it is too far off.
 * Within the tolerance means: every point is that near to the curve, and the
 * curve between two neighbours, in eighths, that near to the line between them.
 *
 * Units: mm, rotary axes in degrees, all counted alike.
 * Threads: allocates; not for the cycle.
 * Source: Piegl and Tiller, The NURBS Book, 9.4.1 (least squares).
 */
#ifndef INTERP_NURBS_FIT_H
#define INTERP_NURBS_FIT_H

#include "interp/nurbs.h"

#define INTERP_FIT_POINTS_MAX	4096	/* in one curve */
#define INTERP_FIT_POINTS_MIN	6

/* A curve with its own numbers. */
struct interp_nurbs_own {
	struct interp_nurbs c;		/* c.knots, c.points: these two */
	double *knots, *points;		/* lent by the caller, with room */
	uint32_t room;			/* of control points; of knots it is
					 * room + degree + 1 */
};

struct interp_fit {
	const double *points;		/* rows of naxes; no two neighbours
					 * are the same */
	uint32_t npoints;		/* INTERP_FIT_POINTS_MIN ... _MAX */
	uint32_t naxes;
	double tolerance_mm;		/* > 0 */
};

/**
 * interp_nurbs_fit() - @ret lends room for npoints control points; its
 * parameter runs from 0 to the length of the polygon.
 *
 * Return: 0, -ERANGE if no such curve was found, -ENOMEM.
 */
int interp_nurbs_fit(const struct interp_fit *f, struct interp_nurbs_own *ret);

/**
 * interp_fit_corner() - is the bend at point @at, neither the first nor the
 * last, too sharp for a smooth curve within the tolerance?
 */
bool interp_fit_corner(const struct interp_fit *f, uint32_t at);

#endif /* INTERP_NURBS_FIT_H */
