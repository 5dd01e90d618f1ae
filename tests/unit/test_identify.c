/* SPDX-License-Identifier: Apache-2.0 */
/* test_identify.c - promises of identification and of what is learned */
#include "contour_help.h"

#include "interp/identify.h"
#include "tried/ridge.h"

#include <errno.h>

#define ROWS	8000

static double target[ROWS], actual[ROWS];

static double noise(uint64_t *s)
{
	double sum = -6;

	for (int i = 0; i < 12; i++) {
		*s = *s * 6364136223846793005u + 1442695040888963407u;
		sum += (double)(*s >> 11) * 0x1p-53;
	}
	return sum;
}

/* A trace of @l along target[], encoder of 1 um, 0.5 um of noise. */
static void record(const struct interp_axis_loop *l, uint64_t seed)
{
	struct interp_axis_model m;

	assert_int_equal(interp_axis_model_init(&m, l, PERIOD_S, target[0]), 0);
	for (int k = 0; k < ROWS; k++) {
		const double mm = m.actual_mm + 0.0005 * noise(&seed);
		const double before = target[k ? k - 1 : 0];

		actual[k] = floor(mm / 0.001 + 0.5) * 0.001;
		interp_axis_model_step(&m,
				       l->gain_1_s * (target[k] - actual[k]) +
				       l->feedforward * (target[k] - before) /
					       PERIOD_S);
	}
}

static void to_and_fro(void)
{
	for (int k = 0; k < ROWS; k++) {
		const double t = k * PERIOD_S;

		target[k] = 3 * sin(4 * t) + 0.3 * sin(23 * t) +
			    0.03 * sin(111 * t);
	}
}

static const struct interp_identify_trace trace = {
	.target_mm = target, .actual_mm = actual, .n = ROWS,
	.period_s = PERIOD_S,
};

static void check_within(double found, double truth, double part)
{
	if (fabs(found / truth - 1) > part)
		fail_msg("found %g, truth %g", found, truth);
}

/* A drive whose loop sees its own place, and pushed by @push_mm_s of noise. */
static void record_own(const struct interp_axis_loop *l, double push_mm_s)
{
	struct interp_axis_model m;
	uint64_t seed = 5;
	double push = 0;

	assert_int_equal(interp_axis_model_init(&m, l, PERIOD_S, target[0]), 0);
	for (int k = 0; k < ROWS; k++) {
		const double mm = m.actual_mm + 0.0005 * noise(&seed);

		actual[k] = floor(mm / 0.001 + 0.5) * 0.001;
		push = 0.99 * push + push_mm_s * noise(&seed);
		interp_axis_model_step(&m, l->gain_1_s *
				       (target[k] - m.actual_mm) + push);
	}
}

static void noisy_trace_tells_the_loops_within_5_percent(void **state)
{
	(void)state;
	to_and_fro();
	for (uint64_t seed = 1; seed <= 10; seed += 3) {
		const struct interp_axis_loop l = {
			.gain_1_s = 15 + 2 * (double)seed,
			.velocity_hz = 40 + 4 * (double)seed, .damping = 0.7,
			.kick_mm_s = 0.3, .kick_s = 0.02,
		};
		struct interp_identified d;

		record(&l, seed);
		assert_int_equal(interp_identify(&trace, &d), 0);
		check_within(d.loop.gain_1_s, l.gain_1_s, 0.001);
		check_within(d.loop.velocity_hz, l.velocity_hz, 0.05);
		check_within(d.loop.damping, l.damping, 0.05);
		check_within(d.loop.kick_mm_s, l.kick_mm_s, 0.05);
		check_within(d.loop.kick_s, l.kick_s, 0.05);
		/* There is none, and it does not blur the rest. */
		assert_false(d.told[INTERP_IDENTIFY_BACKLASH]);
		assert_true(d.loop.backlash_mm == 0);
		assert_true(d.left_mm < 0.0006);
		/* And it knows how well it knows. */
		assert_true(fabs(d.loop.velocity_hz - l.velocity_hz) <
			    5 * d.sigma[INTERP_IDENTIFY_VELOCITY]);
		assert_true(fabs(d.loop.kick_mm_s - l.kick_mm_s) <
			    4 * d.sigma[INTERP_IDENTIFY_KICK]);
	}
}

