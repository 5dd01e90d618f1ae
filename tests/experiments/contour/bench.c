/* SPDX-License-Identifier: Apache-2.0 */
/* bench.c - the machine of the experiment: as it is believed to be, and as it
 * is */
#include "contour_try.h"
#include "tried/set_twin.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const struct interp_axis_loop loop_believed[2] = {
	{ .gain_1_s = 30, .velocity_hz = 60, .damping = 0.7 },
	{ .gain_1_s = 21.5, .velocity_hz = 60, .damping = 0.7 },
};

static const double real_hz[2] = { 66, 54 };

void bench_make(struct bench *b, struct feed *f, bool real)
{
	const size_t room = INTERP_COMPENSATE_BEHIND + f->n +
			    INTERP_COMPENSATE_AHEAD + 1;

	*b = (struct bench) { .feed = f, .config = {
		.gains = {
			.velocity = 1, .acceleration = 1, .lead_periods = 0.5,
			.cross_1_s = 100,
			.predicted_1_s = 60, .measured_1_s = 60,
			.horizon_s = 0.020,
		},
		.naxes = 2, .period_s = PERIOD_S, .look_mm = 0.02,
		.noise = { .drive_mm_s = 5, .sensor_mm = 0.0006 },
	} };
	b->offset_mm = must(calloc(f->n, sizeof(*b->offset_mm)));
	for (int k = 0; k < 2; k++) {
		b->set[k] = (double *)must(calloc(room, sizeof(double)));
		memcpy(b->set[k], f->mm[k] - INTERP_COMPENSATE_BEHIND,
		       room * sizeof(double));
		b->set[k] += INTERP_COMPENSATE_BEHIND;
		b->config.loop[k] = b->trial.truth[k] = loop_believed[k];
		b->trial.set.at[k] = b->set[k];
	}
	b->trial.set.u = f->u;
	b->trial.path = &f->curve->path;
	b->trial.n = f->n;
	b->trial.compensate = &b->config;
	for (int k = 0; k < 2 && real; k++) {
		b->trial.truth[k].velocity_hz = real_hz[k];
		b->trial.truth[k].kick_mm_s = 0.3;
		b->trial.truth[k].kick_s = 0.02;
	}
	b->trial.encoder_mm = real ? 0.001 : 0;
	b->trial.noise_mm = real ? 0.0005 : 0;
	b->trial.seed = 1;
}

void bench_free(struct bench *b)
{
	for (int k = 0; k < 2; k++)
		free(b->set[k] - INTERP_COMPENSATE_BEHIND);
	free(b->offset_mm);
}

struct interp_trial_result bench_run(struct bench *b)
{
	struct interp_trial_result r;
	const int err = interp_trial_run(&b->trial, &r);

	if (err) {
		fprintf(stderr, "trial: %s\n", strerror(-err));
		exit(1);
	}
	return r;
}

static void apply(struct bench *b)
{
	for (size_t i = 0; i < b->feed->n; i++)
		for (int k = 0; k < 2; k++)
			b->set[k][i] = b->feed->mm[k][i] + b->offset_mm[i][k];
}

void bench_twin(struct bench *b, int rounds, double gain)
{
	const size_t n = b->feed->n;
	double *u = must(calloc(n, sizeof(*u)));
	double (*e)[INTERP_NAXES] = must(calloc(n, sizeof(*e)));
	const struct interp_twin_set set = { b->feed->u, b->offset_mm, n };
	const struct interp_twin_run run = {
		u, (const double (*)[INTERP_NAXES])e, n
	};
	struct bench model = *b;

	model.trial.compensate = &model.config;
	for (int k = 0; k < 2; k++)
		model.trial.truth[k] = b->config.loop[k];
	model.trial.encoder_mm = model.trial.noise_mm = 0;
	model.trial.u = u;
	model.trial.error_mm = e;
	for (int i = 0; i < rounds; i++) {
		bench_run(&model);
		interp_twin_correct(&set, &run, gain, 2);
		apply(b);
	}
	free(u);
	free(e);
}
