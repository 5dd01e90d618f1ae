/* SPDX-License-Identifier: Apache-2.0 */
/*
 * curl.c - how fast a node may be passed at which the bend of the path changes
 *
 * From a line onto an arc that touches it, and at a knot of a curve of second
 * degree, the acceleration of an axis makes a step.  With its jerk j it takes a
 * time step / j from one to the other, and is then off the path by
 * step^3 / (24 j^2): no more than a corner may be.
 */
#include "speed/pass.h"

#include <math.h>

/* How a place of an arc bends: by the angle in a mm, square to its
 * direction. */
static void bend(const struct pass *w, const struct interp_arc *arc,
		 double per_mm, const struct heading *h, double ret[])
{
	const uint32_t a = heading_column(w->p, arc->axis_a);
	const uint32_t b = heading_column(w->p, arc->axis_b);
	const double turn = arc->sweep * per_mm;

	if (!(arc->r_mm > 0))
		return;
	ret[a] -= turn * h->rate[b];
	ret[b] += turn * h->rate[a];
}

/* In a cusp a curve bends within less than anybody sees. */
static void bend_of_curve(const struct pass *w, const struct interp_seg *s,
			  double times, double ret[])
{
	double bend[INTERP_NAXES];

	interp_program_curve_bend(w->p, s, times < 0, bend);
	for (uint32_t j = 0; j < w->n; j++)
		ret[j] += times * smaller(larger(bend[j], -1 / w->tol[j]),
					  1 / w->tol[j]);
}

/* Add @times the bend of segment @i where its direction is @h: -1 at its end, 1
 * where it begins. */
static void bends(const struct pass *w, uint32_t i, const struct heading *h,
		  double times, double ret[])
{
	const struct interp_seg *s = &w->segs[i];
	const double per_mm = times / s->length_mm;

	if (s->kind == INTERP_CURVE)
		bend_of_curve(w, s, times, ret);
	if (s->kind == INTERP_ARC)
		bend(w, &w->p->arcs[s->arg], per_mm, h, ret);
	for (int k = 0; k < 2 && s->kind == INTERP_PAIR; k++)
		bend(w, &w->p->couples[s->arg].side[k], per_mm, h, ret);
}

double pass_curl(const struct pass *w, uint32_t last, uint32_t i,
		 const struct heading *a, const struct heading *b)
{
	double d[INTERP_NAXES] = { 0 }, v = INFINITY;

	bends(w, last, a, -1, d);
	bends(w, i, b, 1, d);
	for (uint32_t j = 0; j < w->n; j++)
		if (v * v * fabs(d[j]) > w->curl_mm_s2[j])
			v = sqrt(w->curl_mm_s2[j] / fabs(d[j]));
	return v;
}