static void loop_over_another_encoder_is_told_too(void **state)
{
	const struct interp_axis_loop l = {
		.gain_1_s = 30, .velocity_hz = 66, .damping = 0.7,
		.kick_mm_s = 0.3, .kick_s = 0.02,
	};
	struct interp_identified d;

	(void)state;
	to_and_fro();
	for (int pushed = 0; pushed < 2; pushed++) {
		record_own(&l, 0.003 * pushed);
		assert_int_equal(interp_identify(&trace, &d), 0);
		check_within(d.loop.gain_1_s, l.gain_1_s, 0.01);
		check_within(d.loop.velocity_hz, l.velocity_hz, 0.1);
		check_within(d.loop.damping, l.damping, 0.1);
		check_within(d.loop.kick_mm_s, l.kick_mm_s, 0.1);
		assert_false(d.sought[INTERP_IDENTIFY_FEEDFORWARD]);
	}
}

static void no_friction_is_found_where_there_is_none(void **state)
{
	const struct interp_axis_loop l = {
		.gain_1_s = 25, .velocity_hz = 50, .damping = 0.8,
	};
	struct interp_identified d;

	(void)state;
	to_and_fro();
	record(&l, 4);
	assert_int_equal(interp_identify(&trace, &d), 0);
	assert_false(d.told[INTERP_IDENTIFY_KICK]);
	assert_true(d.loop.kick_mm_s == 0 && d.loop.backlash_mm == 0);
	check_within(d.loop.velocity_hz, l.velocity_hz, 0.05);
}

/* Rings as of examples/identify.ngc: ever smaller, as fast as 500 mm/s^2 is. */
static void in_rings(void)
{
	static const double mm[] = { 2, 0.5, 0.1, 0.05, 0.02, 0.01 };
	double angle = 0;

	for (int k = 0; k < ROWS; k++) {
		const double r = mm[k * 6 / ROWS];

		angle += PERIOD_S * sqrt(500 / r);
		target[k] = r * sin(angle);
	}
}

static void rings_tell_a_delay_from_a_slow_loop(void **state)
{
	const struct interp_axis_loop l = {
		.gain_1_s = 30, .velocity_hz = 66, .damping = 0.7,
		.delay_s = 0.002, .kick_mm_s = 0.3, .kick_s = 0.02,
	};
	struct interp_identified d;

	(void)state;
	in_rings();
	record(&l, 3);
	assert_int_equal(interp_identify(&trace, &d), 0);
	assert_true(d.sought[INTERP_IDENTIFY_DELAY]);
	check_within(d.loop.delay_s, l.delay_s, 0.1);
	check_within(d.loop.velocity_hz, l.velocity_hz, 0.1);
	check_within(d.loop.kick_mm_s, l.kick_mm_s, 0.05);
}

static void backlash_and_feedforward_are_found(void **state)
{
	const struct interp_axis_loop l = {
		.gain_1_s = 25, .velocity_hz = 50, .damping = 0.8,
		.feedforward = 0.6, .backlash_mm = 0.008,
	};
	struct interp_identified d;

	(void)state;
	to_and_fro();
	record(&l, 9);
	assert_int_equal(interp_identify(&trace, &d), 0);
	assert_true(d.told[INTERP_IDENTIFY_BACKLASH]);
	check_within(d.loop.backlash_mm, l.backlash_mm, 0.05);
	assert_true(d.sought[INTERP_IDENTIFY_FEEDFORWARD]);
	check_within(d.loop.feedforward, l.feedforward, 0.05);
	check_within(d.loop.gain_1_s, l.gain_1_s, 0.05);
}

