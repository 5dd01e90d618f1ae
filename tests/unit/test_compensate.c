/* SPDX-License-Identifier: Apache-2.0 */
/* test_compensate.c - promises of the contour compensations */
#include "contour_help.h"

#include "interp/tune.h"
#include "tried/set_twin.h"

#include <errno.h>

static void names_are_read_alone_and_together(void **state)
{
	(void)state;
	assert_int_equal(interp_compensate_parse("none"), 0);
	assert_int_equal(interp_compensate_parse("cross-coupled+feedforward"),
			 INTERP_COMPENSATE_CROSS |
			 INTERP_COMPENSATE_FEEDFORWARD);
	assert_int_equal(interp_compensate_parse("zpetc"),
			 INTERP_COMPENSATE_ZPETC);
	assert_int_equal(interp_compensate_parse("zpetc+"), -EINVAL);
	assert_int_equal(interp_compensate_parse("cross"), -EINVAL);
	assert_int_equal(interp_compensate_parse(""), -EINVAL);
	for (int i = 0; interp_compensate_name(i); i++)
		assert_int_equal(interp_compensate_parse(
			interp_compensate_name(i)), 1 << i);
}

static void two_cures_of_one_ill_are_refused(void **state)
{
	struct interp_trial_result r;
	struct rig g;

	(void)state;
	rig_make(&g, &circle, 1);
	g.config.methods = INTERP_COMPENSATE_FEEDFORWARD |
			   INTERP_COMPENSATE_ZPETC;
	assert_int_equal(interp_trial_run(&g.trial, &r), -EINVAL);
	g.config.methods = INTERP_COMPENSATE_PREDICTIVE;
	g.config.gains.horizon_s = 0.1;
	assert_int_equal(interp_trial_run(&g.trial, &r), -ERANGE);
	rig_free(&g);
}

/* Unmatched axes at 20 mm/s: 0.1 mm off. Each method by what it is good for. */
static void each_method_mends_what_it_should(void **state)
{
	struct rig g;
	double none;

	(void)state;
	rig_make(&g, &circle, 2);
	none = rig_run(&g, "none").max_mm;
	assert_true(none > 0.08);
	assert_true(rig_run(&g, "cross-coupled").mean_mm < 0.02);
	assert_true(rig_run(&g, "predictive").mean_mm < 0.01);
	assert_true(rig_run(&g, "feedforward").max_mm < 0.001);
	assert_true(rig_run(&g, "feedforward+cross-coupled").max_mm < 0.001);
	assert_true(rig_run(&g, "zpetc").max_mm < 1e-5);
	assert_true(rig_run(&g, "zpetc+cross-coupled").max_mm < 1e-5);
	rig_free(&g);
}

static void delays_are_answered_ahead(void **state)
{
	struct rig g;

	(void)state;
	rig_make(&g, &circle, 2);
	for (int k = 0; k < 2; k++)
		g.config.loop[k].delay_s = g.trial.truth[k].delay_s = 0.003;
	assert_true(rig_run(&g, "zpetc").max_mm < 5e-5);
	assert_true(rig_run(&g, "feedforward").max_mm < 0.001);
	/* Not known of, it shows. */
	for (int k = 0; k < 2; k++)
		g.config.loop[k].delay_s = 0;
	assert_true(rig_run(&g, "feedforward").mean_mm > 1e-4);
	rig_free(&g);
}

static void zpetc_bears_zeros_it_cannot_cancel(void **state)
{
	struct rig g;

	(void)state;
	/* A slow velocity loop sampled slowly: a zero outside the circle. */
	rig_make(&g, &circle, 0.5);
	for (int k = 0; k < 2; k++) {
		g.config.loop[k].velocity_hz = g.trial.truth[k].velocity_hz =
			15;
		g.config.loop[k].gain_1_s = g.trial.truth[k].gain_1_s = 15;
	}
	assert_true(rig_run(&g, "zpetc").max_mm <
		    rig_run(&g, "none").max_mm / 100);
	rig_free(&g);
}

static void coupling_gets_round_a_tip(void **state)
{
	struct rig g;

	(void)state;
	/* A free search for the nearest point is lost here: see the foot. */
	rig_make(&g, &tip, 5);
	g.config.gains.cross_1_s = 60;
	assert_true(rig_run(&g, "cross-coupled").max_mm < 0.25);
	rig_free(&g);
}

static void filter_helps_a_noisy_encoder(void **state)
{
	struct rig g;
	double raw;

	(void)state;
	rig_make(&g, &circle, 2);
	g.trial.noise_mm = 0.01;
	g.trial.seed = 4;
	g.config.gains.cross_1_s = 150;
	raw = rig_run(&g, "feedforward+cross-coupled").mean_mm;
	g.config.filtered = true;
	g.config.noise = (struct interp_kalman_noise) { 1, 0.01 };
	assert_true(rig_run(&g, "feedforward+cross-coupled").mean_mm <
		    0.75 * raw);
	rig_free(&g);
}

