/* SPDX-License-Identifier: Apache-2.0 */
/*
 * nurbs_edit.c - insert knots, split curves, raise their degree
 *
 * Insertion is Boehm's: one more knot in span k changes p - s control points,
 * each to a point between two old ones.  So it is as exact as the numbers are.
 *
 * A curve's blossom f(a1 ... ap) is the result of de Boor's triangle with p
 * different arguments.  A control point is the blossom at the p knots inside
 * its support.  A curve whose degree is raised by one has the blossom
 *
 *	g(a1 ... ap+1) = 1/(p+1) sum of f(all of them but one)
 *
 * which gives its control points.
 */
#include "tried/nurbs_edit.h"

#include <errno.h>
#include <string.h>

static size_t row_of(const struct interp_nurbs *c)
{
	return c->naxes + 1;
}

static void own(struct interp_nurbs_own *ret, const struct interp_nurbs *c,
		uint32_t degree, uint32_t npoints)
{
	ret->c = *c;
	ret->c.degree = degree;
	ret->c.npoints = npoints;
	ret->c.knots = ret->knots;
	ret->c.points = ret->points;
}

int interp_nurbs_copy(const struct interp_nurbs *c,
		      struct interp_nurbs_own *ret)
{
	if (c->npoints > ret->room)
		return -ENOSPC;
	own(ret, c, c->degree, c->npoints);
	memcpy(ret->knots, c->knots,
	       (c->npoints + c->degree + 1) * sizeof(*c->knots));
	memcpy(ret->points, c->points,
	       c->npoints * row_of(c) * sizeof(*c->points));
	return 0;
}

static uint32_t multiplicity(const struct interp_nurbs *c, double u)
{
	uint32_t n = 0;

	for (uint32_t i = 0; i <= c->npoints + c->degree; i++)
		n += c->knots[i] == u;
	return n;
}

/* Once, in place; there is room. */
static void insert_one(struct interp_nurbs_own *o, double u)
{
	const uint32_t p = o->c.degree, n = o->c.npoints;
	const uint32_t k = interp_nurbs_span(&o->c, u);
	const size_t row = row_of(&o->c);
	double *q = o->points;

	memmove(q + (k - p + 1) * row, q + (k - p) * row,
		(n - (k - p)) * row * sizeof(*q));
	/* Row i + 1 now has old point i. */
	for (uint32_t i = k - p + 1; i <= k; i++) {
		const double a = (u - o->knots[i]) /
				 (o->knots[i + p] - o->knots[i]);

		for (size_t j = 0; j < row; j++)
			q[i * row + j] += a * (q[(i + 1) * row + j] -
					       q[i * row + j]);
	}
	memmove(o->knots + k + 2, o->knots + k + 1,
		(n + p - k) * sizeof(*o->knots));
	o->knots[k + 1] = u;
	o->c.npoints++;
}

int interp_nurbs_insert(const struct interp_nurbs *c, double u, uint32_t times,
			struct interp_nurbs_own *ret)
{
	if (!(u > interp_nurbs_first(c) && u < interp_nurbs_last(c)) ||
	    times > c->degree || multiplicity(c, u) + times > c->degree)
		return -EINVAL;
	if (c->npoints + times > ret->room)
		return -ENOSPC;
	interp_nurbs_copy(c, ret);
	while (times-- > 0)
		insert_one(ret, u);
	return 0;
}

int interp_nurbs_split(const struct interp_nurbs *c, double u,
		       struct interp_nurbs_own *left,
		       struct interp_nurbs_own *right)
{
	const uint32_t p = c->degree;
	const uint32_t times = p - multiplicity(c, u);
	const size_t row = row_of(c);
	uint32_t k, cut;
	int r = interp_nurbs_insert(c, u, times, right);

	if (r < 0)
		return r;
	/* u is knot k - p + 1 ... k, and the curve's point there is @cut. */
	k = interp_nurbs_span(&right->c, u);
	cut = k - p;
	if (cut + 1 > left->room)
		return -ENOSPC;
	own(left, c, p, cut + 1);
	memcpy(left->points, right->points, (cut + 1) * row * sizeof(double));
	memcpy(left->knots, right->knots, (k + 1) * sizeof(double));
	left->knots[k + 1] = u;
	memmove(right->points, right->points + cut * row,
		(right->c.npoints - cut) * row * sizeof(double));
	memmove(right->knots + 1, right->knots + cut + 1,
		(right->c.npoints + p - cut) * sizeof(double));
	right->knots[0] = u;
	right->c.npoints -= cut;
	return 0;
}

/* The blossom of the piece in span @k, for p arguments. */
static void blossom(const struct interp_nurbs *c, uint32_t k,
		    const double *args, double ret[INTERP_NAXES + 1])
{
	const uint32_t p = c->degree;
	const size_t row = row_of(c);
	double d[INTERP_NURBS_ORDER_MAX][INTERP_NAXES + 1];

	for (uint32_t r = 0; r <= p; r++)
		memcpy(d[r], c->points + (k - p + r) * row,
		       row * sizeof(double));
	for (uint32_t j = 1; j <= p; j++) {
		for (uint32_t r = p; r >= j; r--) {
			const double from = c->knots[k - p + r];
			const double to = c->knots[k + r + 1 - j];
			const double a = (args[j - 1] - from) / (to - from);

			for (size_t i = 0; i < row; i++)
				d[r][i] = (1 - a) * d[r - 1][i] + a * d[r][i];
		}
	}
	memcpy(ret, d[p], row * sizeof(double));
}

/* Control point for the p + 1 knots at @knots. */
static void raised_point(const struct interp_nurbs *c, const double *knots,
			 double *ret)
{
	const uint32_t p = c->degree;
	const size_t row = row_of(c);
	double sum[INTERP_NAXES + 1] = { 0 }, one[INTERP_NAXES + 1], middle = 0;
	uint32_t span;

	for (uint32_t i = 0; i <= p; i++)
		middle += knots[i] / (p + 1);
	span = interp_nurbs_span(c, middle);
	for (uint32_t out = 0; out <= p; out++) {
		double args[INTERP_NURBS_ORDER_MAX];
		uint32_t n = 0;

		for (uint32_t i = 0; i <= p; i++) {
			if (i != out)
				args[n++] = knots[i];
		}
		blossom(c, span, args, one);
		for (size_t j = 0; j < row; j++)
			sum[j] += one[j];
	}
	for (size_t j = 0; j < row; j++)
		ret[j] = sum[j] / (p + 1);
}

int interp_nurbs_elevate(const struct interp_nurbs *c,
			 struct interp_nurbs_own *ret)
{
	const uint32_t p = c->degree, n = c->npoints + p + 1;
	uint32_t knots = 0, distinct = 1;

	for (uint32_t i = 1; i < n; i++)
		distinct += c->knots[i] != c->knots[i - 1];
	if (p == INTERP_NURBS_DEGREE_MAX ||
	    c->knots[0] != interp_nurbs_first(c) ||
	    c->knots[n - 1] != interp_nurbs_last(c))
		return -EINVAL;
	if (n + distinct - p - 2 > ret->room)
		return -ENOSPC;
	for (uint32_t i = 0; i < n; i++) {
		ret->knots[knots++] = c->knots[i];
		if (i + 1 == n || c->knots[i + 1] != c->knots[i])
			ret->knots[knots++] = c->knots[i];
	}
	own(ret, c, p + 1, knots - p - 2);
	for (uint32_t i = 0; i < ret->c.npoints; i++)
		raised_point(c, ret->knots + i + 1,
			     ret->points + i * row_of(c));
	return 0;
}
