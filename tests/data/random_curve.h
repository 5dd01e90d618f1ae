/* SPDX-License-Identifier: Apache-2.0 */
/*
 * random_curve.h - random NURBS of every degree and number of axes
 */
#ifndef DATA_RANDOM_CURVE_H
#define DATA_RANDOM_CURVE_H

#include "interp/nurbs.h"

#include <math.h>

#define RANDOM_POINTS_MAX	24

struct random_curve {
	struct interp_nurbs c;
	double knots[RANDOM_POINTS_MAX + INTERP_NURBS_ORDER_MAX];
	double points[RANDOM_POINTS_MAX * (INTERP_NAXES + 1)];
};

static inline uint64_t curve_rnd(uint64_t *s)
{
	uint64_t z = *s += 0x9e3779b97f4a7c15u;

	z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
	z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
	return z ^ (z >> 31);
}

static inline double curve_uniform(uint64_t *s, double lo, double hi)
{
	return lo + (hi - lo) * (double)(curve_rnd(s) >> 11) * 0x1p-53;
}

/* Clamped from 0 to 1; inside, knots stand up to degree times. */
static inline void random_knots(uint64_t *s, struct random_curve *r)
{
	const uint32_t p = r->c.degree, n = r->c.npoints;
	double sum = 0;
	uint32_t same = 0;

	for (uint32_t i = 0; i <= p; i++)
		r->knots[i] = 0;
	for (uint32_t i = p + 1; i < n; i++) {
		const bool again = i > p + 1 && same + 1 < p &&
				   curve_rnd(s) % 4 == 0;

		same = again ? same + 1 : 0;
		sum += again ? 0 : curve_uniform(s, 0.05, 1);
		r->knots[i] = sum;
	}
	sum += curve_uniform(s, 0.05, 1);
	for (uint32_t i = p + 1; i < n; i++)
		r->knots[i] /= sum;
	for (uint32_t i = n; i <= n + p; i++)
		r->knots[i] = 1;
}

/* Weights from 0.1 to 10, places within 100 mm. */
static inline void random_curve(uint64_t *s, struct random_curve *r)
{
	r->c = (struct interp_nurbs) {
		.degree = 1 + (uint32_t)(curve_rnd(s) %
					 INTERP_NURBS_DEGREE_MAX),
		.naxes = 1 + (uint32_t)(curve_rnd(s) % INTERP_NAXES),
		.knots = r->knots, .points = r->points,
	};
	r->c.counted = r->c.naxes;
	r->c.npoints = r->c.degree + 1 + (uint32_t)(curve_rnd(s) % 12);
	random_knots(s, r);
	for (uint32_t i = 0; i < r->c.npoints; i++) {
		double *row = r->points + i * (r->c.naxes + 1);
		const double w = pow(10, curve_uniform(s, -1, 1));

		for (uint32_t j = 0; j < r->c.naxes; j++)
			row[j] = w * curve_uniform(s, -100, 100);
		row[r->c.naxes] = w;
	}
}

#endif /* DATA_RANDOM_CURVE_H */
