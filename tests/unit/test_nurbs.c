/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_nurbs.c - promises of curves: points, derivatives, lengths, knots
 *
 * Over random curves; the seed is printed.
 */
#include "walk_help.h"

#include "curves.h"
#include "tried/nurbs_edit.h"
#include "interp/nurbs_way.h"
#include "interp/nurbs_length.h"
#include "random_curve.h"
#include "seed.h"

#include <math.h>
#include <errno.h>

#define ROUNDS	SEED_ROUNDS(2000)
#define ROOM	64

static uint64_t seed;

/* The definition itself, in long double: N_i,p by recursion. */
static long double basis(const struct interp_nurbs *c, uint32_t i, uint32_t p,
			 long double u)
{
	const double *k = c->knots;
	long double sum = 0;

	if (p == 0)
		return (k[i] <= u && u < k[i + 1]) ||
		       (u == k[c->npoints] && k[i] < u && k[i + 1] == u);
	if (k[i + p] > k[i])
		sum += (u - k[i]) / ((long double)k[i + p] - k[i]) *
		       basis(c, i, p - 1, u);
	if (k[i + p + 1] > k[i + 1])
		sum += (k[i + p + 1] - u) /
		       ((long double)k[i + p + 1] - k[i + 1]) *
		       basis(c, i + 1, p - 1, u);
	return sum;
}

static void defined(const struct interp_nurbs *c, double u,
		    double ret[INTERP_NAXES])
{
	long double sum[INTERP_NAXES + 1] = { 0 };

	for (uint32_t i = 0; i < c->npoints; i++) {
		const long double n = basis(c, i, c->degree, u);

		for (uint32_t j = 0; j <= c->naxes; j++)
			sum[j] += n * c->points[i * (c->naxes + 1) + j];
	}
	for (uint32_t j = 0; j < c->naxes; j++)
		ret[j] = (double)(sum[j] / sum[c->naxes]);
}

static void a_point_is_what_the_definition_says(void **state)
{
	uint64_t s = seed;

	(void)state;
	for (int k = 0; k < ROUNDS; k++) {
		struct interp_nurbs_eval e;
		struct random_curve r;

		random_curve(&s, &r);
		interp_nurbs_open(&e, &r.c);
		for (int i = 0; i <= 4; i++) {
			const double u = i == 4 ? 1 : curve_uniform(&s, 0, 1);
			struct interp_nurbs_point p;
			double want[INTERP_NAXES];

			interp_nurbs_at(&e, u, 0, &p);
			defined(&r.c, u, want);
			for (uint32_t j = 0; j < r.c.naxes; j++)
				assert_true(fabs(p.d[0][j] - want[j]) <=
					    1e-12 * 100);
		}
	}
}

/* Central difference of eighth order of derivative @k - 1. */
static double difference(struct interp_nurbs_eval *e, double u, double h,
			 int k, uint32_t axis)
{
	static const double by[] = { 4 / 5.0, -1 / 5.0, 4 / 105.0, -1 / 280.0 };
	double sum = 0;

	for (int i = 1; i <= 4; i++) {
		struct interp_nurbs_point a, b;

		interp_nurbs_at(e, u + i * h, k - 1, &a);
		interp_nurbs_at(e, u - i * h, k - 1, &b);
		sum += by[i - 1] * (a.d[k - 1][axis] - b.d[k - 1][axis]);
	}
	return sum / h;
}

