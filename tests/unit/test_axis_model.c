/* SPDX-License-Identifier: Apache-2.0 */
/* test_axis_model.c - promises of the axis model and its Kalman filter */
#include "contour_help.h"

#include "interp/kalman.h"

#include <errno.h>

static const struct interp_axis_loop plain = {
	.gain_1_s = 30, .velocity_hz = 60, .damping = 0.7,
};

/* Place after a step of the demanded speed to 1 mm/s, by the textbook. */
static double step_answer(const struct interp_axis_loop *l, double t)
{
	const double w = 2 * M_PI * l->velocity_hz, z = l->damping;
	const double wd = w * sqrt(1 - z * z);

	if (t <= 0)
		return 0;
	return t - 2 * z / w + exp(-z * w * t) / w *
	       (2 * z * cos(wd * t) + (2 * z * z - 1) * w / wd * sin(wd * t));
}

static void state_space_answers_a_step_like_the_textbook(void **state)
{
	static const double delays_s[] = { 0, 0.001, 0.0004, 0.0037 };

	(void)state;
	for (int d = 0; d < 4; d++) {
		struct interp_axis_loop l = plain;
		struct interp_axis_model m;

		l.delay_s = delays_s[d];
		assert_int_equal(interp_axis_model_init(&m, &l, PERIOD_S, 5),
				 0);
		for (int k = 1; k < 100; k++) {
			interp_axis_model_step(&m, 1);
			assert_near(interp_axis_model_actual_mm(&m) - 5,
					   step_answer(&l, k * PERIOD_S -
						       l.delay_s), 1e-12);
		}
	}
}

static void quotient_answers_like_the_state_space(void **state)
{
	struct interp_axis_model m;
	struct interp_axis_quotient q;
	double y[4] = { 0 }, u[4] = { 0 };

	(void)state;
	interp_axis_model_init(&m, &plain, PERIOD_S, 0);
	interp_axis_model_quotient(&m, &q);
	for (int k = 1; k < 200; k++) {
		const double demand = sin(k * 0.3);
		double next;

		interp_axis_model_step(&m, demand);
		u[0] = demand;
		next = q.b[0] * u[0] + q.b[1] * u[1] + q.b[2] * u[2] -
		       q.a[0] * y[0] - q.a[1] * y[1] - q.a[2] * y[2];
		for (int i = 2; i > 0; i--) {
			y[i] = y[i - 1];
			u[i] = u[i - 1];
		}
		y[0] = next;
		assert_near(next, interp_axis_model_actual_mm(&m),
				   1e-10);
	}
}

/* Does the loop die away from a push, at @part of its limit? */
static bool settles(double delay_s, double part)
{
	struct interp_axis_loop l = plain;
	struct interp_axis_model m;

	l.delay_s = delay_s;
	interp_axis_model_init(&m, &l, PERIOD_S, 0);
	l.gain_1_s = part * interp_axis_model_gain_max_1_s(&m);
	interp_axis_model_init(&m, &l, PERIOD_S, 1);
	for (int k = 0; k < 4000; k++)
		interp_axis_model_follow(&m, 0, 0);
	return fabs(interp_axis_model_actual_mm(&m)) < 1;
}

static void gain_limit_is_where_the_loop_swings(void **state)
{
	(void)state;
	for (int ms = 0; ms < 5; ms++) {
		assert_true(settles(ms * 0.00073, 0.99));
		assert_false(settles(ms * 0.00073, 1.01));
	}
}

static void backlash_is_lost_at_a_turn(void **state)
{
	struct interp_axis_loop l = plain;
	struct interp_axis_model m;
	double top;

	(void)state;
	l.backlash_mm = 0.01;
	interp_axis_model_init(&m, &l, PERIOD_S, 0);
	for (int k = 0; k < 200; k++)
		interp_axis_model_step(&m, 1);
	top = interp_axis_model_actual_mm(&m);
	assert_near(m.x[0] - top, 0.005, 1e-12);
	for (int k = 0; k < 200; k++)
		interp_axis_model_step(&m, -1);
	assert_near(m.x[0] - interp_axis_model_actual_mm(&m), -0.005,
			   1e-12);
}

static void friction_kicks_at_a_turn_only(void **state)
{
	struct interp_axis_loop l = plain;
	struct interp_axis_model m, smooth;
	double before, after;

	(void)state;
	l.kick_mm_s = 0.3;
	l.kick_s = 0.02;
	interp_axis_model_init(&m, &l, PERIOD_S, 0);
	interp_axis_model_init(&smooth, &plain, PERIOD_S, 0);
	for (int k = 0; k < 200; k++) {
		interp_axis_model_step(&m, 1);
		interp_axis_model_step(&smooth, 1);
	}
	before = m.actual_mm - smooth.actual_mm;
	for (int k = 0; k < 300; k++) {
		interp_axis_model_step(&m, -1);
		interp_axis_model_step(&smooth, -1);
	}
	after = m.actual_mm - smooth.actual_mm;
	assert_near(before, 0, 1e-12);
	/* 0.3 mm/s times 20 ms against the new motion, which is back. */
	assert_near(after, 0.006, 1e-5);
}

