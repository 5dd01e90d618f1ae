/* SPDX-License-Identifier: Apache-2.0 */
/* spline.c - read a rational B-spline and evaluate it (de Boor) */
#include "contour_try.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>

#define FILE_NAME	"tests/experiments/curves.json"

#define DEGREE_MAX	5

/* b[d][j]: the function span - d + j of degree d; those beside it are 0. */
struct basis {
	int at;				/* the span it is for */
	double b[DEGREE_MAX + 1][DEGREE_MAX + 3];
};

static int span(const struct spline *c, double u)
{
	int i = c->degree;

	while (i < c->n - 1 && u >= c->knot[i + 1])
		i++;
	return i;
}

static double divide(double a, double b)
{
	return b > 0 ? a / b : 0;
}

/* By the recursion of Cox and de Boor. */
static void basis_at(const struct spline *c, int at, double u, struct basis *r)
{
	const double *k = c->knot;

	*r = (struct basis) { .at = at, .b = { { 1 } } };
	for (int d = 1; d <= c->degree; d++)
		for (int j = 0; j <= d; j++) {
			const int i = at - d + j;

			r->b[d][j] = divide(u - k[i], k[i + d] - k[i]) *
				     (j ? r->b[d - 1][j - 1] : 0) +
				     divide(k[i + d + 1] - u,
					    k[i + d + 1] - k[i + 1]) *
				     r->b[d - 1][j];
		}
}

/* Derivative of @order of function j of degree d. */
static double slope(const struct spline *c, const struct basis *b, int d,
		    int j, int order)
{
	const double *k = c->knot;
	const int i = b->at - d + j;

	if (j < 0 || j > d)
		return 0;
	if (order == 0)
		return b->b[d][j];
	return d * (divide(slope(c, b, d - 1, j - 1, order - 1),
			   k[i + d] - k[i]) -
		    divide(slope(c, b, d - 1, j, order - 1),
			   k[i + d + 1] - k[i + 1]));
}

void spline_at(const struct spline *c, double u, double ret[3][2])
{
	const int at = span(c, u), p = c->degree;
	double h[3][3] = { { 0 } };
	struct basis b;

	basis_at(c, at, u, &b);
	for (int j = 0; j <= p; j++)
		for (int d = 0; d < 3 && d <= p; d++) {
			const double n = slope(c, &b, p, j, d);

			for (int k = 0; k < 3; k++)
				h[d][k] += n * c->point[at - p + j][k];
		}
	for (int k = 0; k < 2; k++) {
		ret[0][k] = h[0][k] / h[0][2];
		ret[1][k] = (h[1][k] - h[1][2] * ret[0][k]) / h[0][2];
		ret[2][k] = (h[2][k] - 2 * h[1][2] * ret[1][k] -
			     h[2][2] * ret[0][k]) / h[0][2];
	}
}

static void point_at(const void *arg, double u, struct interp_contour_point *p)
{
	double d[3][2];

	spline_at(arg, u, d);
	for (int k = 0; k < 2; k++) {
		p->mm[k] = d[0][k];
		p->per_u[k] = d[1][k];
	}
}

void spline_load(struct spline *c, const char *name)
{
	json_error_t e;
	json_t *file = json_load_file(FILE_NAME, 0, &e);
	const json_t *j = json_object_get(file, name);
	const json_t *points = json_object_get(j, "points");
	const json_t *weights = json_object_get(j, "weights");
	const json_t *knots = json_object_get(j, "knots");

	if (!knots) {
		fprintf(stderr, "%s: no curve %s: %s\n", FILE_NAME, name,
			file ? "not in it" : e.text);
		exit(1);
	}
	*c = (struct spline) {
		.degree = (int)json_integer_value(json_object_get(j, "degree")),
		.n = (int)json_array_size(points),
	};
	for (size_t i = 0; i < json_array_size(knots); i++)
		c->knot[i] = json_number_value(json_array_get(knots, i));
	for (int i = 0; i < c->n; i++) {
		const json_t *p = json_array_get(points, (size_t)i);
		const double w = json_number_value(json_array_get(weights,
								  (size_t)i));

		for (size_t k = 0; k < 2; k++)
			c->point[i][k] = w *
				json_number_value(json_array_get(p, k));
		c->point[i][2] = w;
	}
	c->path = (struct interp_contour_path) {
		c, point_at, c->knot[c->degree], c->knot[c->n], 2
	};
	json_decref(file);
}
