/* SPDX-License-Identifier: Apache-2.0 */
/*
 * nurbs.c - check a curve, and find its points
 *
 * In a span only p + 1 basis functions are not zero.  The triangle makes them
 * degree by degree,
 *
 *	N_i,j = (u - u_i)/(u_i+j - u_i) N_i,j-1
 *	      + (u_i+j+1 - u)/(u_i+j+1 - u_i+1) N_i+1,j-1
 *
 * and on its way passes those of degree p-1, p-2 and p-3, which are what the
 * derivatives need: the k-th derivative of a B-spline is one of degree p-k
 * whose control points are differences of the ones before.  Those differences,
 * and the reciprocals of the knot distances, are fixed in a span and kept.
 */
#include "curve/span.h"

#include <math.h>

#define WEIGHT_MOST	1e9
#define WEIGHTS_PART	1e4		/* largest divided by smallest */
#define KNOTS_NEAR	1e-9		/* share of the distance from first to
					 * last */

/* -- Check ---------------------------------------------------------------- */

static const char *const flaw_text[INTERP_NURBS_NFLAWS] = {
	[INTERP_NURBS_SOUND]		= "a sound curve",
	[INTERP_NURBS_BAD_DEGREE]	= "a degree out of range",
	[INTERP_NURBS_BAD_AXES]		= "a number of axes out of range",
	[INTERP_NURBS_FEW_POINTS]	= "too few control points for the degree",
	[INTERP_NURBS_MANY_POINTS]	= "too many control points",
	[INTERP_NURBS_NOT_FINITE]	= "a control point that is no number",
	[INTERP_NURBS_BAD_WEIGHT]	= "a weight of zero or less",
	[INTERP_NURBS_WEIGHTS_PART]	=
		"a weight more than 10000 times another",
	[INTERP_NURBS_KNOTS_NEAR]	=
		"a knot too near to the one before it",
	[INTERP_NURBS_KNOT_FALLS]	= "a knot below the one before it",
	[INTERP_NURBS_KNOT_REPEATS]	= "a knot repeated too often",
	[INTERP_NURBS_NO_DOMAIN]	= "knots that span nothing",
};

static const char *const flaw_wanted[INTERP_NURBS_NFLAWS] = {
	[INTERP_NURBS_SOUND]		= "",
	[INTERP_NURBS_BAD_DEGREE]	= "degree 1 to 9 (order 2 to 10)",
	[INTERP_NURBS_BAD_AXES]		= "1 to 8 axes",
	[INTERP_NURBS_FEW_POINTS]	= "degree + 1 control points or more",
	[INTERP_NURBS_MANY_POINTS]	= "up to 16777216 control points",
	[INTERP_NURBS_NOT_FINITE]	= "finite places",
	[INTERP_NURBS_BAD_WEIGHT]	= "weights from 1e-9 to 1e9",
	[INTERP_NURBS_WEIGHTS_PART]	=
		"weights within a factor of 10000 of each other",
	[INTERP_NURBS_KNOTS_NEAR]	=
		("equal knots, or 1e-9 of the way from the first to the last and "
		 "more between them"),
	[INTERP_NURBS_KNOT_FALLS]	= "knots that do not fall",
	[INTERP_NURBS_KNOT_REPEATS]	=
		("a knot at most as often as the order at an end, one time less "
		 "inside"),
	[INTERP_NURBS_NO_DOMAIN]	= "knots that rise between the ends",
};

const char *interp_nurbs_flaw_text(enum interp_nurbs_flaw f)
{
	return flaw_text[f];
}

const char *interp_nurbs_flaw_wanted(enum interp_nurbs_flaw f)
{
	return flaw_wanted[f];
}

static enum interp_nurbs_flaw check_size(const struct interp_nurbs *c)
{
	if (c->degree < 1 || c->degree > INTERP_NURBS_DEGREE_MAX)
		return INTERP_NURBS_BAD_DEGREE;
	if (c->naxes < 1 || c->naxes > INTERP_NAXES || c->counted < 1 ||
	    c->counted > c->naxes)
		return INTERP_NURBS_BAD_AXES;
	if (c->npoints < c->degree + 1)
		return INTERP_NURBS_FEW_POINTS;
	return c->npoints > INTERP_NURBS_POINTS_MAX ? INTERP_NURBS_MANY_POINTS :
						      INTERP_NURBS_SOUND;
}

static enum interp_nurbs_flaw check_points(const struct interp_nurbs *c,
					   uint32_t *ret_at)
{
	double least = WEIGHT_MOST, most = 0;

	for (uint32_t i = 0; i < c->npoints; i++) {
		const double *row = c->points + (size_t)i * (c->naxes + 1);

		*ret_at = i;
		if (!(row[c->naxes] >= 1 / WEIGHT_MOST &&
		      row[c->naxes] <= WEIGHT_MOST))
			return INTERP_NURBS_BAD_WEIGHT;
		least = fmin(least, row[c->naxes]);
		most = fmax(most, row[c->naxes]);
		if (most > WEIGHTS_PART * least * (1 + 1e-9))
			return INTERP_NURBS_WEIGHTS_PART;
		for (uint32_t j = 0; j < c->naxes; j++) {
			if (!isfinite(row[j]))
				return INTERP_NURBS_NOT_FINITE;
		}
	}
	return INTERP_NURBS_SOUND;
}