static void nonsense_is_refused(void **state)
{
	struct interp_axis_loop l = plain;
	struct interp_axis_model m;

	(void)state;
	l.gain_1_s = 0;
	assert_int_equal(interp_axis_model_init(&m, &l, PERIOD_S, 0), -EINVAL);
	l = plain;
	l.damping = NAN;
	assert_int_equal(interp_axis_model_init(&m, &l, PERIOD_S, 0), -EINVAL);
	l = plain;
	l.delay_s = 0.0151;
	assert_int_equal(interp_axis_model_init(&m, &l, PERIOD_S, 0), -ERANGE);
}

static double uniform(uint64_t *s)
{
	*s = *s * 6364136223846793005u + 1442695040888963407u;
	return (double)(*s >> 11) * 0x1p-53 - 0.5;
}

static void filter_is_nearer_than_the_encoder(void **state)
{
	const struct interp_kalman_noise noise = { 0.5, 0.005 };
	struct interp_axis_loop truth = plain;
	struct interp_axis_model m;
	struct interp_kalman k;
	double raw = 0, filtered = 0, speed = 0;
	uint64_t s = 3;

	(void)state;
	/* The machine is not quite what the filter believes. */
	truth.velocity_hz = 66;
	interp_axis_model_init(&m, &truth, PERIOD_S, 0);
	assert_int_equal(interp_kalman_init(&k, &plain, PERIOD_S, &noise, 0),
			 0);
	for (int i = 0; i < 5000; i++) {
		const double u = 10 * sin(i * 0.004);
		const double measured = m.actual_mm +
					0.005 * sqrt(12) * uniform(&s);

		interp_kalman_correct(&k, measured);
		raw += pow(measured - m.actual_mm, 2);
		filtered += pow(interp_kalman_place_mm(&k) - m.actual_mm, 2);
		speed = fmax(speed, fabs(k.model.x[1] - m.x[1]));
		interp_axis_model_step(&m, u);
		interp_kalman_predict(&k, u);
	}
	assert_true(filtered < raw / 9);
	assert_true(speed < 0.5);
}

static void filter_finds_a_place_it_was_not_told(void **state)
{
	const struct interp_kalman_noise noise = { 5, 0.001 };
	struct interp_axis_model m;
	struct interp_kalman k;

	(void)state;
	interp_axis_model_init(&m, &plain, PERIOD_S, 3);
	interp_kalman_init(&k, &plain, PERIOD_S, &noise, 2.9);
	for (int i = 0; i < 500; i++) {
		interp_kalman_correct(&k, m.actual_mm);
		interp_axis_model_step(&m, 2);
		interp_kalman_predict(&k, 2);
	}
	assert_near(interp_kalman_place_mm(&k), m.actual_mm, 1e-4);
}

static void kick_begins_with_the_turn_and_not_with_the_period(void **state)
{
	const struct interp_axis_loop l = {
		.gain_1_s = 30, .velocity_hz = 50, .damping = 0.7,
		.kick_mm_s = 0.3, .kick_s = 0.02,
	};
	struct interp_axis_model coarse, fine;

	(void)state;
	interp_axis_model_init(&coarse, &l, PERIOD_S, 0);
	interp_axis_model_init(&fine, &l, PERIOD_S / 50, 0);
	for (int k = 0; k < 4000; k++) {
		/* A period of its own for each turn. */
		const double u = 5 * sin(0.0173 * k) + sin(0.031 * k);

		interp_axis_model_step(&coarse, u);
		for (int i = 0; i < 50; i++)
			interp_axis_model_step(&fine, u);
		/* A whole period late would be 0.3 um each. */
		assert_near(coarse.actual_mm, fine.actual_mm, 3e-5);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(state_space_answers_a_step_like_the_textbook),
		cmocka_unit_test(quotient_answers_like_the_state_space),
		cmocka_unit_test(gain_limit_is_where_the_loop_swings),
		cmocka_unit_test(backlash_is_lost_at_a_turn),
		cmocka_unit_test(friction_kicks_at_a_turn_only),
		cmocka_unit_test(nonsense_is_refused),
		cmocka_unit_test(filter_is_nearer_than_the_encoder),
		cmocka_unit_test(filter_finds_a_place_it_was_not_told),
		cmocka_unit_test(kick_begins_with_the_turn_and_not_with_the_period),
	};

	return cmocka_run_group_tests_name("interp/axis_model", tests, NULL,
					   NULL);
}
