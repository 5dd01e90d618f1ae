/* SPDX-License-Identifier: Apache-2.0 */
/*
 * curves.h - three plane curves from the literature, for tests and experiments
 *
 * A row has x, y in mm and the weight.
 */
#ifndef DATA_CURVES_H
#define DATA_CURVES_H

#include "interp/nurbs.h"

#define CURVES_POINTS_MAX	51

struct curve_data {
	const char *name;
	uint32_t degree, npoints;
	const double *knots;
	const double (*points)[3];
};

/* clang-format off */
/* Circle: radius 50, degree 2, 9 points, exact; Piegl and Tiller, The NURBS
 * Book. */
static const double circle_knots[] = {
	0, 0, 0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1, 1, 1
};

static const double circle_points[][3] = {
	{ 50, 0, 1 }, { 50, 50, 0.7071067811865476 }, { 0, 50, 1 },
	{ -50, 50, 0.7071067811865476 }, { -50, 0, 1 },
	{ -50, -50, 0.7071067811865476 }, { 0, -50, 1 },
	{ 50, -50, 0.7071067811865476 }, { 50, 0, 1 }
};

/* Infinity: degree 2, 7 points; Yeh and Hsu, The speed-controlled interpolator
 * for machining parametric curves, 1999. */
static const double infinity_knots[] = {
	0, 0, 0, 0.25, 0.5, 0.5, 0.75, 1, 1, 1
};

static const double infinity_points[][3] = {
	{ 0, 0, 1 }, { -150, -150, 25 }, { -150, 150, 25 }, { 0, 0, 1 },
	{ 150, -150, 25 }, { 150, 150, 25 }, { 0, 0, 1 }
};

/* Butterfly: degree 3, 51 points; the test curve of the NURBS interpolation
 * literature.  The points as published are symmetric to 0.3 mm only. */
static const double butterfly_knots[] = {
	0, 0, 0, 0, 0.0083, 0.015, 0.0361, 0.0855, 0.1293, 0.1509, 0.1931,
	0.2273, 0.2435, 0.2561, 0.2692, 0.2889, 0.317, 0.3316, 0.3482,
	0.3553, 0.3649, 0.3837, 0.4005, 0.4269, 0.451, 0.466, 0.4891, 0.5,
	0.5109, 0.534, 0.5489, 0.5731, 0.5994, 0.6163, 0.6351, 0.6447,
	0.6518, 0.6683, 0.683, 0.7111, 0.7307, 0.7439, 0.7565, 0.7729,
	0.8069, 0.8491, 0.8707, 0.9145, 0.9639, 0.985, 0.9917, 1, 1, 1, 1
};

static const double butterfly_points[][3] = {
	{ 54.493, 52.139, 1 }, { 55.507, 52.139, 1 }, { 56.082, 49.615, 1 },
	{ 56.78, 44.971, 1.2 }, { 69.575, 51.358, 1 }, { 77.786, 58.573, 1 },
	{ 90.526, 67.081, 1 }, { 105.973, 63.801, 1 }, { 100.4, 47.326, 1 },
	{ 94.567, 39.913, 1 }, { 92.369, 30.485, 1 }, { 83.44, 33.757, 2 },
	{ 91.892, 28.509, 1 }, { 89.444, 20.393, 1 }, { 83.218, 15.446, 5 },
	{ 87.621, 4.83, 3 }, { 80.945, 9.267, 1 }, { 79.834, 14.535, 1.1 },
	{ 76.074, 8.522, 1 }, { 70.183, 12.55, 1 }, { 64.171, 16.865, 1 },
	{ 59.993, 22.122, 1 }, { 55.68, 36.359, 1 }, { 56.925, 24.995, 1 },
	{ 59.765, 19.828, 1 }, { 54.493, 14.94, 1 }, { 49.22, 19.828, 1 },
	{ 52.06, 24.994, 1 }, { 53.305, 36.359, 1 }, { 48.992, 22.122, 1 },
	{ 44.814, 16.865, 1 }, { 38.802, 12.551, 1 }, { 32.911, 8.521, 1 },
	{ 29.152, 14.535, 1.1 }, { 28.04, 9.267, 1 }, { 21.364, 4.83, 3 },
	{ 25.768, 15.447, 5 }, { 19.539, 20.391, 1 }, { 17.097, 28.512, 1 },
	{ 25.537, 33.75, 2 }, { 16.602, 30.496, 1 }, { 14.199, 39.803, 1 },
	{ 8.668, 47.408, 1 }, { 3, 63.794, 1 }, { 18.465, 67.084, 1 },
	{ 31.197, 58.572, 1 }, { 39.411, 51.358, 1 },
	{ 52.204, 44.971, 1.2 }, { 52.904, 49.614, 1 },
	{ 53.478, 52.139, 1 }, { 54.492, 52.139, 1 }
};

static const struct curve_data curves_data[] = {
	{ "circle", 2, 9, circle_knots, circle_points },
	{ "infinity", 2, 7, infinity_knots, infinity_points },
	{ "butterfly", 3, 51, butterfly_knots, butterfly_points },
};
/* clang-format on */

#define NCURVES	(sizeof(curves_data) / sizeof(curves_data[0]))

/** curve_load() - @ret with @points, room for it, as its control points. */
static inline void curve_load(const struct curve_data *d,
			      double points[CURVES_POINTS_MAX][3],
			      struct interp_nurbs *ret)
{
	for (uint32_t i = 0; i < d->npoints; i++) {
		points[i][0] = d->points[i][0] * d->points[i][2];
		points[i][1] = d->points[i][1] * d->points[i][2];
		points[i][2] = d->points[i][2];
	}
	*ret = (struct interp_nurbs) {
		.degree = d->degree, .naxes = 2, .npoints = d->npoints,
		.counted = 2, .knots = d->knots, .points = points[0],
	};
}

#endif /* DATA_CURVES_H */