/* In the middle of a span, so that no knot is among the differences. */
static void derivatives_are_those_of_finite_differences(void **state)
{
	uint64_t s = seed;

	(void)state;
	for (int k = 0; k < ROUNDS; k++) {
		struct interp_nurbs_eval e;
		struct interp_nurbs_point p;
		struct random_curve r;
		double u, h, scale[4];

		random_curve(&s, &r);
		interp_nurbs_open(&e, &r.c);
		interp_nurbs_at(&e, curve_uniform(&s, 0, 1), 0, &p);
		u = (e.from + e.to) / 2;
		h = (e.to - e.from) / 400;
		for (int d = 0; d < 4; d++)
			scale[d] = 100 / pow(20 * h, d);
		interp_nurbs_at(&e, u, 3, &p);
		for (int d = 1; d <= 3; d++) {
			for (uint32_t j = 0; j < r.c.naxes; j++) {
				const double want = difference(&e, u, h, d, j);

				assert_true(fabs(p.d[d][j] - want) <=
					    1e-9 * (fabs(want) + scale[d]));
			}
		}
	}
}

static void a_circle_is_round_and_as_long_as_it_is(void **state)
{
	double points[CURVES_POINTS_MAX][3];
	struct interp_nurbs_eval e;
	struct interp_nurbs c;

	(void)state;
	curve_load(&curves_data[0], points, &c);
	interp_nurbs_open(&e, &c);
	for (int i = 0; i <= 1000; i++) {
		struct interp_nurbs_point p;
		struct interp_nurbs_way way;

		interp_nurbs_at(&e, i / 1000.0, 0, &p);
		assert_true(fabs(hypot(p.d[0][0], p.d[0][1]) - 50) < 1e-12);
		interp_nurbs_way(&e, i / 1000.0, &way);
		assert_true(fabs(hypot(way.d[1][0], way.d[1][1]) - 0.02) <
			    1e-12);
	}
	assert_true(fabs(interp_nurbs_length(&e, 0, 1, 1e-9) -
			 100 * M_PI) < 1e-9);
}

/* -- Edits ---------------------------------------------------------------- */

struct made_curve {
	struct interp_nurbs_own own;
	double knots[ROOM + 12], points[ROOM * (INTERP_NAXES + 1)];
};

static struct made_curve *room(struct made_curve *m)
{
	m->own = (struct interp_nurbs_own) { .knots = m->knots,
					     .points = m->points,
					     .room = ROOM };
	return m;
}

static void assert_same(const struct interp_nurbs *a,
			const struct interp_nurbs *b, double from, double to,
			double within)
{
	struct interp_nurbs_eval ea, eb;
	uint32_t at;

	assert_int_equal(interp_nurbs_check(b, &at), INTERP_NURBS_SOUND);
	interp_nurbs_open(&ea, a);
	interp_nurbs_open(&eb, b);
	for (int i = 0; i <= 20; i++) {
		const double u = from + (to - from) * i / 20;
		struct interp_nurbs_point pa, pb;

		interp_nurbs_at(&ea, u, 0, &pa);
		interp_nurbs_at(&eb, u, 0, &pb);
		for (uint32_t j = 0; j < a->naxes; j++)
			assert_true(fabs(pa.d[0][j] - pb.d[0][j]) <= within);
	}
}

static void a_knot_more_is_the_same_curve(void **state)
{
	static struct made_curve m;
	uint64_t s = seed;

	(void)state;
	for (int k = 0; k < ROUNDS; k++) {
		struct random_curve r;
		double u;

		random_curve(&s, &r);
		u = curve_uniform(&s, 0.01, 0.99);
		assert_int_equal(interp_nurbs_insert(&r.c, u, r.c.degree,
						     &room(&m)->own), 0);
		assert_same(&r.c, &m.own.c, 0, 1, 1e-11);
		assert_int_equal(interp_nurbs_insert(&r.c, u, r.c.degree + 1,
						     &room(&m)->own), -EINVAL);
		assert_int_equal(interp_nurbs_insert(&r.c, 0, 1, &m.own),
				 -EINVAL);
		m.own.room = r.c.npoints;
		assert_int_equal(interp_nurbs_insert(&r.c, u, 1, &m.own),
				 -ENOSPC);
	}
}

