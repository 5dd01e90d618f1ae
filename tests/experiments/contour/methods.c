/* SPDX-License-Identifier: Apache-2.0 */
/* methods.c - the baseline, and every compensation at three speeds */
#include "contour_try.h"

#include <math.h>

#define COUNT(x)	(sizeof(x) / sizeof((x)[0]))

const double speed_mm_min[3] = { 500, 1000, 1500 };

/* A row: what is done, with which gains. */
struct row {
	const char *name, *methods;
	double gain_1_s[2];		/* of the loops; 0: as they are */
	struct interp_compensate_gains gains;
	int twin_rounds;
	bool filtered;
};

#define FEEDFORWARD(kv, ka, lead) \
	.velocity = (kv), .acceleration = (ka), .lead_periods = (lead)
#define PREDICT(kff, kfb, ms)                          \
	.predicted_1_s = (kff), .measured_1_s = (kfb), \
	.horizon_s = (ms) / 1000.0

static const struct row rows[] = {
	{ .name = "none", .methods = "none" },
	{ .name = "matched gains 30",
	  .methods = "none",
	  .gain_1_s = { 30, 30 } },
	{ .name = "matched gains 60",
	  .methods = "none",
	  .gain_1_s = { 60, 60 } },
	{ .name = "cross-coupled 20",
	  .methods = "cross-coupled",
	  .gains = { .cross_1_s = 20 } },
	{ .name = "cross-coupled 100",
	  .methods = "cross-coupled",
	  .gains = { .cross_1_s = 100 } },
	{ .name = "predictive, Kff = Kfb = 60, 10 ms",
	  .methods = "predictive",
	  .gains = { PREDICT(60, 60, 10) } },
	{ .name = "predictive, Kff = Kfb = 60, 20 ms",
	  .methods = "predictive",
	  .gains = { PREDICT(60, 60, 20) } },
	{ .name = "predictive, matched gains 60, 12 ms",
	  .methods = "predictive",
	  .gain_1_s = { 60, 60 },
	  .gains = { PREDICT(60, 60, 12) } },
	{ .name = "twin, 1 round of 0.8", .methods = "none", .twin_rounds = 1 },
	{ .name = "twin, 5 rounds of 0.8",
	  .methods = "none",
	  .twin_rounds = 5 },
	{ .name = "feedforward, speed 0.9",
	  .methods = "feedforward",
	  .gains = { FEEDFORWARD(0.9, 0, 0) } },
	{ .name = "feedforward, speed",
	  .methods = "feedforward",
	  .gains = { FEEDFORWARD(1, 0, 0) } },
	{ .name = "feedforward, speed and acceleration",
	  .methods = "feedforward",
	  .gains = { FEEDFORWARD(1, 1, 0) } },
	{ .name = "feedforward, and half a period ahead",
	  .methods = "feedforward",
	  .gains = { FEEDFORWARD(1, 1, 0.5) } },
	{ .name = "zpetc", .methods = "zpetc" },
	{ .name = "feedforward, twin 3 rounds",
	  .methods = "feedforward",
	  .gains = { FEEDFORWARD(1, 1, 0.5) },
	  .twin_rounds = 3 },
	{ .name = "feedforward, cross-coupled 100",
	  .methods = "feedforward+cross-coupled",
	  .gains = { FEEDFORWARD(1, 1, 0.5), .cross_1_s = 100 } },
	{ .name = "the same on the Kalman estimate",
	  .methods = "feedforward+cross-coupled",
	  .gains = { FEEDFORWARD(1, 1, 0.5), .cross_1_s = 100 },
	  .filtered = true },
	{ .name = "feedforward, predictive, 20 ms",
	  .methods = "feedforward+predictive",
	  .gains = { FEEDFORWARD(1, 1, 0.5), PREDICT(60, 60, 20) } },
	{ .name = "zpetc, cross-coupled 100",
	  .methods = "zpetc+cross-coupled",
	  .gains = { .cross_1_s = 100 } },
	{ .name = "zpetc, predictive, 20 ms",
	  .methods = "zpetc+predictive",
	  .gains = { PREDICT(60, 60, 20) } },
	{ .name = "feedforward, cross-coupled 100, gains 60",
	  .methods = "feedforward+cross-coupled",
	  .gain_1_s = { 60, 60 },
	  .gains = { FEEDFORWARD(1, 1, 0.5), .cross_1_s = 100 } },
};

static struct interp_trial_result run(const struct row *r, struct feed *f,
				      bool real)
{
	struct interp_trial_result result;
	struct bench b;

	bench_make(&b, f, real);
	b.config.methods = (uint32_t)interp_compensate_parse(r->methods);
	b.config.gains = r->gains;
	b.config.filtered = r->filtered;
	for (int k = 0; k < 2 && r->gain_1_s[k] > 0; k++)
		b.config.loop[k].gain_1_s = b.trial.truth[k].gain_1_s =
			r->gain_1_s[k];
	bench_twin(&b, r->twin_rounds, 0.8);
	result = bench_run(&b);
	bench_free(&b);
	return result;
}

static void print_cell(const struct row *r, struct feed *f, bool real)
{
	const struct interp_trial_result t = run(r, f, real);

	printf(" %.1f / %.2f |", t.max_mm * 1e3, t.mean_mm * 1e3);
}

