/* SPDX-License-Identifier: Apache-2.0 */
/* test_fit.c - promises of curves through points */
#include "walk_help.h"

#include "curves.h"
#include "interp/nurbs_fit.h"
#include "interp/nurbs_length.h"

#include <errno.h>

#define N	400

static double points[N * 3], knots[N + 4], control[N * 4];
static struct interp_nurbs_own own;

static struct interp_fit fit_of(uint32_t n, uint32_t axes, double tolerance_mm)
{
	own = (struct interp_nurbs_own) { .knots = knots, .points = control,
					  .room = N };
	return (struct interp_fit) { points, n, axes, tolerance_mm };
}

/* From @p to the nearest of many places of the curve. */
static double nearest(struct interp_nurbs_eval *e, const double *p)
{
	const double last = interp_nurbs_last(&e->c);
	double best = HUGE_VAL;

	for (int i = 0; i <= 20000; i++) {
		struct interp_nurbs_point q;
		double d2 = 0;

		interp_nurbs_at(e, last * i / 20000, 0, &q);
		for (uint32_t j = 0; j < e->c.naxes; j++)
			d2 += (q.d[0][j] - p[j]) * (q.d[0][j] - p[j]);
		best = fmin(best, d2);
	}
	return sqrt(best);
}

static void a_helix_fits_with_few_control_points(void **state)
{
	const struct interp_fit f = fit_of(N, 3, 0.001);
	struct interp_nurbs_eval e;
	uint32_t at;

	(void)state;
	for (int i = 0; i < N; i++) {
		points[3 * i] = 5 * cos(i * 0.02);
		points[3 * i + 1] = 5 * sin(i * 0.02);
		points[3 * i + 2] = i * 0.01;
	}
	assert_int_equal(interp_nurbs_fit(&f, &own), 0);
	assert_int_equal(interp_nurbs_check(&own.c, &at), INTERP_NURBS_SOUND);
	assert_true(own.c.npoints < N / 5);
	interp_nurbs_open(&e, &own.c);
	for (uint32_t i = 0; i < N; i += 37)
		assert_true(nearest(&e, points + 3 * i) < 0.0015);
	for (uint32_t j = 0; j < 3; j++) {
		assert_true(control[j] == points[j]);
		assert_true(control[4 * (own.c.npoints - 1) + j] ==
			    points[3 * (N - 1) + j]);
	}
}

/* Points of the butterfly, rounded as a postprocessor rounds them. */
static void the_butterflys_points_fit(void **state)
{
	const struct interp_fit f = fit_of(N, 2, 0.01);
	double data[CURVES_POINTS_MAX][3];
	struct interp_nurbs_eval e;
	struct interp_nurbs c;
	uint32_t fits = 0;

	(void)state;
	curve_load(&curves_data[2], data, &c);
	interp_nurbs_open(&e, &c);
	for (int i = 0; i < N; i++) {
		struct interp_nurbs_point p;

		interp_nurbs_at(&e, 0.04 + i * 0.0004, 0, &p);
		points[2 * i] = round(p.d[0][0] * 1000) / 1000;
		points[2 * i + 1] = round(p.d[0][1] * 1000) / 1000;
	}
	assert_int_equal(interp_nurbs_fit(&f, &own), 0);
	interp_nurbs_open(&e, &own.c);
	for (uint32_t i = 0; i < N; i += 37)
		fits += nearest(&e, points + 2 * i) < 0.0105;
	assert_int_equal(fits, (N + 36) / 37);
}

static void a_corner_is_told_from_a_bend(void **state)
{
	const struct interp_fit f = fit_of(7, 2, 0.001);

	(void)state;
	for (int i = 0; i < 7; i++) {
		points[2 * i] = i < 4 ? i * 0.1 : 0.3;
		points[2 * i + 1] = i < 4 ? 0 : (i - 3) * 0.1;
	}
	for (uint32_t i = 1; i < 6; i++)
		assert_int_equal(interp_fit_corner(&f, i), i == 3);
	/* And no smooth curve goes round it. */
	assert_int_equal(interp_nurbs_fit(&f, &own), -ERANGE);
}

static void lines_far_apart_are_left_alone(void **state)
{
	const struct interp_fit f = fit_of(20, 2, 0.001);

	(void)state;
	for (int i = 0; i < 20; i++) {
		points[2 * i] = 5 * cos(i * 0.3);
		points[2 * i + 1] = 5 * sin(i * 0.3);
	}
	assert_int_equal(interp_nurbs_fit(&f, &own), -ERANGE);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_helix_fits_with_few_control_points),
		cmocka_unit_test(the_butterflys_points_fit),
		cmocka_unit_test(a_corner_is_told_from_a_bend),
		cmocka_unit_test(lines_far_apart_are_left_alone),
	};

	return cmocka_run_group_tests_name("interp/nurbs_fit", tests, NULL,
					   NULL);
}