static void twin_mends_a_path_beforehand(void **state)
{
	struct rig g;
	double (*offset)[INTERP_NAXES], (*error)[INTERP_NAXES], *u, before;
	struct interp_trial_result r = { 0 };

	(void)state;
	rig_make(&g, &circle, 2);
	before = rig_run(&g, "none").mean_mm;
	offset = calloc(g.set.n, sizeof(*offset));
	error = calloc(g.set.n, sizeof(*error));
	u = calloc(g.set.n, sizeof(*u));
	g.trial.u = u;
	g.trial.error_mm = error;
	for (int round = 0; round < 5; round++) {
		double *at[2] = { g.set.mm[0], g.set.mm[1] };
		struct interp_contour_point p;

		r = rig_run(&g, "none");
		interp_twin_correct(
			&(struct interp_twin_set) { g.set.u, offset, g.set.n },
			&(struct interp_twin_run) {
				u, (const double (*)[INTERP_NAXES])error,
				g.set.n }, 0.8, 2);
		for (size_t i = 0; i < g.set.n; i++) {
			circle_at(NULL, g.set.u[i], &p);
			for (int k = 0; k < 2; k++)
				at[k][i] = p.mm[k] + offset[i][k];
		}
	}
	assert_true(r.mean_mm < before / 20);
	free(offset);
	free(error);
	free(u);
	rig_free(&g);
}

static double valley(void *arg, const double *x)
{
	(*(unsigned int *)arg)++;
	return 100 * pow(x[1] - x[0] * x[0], 2) + pow(1 - x[0], 2);
}

static void both_methods_find_the_end_of_a_valley(void **state)
{
	unsigned int looked = 0;
	struct interp_minimise m = {
		.n = 2, .low = { -2, -2 }, .high = { 2, 2 }, .cost = valley,
		.arg = &looked, .budget = 600,
	};

	(void)state;
	for (int k = 0; k < 2; k++) {
		double x[2] = { -1.2, 1 };
		double least;

		assert_int_equal(k ? interp_minimise_global(&m, x, &least) :
				     interp_minimise_local(&m, x, &least), 0);
		assert_true(looked <= m.budget);
		assert_true(least < 0.02);
		assert_near(valley(&looked, x), least, 1e-12);
		looked = 0;
	}
}

static void least_on_the_wall_is_found_inside_the_box(void **state)
{
	unsigned int looked = 0;
	struct interp_minimise m = {
		.n = 2, .low = { -2, -2 }, .high = { 0.5, 2 }, .cost = valley,
		.arg = &looked, .budget = 600,
	};

	(void)state;
	for (int k = 0; k < 2; k++) {
		double x[2] = { -1.2, 1 }, least;

		assert_int_equal(k ? interp_minimise_global(&m, x, &least) :
				     interp_minimise_local(&m, x, &least), 0);
		assert_true(x[0] <= 0.5);
		assert_near(x[0], 0.5, 0.02);
		assert_near(x[1], 0.25, 0.02);
	}
}

static void tuning_beats_no_gains(void **state)
{
	struct interp_compensate_gains found;
	struct interp_trial_result r;
	struct rig g;
	double cost;

	(void)state;
	rig_make(&g, &circle, 2);
	g.config.methods = INTERP_COMPENSATE_FEEDFORWARD;
	g.config.gains = (struct interp_compensate_gains) { .velocity = 0.8 };
	assert_int_equal(interp_tune_run(&(struct interp_tune) {
		.trial = g.trial, .budget = 240 }, &found, &cost), 0);
	r = rig_run(&g, "feedforward");
	assert_true(cost < 1e3 * r.max_mm / 50);
	g.config.gains = found;
	r = rig_run(&g, "feedforward");
	assert_near(1e3 * (r.max_mm + INTERP_TUNE_MEAN * r.mean_mm),
			   cost, 1e-9);
	g.config.methods = 0;
	assert_int_equal(interp_tune_run(&(struct interp_tune) {
		.trial = g.trial, .budget = 80 }, &found, &cost), -EINVAL);
	rig_free(&g);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(names_are_read_alone_and_together),
		cmocka_unit_test(two_cures_of_one_ill_are_refused),
		cmocka_unit_test(each_method_mends_what_it_should),
		cmocka_unit_test(delays_are_answered_ahead),
		cmocka_unit_test(zpetc_bears_zeros_it_cannot_cancel),
		cmocka_unit_test(coupling_gets_round_a_tip),
		cmocka_unit_test(filter_helps_a_noisy_encoder),
		cmocka_unit_test(twin_mends_a_path_beforehand),
		cmocka_unit_test(both_methods_find_the_end_of_a_valley),
		cmocka_unit_test(least_on_the_wall_is_found_inside_the_box),
		cmocka_unit_test(tuning_beats_no_gains),
	};

	return cmocka_run_group_tests_name("interp/compensate", tests, NULL,
					   NULL);
}
