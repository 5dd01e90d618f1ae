/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fit.c - one curve for many points, within a tolerance
 *
 * It is a least squares problem with fixed ends.  The normal equations have a
 * band of seven, so the cost of a round is proportional to the number of
 * points.  Knots are at points, but never at the second point nor at the last
 * but one.  So even with a knot at all others there are as many unknowns as
 * points, and each unknown has a point in its support.
 */
#include "interp/nurbs_fit.h"

#include "curve/span.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define P	3			/* degree */
#define BAND	(P + 1)			/* diagonal and those beside it */
#define ROUNDS	16
#define BETWEEN	8			/* a line is checked at its eighths */

struct work {
	const struct interp_fit *f;
	struct interp_nurbs_own *o;
	double *t;			/* parameter of each point */
	uint32_t *knot;			/* points that have one, increasing */
	uint32_t nknots;		/* both ends are included */
	double (*m)[BAND];		/* of the inner control points */
	double *rhs;			/* rows of naxes */
	bool *bad;			/* between knot i and i + 1 */
};

static const double *point(const struct interp_fit *f, uint32_t i)
{
	return f->points + (size_t)i * f->naxes;
}

static double distance(const struct interp_fit *f, const double *a,
		       const double *b)
{
	double sum = 0;

	for (uint32_t j = 0; j < f->naxes; j++)
		sum += (a[j] - b[j]) * (a[j] - b[j]);
	return sqrt(sum);
}

/* At a bend of angle a between lines of length L, a circle rises L a / 8 above
 * them. */
bool interp_fit_corner(const struct interp_fit *f, uint32_t at)
{
	const double *p = point(f, at);
	const double before = distance(f, p, point(f, at - 1));
	const double after = distance(f, point(f, at + 1), p);
	double dot = 0, cosine;

	for (uint32_t j = 0; j < f->naxes; j++)
		dot += (p[j] - point(f, at - 1)[j]) *
		       (point(f, at + 1)[j] - p[j]);
	cosine = fmin(fmax(dot / (before * after), -1), 1);
	return fmax(before, after) * acos(cosine) / 8 > f->tolerance_mm;
}

/* -- The system ----------------------------------------------------------- */

static void set_knots(struct work *w)
{
	struct interp_nurbs *c = &w->o->c;
	double *k = w->o->knots;
	uint32_t n = 0;

	for (int i = 0; i < P; i++)
		k[n++] = 0;
	for (uint32_t i = 0; i < w->nknots; i++)
		k[n++] = w->t[w->knot[i]];
	for (int i = 0; i < P; i++)
		k[n++] = w->t[w->f->npoints - 1];
	*c = (struct interp_nurbs) {
		.degree = P, .naxes = w->f->naxes, .counted = w->f->naxes,
		.npoints = w->nknots + P - 1, .knots = k,
		.points = w->o->points,
	};
}

/* Add the part of one point.  Control points 0 and last are known. */
static void add_point(struct work *w, uint32_t i)
{
	const struct interp_fit *f = w->f;
	const uint32_t last = w->o->c.npoints - 1;
	double n[INTERP_NURBS_ORDER_MAX], d[INTERP_NURBS_ORDER_MAX];
	double rest[INTERP_NAXES];
	const uint32_t first = nurbs_basis(&w->o->c, w->t[i], n, d);

	for (uint32_t j = 0; j < f->naxes; j++)
		rest[j] = point(f, i)[j] -
			  (first == 0 ? n[0] * point(f, 0)[j] : 0) -
			  (first + P == last ?
			   n[P] * point(f, f->npoints - 1)[j] : 0);
	for (uint32_t r = 0; r <= P; r++) {
		const uint32_t row = first + r - 1;

		if (first + r == 0 || first + r == last)
			continue;
		for (uint32_t k = r; k <= P && first + k != last; k++)
			w->m[row][k - r] += n[r] * n[k];
		for (uint32_t j = 0; j < f->naxes; j++)
			w->rhs[row * f->naxes + j] += n[r] * rest[j];
	}
}

/* Cholesky, L in place; false if the matrix is not definite. */
static bool factor(double (*m)[BAND], uint32_t n)
{
	for (uint32_t i = 0; i < n; i++) {
		if (!(m[i][0] > 1e-14))
			return false;
		m[i][0] = sqrt(m[i][0]);
		for (uint32_t k = 1; k < BAND; k++)
			m[i][k] /= m[i][0];
		for (uint32_t k = 1; k < BAND && i + k < n; k++) {
			for (uint32_t l = k; l < BAND; l++)
				m[i + k][l - k] -= m[i][k] * m[i][l];
		}
	}
	return true;
}

static void solve(const struct work *w, uint32_t n)
{
	const uint32_t axes = w->f->naxes;

	for (uint32_t j = 0; j < axes; j++) {
		double *x = w->rhs + j;

		for (uint32_t i = 0; i < n; i++) {
			x[i * axes] /= w->m[i][0];
			for (uint32_t k = 1; k < BAND && i + k < n; k++)
				x[(i + k) * axes] -= w->m[i][k] * x[i * axes];
		}
		for (uint32_t i = n; i-- > 0; ) {
			for (uint32_t k = 1; k < BAND && i + k < n; k++)
				x[i * axes] -= w->m[i][k] * x[(i + k) * axes];
			x[i * axes] /= w->m[i][0];
		}
	}
}

