/* SPDX-License-Identifier: Apache-2.0 */
/*
 * way_curve.c - cut a NURBS until its control points lie on a chord
 *
 * A curve is an average of its control points, with weights that are positive
 * and sum to one.  If point k is chord(t_k) + e_k, whatever t_k was chosen, the
 * curve is chord(t) + e with t and e the same averages: no e is larger than
 * the largest e_k.  So axis by axis that is how far the curve strays.
 */
#include "way_curve.h"

#include "interp/nurbs_edit.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DEPTH_MAX	30

static int own(const struct interp_nurbs *like, uint32_t more,
	       struct interp_nurbs_own *ret)
{
	const uint32_t room = like->npoints + more;

	*ret = (struct interp_nurbs_own) { .room = room };
	ret->knots = malloc((room + like->degree + 1) * sizeof(double));
	ret->points = malloc((size_t)room * (like->naxes + 1) * sizeof(double));
	return ret->knots && ret->points ? 0 : -ENOMEM;
}

static void disown(struct interp_nurbs_own *o)
{
	free(o->knots);
	free(o->points);
}

static double place(const struct interp_nurbs *c, uint32_t k, uint32_t axis)
{
	const double *p = c->points + (size_t)k * (c->naxes + 1);

	return p[axis] / p[c->naxes];
}

/* Where along the chord point @k is nearest to it. */
static double along(const struct interp_nurbs *c, uint32_t k)
{
	double up = 0, square = 0;

	for (uint32_t j = 0; j < c->naxes; j++) {
		const double a = place(c, 0, j);
		const double d = place(c, c->npoints - 1, j) - a;

		up += d * (place(c, k, j) - a);
		square += d * d;
	}
	return square > 0 ? fmin(fmax(up / square, 0), 1) : 0;
}

static double strays(const struct interp_nurbs *c)
{
	double most = 0;

	for (uint32_t k = 0; k < c->npoints; k++) {
		const double t = along(c, k);

		for (uint32_t j = 0; j < c->naxes; j++) {
			const double a = place(c, 0, j);
			const double b = place(c, c->npoints - 1, j);

			most = fmax(most, fabs(place(c, k, j) -
					       (a + t * (b - a))));
		}
	}
	return most;
}

static int add_chord(struct way *w, const struct way_curve *k,
		     const struct interp_nurbs *c, double off)
{
	struct way_node n = w->node[w->n - 1];

	n.line = k->at.line;
	n.rapid = k->at.rapid;
	n.strays = (float)(off * (1 + 1e-6));
	for (uint32_t j = 0; j < c->naxes; j++)
		n.q[k->axis[j]] = place(c, c->npoints - 1, j);
	return way_add(w, &n);
}

static int cut(struct way *w, const struct way_curve *k,
	       const struct interp_nurbs *c, int depth)
{
	const double off = strays(c);
	struct interp_nurbs_own left, right;
	int r;

	if (off <= WAY_CURVE_STRAYS)
		return add_chord(w, k, c, off);
	if (depth == DEPTH_MAX)
		return -EINVAL;
	r = own(c, c->degree + 1, &left);
	if (own(c, c->degree + 1, &right) || r)
		r = -ENOMEM;
	if (r == 0)
		r = interp_nurbs_split(c, (interp_nurbs_first(c) +
					   interp_nurbs_last(c)) / 2, &left,
				       &right) ? -EINVAL : 0;
	if (r == 0)
		r = cut(w, k, &left.c, depth + 1);
	if (r == 0)
		r = cut(w, k, &right.c, depth + 1);
	disown(&left);
	disown(&right);
	return r;
}

/* @c from @u on, or up to @u. */
static int part(const struct interp_nurbs *c, double u, bool first,
		struct interp_nurbs_own *ret)
{
	struct interp_nurbs_own rest;
	int r = own(c, c->degree + 1, &rest);

	if (r == 0)
		r = interp_nurbs_split(c, u, first ? ret : &rest,
				       first ? &rest : ret) ? -EINVAL : 0;
	disown(&rest);
	return r;
}

int way_curve(struct way *w, const struct way_curve *k)
{
	struct interp_nurbs_own a = { .c = k->curve }, b = { .c = k->curve };
	const double first = interp_nurbs_first(&k->curve);
	const double last = interp_nurbs_last(&k->curve);
	const double least = 1e-9 * (last - first);
	int r = 0;

	if (k->from > first + least) {
		r = own(&k->curve, k->curve.degree + 1, &a);
		if (r == 0)
			r = part(&k->curve, k->from, false, &a);
	}
	b.c = a.c;
	if (r == 0 && k->to < last - least) {
		r = own(&a.c, a.c.degree + 1, &b);
		if (r == 0)
			r = part(&a.c, k->to, true, &b);
	}
	if (r == 0)
		r = cut(w, k, &b.c, 0);
	if (a.knots)
		disown(&a);
	if (b.knots)
		disown(&b);
	return r;
}
