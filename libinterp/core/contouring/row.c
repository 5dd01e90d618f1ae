/* SPDX-License-Identifier: Apache-2.0 */
/* row.c - the last targets as a path of chords */
#include "interp/row.h"

#include <math.h>
#include <string.h>

#define LOOK_MM		0.02
#define SAME_MM		1e-7

static const double *point(const struct interp_row *r, uint64_t i)
{
	return r->mm[i % INTERP_ROW_POINTS];
}

/* u counts the points. */
static void chord_at(const void *arg, double u,
		     struct interp_contour_point *ret)
{
	const struct interp_row *r = arg;
	const double last = (double)(r->n - 2);
	const double from = fmin(floor(u), last), part = u - from;
	const double *a = point(r, (uint64_t)from);
	const double *b = point(r, (uint64_t)from + 1);

	for (int i = 0; i < r->path.naxes; i++) {
		ret->mm[i] = a[i] + part * (b[i] - a[i]);
		ret->per_u[i] = b[i] - a[i];
	}
}

static size_t bytes(const struct interp_row *r)
{
	return (size_t)r->path.naxes * sizeof(double);
}

void interp_row_begin(struct interp_row *r, int naxes, const double *mm)
{
	r->n = 1;
	r->path = (struct interp_contour_path) {
		.arg = r, .at = chord_at, .naxes = naxes
	};
	memcpy(r->mm[0], mm, bytes(r));
}

void interp_row_foot(const struct interp_row *r, struct interp_contour *foot)
{
	interp_contour_begin(foot, &r->path, r->path.u_max, LOOK_MM);
}

static double way_mm(const struct interp_row *r, const double *a,
		     const double *b)
{
	double square = 0;

	for (int i = 0; i < r->path.naxes; i++)
		square += (a[i] - b[i]) * (a[i] - b[i]);
	return sqrt(square);
}

/* The last point moves with the targets until its chord is long enough. */
void interp_row_take(struct interp_row *r, const double *mm)
{
	const uint64_t last = r->n - 1;

	if (way_mm(r, point(r, last), mm) < SAME_MM)
		return;
	if (last > 0 && way_mm(r, point(r, last - 1), point(r, last)) <
				INTERP_ROW_SPACING_MM) {
		if (way_mm(r, point(r, last - 1), mm) < SAME_MM)
			return;
		r->n = last;
	}
	memcpy(r->mm[r->n % INTERP_ROW_POINTS], mm, bytes(r));
	r->n++;
	r->path.u_max = (double)(r->n - 1);
	if (r->n > INTERP_ROW_POINTS)
		r->path.u_min = (double)(r->n - INTERP_ROW_POINTS);
}

void interp_row_error(const struct interp_row *r, struct interp_contour *foot,
		      const double *mm, struct interp_contour_error *ret)
{
	*ret = (struct interp_contour_error) { .u = foot->u };
	if (r->n < 2)
		return;
	if (foot->u < r->path.u_min)
		interp_contour_begin(foot, &r->path, r->path.u_min, LOOK_MM);
	interp_contour_step(foot, mm, r->path.u_max, ret);
}
