/* SPDX-License-Identifier: Apache-2.0 */
/* tune.c - finds gains as the unknowns of a minimum */
#include "interp/tune.h"

#include <errno.h>
#include <math.h>
#include <stddef.h>

/* Which gains a method has, and where they are searched. */
static const struct gain {
	uint32_t methods;
	size_t at;
	double low, high;
} gains[] = {
#define GAIN(field)	offsetof(struct interp_compensate_gains, field)
	{ INTERP_COMPENSATE_FEEDFORWARD, GAIN(velocity), 0.7, 1.2 },
	{ INTERP_COMPENSATE_FEEDFORWARD, GAIN(acceleration), 0, 2 },
	{ INTERP_COMPENSATE_FEEDFORWARD, GAIN(lead_periods), 0, 1 },
	{ INTERP_COMPENSATE_CROSS, GAIN(cross_1_s), 0, 300 },
	{ INTERP_COMPENSATE_PREDICTIVE, GAIN(predicted_1_s), 0, 200 },
	{ INTERP_COMPENSATE_PREDICTIVE, GAIN(measured_1_s), 0, 200 },
	{ INTERP_COMPENSATE_PREDICTIVE, GAIN(horizon_s), 0, 0.05 },
#undef GAIN
};

#define NGAINS	(sizeof(gains) / sizeof(gains[0]))

_Static_assert(NGAINS <= INTERP_MINIMISE_NMAX, "more gains than unknowns");

struct search {
	const struct interp_tune *tune;
	struct interp_compensate_config config;
	const struct gain *gain[NGAINS];
	int n;
	unsigned int used;
	double best;
};

static double *field(struct interp_compensate_gains *g, size_t at)
{
	return (double *)(void *)((char *)g + at);
}

static double high_of(const struct search *s, const struct gain *g)
{
	const double horizon = INTERP_COMPENSATE_HORIZON_MAX *
			       s->config.period_s;

	return g->at == offsetof(struct interp_compensate_gains, horizon_s) ?
	       fmin(g->high, horizon) : g->high;
}

/* Rounded as in a machine file: a gain that is tried can be printed. */
static double rounded(double x)
{
	double unit;

	if (x == 0)
		return 0;
	unit = pow(10, floor(log10(fabs(x))) + 1 - INTERP_TUNE_DIGITS);
	return unit < 1 ? round(x / unit) / round(1 / unit) :
	       round(x / unit) * unit;
}

static double try_gains(struct search *s, const double *x)
{
	struct interp_trial trial = s->tune->trial;
	struct interp_trial_result r;

	for (int i = 0; i < s->n; i++)
		*field(&s->config.gains, s->gain[i]->at) = rounded(x[i]);
	trial.compensate = &s->config;
	if (interp_trial_run(&trial, &r) < 0)
		return INFINITY;
	return 1e3 * (r.max_mm + INTERP_TUNE_MEAN * r.mean_mm);
}

static double cost_of(void *arg, const double *x)
{
	struct search *s = arg;
	const double cost = try_gains(s, x);

	s->best = fmin(s->best, cost);
	s->used++;
	if (s->tune->on_trial)
		s->tune->on_trial(s->tune->on_trial_arg, s->used, s->best);
	return cost;
}

int interp_tune_run(const struct interp_tune *t,
		    struct interp_compensate_gains *ret, double *ret_cost)
{
	struct search s = {
		.tune = t, .config = *t->trial.compensate, .best = INFINITY,
	};
	struct interp_minimise m = {
		.cost = cost_of, .arg = &s, .budget = t->budget,
	};
	struct interp_trial_result first;
	double x[INTERP_MINIMISE_NMAX];
	int err = interp_trial_run(&t->trial, &first);

	if (err)
		return err;
	for (size_t i = 0; i < NGAINS; i++) {
		const struct gain *g = &gains[i];

		if (!(g->methods & s.config.methods))
			continue;
		m.low[s.n] = g->low;
		m.high[s.n] = high_of(&s, g);
		x[s.n] = *field(&s.config.gains, g->at);
		s.gain[s.n++] = g;
	}
	if (s.n == 0)
		return -EINVAL;
	m.n = s.n;
	err = t->method == INTERP_TUNE_GLOBAL ?
	      interp_minimise_global(&m, x, ret_cost) :
	      interp_minimise_local(&m, x, ret_cost);
	if (err)
		return err;
	*ret = t->trial.compensate->gains;
	for (int i = 0; i < s.n; i++)
		*field(ret, s.gain[i]->at) = rounded(x[i]);
	return 0;
}
