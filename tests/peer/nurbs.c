/* SPDX-License-Identifier: Apache-2.0 */
/*
 * nurbs.c - random curves and points of them, for a comparison in Python
 *
 *	nurbs CURVES SEED
 *
 * Prints for each curve: a line of degree, axes, control points; a line of
 * knots; a line of control points times weights, and weights; a line of u and
 * the point and first derivative there.
 */
#include "interp/nurbs.h"
#include "random_curve.h"

#include <stdio.h>
#include <stdlib.h>

static void print_row(const double *x, uint32_t n)
{
	for (uint32_t i = 0; i < n; i++)
		printf("%.17g ", x[i]);
	printf("\n");
}

int main(int argc, char **argv)
{
	const long curves = argc > 1 ? strtol(argv[1], NULL, 10) : 1000;
	uint64_t s = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;

	for (long i = 0; i < curves; i++) {
		struct interp_nurbs_eval e;
		struct interp_nurbs_point p;
		struct random_curve r;
		double u;

		random_curve(&s, &r);
		u = curve_uniform(&s, 0, 1);
		interp_nurbs_open(&e, &r.c);
		interp_nurbs_at(&e, u, 1, &p);
		printf("%u %u %u\n", r.c.degree, r.c.naxes, r.c.npoints);
		print_row(r.knots, r.c.npoints + r.c.degree + 1);
		print_row(r.points, r.c.npoints * (r.c.naxes + 1));
		printf("%.17g ", u);
		print_row(p.d[0], r.c.naxes);
		print_row(p.d[1], r.c.naxes);
	}
	return 0;
}
