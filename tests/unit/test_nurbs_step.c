/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_nurbs_step.c - promises of steps along a curve
 */
#include "walk_help.h"

#include "curves.h"
#include "tried/nurbs_step.h"

#define LIMIT_MM	0.001
#define STEPS_MAX	100000

static double points[CURVES_POINTS_MAX][3];

static void stand(struct interp_nurbs_stepper *s, size_t curve,
		  enum interp_nurbs_method m)
{
	struct interp_nurbs c;

	curve_load(&curves_data[curve], points, &c);
	interp_nurbs_stepper_init(s, &c, 0, m);
	s->mm_per_u = 500;
}

/* Farther than the limit, looked at in 64 places? */
static double error_of(struct interp_nurbs_eval *e, double from, double to)
{
	struct interp_nurbs_point a, b, p;
	double most = 0;

	interp_nurbs_at(e, from, 0, &a);
	interp_nurbs_at(e, to, 0, &b);
	for (int i = 1; i < 64; i++) {
		const double x = b.d[0][0] - a.d[0][0];
		const double y = b.d[0][1] - a.d[0][1];
		double px, py, along;

		interp_nurbs_at(e, from + (to - from) * i / 64, 0, &p);
		px = p.d[0][0] - a.d[0][0];
		py = p.d[0][1] - a.d[0][1];
		along = fmin(fmax((px * x + py * y) / (x * x + y * y), 0), 1);
		most = fmax(most, hypot(px - along * x, py - along * y));
	}
	return most;
}

static void the_default_keeps_feed_and_chord_error(void **state)
{
	static const double lengths_mm[] = { 0.025, 0.1, 0.4 };

	(void)state;
	for (size_t i = 0; i < NCURVES * 3; i++) {
		const double step = lengths_mm[i % 3];
		struct interp_nurbs_stepper s;
		struct interp_nurbs_step t;
		double u = 0;
		int n = 0;

		stand(&s, i / 3, INTERP_NURBS_PREDICTOR_CORRECTOR);
		s.chord_error_mm = LIMIT_MM;
		do {
			t = interp_nurbs_step(&s, step);
			assert_true(s.u > u);
			assert_true(error_of(&s.e, u, s.u) <= LIMIT_MM);
			assert_true(t.limited || t.ended ||
				    fabs(t.chord_mm / step - 1) < 1e-6);
			assert_true(t.chord_mm <= step * (1 + 1e-6));
			u = s.u;
		} while (!t.ended && ++n < STEPS_MAX);
		assert_in_range(n, 1, STEPS_MAX - 1);
	}
}

/* Of steps the limit has not shortened; from the middle of the curve, where
 * the last step has not met the end. */
static void steps_back_lead_to_the_same_points(void **state)
{
	static double u[STEPS_MAX];

	(void)state;
	for (size_t i = 0; i < 2; i++) {
		struct interp_nurbs_stepper s;
		int n = 0;

		stand(&s, i, INTERP_NURBS_PREDICTOR_CORRECTOR);
		while (s.u < 0.9) {
			u[n++] = s.u;
			interp_nurbs_step(&s, 0.1);
		}
		while (n-- > 0) {
			interp_nurbs_step(&s, -0.1);
			assert_true(fabs(s.u - u[n]) < 1e-9);
		}
	}
}

/* A cusp of no radius at all: out along a spine and back. */
static void steps_pass_a_cusp_without_going_back(void **state)
{
	const double knots[] = { 0, 0, 0, 1, 1, 1 };
	const double spine[] = { 0, 1, 10, 1, 0, 1 };
	const struct interp_nurbs c = { 2, 1, 3, 1, 0, knots, spine };
	struct interp_nurbs_stepper s;
	struct interp_nurbs_step t;
	double u = 0, top = 0;
	int n = 0;

	(void)state;
	interp_nurbs_stepper_init(&s, &c, 0, INTERP_NURBS_PREDICTOR_CORRECTOR);
	s.chord_error_mm = LIMIT_MM;
	do {
		t = interp_nurbs_step(&s, 0.4);
		assert_true(s.u > u);
		u = s.u;
		top = fmax(top, s.p.d[0][0]);
	} while (!t.ended && ++n < 1000);
	assert_true(t.ended);
	assert_true(top >= 5 - LIMIT_MM);
}

static void every_method_comes_to_both_ends(void **state)
{
	(void)state;
	for (int m = 0; m < INTERP_NURBS_NMETHODS; m++) {
		struct interp_nurbs_stepper s;
		struct interp_nurbs_step t;
		int n = 0;

		stand(&s, 0, (enum interp_nurbs_method)m);
		do
			t = interp_nurbs_step(&s, 0.1);
		while (!t.ended && ++n < STEPS_MAX);
		assert_true(s.u == 1);
		assert_true(interp_nurbs_step(&s, 0.1).ended);
		for (n = 0; n < STEPS_MAX && s.u > 0; n++)
			interp_nurbs_step(&s, -0.1);
		assert_true(s.u == 0);
	}
}

static void methods_have_names(void **state)
{
	(void)state;
	for (int m = 0; m < INTERP_NURBS_NMETHODS; m++)
		assert_int_equal(interp_nurbs_method_parse(
			interp_nurbs_method_name((enum interp_nurbs_method)m)),
			m);
	assert_true(interp_nurbs_method_parse("euler") < 0);
	assert_null(interp_nurbs_method_name(INTERP_NURBS_NMETHODS));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_default_keeps_feed_and_chord_error),
		cmocka_unit_test(steps_back_lead_to_the_same_points),
		cmocka_unit_test(steps_pass_a_cusp_without_going_back),
		cmocka_unit_test(every_method_comes_to_both_ends),
		cmocka_unit_test(methods_have_names),
	};

	return cmocka_run_group_tests_name("interp/nurbs_step", tests, NULL,
					   NULL);
}