static void trace_without_excitation_is_refused(void **state)
{
	const struct interp_axis_loop l = {
		.gain_1_s = 25, .velocity_hz = 50, .damping = 0.8,
	};
	struct interp_identified d;

	(void)state;
	for (int k = 0; k < ROWS; k++)
		target[k] = 0.002 * k;
	record(&l, 1);
	assert_int_equal(interp_identify(&trace, &d), -EDOM);
	for (int k = 0; k < ROWS; k++)
		target[k] = 7;
	record(&l, 1);
	assert_int_equal(interp_identify(&trace, &d), -ENODATA);
	to_and_fro();
	record(&l, 1);
	assert_int_equal(interp_identify(&(struct interp_identify_trace) {
		.target_mm = target, .actual_mm = actual, .n = 100,
		.period_s = PERIOD_S }, &d), -ENODATA);
	actual[50] = NAN;
	assert_int_equal(interp_identify(&trace, &d), -EINVAL);
}

static void ridge_finds_the_weights_behind_noise(void **state)
{
	const double truth[INTERP_RIDGE_NFEATURES] = {
		1, -2, 0.5, 0, 3, -1e-3, 20, 0
	};
	struct interp_ridge_training t = { 0 };
	struct interp_ridge r;
	uint64_t s = 11;

	(void)state;
	assert_int_equal(interp_ridge_solve(&t, 1e-6, &r), -EDOM);
	for (int i = 0; i < 20000; i++) {
		double x[INTERP_RIDGE_NFEATURES] = { 0 };
		double y = 0.1 * noise(&s);

		/* The last one never is: it gets no weight, not a NAN. */
		for (int k = 0; k < INTERP_RIDGE_NFEATURES - 1; k++) {
			x[k] = noise(&s) * (k == 5 ? 1000 : 1);
			y += truth[k] * x[k];
		}
		interp_ridge_add(&t, x, y);
	}
	assert_int_equal(interp_ridge_solve(&t, 1e-6, &r), 0);
	for (int k = 0; k < INTERP_RIDGE_NFEATURES; k++)
		assert_near(r.weight[k], truth[k],
				   k == 5 ? 1e-5 : 0.005);
}

static void a_high_price_makes_small_weights(void **state)
{
	struct interp_ridge_training t = { 0 };
	struct interp_ridge cheap, dear;
	const double x[INTERP_RIDGE_NFEATURES] = { 1, 1 };

	(void)state;
	for (int i = 0; i < 10; i++)
		interp_ridge_add(&t, x, 4);
	interp_ridge_solve(&t, 1e-6, &cheap);
	interp_ridge_solve(&t, 10, &dear);
	assert_near(interp_ridge_eval(&cheap, x), 4, 1e-4);
	assert_near(interp_ridge_eval(&dear, x), 4 * 2 / 12.0, 1e-9);
}

static void features_tell_a_turn(void **state)
{
	struct interp_ridge_motion m;
	double x[INTERP_RIDGE_NFEATURES];
	double mm[203];

	(void)state;
	interp_ridge_motion_init(&m, PERIOD_S);
	for (int k = 0; k < 203; k++)
		mm[k] = k < 103 ? 0.01 * k : 0.01 * (205 - k);
	for (int k = 3; k < 104; k++)
		interp_ridge_features(&m, mm + k, x);
	assert_near(x[0], 0, 1e-12);
	assert_near(x[4], 1, 1e-12);
	for (int k = 104; k < 203; k++) {
		interp_ridge_features(&m, mm + k, x);
		assert_near(x[2], -exp(-(k - 104) * PERIOD_S / 0.02),
				   1e-9);
	}
	assert_near(x[4], -1, 1e-12);
	assert_near(x[5], -10, 1e-9);
	assert_near(x[6], 0, 1e-6);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(noisy_trace_tells_the_loops_within_5_percent),
		cmocka_unit_test(loop_over_another_encoder_is_told_too),
		cmocka_unit_test(no_friction_is_found_where_there_is_none),
		cmocka_unit_test(rings_tell_a_delay_from_a_slow_loop),
		cmocka_unit_test(backlash_and_feedforward_are_found),
		cmocka_unit_test(trace_without_excitation_is_refused),
		cmocka_unit_test(ridge_finds_the_weights_behind_noise),
		cmocka_unit_test(a_high_price_makes_small_weights),
		cmocka_unit_test(features_tell_a_turn),
	};

	return cmocka_run_group_tests_name("interp/identify", tests, NULL,
					   NULL);
}
