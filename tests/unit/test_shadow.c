/* SPDX-License-Identifier: Apache-2.0 */
/* test_shadow.c - promises of the twin beside the machine */
#include "contour_help.h"

#include "interp/shadow.h"

static const struct interp_axis_loop loops[2] = {
	{ .gain_1_s = 30, .velocity_hz = 60, .damping = 0.7 },
	{ .gain_1_s = 21.5, .velocity_hz = 60, .damping = 0.7 },
};

/* A machine of its own beside the shadow. */
struct pair {
	struct interp_shadow shadow;
	struct interp_axis_model machine[2];
	double before[2];
};

static void pair_make(struct pair *p, const struct interp_axis_loop *truth,
		      const double *at)
{
	assert_int_equal(interp_shadow_init(&p->shadow, loops, 2, PERIOD_S), 0);
	for (int k = 0; k < 2; k++) {
		interp_axis_model_init(&p->machine[k], &truth[k], PERIOD_S,
				       at[k]);
		p->before[k] = at[k];
	}
}

static struct interp_shadow_error pair_step(struct pair *p, const double *at)
{
	const double pulse_mm = 0.001;
	double target[2], actual[2];
	struct interp_shadow_error e;

	for (int k = 0; k < 2; k++) {
		target[k] = floor(at[k] / pulse_mm + 0.5) * pulse_mm;
		actual[k] = p->machine[k].actual_mm;
	}
	interp_shadow_step(&p->shadow, target, target, actual, &e);
	for (int k = 0; k < 2; k++) {
		interp_axis_model_follow(&p->machine[k], target[k],
					 p->before[k]);
		p->before[k] = target[k];
	}
	return e;
}

/* The largest errors of a turn of @mm_s round a circle of 10 mm. */
static struct interp_shadow_error turn(const struct interp_axis_loop *truth,
				       double mm_s)
{
	struct interp_shadow_error most = { 0 };
	struct pair p;

	pair_make(&p, truth, (const double[2]) { 10, 0 });
	for (int i = 0; i < 6 / mm_s * 10000; i++) {
		const double u = i * mm_s / 10000;
		const struct interp_shadow_error e = pair_step(&p,
			(const double[2]) { 10 * cos(u), 10 * sin(u) });

		most.measured_mm = fmax(most.measured_mm, e.measured_mm);
		most.predicted_mm = fmax(most.predicted_mm, e.predicted_mm);
		most.missed_mm = fmax(most.missed_mm, e.missed_mm);
	}
	return most;
}

static void machine_that_is_as_believed_is_predicted(void **state)
{
	const struct interp_shadow_error e = turn(loops, 20);
	/* v (1/K_y - 1/K_x) sin cos of two lags, and what the circle adds. */
	const double lag = 20 * (1 / 21.5 - 1 / 30.0) / 2;

	(void)state;
	assert_near(e.measured_mm, lag, 0.35 * lag);
	assert_near(e.predicted_mm, e.measured_mm, 1e-9);
	assert_near(e.missed_mm, 0, 1e-9);
}

static void another_machine_is_found_out(void **state)
{
	struct interp_axis_loop worn[2] = { loops[0], loops[1] };
	struct interp_shadow_error e;

	(void)state;
	worn[1].gain_1_s = 15;
	e = turn(worn, 20);
	assert_true(e.measured_mm > 1.5 * e.predicted_mm);
	assert_true(e.missed_mm > 0.2);
}

static void slow_targets_are_a_path_not_stairs(void **state)
{
	const struct interp_shadow_error e = turn(loops, 0.5);

	(void)state;
	/* 4 um of lag at this speed, and a pulse of rounding. */
	assert_true(e.measured_mm < 0.006);
	assert_true(e.measured_mm > 0.001);
}

static void way_back_is_a_path_too(void **state)
{
	struct pair p;
	double most = 0;

	(void)state;
	pair_make(&p, loops, (const double[2]) { 0, 0 });
	for (int i = 0; i < 4000; i++) {
		const double x = 0.01 * (i < 2000 ? i : 4000 - i);
		const struct interp_shadow_error e = pair_step(&p,
			(const double[2]) { x, 0 });

		most = fmax(most, e.measured_mm);
	}
	/* One axis has no contour error; its turn shows for a moment. */
	assert_true(most < 0.012);
}

static void lost_periods_begin_it_anew(void **state)
{
	struct interp_shadow_error e = { 0 };
	struct pair p;

	(void)state;
	pair_make(&p, loops, (const double[2]) { 0, 0 });
	for (int i = 0; i < 100; i++)
		pair_step(&p, (const double[2]) { 0.01 * i, 0 });
	interp_shadow_forget(&p.shadow);
	for (int k = 0; k < 2; k++) {
		interp_axis_model_init(&p.machine[k], &loops[k], PERIOD_S, 7);
		p.before[k] = 7;
	}
	for (int i = 0; i < 100; i++)
		e = pair_step(&p, (const double[2]) { 7 + 0.01 * i, 7 });
	assert_true(e.missed_mm < 1e-9);
	assert_true(e.measured_mm < 1e-6);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(machine_that_is_as_believed_is_predicted),
		cmocka_unit_test(another_machine_is_found_out),
		cmocka_unit_test(slow_targets_are_a_path_not_stairs),
		cmocka_unit_test(way_back_is_a_path_too),
		cmocka_unit_test(lost_periods_begin_it_anew),
	};

	return cmocka_run_group_tests_name("interp/shadow", tests, NULL, NULL);
}
