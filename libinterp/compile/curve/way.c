/* SPDX-License-Identifier: Apache-2.0 */
/*
 * way.c - how a curve goes at a point, by the length of the path
 *
 * The derivatives by length follow from those by parameter.  With g = |C'|:
 *
 *	u_s = 1/g,  u_ss = -g'/g^3,  u_sss = (3 g'^2 - g g'')/g^5
 */
#include "interp/nurbs_way.h"

#include <math.h>

void interp_nurbs_way(struct interp_nurbs_eval *e, double u,
		      struct interp_nurbs_way *ret)
{
	const struct interp_nurbs *c = &e->c;
	struct interp_nurbs_point p;
	double g2, g, g1, gg2, us, uss, usss;

	interp_nurbs_at(e, u, 3, &p);
	g2 = interp_nurbs_dot(c, p.d[1], p.d[1]);
	g = sqrt(g2);
	ret->by_u_mm = g;
	ret->cusp = !(g > 0);
	if (ret->cusp)
		return;
	g1 = interp_nurbs_dot(c, p.d[1], p.d[2]) / g;
	gg2 = (interp_nurbs_dot(c, p.d[2], p.d[2]) +
	       interp_nurbs_dot(c, p.d[1], p.d[3]) - g1 * g1) / g;
	us = 1 / g;
	uss = -g1 * us * us * us;
	usss = (3 * g1 * g1 - g * gg2) * us * us * us * us * us;
	for (uint32_t j = 0; j < c->naxes; j++) {
		ret->d[0][j] = p.d[1][j] * us;
		ret->d[1][j] = p.d[2][j] * us * us + p.d[1][j] * uss;
		ret->d[2][j] = p.d[3][j] * us * us * us +
			       3 * p.d[2][j] * us * uss + p.d[1][j] * usss;
	}
}
