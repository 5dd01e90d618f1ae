/* SPDX-License-Identifier: Apache-2.0 */
/* errormap.c - geometric errors added up, and solved for the place to command */
#include "interp/errormap.h"

#include <errno.h>
#include <math.h>

/*
 * x = place - error(x), begun at x = place.  A slope of s leaves s^n of the
 * error after n rounds: 1e-8 of it at the steepest allowed.
 */
#define ROUNDS	4

static bool row_ok(const struct interp_errormap_row *r)
{
	if (r->along >= INTERP_NAXES || r->across >= INTERP_NAXES ||
	    r->n < 2 || r->n > INTERP_ERRORMAP_POINTS ||
	    !isfinite(r->from_mm) || !(r->spacing_mm > 0) ||
	    !isfinite(r->spacing_mm))
		return false;
	for (int i = 0; i < r->n; i++)
		if (!isfinite(r->error_mm[i]) ||
		    (i && fabs(r->error_mm[i] - r->error_mm[i - 1]) >
				  INTERP_ERRORMAP_SLOPE_MAX * r->spacing_mm))
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

static double row_at(const struct interp_errormap_row *r, double place_mm)
{
	const double at = fmin(fmax((place_mm - r->from_mm) / r->spacing_mm, 0),
			       r->n - 1);
	const int i = at < r->n - 1 ? (int)at : r->n - 2;

	return r->error_mm[i] +
	       (at - i) * (r->error_mm[i + 1] - r->error_mm[i]);
}

void interp_errormap_error(const struct interp_errormap *m,
			   const double *place_mm, double *ret_mm)
{
	for (int i = 0; i < INTERP_NAXES; i++) {
		const struct interp_errormap_growth *g = &m->growth[i];

		ret_mm[i] = g->per_k * g->over_k * (place_mm[i] - g->fixed_mm);
	}
	for (int i = 0; i < m->nrows; i++)
		ret_mm[m->row[i].across] += row_at(&m->row[i],
						   place_mm[m->row[i].along]);
	for (int i = 0; i < m->nleans; i++)
		ret_mm[m->lean[i].across] += m->lean[i].rad *
					     place_mm[m->lean[i].along];
}

void interp_errormap_apply(const struct interp_errormap *m,
			   const double *place_mm, double *ret_mm)
{
	double error[INTERP_NAXES], told[INTERP_NAXES];

	for (int i = 0; i < INTERP_NAXES; i++)
		told[i] = place_mm[i];
	for (int n = 0; n < ROUNDS; n++) {
		interp_errormap_error(m, told, error);
		for (int i = 0; i < INTERP_NAXES; i++)
			told[i] = place_mm[i] - error[i];
	}
	for (int i = 0; i < INTERP_NAXES; i++)
		ret_mm[i] = -error[i];
}