static void keep_point(struct work *w, uint32_t i, const double *from)
{
	double *to = w->o->points + (size_t)i * (w->f->naxes + 1);

	memcpy(to, from, w->f->naxes * sizeof(*to));
	to[w->f->naxes] = 1;
}

static bool least_squares(struct work *w)
{
	const struct interp_fit *f = w->f;
	uint32_t inner;

	set_knots(w);
	inner = w->o->c.npoints - 2;
	memset(w->m, 0, inner * sizeof(*w->m));
	memset(w->rhs, 0, (size_t)inner * f->naxes * sizeof(*w->rhs));
	for (uint32_t i = 1; i + 1 < f->npoints; i++)
		add_point(w, i);
	if (!factor(w->m, inner))
		return false;
	solve(w, inner);
	keep_point(w, 0, point(f, 0));
	for (uint32_t i = 0; i < inner; i++)
		keep_point(w, i + 1, w->rhs + (size_t)i * f->naxes);
	keep_point(w, inner + 1, point(f, f->npoints - 1));
	return true;
}

/* -- How near it is, and where a knot is missing
 * ---------------------------- */

static double off_line(const struct interp_fit *f, const double *p,
		       const double *a, const double *b)
{
	double along = 0, ab2 = 0, foot[INTERP_NAXES];

	for (uint32_t j = 0; j < f->naxes; j++) {
		along += (p[j] - a[j]) * (b[j] - a[j]);
		ab2 += (b[j] - a[j]) * (b[j] - a[j]);
	}
	along = fmin(fmax(along / ab2, 0), 1);
	for (uint32_t j = 0; j < f->naxes; j++)
		foot[j] = a[j] + along * (b[j] - a[j]);
	return distance(f, p, foot);
}

static bool near_at(struct work *w, struct interp_nurbs_eval *e, uint32_t i)
{
	const struct interp_fit *f = w->f;
	struct interp_nurbs_point p;

	interp_nurbs_at(e, w->t[i], 0, &p);
	if (distance(f, p.d[0], point(f, i)) > f->tolerance_mm)
		return false;
	if (i + 1 == f->npoints)
		return true;
	for (int n = 1; n < BETWEEN; n++) {
		interp_nurbs_at(e, w->t[i] + (w->t[i + 1] - w->t[i]) * n /
					     BETWEEN, 0, &p);
		if (off_line(f, p.d[0], point(f, i), point(f, i + 1)) >
		    f->tolerance_mm)
			return false;
	}
	return true;
}

/* Mark the spans that are too far off.  Return: how many there are. */
static uint32_t judge(struct work *w)
{
	struct interp_nurbs_eval e;
	uint32_t bad = 0, span = 0;

	memset(w->bad, 0, w->nknots * sizeof(*w->bad));
	interp_nurbs_open(&e, &w->o->c);
	for (uint32_t i = 0; i < w->f->npoints; i++) {
		if (span + 2 < w->nknots && i >= w->knot[span + 1])
			span++;
		if (!w->bad[span] && !near_at(w, &e, i)) {
			w->bad[span] = true;
			bad++;
		}
	}
	return bad;
}

/* Add a knot in the middle of every marked span; false if none has room. */
static bool add_knots(struct work *w)
{
	const uint32_t most = w->f->npoints - 3, was = w->nknots;
	uint32_t *more = w->knot + w->f->npoints;
	uint32_t n = 0;

	for (uint32_t i = 0; i < was; i++) {
		const uint32_t a = w->knot[i];
		uint32_t middle;

		more[n++] = a;
		if (i + 1 == was || !w->bad[i])
			continue;
		middle = (a + w->knot[i + 1]) / 2;
		middle = middle < 2 ? 2 : middle;
		middle = middle > most ? most : middle;
		if (middle > a && middle < w->knot[i + 1])
			more[n++] = middle;
	}
	memcpy(w->knot, more, n * sizeof(*more));
	w->nknots = n;
	return n > was;
}

static int fit(struct work *w)
{
	w->t[0] = 0;
	for (uint32_t i = 1; i < w->f->npoints; i++)
		w->t[i] = w->t[i - 1] + distance(w->f, point(w->f, i),
						 point(w->f, i - 1));
	w->knot[0] = 0;
	w->knot[1] = w->f->npoints - 1;
	w->nknots = 2;
	for (int i = 0; i < ROUNDS; i++) {
		if (!least_squares(w))
			return -ERANGE;
		if (judge(w) == 0)
			return 0;
		if (!add_knots(w))
			return -ERANGE;
	}
	return -ERANGE;
}

int interp_nurbs_fit(const struct interp_fit *f, struct interp_nurbs_own *ret)
{
	const size_t n = f->npoints;
	struct work w = { .f = f, .o = ret };
	int err = -ENOMEM;

	if (f->npoints < INTERP_FIT_POINTS_MIN ||
	    f->npoints > INTERP_FIT_POINTS_MAX || ret->room < f->npoints)
		return -ERANGE;
	w.t = malloc(n * sizeof(*w.t));
	w.knot = malloc(2 * n * sizeof(*w.knot));
	w.m = malloc(n * sizeof(*w.m));
	w.rhs = malloc(n * f->naxes * sizeof(*w.rhs));
	w.bad = malloc(n * sizeof(*w.bad));
	if (w.t && w.knot && w.m && w.rhs && w.bad)
		err = fit(&w);
	free(w.t);
	free(w.knot);
	free(w.m);
	free(w.rhs);
	free(w.bad);
	return err;
}
