/* SPDX-License-Identifier: Apache-2.0 */
/*
 * nurbs_way.h - how a curve goes at a point, by the length of the path
 *
 * Units: mm, s.
 * Threads: any thread; nothing is allocated.
 */
#ifndef INTERP_NURBS_WAY_H
#define INTERP_NURBS_WAY_H

#include "interp/nurbs.h"

#include <stdbool.h>

/* A point of a curve, by the length of the path. */
struct interp_nurbs_way {
	bool cusp;			/* the curve does not go on here; then
					 * the rest says nothing */
	double by_u_mm;			/* length, by parameter */
	double d[3][INTERP_NAXES];	/* x_s, x_ss and x_sss of each column */
};

/** interp_nurbs_way() - how the curve goes at @u. */
void interp_nurbs_way(struct interp_nurbs_eval *e, double u,
		      struct interp_nurbs_way *ret);

#endif /* INTERP_NURBS_WAY_H */
