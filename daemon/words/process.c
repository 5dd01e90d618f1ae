/* SPDX-License-Identifier: Apache-2.0 */
/*
 * process.c - where the settings of a field are
 */
#include "process.h"

#include <math.h>

/* A part of a step, or of a value, that is a rounding and no distance. */
#define ROUNDING	1e-6

const char *process_name(int field)
{
	static const char *const names[] = {
		"sense", "pump", "spark", "opens", "sparks", "arcs", "shorts",
		"energy_j", "fault",
	};

	return field < INTERP_NGENERATOR ? interp_tech_field[field].name :
	       field < PROCESS_NTOLD ? names[field - INTERP_NGENERATOR] : "?";
}

const char *process_unit(int field)
{
	return field < INTERP_NGENERATOR ? interp_tech_field[field].unit :
	       field == PROCESS_ENERGY_J ? "J" : "";
}

static double least(const struct process_delivers *d)
{
	double x = d->n ? d->value[0] : d->min;

	for (uint32_t i = 1; i < d->n; i++)
		x = d->value[i] < x ? d->value[i] : x;
	return x;
}

static double most(const struct process_delivers *d)
{
	double x = d->n ? d->value[0] : d->max;

	for (uint32_t i = 1; i < d->n; i++)
		x = d->value[i] > x ? d->value[i] : x;
	return x;
}

static double of_list(const struct process_delivers *d, bool below,
		      double asked, double slack)
{
	double best = least(d);

	for (uint32_t i = 0; i < d->n; i++) {
		const double v = d->value[i];

		if (below ? v <= asked + slack && v > best :
			    fabs(v - asked) < fabs(best - asked))
			best = v;
	}
	return best;
}

double process_nearest(const struct process_delivers *d, int field,
		       double asked)
{
	const bool below = field == INTERP_TECH_PEAK_A;
	const double slack = ROUNDING * (fabs(asked) + d->step);
	double steps;

	if (!d->there || !(asked >= least(d) - slack) ||
	    !(asked <= most(d) + slack))
		return (double)NAN;
	if (d->n)
		return of_list(d, below, asked, slack);
	if (d->step <= 0)
		return asked;
	steps = (asked - d->min) / d->step;
	steps = below ? floor(steps + ROUNDING * (steps + 1)) :
			floor(steps + 0.5);
	return fmin(d->min + fmax(steps, 0) * d->step, d->max);
}

/* A generator that nobody turns round is positive. */
bool process_takes(const struct process_delivers *d, int field, double value)
{
	return isnan(value) || (field == INTERP_TECH_POLARITY && value > 0) ||
	       (!d->there && process_is_setting(field)) ||
	       !isnan(process_nearest(d, field, value));
}

bool process_is_setting(int field)
{
	static const bool is_setting[INTERP_NTECH] = {
#define IS_SETTING(id, of, member) [INTERP_TECH_##id] = true,
		PROCESS_SETTINGS(IS_SETTING)
	};

	return field < INTERP_NGENERATOR && is_setting[field];
}

double *process_setting(enum interp_tech_id id, struct cycle_gap_config *gap,
			struct cycle_jump_config *jump)
{
	switch (id) {
#define SETTING(field, of, member) \
	case INTERP_TECH_##field: \
		return &(of)->member;
	PROCESS_SETTINGS(SETTING)
	default:
		return NULL;
	}
}

void process_base(struct interp_tech *ret, const struct cycle_gap_config *gap,
		  const struct cycle_jump_config *jump)
{
	interp_tech_clear(ret);
#define BASE(field, of, member) \
	ret->v[INTERP_TECH_##field] = (of)->member;
	PROCESS_SETTINGS(BASE)
}