static void two_pieces_are_the_curve(void **state)
{
	static struct made_curve a, b;
	uint64_t s = seed;

	(void)state;
	for (int k = 0; k < ROUNDS; k++) {
		struct random_curve r;
		double u;

		random_curve(&s, &r);
		u = k % 2 ? curve_uniform(&s, 0.01, 0.99) :
			    r.knots[r.c.npoints - 1];
		if (u == 0)
			u = 0.5;
		assert_int_equal(interp_nurbs_split(&r.c, u, &room(&a)->own,
						    &room(&b)->own), 0);
		assert_true(interp_nurbs_last(&a.own.c) == u);
		assert_true(interp_nurbs_first(&b.own.c) == u);
		assert_same(&r.c, &a.own.c, 0, u * (1 - 1e-15), 1e-11);
		assert_same(&r.c, &b.own.c, u, 1, 1e-11);
	}
}

static void a_degree_more_is_the_same_curve(void **state)
{
	static struct made_curve m;
	uint64_t s = seed;

	(void)state;
	for (int k = 0; k < ROUNDS; k++) {
		struct random_curve r;

		random_curve(&s, &r);
		if (r.c.degree == INTERP_NURBS_DEGREE_MAX) {
			assert_int_equal(interp_nurbs_elevate(&r.c,
						&room(&m)->own), -EINVAL);
			continue;
		}
		assert_int_equal(interp_nurbs_elevate(&r.c, &room(&m)->own), 0);
		assert_int_equal(m.own.c.degree, r.c.degree + 1);
		assert_same(&r.c, &m.own.c, 0, 1, 1e-9);
	}
}

/* -- Lengths -------------------------------------------------------------- */

static void stops_lead_to_their_places_and_never_back(void **state)
{
	static struct interp_nurbs_stop stops[20000];
	const double error_mm = 1e-5;

	(void)state;
	for (size_t i = 0; i < NCURVES; i++) {
		const struct interp_nurbs_range range = { 0, 1, error_mm };
		double points[CURVES_POINTS_MAX][3], last = 0;
		struct interp_nurbs_between b;
		struct interp_nurbs_eval e;
		struct interp_nurbs c;
		size_t n;

		curve_load(&curves_data[i], points, &c);
		interp_nurbs_open(&e, &c);
		n = interp_nurbs_stops(&e, &range, stops, 20000);
		assert_in_range(n, 2, 20000);
		assert_true(stops[n - 1].u == 1);
		for (int k = 1; k <= 200; k++) {
			const double s = stops[n - 1].s_mm * k / 200;
			double u;

			interp_nurbs_between(stops + interp_nurbs_stop_of(
					     stops, n, s), &b);
			u = interp_nurbs_between_at(&b, s);
			assert_true(u > last);
			assert_true(fabs(interp_nurbs_length(&e, 0, u, 1e-9) -
					 s) < 20 * error_mm);
			last = u;
		}
	}
}

/* A spine there and back on itself: the curve stands at its tip. */
static void stops_pass_a_cusp(void **state)
{
	const double knots[] = { 0, 0, 0, 1, 1, 1 };
	const double points[] = { 0, 1, 10, 1, 0, 1 };
	const struct interp_nurbs c = { 2, 1, 3, 1, 0, knots, points };
	const struct interp_nurbs_range range = { 0, 1, 1e-5 };
	static struct interp_nurbs_stop stops[1000];
	struct interp_nurbs_eval e;
	struct interp_nurbs_way way;
	double last = 0;
	size_t n;

	(void)state;
	interp_nurbs_open(&e, &c);
	n = interp_nurbs_stops(&e, &range, stops, 1000);
	assert_in_range(n, 2, 1000);
	assert_true(fabs(stops[n - 1].s_mm - 10) < 1e-4);
	for (int k = 1; k <= 10000; k++) {
		const double s = stops[n - 1].s_mm * k / 10000;
		struct interp_nurbs_between b;
		struct interp_nurbs_point p;
		double u;

		interp_nurbs_between(stops + interp_nurbs_stop_of(stops, n, s),
				     &b);
		u = interp_nurbs_between_at(&b, s);
		assert_true(u >= last);
		interp_nurbs_at(&e, u, 0, &p);
		assert_true(fabs(p.d[0][0] - (s < 5 ? s : 10 - s)) < 1e-3);
		last = u;
	}
	interp_nurbs_way(&e, 0.5, &way);
	assert_true(way.cusp);
}

