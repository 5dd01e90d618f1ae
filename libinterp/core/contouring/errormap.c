/* SPDX-License-Identifier: Apache-2.0 */
/* errormap.c - adds the geometric errors up, and finds the place to command */
#include "interp/errormap.h"

#include <errno.h>
#include <math.h>

/* If the place moves by less, it is found: 1 % of that is left as an error. */
#define FOUND_MM	5e-7

static bool point_ok(const struct interp_errormap_row *r, int i)
{
	if (!isfinite(r->at_mm[i]) || !isfinite(r->error_mm[i]))
		return false;
	return i == 0 || (r->at_mm[i] > r->at_mm[i - 1] &&
			  fabs(r->error_mm[i] - r->error_mm[i - 1]) <=
				  INTERP_ERRORMAP_SLOPE_MAX *
				  (r->at_mm[i] - r->at_mm[i - 1]));
}

static bool row_ok(const struct interp_errormap_row *r)
{
	if (r->along >= INTERP_NAXES || r->across >= INTERP_NAXES ||
	    r->n < 2 || r->n > INTERP_ERRORMAP_POINTS)
		return false;
	for (int i = 0; i < r->n; i++)
		if (!point_ok(r, i))
			return false;
	return true;
}

static bool lean_ok(const struct interp_errormap_lean *l)
{
	return l->along < INTERP_NAXES && l->across < INTERP_NAXES &&
	       l->along != l->across &&
	       fabs(l->rad) <= INTERP_ERRORMAP_SLOPE_MAX;
}

static bool growth_ok(const struct interp_errormap_growth *g)
{
	return isfinite(g->fixed_mm) &&
	       fabs(g->per_k * g->over_k) <= INTERP_ERRORMAP_SLOPE_MAX;
}

int interp_errormap_check(const struct interp_errormap *m)
{
	if (m->nrows < 0 || m->nrows > INTERP_ERRORMAP_ROWS ||
	    m->nleans < 0 || m->nleans > INTERP_ERRORMAP_LEANS)
		return -EINVAL;
	for (int i = 0; i < m->nrows; i++)
		if (!row_ok(&m->row[i]))
			return -EINVAL;
	for (int i = 0; i < m->nleans; i++)
		if (!lean_ok(&m->lean[i]))
			return -EINVAL;
	for (int i = 0; i < INTERP_NAXES; i++)
		if (!growth_ok(&m->growth[i]))
			return -EINVAL;
	return 0;
}

bool interp_errormap_is_empty(const struct interp_errormap *m)
{
	for (int i = 0; i < INTERP_NAXES; i++)
		if (m->growth[i].per_k != 0)
			return false;
	return m->nrows == 0 && m->nleans == 0;
}

/* The last point at or before the place, but never the last point of the
 * row. */
static int point_before(const struct interp_errormap_row *r, double place_mm)
{
	int low = 0, high = r->n - 1;

	while (high - low > 1) {
		const int middle = low + (high - low) / 2;

		if (r->at_mm[middle] <= place_mm)
			low = middle;
		else
			high = middle;
	}
	return low;
}

/* The same, searched from a point near it. */
static int point_near(const struct interp_errormap_row *r, int i,
		      double place_mm)
{
	while (i < r->n - 2 && r->at_mm[i + 1] <= place_mm)
		i++;
	while (i > 0 && r->at_mm[i] > place_mm)
		i--;
	return i;
}

static double row_at(const struct interp_errormap_row *r, int i,
		     double place_mm)
{
	const double from = r->at_mm[i], to = r->at_mm[i + 1];
	const double at = place_mm < from ? from :
			  place_mm > to ? to : place_mm;

	return r->error_mm[i] + (at - from) / (to - from) *
				(r->error_mm[i + 1] - r->error_mm[i]);
}

/* @point: for each row, the point before the place; on entry, one near it. */
static void error_at(const struct interp_errormap *m, const double *place_mm,
		     int *point, double *ret_mm)
{
	for (int i = 0; i < INTERP_NAXES; i++) {
		const struct interp_errormap_growth *g = &m->growth[i];

		ret_mm[i] = g->per_k * g->over_k * (place_mm[i] - g->fixed_mm);
	}
	for (int i = 0; i < m->nrows; i++) {
		const struct interp_errormap_row *r = &m->row[i];
		const double at = place_mm[r->along];

		point[i] = point_near(r, point[i], at);
		ret_mm[r->across] += row_at(r, point[i], at);
	}
	for (int i = 0; i < m->nleans; i++)
		ret_mm[m->lean[i].across] += m->lean[i].rad *
					     place_mm[m->lean[i].along];
}

static void points_find(const struct interp_errormap *m,
			const double *place_mm, int *ret)
{
	for (int i = 0; i < m->nrows; i++)
		ret[i] = point_before(&m->row[i], place_mm[m->row[i].along]);
}

void interp_errormap_error(const struct interp_errormap *m,
			   const double *place_mm, double *ret_mm)
{
	int point[INTERP_ERRORMAP_ROWS];

	points_find(m, place_mm, point);
	error_at(m, place_mm, point, ret_mm);
}

/* Iterate x = place - error(x), beginning with x = place. */
void interp_errormap_apply(const struct interp_errormap *m,
			   const double *place_mm, double *ret_mm)
{
	double error[INTERP_NAXES], told[INTERP_NAXES];
	int point[INTERP_ERRORMAP_ROWS];
	double off = INFINITY;

	points_find(m, place_mm, point);
	for (int i = 0; i < INTERP_NAXES; i++)
		told[i] = place_mm[i];
	for (int n = 0; n < INTERP_ERRORMAP_ROUNDS && off > FOUND_MM; n++) {
		error_at(m, told, point, error);
		off = 0;
		for (int i = 0; i < INTERP_NAXES; i++) {
			const double next = place_mm[i] - error[i];

			off = fmax(off, fabs(next - told[i]));
			told[i] = next;
		}
	}
	for (int i = 0; i < INTERP_NAXES; i++)
		ret_mm[i] = -error[i];
}
