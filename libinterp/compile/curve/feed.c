/* SPDX-License-Identifier: Apache-2.0 */
/*
 * feed.c - how fast a curve may be followed at a point
 *
 * The derivatives by length follow from those by parameter.  With g = |C'|:
 *
 *	u_s = 1/g,  u_ss = -g'/g^3,  u_sss = (3 g'^2 - g g'')/g^5
 */
#include "interp/nurbs_feed.h"

#include <math.h>

/* x_s, x_ss and x_sss of every axis; false at a cusp. */
static bool by_length(struct interp_nurbs_eval *e, double u,
		      double d[3][INTERP_NAXES])
{
	const struct interp_nurbs *c = &e->c;
	struct interp_nurbs_point p;
	double g2, g, g1, gg2, us, uss, usss;

	interp_nurbs_at(e, u, 3, &p);
	g2 = interp_nurbs_dot(c, p.d[1], p.d[1]);
	g = sqrt(g2);
	if (!(g > 0))
		return false;
	g1 = interp_nurbs_dot(c, p.d[1], p.d[2]) / g;
	gg2 = (interp_nurbs_dot(c, p.d[2], p.d[2]) +
	       interp_nurbs_dot(c, p.d[1], p.d[3]) - g1 * g1) / g;
	us = 1 / g;
	uss = -g1 * us * us * us;
	usss = (3 * g1 * g1 - g * gg2) * us * us * us * us * us;
	for (uint32_t j = 0; j < c->naxes; j++) {
		d[0][j] = p.d[1][j] * us;
		d[1][j] = p.d[2][j] * us * us + p.d[1][j] * uss;
		d[2][j] = p.d[3][j] * us * us * us +
			  3 * p.d[2][j] * us * uss + p.d[1][j] * usss;
	}
	return true;
}

static double curvature(const struct interp_nurbs *c, const double *d2)
{
	return sqrt(interp_nurbs_dot(c, d2, d2));
}

double interp_nurbs_curvature(struct interp_nurbs_eval *e, double u,
			      double bends[INTERP_NAXES])
{
	double d[3][INTERP_NAXES];

	if (!by_length(e, u, d))
		return HUGE_VAL;
	for (uint32_t j = 0; bends && j < e->c.naxes; j++)
		bends[j] = d[1][j];
	return curvature(&e->c, d[1]);
}

double interp_nurbs_feed_mm_s(struct interp_nurbs_eval *e, double u,
			      const struct interp_nurbs_limits *l)
{
	double d[3][INTERP_NAXES], k, v = HUGE_VAL;

	if (!by_length(e, u, d))
		return 0;
	k = curvature(&e->c, d[1]);
	if (k > 0) {
		v = sqrt(8 * l->chord_error_mm / k) / l->period_s;
		v = fmin(v, sqrt(l->centripetal_mm_s2 / k));
	}
	for (uint32_t j = 0; j < e->c.naxes; j++) {
		if (d[0][j] != 0)
			v = fmin(v, l->v_mm_s[j] / fabs(d[0][j]));
		if (d[1][j] != 0)
			v = fmin(v, sqrt(l->a_mm_s2[j] / fabs(d[1][j])));
		if (d[2][j] != 0)
			v = fmin(v, cbrt(l->j_mm_s3[j] / fabs(d[2][j])));
	}
	return v;
}
