/* SPDX-License-Identifier: Apache-2.0 */
/* trial.c - runs axis models, encoders and a compensation along a row of
 * targets */
#include "interp/trial.h"

#include <math.h>
#include <string.h>

/* Irwin and Hall: the sum of 12 uniform numbers minus 6 is almost normal. */
static double normal(uint64_t *s)
{
	double sum = -6;

	for (int i = 0; i < 12; i++) {
		*s ^= *s >> 12;
		*s ^= *s << 25;
		*s ^= *s >> 27;
		sum += (double)((*s * 2685821657736338717u) >> 11) * 0x1p-53;
	}
	return sum;
}

struct bench {
	const struct interp_trial *t;
	struct interp_axis_model axis[INTERP_NAXES];
	struct interp_compensate compensate;
	struct interp_contour foot;
	uint64_t seed;
	int naxes;
};

static int begin(struct bench *b, const struct interp_trial *t)
{
	const struct interp_compensate_config *c = t->compensate;
	double place[INTERP_NAXES] = { 0 };
	int err = 0;

	*b = (struct bench) {
		.t = t, .seed = t->seed * 2 + 1, .naxes = c->naxes
	};
	for (int i = 0; i < c->naxes && err == 0; i++) {
		place[i] = t->set.at[i][0];
		err = interp_axis_model_init(&b->axis[i], &t->truth[i],
					     c->period_s, place[i]);
	}
	if (err == 0)
		err = interp_compensate_begin(&b->compensate, c, t->path,
					      t->path->u_min, place);
	interp_contour_begin(&b->foot, t->path, t->path->u_min, c->look_mm);
	return err;
}

static double encoder(struct bench *b, double mm)
{
	const struct interp_trial *t = b->t;

	if (t->noise_mm > 0)
		mm += t->noise_mm * normal(&b->seed);
	return t->encoder_mm > 0 ?
	       floor(mm / t->encoder_mm + 0.5) * t->encoder_mm : mm;
}

static void keep(const struct interp_trial *t, size_t k,
		 const struct interp_contour_error *e, const double *actual,
		 const double *measured)
{
	if (t->u)
		t->u[k] = e->u;
	if (t->error_mm)
		memcpy(t->error_mm[k], e->vector_mm, sizeof(e->vector_mm));
	if (t->actual_mm)
		memcpy(t->actual_mm[k], actual, sizeof(t->actual_mm[k]));
	if (t->measured_mm)
		memcpy(t->measured_mm[k], measured, sizeof(t->measured_mm[k]));
}

static double period(struct bench *b, size_t k)
{
	struct interp_compensate_preview set;
	struct interp_contour_error e;
	double actual[INTERP_NAXES] = { 0 }, measured[INTERP_NAXES] = { 0 };
	double v[INTERP_NAXES] = { 0 };

	for (int i = 0; i < b->naxes; i++) {
		set.at[i] = b->t->set.at[i] + k;
		actual[i] = interp_axis_model_actual_mm(&b->axis[i]);
		measured[i] = encoder(b, actual[i]);
	}
	set.u = b->t->set.u + k;
	interp_contour_step(&b->foot, actual, set.u[0], &e);
	keep(b->t, k, &e, actual, measured);
	interp_compensate_step(&b->compensate, &set, measured, v);
	for (int i = 0; i < b->naxes; i++) {
		const struct interp_axis_loop *l = &b->t->truth[i];
		const double *s = set.at[i];

		interp_axis_model_step(&b->axis[i],
			l->gain_1_s * (s[0] - measured[i]) + l->feedforward *
			(s[0] - s[-1]) / b->axis[i].period_s + v[i]);
	}
	return e.mm;
}

int interp_trial_run(const struct interp_trial *t,
		     struct interp_trial_result *ret)
{
	struct interp_trial_result r = { 0 };
	struct bench b;
	const int err = begin(&b, t);

	if (err)
		return err;
	for (size_t k = 0; k < t->n; k++) {
		const double mm = period(&b, k);

		r.max_mm = fmax(r.max_mm, mm);
		r.mean_mm += mm / (double)t->n;
	}
	*ret = r;
	return 0;
}