void table_baseline(struct speeds *s)
{
	static const double other[] = { 30, 24, 21.5, 21 };

	printf("## Position loops alone\n\nThe largest and the mean contour "
	       "error, um, without any compensation.\n\n| gains of X, Y, 1/s | "
	       "500 mm/min | 1000 | 1500 |\n|---|---|---|---|\n");
	for (size_t i = 0; i < COUNT(other); i++) {
		const struct row r = { .methods = "none",
				       .gain_1_s = { 30, other[i] } };

		printf("| 30, %g |", other[i]);
		for (int k = 0; k < 3; k++)
			print_cell(&r, &s->feed[k], false);
		printf("\n");
	}
	printf("| the paper | 100 / - | 150 / 80 | 200 / - |\n\nIf two axes "
	       "lag alike, a large lag makes only a small error. In the paper "
	       "the\nmean is half the largest; that needs gains that differ. "
	       "All tables below are of\nthe machine with 30 and 21.5.\n\n");
}

void table_methods(struct speeds *s)
{
	printf("## Every method at three speeds\n\nThe largest and the mean "
	       "contour error, um. *Ideal*: the loops are what the\ncontroller "
	       "believes. *Real*: the velocity loops have 66 and 54 Hz while "
	       "it\nbelieves 60, the encoder has steps of 1 um and noise of "
	       "0.5 um, and at every\nreversal friction makes a kick of 0.3 "
	       "mm/s that decays in 20 ms.\n\n| method | ideal 500 | 1000 | "
	       "1500 | real 500 | 1000 | 1500 |\n"
	       "|---|---|---|---|---|---|---|\n");
	for (size_t i = 0; i < COUNT(rows); i++) {
		printf("| %s |", rows[i].name);
		for (int k = 0; k < 6; k++)
			print_cell(&rows[i], &s->feed[k % 3], k >= 3);
		printf("\n");
		fflush(stdout);
	}
	printf("\n");
}

void table_noise(struct speeds *s)
{
	static const double sigma_um[] = { 0.5, 2, 5, 10 };

	printf("## What the Kalman filter is worth\n\nThe largest and the mean "
	       "contour error, um, at 1000 mm/min on the real machine,\nwith "
	       "feedforward and cross-coupled 150. The sensor noise of the "
	       "filter is the\ntrue one; its drive noise is in the head of "
	       "each column.\n\n| encoder noise, um | no filter | 5 mm/s | 1 "
	       "mm/s | 0.3 mm/s |\n|---|---|---|---|---|\n");
	for (size_t i = 0; i < COUNT(sigma_um); i++) {
		printf("| %g |", sigma_um[i]);
		for (int k = 0; k < 4; k++) {
			static const double drive[] = { 0, 5, 1, 0.3 };
			struct interp_trial_result r;
			struct bench b;

			bench_make(&b, &s->feed[1], true);
			b.config.methods = INTERP_COMPENSATE_FEEDFORWARD |
					   INTERP_COMPENSATE_CROSS;
			b.config.gains.cross_1_s = 150;
			b.trial.noise_mm = sigma_um[i] * 1e-3;
			b.config.filtered = drive[k] > 0;
			b.config.noise.sensor_mm = b.trial.noise_mm + 0.0003;
			if (drive[k] > 0)
				b.config.noise.drive_mm_s = drive[k];
			r = bench_run(&b);
			printf(" %.1f / %.2f |", r.max_mm * 1e3,
			       r.mean_mm * 1e3);
			bench_free(&b);
		}
		printf("\n");
	}
	printf("\n");
}

void table_gains(struct speeds *s)
{
	static const double cross[] = { 50, 100, 150, 200, 250, 300, 350, 400 };
	static const double delay_ms[] = { 0, 1, 2, 4 };

	printf("## Gain margin\n\nThe largest contour error, um, at 1000 "
	       "mm/min with cross-coupled alone. The\nloops are what the "
	       "controller believes, except for a delay. Cross-coupling adds\n"
	       "to the position gain across the path; *limit* is the sum at "
	       "which the loop\nbegins to swing, from the phase of the model\n"
	       "(`interp_axis_model_gain_max_1_s`).\n\n| delay, ms | limit, "
	       "1/s |");
	for (size_t i = 0; i < COUNT(cross); i++)
		printf(" %g |", cross[i]);
	printf(" margin at 100, dB |\n|---|---|");
	for (size_t i = 0; i < COUNT(cross); i++)
		printf("---|");
	printf("---|\n");
	for (size_t k = 0; k < COUNT(delay_ms); k++) {
		struct interp_axis_model m;
		struct bench b;
		double limit;

		bench_make(&b, &s->feed[1], false);
		b.config.methods = INTERP_COMPENSATE_CROSS;
		for (int a = 0; a < 2; a++)
			b.config.loop[a].delay_s = b.trial.truth[a].delay_s =
				delay_ms[k] / 1000;
		interp_axis_model_init(&m, &b.config.loop[0], PERIOD_S, 0);
		limit = interp_axis_model_gain_max_1_s(&m);
		printf("| %g | %.0f |", delay_ms[k], limit);
		for (size_t i = 0; i < COUNT(cross); i++) {
			struct interp_trial_result r;

			b.config.gains.cross_1_s = cross[i];
			r = bench_run(&b);
			if (r.max_mm < 0.2)
				printf(" %.0f |", r.max_mm * 1e3);
			else
				printf(" swings |");
		}
		printf(" %.1f |\n", 20 * log10(limit / 130));
		bench_free(&b);
	}
	printf("\n");
}
