/* SPDX-License-Identifier: Apache-2.0 */
/*
 * nurbs_sisl.c - random curves evaluated here and by SISL
 *
 *	nurbs_sisl CURVES SEED
 *
 * Prints the largest difference of points, by the 100 mm they lie within, and
 * of each derivative, by its own size, or that of 100 mm over the knot span if
 * that is more.
 */
#include "interp/nurbs.h"
#include "random_curve.h"

#include <sisl.h>
#include <stdio.h>
#include <stdlib.h>

#define PLACES	4

static double worst[INTERP_NURBS_DERIVS + 1];

/* What the k-th derivative is measured by. */
static double scale_of(const struct interp_nurbs_eval *e,
		       const struct interp_nurbs_point *p, int k)
{
	double most = 100 / pow(e->to - e->from, k);

	for (uint32_t j = 0; j < e->c.naxes; j++)
		most = fmax(most, fabs(p->d[k][j]));
	return most;
}

static void compare(const struct interp_nurbs_eval *e,
		    const struct interp_nurbs_point *p, const double *theirs)
{
	const uint32_t naxes = e->c.naxes;

	for (int k = 0; k <= INTERP_NURBS_DERIVS; k++) {
		const double by = scale_of(e, p, k);

		for (uint32_t j = 0; j < naxes; j++) {
			const double d = p->d[k][j] -
					 theirs[(uint32_t)k * naxes + j];

			worst[k] = fmax(worst[k], fabs(d) / by);
		}
	}
}

static void one_curve(uint64_t *s)
{
	double theirs[(INTERP_NURBS_DERIVS + 1) * INTERP_NAXES];
	struct interp_nurbs_eval e;
	struct interp_nurbs_point p;
	struct random_curve r;
	SISLCurve *c;

	random_curve(s, &r);
	interp_nurbs_open(&e, &r.c);
	c = newCurve((int)r.c.npoints, (int)r.c.degree + 1, r.knots, r.points,
		     2, (int)r.c.naxes, 1);
	if (!c)
		exit(1);
	for (int i = 0; i < PLACES; i++) {
		const double u = curve_uniform(s, 0, 1);
		int left = 0, status;

		s1221(c, INTERP_NURBS_DERIVS, u, &left, theirs, &status);
		if (status < 0)
			exit(1);
		interp_nurbs_at(&e, u, INTERP_NURBS_DERIVS, &p);
		compare(&e, &p, theirs);
	}
	freeCurve(c);
}

int main(int argc, char **argv)
{
	const long curves = argc > 1 ? strtol(argv[1], NULL, 10) : 1000;
	uint64_t s = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;

	for (long i = 0; i < curves; i++)
		one_curve(&s);
	for (int k = 0; k <= INTERP_NURBS_DERIVS; k++)
		printf("derivative-%d %.3g\n", k, worst[k]);
	return 0;
}
