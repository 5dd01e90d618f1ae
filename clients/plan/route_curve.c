/* SPDX-License-Identifier: Apache-2.0 */
/*
 * route_curve.c - cut a NURBS until its control points lie on a chord
 *
 * Between two parameters of one knot span, a point of a curve is an average of
 * its Bezier points there; the weights are positive and their sum is 1.  Write
 * Bezier point k as chord(t_k) + e_k, with any t_k.  Then the curve is
 * chord(t) + e, where t and e are the same averages of t_k and e_k.  So no
 * axis strays from the chord by more than in the largest e_k.
 *
 * A Bezier point is the blossom of the span at so many times the one parameter
 * and so many times the other (L. Ramshaw, 1987).
 */
#include "route_curve.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#define DEPTH_MAX	40

struct piece {
	uint32_t n, naxes;
	double at[INTERP_NURBS_ORDER_MAX][INTERP_NAXES];
};

/* The blossom of span @span at @u[0 ... degree - 1]. */
static void blossom(const struct interp_nurbs *c, uint32_t span,
		    const double *u, double ret[INTERP_NAXES])
{
	const uint32_t p = c->degree, row = c->naxes + 1;
	double d[INTERP_NURBS_ORDER_MAX][INTERP_NAXES + 1];

	for (uint32_t k = 0; k <= p; k++)
		memcpy(d[k], c->points + (size_t)(span - p + k) * row,
		       row * sizeof(double));
	for (uint32_t r = 1; r <= p; r++) {
		for (uint32_t k = p; k >= r; k--) {
			const uint32_t i = span - p + k;
			const double low = c->knots[i];
			const double high = c->knots[i + p - r + 1];
			const double a = (u[r - 1] - low) / (high - low);

			for (uint32_t j = 0; j < row; j++)
				d[k][j] = (1 - a) * d[k - 1][j] + a * d[k][j];
		}
	}
	for (uint32_t j = 0; j < c->naxes; j++)
		ret[j] = d[p][j] / d[p][c->naxes];
}

static void bezier(const struct interp_nurbs *c, uint32_t span, double from,
		   double to, struct piece *ret)
{
	double u[INTERP_NURBS_DEGREE_MAX];

	ret->n = c->degree + 1;
	ret->naxes = c->naxes;
	for (uint32_t k = 0; k <= c->degree; k++) {
		for (uint32_t i = 0; i < c->degree; i++)
			u[i] = i < k ? to : from;
		blossom(c, span, u, ret->at[k]);
	}
}

/* Where along the chord point @k is nearest to it. */
static double along(const struct piece *x, uint32_t k)
{
	double up = 0, square = 0;

	for (uint32_t j = 0; j < x->naxes; j++) {
		const double d = x->at[x->n - 1][j] - x->at[0][j];

		up += d * (x->at[k][j] - x->at[0][j]);
		square += d * d;
	}
	return square > 0 ? fmin(fmax(up / square, 0), 1) : 0;
}

static double strays(const struct piece *x)
{
	double most = 0;

	for (uint32_t k = 0; k < x->n; k++) {
		const double t = along(x, k);

		for (uint32_t j = 0; j < x->naxes; j++)
			most = fmax(most, fabs((1 - t) * x->at[0][j] +
					       t * x->at[x->n - 1][j] -
					       x->at[k][j]));
	}
	return most;
}

static int add_chord(struct route *w, const struct route_curve *k,
		     const struct piece *x, double off)
{
	struct route_node n = k->at;

	memcpy(n.q, w->node[w->n - 1].q, sizeof(n.q));
	n.strays = (float)(off * (1 + 1e-6));
	for (uint32_t j = 0; j < x->naxes; j++)
		n.q[k->axis[j]] = x->at[x->n - 1][j];
	return route_add(w, &n);
}

static int cut(struct route *w, const struct route_curve *k, double from,
	       double to, int depth)
{
	const double mid = from + (to - from) / 2;
	struct piece x;
	double off;
	int err;

	bezier(&k->curve, interp_nurbs_span(&k->curve, mid), from, to, &x);
	off = strays(&x);
	if (off <= ROUTE_CURVE_STRAYS)
		return add_chord(w, k, &x, off);
	if (depth == DEPTH_MAX || !isfinite(off))
		return -EINVAL;
	err = cut(w, k, from, mid, depth + 1);
	return err ? err : cut(w, k, mid, to, depth + 1);
}

int route_curve(struct route *w, const struct route_curve *k)
{
	const struct interp_nurbs *c = &k->curve;
	int err = 0;

	for (uint32_t i = c->degree; i < c->npoints && err == 0; i++) {
		const double from = fmax(c->knots[i], k->from);
		const double to = fmin(c->knots[i + 1], k->to);

		if (from < to)
			err = cut(w, k, from, to, 0);
	}
	return err;
}
