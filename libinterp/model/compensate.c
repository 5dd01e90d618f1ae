/* SPDX-License-Identifier: Apache-2.0 */
/* compensate.c - adds feedforward, cross-coupling and prediction up */
#include "interp/compensate.h"

#include <errno.h>
#include <math.h>

static bool has(const struct interp_compensate *c, uint32_t method)
{
	return (c->config.methods & method) != 0;
}

static int begin_axis(struct interp_compensate *c, int i, double place_mm)
{
	const struct interp_compensate_config *g = &c->config;
	const int err = interp_kalman_init(&c->kalman[i], &g->loop[i],
					   g->period_s, &g->noise, place_mm);

	if (err == 0)
		interp_zpetc_init(&c->zpetc[i], &c->kalman[i].model);
	return err;
}

int interp_compensate_begin(struct interp_compensate *c,
			    const struct interp_compensate_config *config,
			    const struct interp_contour_path *path, double u,
			    const double *place_mm)
{
	const uint32_t both = INTERP_COMPENSATE_FEEDFORWARD |
			      INTERP_COMPENSATE_ZPETC;
	const struct interp_compensate_gains *g = &config->gains;
	int err = 0;

	if (config->naxes < 1 || config->naxes > INTERP_NAXES ||
	    (config->methods & both) == both || !(config->period_s > 0))
		return -EINVAL;
	*c = (struct interp_compensate) { .config = *config };
	c->estimates = config->filtered || has(c, INTERP_COMPENSATE_PREDICTIVE);
	if (has(c, INTERP_COMPENSATE_PREDICTIVE)) {
		if (!(g->horizon_s >= 0))
			return -EINVAL;
		if (g->horizon_s > INTERP_COMPENSATE_HORIZON_MAX *
				   config->period_s)
			return -ERANGE;
		c->horizon = (int)floor(g->horizon_s / config->period_s + 0.5);
	}
	if (has(c, INTERP_COMPENSATE_FEEDFORWARD) &&
	    !(g->lead_periods >= 0 && g->lead_periods <= 1))
		return -ERANGE;
	for (int i = 0; i < config->naxes && err == 0; i++)
		err = begin_axis(c, i, place_mm[i]);
	interp_contour_begin(&c->foot, path, u, config->look_mm);
	c->foot_ahead = c->foot;
	return err;
}

static double feedforward(const struct interp_compensate *c, int axis,
			  const double *set)
{
	return interp_compensate_feedforward(&c->config.gains,
					     &c->config.loop[axis],
					     c->config.period_s, set);
}

/* The part that does not depend on where the axis is. */
static double open_loop(const struct interp_compensate *c,
			struct interp_zpetc *z, int axis, const double *set)
{
	if (has(c, INTERP_COMPENSATE_FEEDFORWARD))
		return feedforward(c, axis, set);
	return has(c, INTERP_COMPENSATE_ZPETC) ? interp_zpetc_step(z, set) : 0;
}

/* Everything that is asked of the drive, including its own loop. */
static double demanded(const struct interp_compensate *c, int axis,
		       const double *set, double place_mm, double added)
{
	const struct interp_axis_loop *l = &c->config.loop[axis];

	return l->gain_1_s * (set[0] - place_mm) +
	       l->feedforward * (set[0] - set[-1]) / c->config.period_s + added;
}

/* Where an axis will be at the horizon. */
static double predict(const struct interp_compensate *c, int axis,
		      const double *set)
{
	struct interp_axis_model m = c->kalman[axis].model;
	struct interp_zpetc z = c->zpetc[axis];

	for (int i = 0; i < c->horizon; i++, set++)
		interp_axis_model_step(&m,
				       demanded(c, axis, set, m.x[0],
						open_loop(c, &z, axis, set)));
	return m.x[0];
}

static void look_ahead(struct interp_compensate *c,
		       const struct interp_compensate_preview *set, double *v)
{
	double place[INTERP_NAXES];

	for (int i = 0; i < c->config.naxes; i++)
		place[i] = predict(c, i, set->at[i]);
	interp_contour_step(&c->foot_ahead, place, set->u[c->horizon],
			    &c->ahead);
	for (int i = 0; i < c->config.naxes; i++)
		v[i] += c->config.gains.predicted_1_s * c->ahead.vector_mm[i];
}

static void couple(struct interp_compensate *c, const double *place,
		   double set_u, double *v)
{
	const struct interp_compensate_gains *g = &c->config.gains;
	double gain = 0;

	if (has(c, INTERP_COMPENSATE_CROSS))
		gain += g->cross_1_s;
	if (has(c, INTERP_COMPENSATE_PREDICTIVE))
		gain += g->measured_1_s;
	interp_contour_step(&c->foot, place, set_u, &c->error);
	for (int i = 0; i < c->config.naxes; i++)
		v[i] += gain * c->error.vector_mm[i];
}

void interp_compensate_step(struct interp_compensate *c,
			    const struct interp_compensate_preview *set,
			    const double *measured_mm, double *ret_mm_s)
{
	const uint32_t coupled = INTERP_COMPENSATE_CROSS |
				 INTERP_COMPENSATE_PREDICTIVE;
	const int n = c->config.naxes;
	double place[INTERP_NAXES], v[INTERP_NAXES] = { 0 };

	for (int i = 0; i < n; i++) {
		if (c->estimates)
			interp_kalman_correct(&c->kalman[i], measured_mm[i]);
		place[i] = c->estimates ?
			   interp_kalman_place_mm(&c->kalman[i]) :
			   measured_mm[i];
	}
	if (has(c, INTERP_COMPENSATE_PREDICTIVE))
		look_ahead(c, set, v);
	for (int i = 0; i < n; i++)
		v[i] += open_loop(c, &c->zpetc[i], i, set->at[i]);
	if (has(c, coupled))
		couple(c, place, set->u[0], v);
	for (int i = 0; i < n; i++) {
		if (c->estimates)
			interp_kalman_predict(&c->kalman[i],
				demanded(c, i, set->at[i], measured_mm[i],
					 v[i]));
		ret_mm_s[i] = v[i];
	}
}