static bool too_near(const struct interp_nurbs *c, uint32_t i)
{
	const double all = c->knots[c->npoints + c->degree] - c->knots[0];
	const double gap = c->knots[i] - c->knots[i - 1];

	return gap > 0 && gap <= KNOTS_NEAR * all;
}

/* Inside the curve, degree + 1 equal knots would tear it apart. */
static enum interp_nurbs_flaw check_knots(const struct interp_nurbs *c,
					  uint32_t *ret_at)
{
	const uint32_t n = c->npoints + c->degree + 1;
	uint32_t same = 1;

	*ret_at = 0;
	if (!isfinite(c->knots[0]))
		return INTERP_NURBS_KNOT_FALLS;
	for (uint32_t i = 1; i < n; i++) {
		*ret_at = i;
		if (!(c->knots[i] >= c->knots[i - 1] && isfinite(c->knots[i])))
			return INTERP_NURBS_KNOT_FALLS;
		same = c->knots[i] == c->knots[i - 1] ? same + 1 : 1;
		if (same > c->degree + 1 ||
		    (same > c->degree && c->knots[i] != c->knots[0] &&
		     c->knots[i] != c->knots[n - 1]))
			return INTERP_NURBS_KNOT_REPEATS;
	}
	for (uint32_t i = 1; i < n; i++) {
		*ret_at = i;
		if (too_near(c, i))
			return INTERP_NURBS_KNOTS_NEAR;
	}
	return interp_nurbs_first(c) < interp_nurbs_last(c) ?
	       INTERP_NURBS_SOUND : INTERP_NURBS_NO_DOMAIN;
}

enum interp_nurbs_flaw interp_nurbs_check(const struct interp_nurbs *c,
					  uint32_t *ret_at)
{
	enum interp_nurbs_flaw f = check_size(c);

	*ret_at = 0;
	if (f == INTERP_NURBS_SOUND)
		f = check_points(c, ret_at);
	return f == INTERP_NURBS_SOUND ? check_knots(c, ret_at) : f;
}

/* -- Spans ---------------------------------------------------------------- */

uint32_t interp_nurbs_span(const struct interp_nurbs *c, double u)
{
	uint32_t low = c->degree, high = c->npoints;

	/* The end belongs to the last span that is not empty. */
	if (u >= c->knots[high]) {
		while (c->knots[high - 1] == c->knots[high] &&
		       high - 1 > c->degree)
			high--;
		return high - 1;
	}
	while (high - low > 1) {
		const uint32_t middle = low + (high - low) / 2;

		if (c->knots[middle] <= u)
			low = middle;
		else
			high = middle;
	}
	while (c->knots[low] == c->knots[low + 1] && low + 1 < c->npoints)
		low++;
	return low;
}

static void load_points(struct interp_nurbs_eval *e)
{
	const struct interp_nurbs *c = &e->c;
	const size_t row = c->naxes + 1;

	for (uint32_t r = 0; r <= c->degree; r++) {
		const double *from = c->points +
				     (e->span - c->degree + r) * row;

		for (uint32_t j = 0; j < INTERP_NAXES; j++)
			e->point[0][r][j] = j < c->naxes ? from[j] : 0;
		e->weight[0][r] = from[c->naxes];
	}
}

/* Make the control points of the k-th derivative from those of the previous
 * one. */
static void load_derivative(struct interp_nurbs_eval *e, uint32_t k)
{
	const struct interp_nurbs *c = &e->c;
	const double *knot = c->knots + (e->span - c->degree);

	for (uint32_t r = 0; r <= c->degree - k; r++) {
		const double by = (c->degree - k + 1) /
				  (knot[r + c->degree + 1] - knot[r + k]);

		for (uint32_t j = 0; j < INTERP_NAXES; j++)
			e->point[k][r][j] = by * (e->point[k - 1][r + 1][j] -
						  e->point[k - 1][r][j]);
		e->weight[k][r] = by * (e->weight[k - 1][r + 1] -
					e->weight[k - 1][r]);
	}
}

void nurbs_span_enter(struct interp_nurbs_eval *e, uint32_t span)
{
	const double *knots = e->c.knots;
	double *gap = e->gap;

	e->span = span;
	e->from = knots[span];
	e->to = knots[span + 1];
	for (uint32_t j = 1; j <= e->c.degree; j++) {
		for (uint32_t r = 0; r < j; r++)
			*gap++ = 1 / (knots[span + r + 1] -
				      knots[span + 1 - j + r]);
	}
	load_points(e);
	for (uint32_t k = 1; k <= INTERP_NURBS_DERIVS && k <= e->c.degree; k++)
		load_derivative(e, k);
}

