/* SPDX-License-Identifier: Apache-2.0 */
/* test_profile.c - shapes of short lines, and speeds along them */
#include "speed/knots.h"
#include "speed/profile.h"
#include "speed/run.h"

#include "interp/smaller.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#define NODES		4001
#define PARTS_MOST	64

struct nodes {
	double s[NODES], x[2 * NODES];
	struct run run;
};

/* A curve of X and Y in lines of @mm, rounded to @unit. */
static void write_curve(struct nodes *r, void (*at)(double s, double *x),
			double mm, double way_mm, double unit)
{
	r->run = (struct run) { .columns = 2, .along = 3, .s_mm = r->s,
				.x = r->x, .tolerance = { 0.001, 0.001 },
				.corner_mm = 0.005 };
	for (int i = 0; i * mm <= way_mm + 1e-9; i++) {
		double *x = r->x + 2 * r->run.n, at_i[2];

		at(i * mm, at_i);
		for (int k = 0; k < 2; k++)
			x[k] = round(at_i[k] / unit) * unit;
		r->s[r->run.n] = r->run.n == 0 ? 0 :
			r->s[r->run.n - 1] + hypot(x[0] - x[-2],
						   x[1] - x[-1]);
		r->run.n += r->run.n == 0 ||
			    r->s[r->run.n] > r->s[r->run.n - 1];
	}
}

static void wave(double s, double *x)
{
	x[0] = s;
	x[1] = 3 * sin(0.7 * s) / 4;
}

static void line(double s, double *x)
{
	x[0] = 0.6 * s;
	x[1] = 0.8 * s;
}

static void bent(double s, double *x)
{
	x[0] = smaller(s, 5);
	x[1] = larger(s - 5, 0);
}

struct found {
	int n;
	size_t intervals, ends[PARTS_MOST];
};

static int note(void *to, struct run_part *p)
{
	struct found *f = to;

	f->ends[f->n++] = p->last;
	f->intervals += p->shape.n;
	return 0;
}

static struct found parts_of(const struct nodes *r)
{
	struct found f = { 0 };

	assert_int_equal(run_parts(&r->run, note, &f), 0);
	return f;
}

static void a_wave_has_the_same_shape_in_short_and_in_long_lines(void **state)
{
	static struct nodes r;

	(void)state;
	for (int k = 0; k < 3; k++) {
		const double mm[] = { 0.005, 0.02, 0.2 };
		struct found f;

		write_curve(&r, wave, mm[k], 20, 0.001);
		f = parts_of(&r);
			assert_int_equal(f.n, 1);
		assert_in_range(f.intervals, 8, 64);
	}
}

static void a_line_is_straight_however_it_is_written(void **state)
{
	static struct nodes r;
	struct found f;

	(void)state;
	write_curve(&r, line, 0.007, 20, 0.001);
	f = parts_of(&r);
	assert_int_equal(f.n, 1);
	assert_int_equal(f.intervals, 0);
}

static void a_corner_is_found_where_it_is(void **state)
{
	static struct nodes r;
	struct found f;

	(void)state;
	write_curve(&r, bent, 0.01, 10, 0.001);
	f = parts_of(&r);
	assert_int_equal(f.n, 2);
	assert_int_equal(f.ends[0], 500);
	assert_int_equal(f.intervals, 0);
}

/* -- Speeds ---------------------------------------------------------------- */

static const struct interp_axes axes = {
	.n = 2, .v_mm_s = { 50, 50 }, .a_mm_s2 = { 500, 800 },
	.j_mm_s3 = { 20000, 30000 },
};

static void straight_way(const void *of, double s_mm, double *ret)
{
	const double *by = of;

	(void)s_mm;
	for (int k = 0; k < 2; k++) {
		ret[3 * k] = by[k];
		ret[3 * k + 1] = ret[3 * k + 2] = 0;
	}
}

static void part_way(const void *of, double s_mm, double *ret)
{
	run_part_way(of, s_mm, ret);
}

static void a_line_takes_the_time_of_its_s_curve(void **state)
{
	const double by[] = { 1, 0 }, corner = 0;
	const struct profile_section k = { 0, 20, INFINITY, straight_way, by };
	/* v/a + a/j for the ramps, to 50 mm/s */
	const double exactly = 20. / 50 + 50. / 500 + 500. / 20000;
	struct profile p;

	(void)state;
	assert_int_equal(profile_solve(&p, &axes, &k, 1, &corner), 0);
	assert_true(fabs(profile_s(&p) / exactly - 1) < 1e-3);
	profile_free(&p);
}

static int solve_part(void *to, struct run_part *part)
{
	const double corner = 0;
	const struct run *r = to;
	const struct profile_section k = {
		r->s_mm[part->first], r->s_mm[part->last], INFINITY, part_way,
		part
	};
	struct profile_asked most = { 0, 0, 0 };
	struct profile p;

	assert_int_equal(profile_solve(&p, &axes, &k, 1, &corner), 0);
	for (size_t i = 0; i < p.n; i++) {
		const struct profile_asked a = profile_asked(&p, &axes, i);

		most.v = larger(most.v, a.v);
		most.a = larger(most.a, a.a);
		most.j = larger(most.j, a.j);
	}
	assert_true(most.v < 1.01 && most.a < 1.02 && most.j < 1.05);
	profile_free(&p);
	return 0;
}

