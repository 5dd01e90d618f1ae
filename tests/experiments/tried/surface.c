/* SPDX-License-Identifier: Apache-2.0 */
/*
 * surface.c - NURBS surfaces
 */
#include "tried/surface.h"

#include "curve/span.h"

#include <errno.h>
#include <math.h>

/* One direction, as a curve that has knots only. */
static struct interp_nurbs side(const struct interp_surface *s, int k)
{
	return (struct interp_nurbs) {
		.degree = s->degree[k], .npoints = s->npoints[k], .naxes = 3,
		.counted = 3, .knots = s->knots[k], .points = s->points,
	};
}

enum interp_nurbs_flaw interp_surface_check(const struct interp_surface *s)
{
	struct interp_nurbs c;
	enum interp_nurbs_flaw f;
	uint32_t at;

	/* Along v row by row; along u the first column's worth is enough to
	 * judge the knots. */
	c = side(s, 0);
	f = interp_nurbs_check(&c, &at);
	for (uint32_t i = 0; f == INTERP_NURBS_SOUND && i < s->npoints[0];
	     i++) {
		c = side(s, 1);
		c.points += (size_t)4 * i * s->npoints[1];
		f = interp_nurbs_check(&c, &at);
	}
	return f;
}

/* The basis in one direction, and its first derivative. */
struct basis {
	uint32_t first;			/* control point of n[0] */
	double n[INTERP_NURBS_ORDER_MAX], d[INTERP_NURBS_ORDER_MAX];
};

static void basis_at(const struct interp_surface *s, int k, double u,
		     struct basis *b)
{
	const struct interp_nurbs c = side(s, k);

	b->first = nurbs_basis(&c, u, b->n, b->d);
}

static double within(const struct interp_surface *s, int k, double u)
{
	const struct interp_nurbs c = side(s, k);

	return fmin(fmax(u, interp_nurbs_first(&c)), interp_nurbs_last(&c));
}

void interp_surface_at(const struct interp_surface *s, double u, double v,
		       struct interp_surface_point *ret)
{
	double a[3][4] = { { 0 } };	/* S, Su, Sv and their weights */
	struct basis bu, bv;

	basis_at(s, 0, within(s, 0, u), &bu);
	basis_at(s, 1, within(s, 1, v), &bv);
	for (uint32_t i = 0; i <= s->degree[0]; i++) {
		const double *row = s->points + (size_t)4 *
			((size_t)(bu.first + i) * s->npoints[1] + bv.first);

		for (uint32_t j = 0; j <= s->degree[1]; j++) {
			for (int x = 0; x < 4; x++) {
				const double p = row[4 * j + (uint32_t)x];

				a[0][x] += bu.n[i] * bv.n[j] * p;
				a[1][x] += bu.d[i] * bv.n[j] * p;
				a[2][x] += bu.n[i] * bv.d[j] * p;
			}
		}
	}
	for (int x = 0; x < 3; x++) {
		ret->at_mm[x] = a[0][x] / a[0][3];
		ret->du[x] = (a[1][x] - a[1][3] * ret->at_mm[x]) / a[0][3];
		ret->dv[x] = (a[2][x] - a[2][3] * ret->at_mm[x]) / a[0][3];
	}
}

int interp_surface_offset(const struct interp_surface *s, double u, double v,
			  double d_mm, double ret_mm[3])
{
	struct interp_surface_point p;
	double n[3], length, scale;

	interp_surface_at(s, u, v, &p);
	n[0] = p.du[1] * p.dv[2] - p.du[2] * p.dv[1];
	n[1] = p.du[2] * p.dv[0] - p.du[0] * p.dv[2];
	n[2] = p.du[0] * p.dv[1] - p.du[1] * p.dv[0];
	length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
	scale = sqrt((p.du[0] * p.du[0] + p.du[1] * p.du[1] +
		      p.du[2] * p.du[2]) *
		     (p.dv[0] * p.dv[0] + p.dv[1] * p.dv[1] +
		      p.dv[2] * p.dv[2]));
	if (!(length > 1e-12 * scale))
		return -EDOM;
	for (int i = 0; i < 3; i++)
		ret_mm[i] = p.at_mm[i] + d_mm / length * n[i];
	return 0;
}

int interp_surface_iso(const struct interp_surface *s, int along, double fixed,
		       struct interp_nurbs_own *ret)
{
	const int across = !along;
	const size_t step = along ? 1 : s->npoints[1];
	const size_t over = along ? s->npoints[1] : 1;
	struct basis b;

	if (s->npoints[along] > ret->room)
		return -ENOSPC;
	basis_at(s, across, within(s, across, fixed), &b);
	for (uint32_t i = 0; i < s->npoints[along]; i++) {
		double sum[4] = { 0 };

		for (uint32_t r = 0; r <= s->degree[across]; r++) {
			const double *p = s->points +
					  4 * (i * step + (b.first + r) * over);

			for (int x = 0; x < 4; x++)
				sum[x] += b.n[r] * p[x];
		}
		for (uint32_t x = 0; x < 4; x++)
			ret->points[4 * i + x] = sum[x];
	}
	for (uint32_t i = 0; i <= s->npoints[along] + s->degree[along]; i++)
		ret->knots[i] = s->knots[along][i];
	ret->c = side(s, along);
	ret->c.knots = ret->knots;
	ret->c.points = ret->points;
	return 0;
}
