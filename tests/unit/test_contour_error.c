/* SPDX-License-Identifier: Apache-2.0 */
/* test_contour_error.c - promises of the foot on a path */
#include "contour_help.h"

static void foot_of_a_circle_is_exact(void **state)
{
	struct interp_contour c;
	struct interp_contour_error e;

	(void)state;
	interp_contour_begin(&c, &circle, 0, 0.02);
	for (int i = 0; i < 5000; i++) {
		const double u = i * 0.001, r = 10 + 0.15 * sin(7 * u);
		const double q[INTERP_NAXES] = { r * cos(u), r * sin(u) };

		interp_contour_step(&c, q, u + 0.05, &e);
		assert_near(e.u, u, 1e-8);
		assert_near(e.mm, fabs(r - 10), 1e-9);
		assert_near(hypot(e.vector_mm[0], e.vector_mm[1]), e.mm,
				   1e-12);
	}
}

static void foot_goes_back_when_travel_does(void **state)
{
	struct interp_contour c;
	struct interp_contour_error e;

	(void)state;
	interp_contour_begin(&c, &circle, 3, 0.02);
	for (int i = 0; i < 2000; i++) {
		const double u = 3 - i * 0.001;
		const double q[INTERP_NAXES] = { 10.1 * cos(u), 10.1 * sin(u) };

		interp_contour_step(&c, q, u - 0.05, &e);
		assert_near(e.u, u, 1e-8);
	}
}

/* The same machine going in and out of a tip, cut by so much. */
static void place_near_tip(double u, double toward, double *q)
{
	struct interp_contour_point p;

	tip_at(NULL, u, &p);
	q[0] = p.mm[0];
	q[1] = p.mm[1] * (1 - toward);
}

static void foot_stays_on_the_branch_it_is_on(void **state)
{
	struct interp_contour c;
	struct interp_contour_error e;
	double q[INTERP_NAXES] = { 0 };

	(void)state;
	/* Far beyond the middle: the other branch is much nearer. */
	interp_contour_begin(&c, &tip, -2, 0.02);
	for (int i = 0; i < 1000; i++) {
		const double u = -2 + i * 0.001;

		place_near_tip(u, 1.5, q);
		interp_contour_step(&c, q, u, &e);
		assert_true(e.u < 0);
		assert_true(e.mm > 0.1);
	}
	/* Having gone round, it does not come back to the first. */
	interp_contour_begin(&c, &tip, 1, 0.02);
	for (int i = 0; i < 1000; i++) {
		const double u = 1 + i * 0.001;

		place_near_tip(u, 1.5, q);
		interp_contour_step(&c, q, u + 0.5, &e);
		assert_true(e.u >= 1 - 0.01);
	}
}

static void foot_gets_round_a_tip_that_is_cut_off(void **state)
{
	struct interp_contour c;
	struct interp_contour_error e;
	double last = -2;

	(void)state;
	interp_contour_begin(&c, &tip, -2, 0.02);
	/* Turns round 0.3 mm before the tip, while the set values go on. */
	for (int i = 0; i < 4000; i++) {
		const double s = -2 + i * 0.001, set_u = fmin(s + 0.4, 10);
		const double x = -fmax(fabs(s), 0.7);
		const double q[INTERP_NAXES] = {
			x, fmin(fmax(s, -0.7), 0.7) * 0.15 * 0.7
		};

		interp_contour_step(&c, q, set_u, &e);
		assert_true(e.u >= last - 0.06);
		assert_true(e.mm < 0.25);
		last = fmax(last, e.u);
	}
	assert_true(e.u > 1.5);
}

static void noise_does_not_carry_the_foot_away(void **state)
{
	struct interp_contour c;
	struct interp_contour_error e;
	uint64_t s = 5;

	(void)state;
	interp_contour_begin(&c, &circle, 1, 0.02);
	for (int i = 0; i < 1000; i++) {
		double q[INTERP_NAXES] = { 10 * cos(1.0), 10 * sin(1.0) };

		for (int k = 0; k < 2; k++) {
			s = s * 6364136223846793005u + 1442695040888963407u;
			q[k] += 0.002 * ((double)(s >> 40) * 0x1p-24 - 0.5);
		}
		interp_contour_step(&c, q, 1.1, &e);
		assert_true(e.mm < 0.0015);
		assert_true(fabs(e.u - 1) * 10 < 0.0015);
	}
}

static void foot_stays_inside_the_path(void **state)
{
	struct interp_contour c;
	struct interp_contour_error e;
	const double beyond[INTERP_NAXES] = { 10 * cos(6.1), 10 * sin(6.1) };

	(void)state;
	interp_contour_begin(&c, &circle, 5.99, 0.02);
	for (int i = 0; i < 10; i++)
		interp_contour_step(&c, beyond, 6, &e);
	assert_near(e.u, 6, 1e-9);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(foot_of_a_circle_is_exact),
		cmocka_unit_test(foot_goes_back_when_travel_does),
		cmocka_unit_test(foot_stays_on_the_branch_it_is_on),
		cmocka_unit_test(foot_gets_round_a_tip_that_is_cut_off),
		cmocka_unit_test(noise_does_not_carry_the_foot_away),
		cmocka_unit_test(foot_stays_inside_the_path),
	};

	return cmocka_run_group_tests_name("interp/contour", tests, NULL, NULL);
}