/* -- Refusals ------------------------------------------------------------- */

static void what_is_no_curve_is_refused(void **state)
{
	double knots[] = { 0, 0, 0, 0, 0.5, 1, 1, 1, 1 };
	double points[] = { 0, 1, 1, 1, 2, 1, 3, 1, 4, 1 };
	struct interp_nurbs c = { 3, 1, 5, 1, 0, knots, points };
	uint32_t at;

	(void)state;
	assert_int_equal(interp_nurbs_check(&c, &at), INTERP_NURBS_SOUND);
	knots[4] = -1;
	assert_int_equal(interp_nurbs_check(&c, &at), INTERP_NURBS_KNOT_FALLS);
	assert_int_equal(at, 4);
	knots[4] = 0;
	assert_int_equal(interp_nurbs_check(&c, &at),
			 INTERP_NURBS_KNOT_REPEATS);
	knots[4] = 0.5;
	points[5] = 0;
	assert_int_equal(interp_nurbs_check(&c, &at), INTERP_NURBS_BAD_WEIGHT);
	assert_int_equal(at, 2);
	points[5] = -1;
	assert_int_equal(interp_nurbs_check(&c, &at), INTERP_NURBS_BAD_WEIGHT);
	points[5] = 1;
	points[6] = NAN;
	assert_int_equal(interp_nurbs_check(&c, &at), INTERP_NURBS_NOT_FINITE);
	points[6] = 3;
	c.npoints = 3;
	assert_int_equal(interp_nurbs_check(&c, &at), INTERP_NURBS_FEW_POINTS);
	c.degree = 10;
	assert_int_equal(interp_nurbs_check(&c, &at), INTERP_NURBS_BAD_DEGREE);
	for (int f = 1; f < INTERP_NURBS_NFLAWS; f++) {
		assert_non_null(
			interp_nurbs_flaw_text((enum interp_nurbs_flaw)f));
		assert_non_null(
			interp_nurbs_flaw_wanted((enum interp_nurbs_flaw)f));
	}
}

/* A degree 2 curve with an inner knot that stands three times has a gap. */
static void a_torn_curve_is_refused(void **state)
{
	const double knots[] = { 0, 0, 0, 1, 1, 1, 2, 2, 2 };
	const double points[] = { 0, 1, 1, 1, 2, 1, 5, 1, 6, 1, 7, 1 };
	const struct interp_nurbs c = { 2, 1, 6, 1, 0, knots, points };
	uint32_t at;

	(void)state;
	assert_int_equal(interp_nurbs_check(&c, &at),
			 INTERP_NURBS_KNOT_REPEATS);
	assert_int_equal(at, 5);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_point_is_what_the_definition_says),
		cmocka_unit_test(derivatives_are_those_of_finite_differences),
		cmocka_unit_test(a_circle_is_round_and_as_long_as_it_is),
		cmocka_unit_test(a_knot_more_is_the_same_curve),
		cmocka_unit_test(two_pieces_are_the_curve),
		cmocka_unit_test(a_degree_more_is_the_same_curve),
		cmocka_unit_test(stops_lead_to_their_places_and_never_back),
		cmocka_unit_test(stops_pass_a_cusp),
		cmocka_unit_test(what_is_no_curve_is_refused),
		cmocka_unit_test(a_torn_curve_is_refused),
	};

	seed = seed_take();
	return cmocka_run_group_tests_name("interp/nurbs", tests, NULL, NULL);
}