static void along_a_wave_each_axis_keeps_its_limits(void **state)
{
	static struct nodes r;

	(void)state;
	for (int k = 0; k < 3; k++) {
		const double mm[] = { 0.005, 0.02, 0.2 };

		write_curve(&r, wave, mm[k], 20, 0.001);
		assert_int_equal(run_parts(&r.run, solve_part, &r.run), 0);
	}
}

/* -- Tables ---------------------------------------------------------------- */

/* By differences of places a millisecond apart. */
static void check_table(const struct interp_speeds *k, struct run_part *part)
{
	const double t = 1e-3, end = k->at[k->n - 1].t_s;
	double s[4], way[2 * INTERP_AXES_WAY], most = 0;

	for (double from = 0; from + 3 * t < end; from += t) {
		struct interp_scurve_state middle;
		double j, a;

		for (int i = 0; i < 4; i++)
			s[i] = interp_speeds_at(k, from + i * t).x_mm;
		assert_true(s[0] <= s[1] && s[1] <= s[2] && s[2] <= s[3]);
		assert_true(fabs(interp_speeds_s(k, s[1]) - from - t) < 1e-6);
		middle = interp_speeds_at(k, from + 1.5 * t);
		a = middle.a_mm_s2;
		j = (s[3] - 3 * s[2] + 3 * s[1] - s[0]) / (t * t * t);
		run_part_way(part, middle.x_mm, way);
		for (int i = 0; i < 2; i++) {
			const double *w = way + i * INTERP_AXES_WAY;
			const double v = middle.v_mm_s;

			most = larger(most, fabs(w[0] * j + 3 * w[1] * v * a +
						 w[2] * v * v * v) /
					    axes.j_mm_s3[i]);
			assert_true(fabs(w[0] * a + w[1] * v * v) <
				    1.03 * axes.a_mm_s2[i]);
		}
	}
	if (most > 1.15)
		fail_msg("%g times an axis's jerk", most);
}

static int write_table(void *to, struct run_part *part)
{
	const struct run *r = to;
	const double corner = 0;
	const struct profile_section k = {
		r->s_mm[part->first], r->s_mm[part->last], INFINITY, part_way,
		part
	};
	struct interp_speed_knot *knots;
	struct profile p;
	long n;

	assert_int_equal(profile_solve(&p, &axes, &k, 1, &corner), 0);
	n = knots_make(&p, &axes, &knots);
	assert_in_range(n, 2, 100);
	assert_true(fabs(knots[n - 1].t_s - profile_s(&p)) < 1e-12);
	check_table(&(struct interp_speeds) { knots, (size_t)n }, part);
	free(knots);
	profile_free(&p);
	return 0;
}

static void a_table_of_few_knots_keeps_the_limits(void **state)
{
	static struct nodes r;

	(void)state;
	for (int k = 0; k < 3; k++) {
		const double mm[] = { 0.005, 0.02, 0.2 };

		write_curve(&r, wave, mm[k], 20, 0.001);
		assert_int_equal(run_parts(&r.run, write_table, &r.run), 0);
	}
}

/* The same part from its other end: r' and the third have the other sign. */
static void part_back(const void *of, double s_mm, double *ret)
{
	const struct run_part *part = of;
	const double *knot = part->shape.knot_mm;

	run_part_way(part, knot[5] + knot[5 + part->shape.n] - s_mm, ret);
	for (int k = 0; k < 2; k++) {
		ret[3 * k] = -ret[3 * k];
		ret[3 * k + 2] = -ret[3 * k + 2];
	}
}

static int solve_both_ways(void *to, struct run_part *part)
{
	const struct run *r = to;
	const double corner = 0;
	struct profile_section k = {
		r->s_mm[part->first], r->s_mm[part->last], INFINITY, part_way,
		part
	};
	struct profile there, back;

	assert_int_equal(profile_solve(&there, &axes, &k, 1, &corner), 0);
	k.way = part_back;
	assert_int_equal(profile_solve(&back, &axes, &k, 1, &corner), 0);
	assert_true(fabs(profile_s(&there) / profile_s(&back) - 1) < 1e-3);
	profile_free(&there);
	profile_free(&back);
	return 0;
}

static void the_way_back_takes_the_same_time(void **state)
{
	static struct nodes r;

	(void)state;
	write_curve(&r, wave, 0.02, 17, 0.001);
	assert_int_equal(run_parts(&r.run, solve_both_ways, &r.run), 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(
			a_wave_has_the_same_shape_in_short_and_in_long_lines),
		cmocka_unit_test(a_line_is_straight_however_it_is_written),
		cmocka_unit_test(a_corner_is_found_where_it_is),
		cmocka_unit_test(a_line_takes_the_time_of_its_s_curve),
		cmocka_unit_test(along_a_wave_each_axis_keeps_its_limits),
		cmocka_unit_test(the_way_back_takes_the_same_time),
		cmocka_unit_test(a_table_of_few_knots_keeps_the_limits),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