void interp_nurbs_open(struct interp_nurbs_eval *e,
		       const struct interp_nurbs *c)
{
	e->c = *c;
	nurbs_span_enter(e, interp_nurbs_span(c, interp_nurbs_first(c)));
}

uint32_t nurbs_basis(const struct interp_nurbs *c, double u,
		     double n[INTERP_NURBS_ORDER_MAX],
		     double d[INTERP_NURBS_ORDER_MAX])
{
	const uint32_t p = c->degree, span = interp_nurbs_span(c, u);
	const double *knot = c->knots + span;

	n[0] = 1;
	for (uint32_t j = 1; j <= p; j++) {
		double saved = 0, slope = 0;

		for (uint32_t r = 0; r < j; r++) {
			const double low = *(knot + 1 + r - j);
			const double t = n[r] / (knot[r + 1] - low);

			d[r] = slope - p * t;
			slope = p * t;
			n[r] = saved + (knot[r + 1] - u) * t;
			saved = (u - low) * t;
		}
		d[j] = slope;
		n[j] = saved;
	}
	return span - p;
}

/* -- Points --------------------------------------------------------------- */

/* The basis functions of degree p - k, for every k that is asked for. */
struct basis {
	double of[INTERP_NURBS_DERIVS + 1][INTERP_NURBS_ORDER_MAX];
};

static void basis_at(const struct interp_nurbs_eval *e, double u, int derivs,
		     struct basis *ret)
{
	const uint32_t p = e->c.degree;
	const double *knot = e->c.knots + e->span;
	const double *gap = e->gap;
	double n[INTERP_NURBS_ORDER_MAX] = { 1 };

	for (uint32_t j = 1; j <= p; j++) {
		double saved = 0;

		if (p - j < (uint32_t)derivs) {
			for (uint32_t r = 0; r < j; r++)
				ret->of[p - j + 1][r] = n[r];
		}
		for (uint32_t r = 0; r < j; r++) {
			const double t = n[r] * *gap++;

			n[r] = saved + (knot[r + 1] - u) * t;
			saved = (u - *(knot + 1 + r - j)) * t;
		}
		n[j] = saved;
	}
	for (uint32_t r = 0; r <= p; r++)
		ret->of[0][r] = n[r];
}

/* The sums over the basis: A of the places, w of the weights. */
static double sum_of(const struct interp_nurbs_eval *e,
		     const struct basis *n, uint32_t k,
		     double ret[INTERP_NAXES])
{
	double sum[INTERP_NAXES] = { 0 }, weight = 0;

	for (uint32_t r = 0; r + k <= e->c.degree; r++) {
		const double by = n->of[k][r];

		for (int j = 0; j < INTERP_NAXES; j++)
			sum[j] += by * e->point[k][r][j];
		weight += by * e->weight[k][r];
	}
	for (int j = 0; j < INTERP_NAXES; j++)
		ret[j] = sum[j];
	return weight;
}

/* From A = w C: C^(k) = (A^(k) - sum of binom(k, i) w^(i) C^(k-i)) / w. */
static void divide(struct interp_nurbs_point *p, const double *w, int k)
{
	static const double binom[][INTERP_NURBS_DERIVS + 1] = {
		{ 1 }, { 1, 1 }, { 1, 2, 1 }, { 1, 3, 3, 1 }
	};
	const double by = 1 / w[0];

	for (int i = 1; i <= k; i++) {
		const double b = binom[k][i] * w[i];

		for (int j = 0; j < INTERP_NAXES; j++)
			p->d[k][j] -= b * p->d[k - i][j];
	}
	for (int j = 0; j < INTERP_NAXES; j++)
		p->d[k][j] *= by;
}

void nurbs_span_at(const struct interp_nurbs_eval *e, double u, int derivs,
		   struct interp_nurbs_point *ret)
{
	double w[INTERP_NURBS_DERIVS + 1];
	struct basis n;

	basis_at(e, u, derivs, &n);
	for (int k = 0; k <= derivs; k++) {
		w[k] = sum_of(e, &n, (uint32_t)k, ret->d[k]);
		divide(ret, w, k);
	}
}

void interp_nurbs_at(struct interp_nurbs_eval *e, double u, int derivs,
		     struct interp_nurbs_point *ret)
{
	const double first = interp_nurbs_first(&e->c);
	const double last = interp_nurbs_last(&e->c);

	u = u > first ? u : first;
	u = u < last ? u : last;
	if (u < e->from || (u >= e->to && e->to < last))
		nurbs_span_enter(e, interp_nurbs_span(&e->c, u));
	nurbs_span_at(e, u, derivs, ret);
}
