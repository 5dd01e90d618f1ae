/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_scurve.c - promises of a plan of constant jerk
 *
 * Limits and states are random; the seed is printed.
 */
#include "walk_help.h"

#include "interp/scurve.h"
#include "seed.h"

#define ROUNDS	SEED_ROUNDS(20000)
#define SAMPLES	200

#define ROUNDING	1e-9

static uint64_t seed;

static double decades(uint64_t *s, double from, double to)
{
	return pow(10, uniform(s, from, to));
}

static struct interp_scurve_limits random_limits(uint64_t *s)
{
	const double v = decades(s, -1, 3), a = v * decades(s, -1, 3);

	return (struct interp_scurve_limits) { v, a, a * decades(s, -0.7, 0.7),
			    a * decades(s, -1, 3) };
}

/* Where letting go of the acceleration leads: within the limits, too. */
static double let_go(const struct interp_scurve_limits *l, double v, double a)
{
	return v + a * fabs(a) / (2 * l->j_max_mm_s3);
}

static void random_state(uint64_t *s, const struct interp_scurve_limits *l,
			 double *v, double *a)
{
	do {
		*v = uniform(s, -1, 1) * l->v_max_mm_s;
		*a = rnd(s) % 4 ? uniform(s, -l->a_down_mm_s2, l->a_up_mm_s2) :
				  0;
	} while (fabs(let_go(l, *v, *a)) > l->v_max_mm_s);
}

static double random_way(uint64_t *s, const struct interp_scurve_limits *l)
{
	const double way = l->v_max_mm_s * l->v_max_mm_s / l->a_up_mm_s2 *
			   decades(s, -4, 1.5);

	return rnd(s) % 2 ? way : -way;
}

static bool near(double a, double b, double scale)
{
	return fabs(a - b) <= ROUNDING * fabs(scale);
}

static double scale_mm(const struct interp_scurve *c,
		const struct interp_scurve_limits *l)
{
	return l->v_max_mm_s * c->end_s + 1e-9;
}

/* Within every limit, and each phase begins where the one before ended. */
static void check_plan(const struct interp_scurve *c,
		const struct interp_scurve_limits *l)
{
	const double mm = scale_mm(c, l), step = c->end_s / SAMPLES;

	assert_true(c->n <= INTERP_SCURVE_PHASES);
	assert_true(isfinite(c->end_s));
	for (int i = 0; i <= SAMPLES; i++) {
		const struct interp_scurve_state s = interp_scurve_at(c,
								      step * i);

		assert_true(fabs(s.v_mm_s) <= l->v_max_mm_s * (1 + ROUNDING));
		assert_true(s.a_mm_s2 <= l->a_up_mm_s2 * (1 + ROUNDING));
		assert_true(s.a_mm_s2 >= -l->a_down_mm_s2 * (1 + ROUNDING));
	}
	for (int i = 0; i < c->n; i++) {
		const struct interp_scurve_state before = interp_scurve_at(
			c,
			nextafter(i + 1 < c->n ? c->t_s[i + 1] : c->end_s, 0));
		const struct interp_scurve_state *at =
			i + 1 < c->n ? &c->from[i + 1] : &c->end;

		assert_true(fabs(c->j_mm_s3[i]) <= l->j_max_mm_s3);
		assert_true(near(before.x_mm, at->x_mm, mm));
		assert_true(near(before.v_mm_s, at->v_mm_s, l->v_max_mm_s));
		assert_true(near(before.a_mm_s2, at->a_mm_s2,
				 l->a_up_mm_s2 + l->a_down_mm_s2 +
				 l->j_max_mm_s3 * c->end_s * 1e-5));
	}
}

static void it_stands_at_its_place_within_all_limits(void **st)
{
	uint64_t s = seed;

	(void)st;
	for (int i = 0; i < ROUNDS; i++) {
		const struct interp_scurve_limits l = random_limits(&s);
		const double way = random_way(&s, &l);
		struct interp_scurve c;
		double v, a;

		random_state(&s, &l, &v, &a);
		interp_scurve_to_place(&c, &l, v, a, way);
		check_plan(&c, &l);
		assert_true(c.end.x_mm == way);
		assert_true(c.end.v_mm_s == 0 && c.end.a_mm_s2 == 0);
		assert_true(interp_scurve_at(&c, c.end_s * 2).x_mm == way);
		assert_true(c.n == 0 || (c.from[0].v_mm_s == v &&
					 c.from[0].a_mm_s2 == a));
	}
}

static void it_comes_to_its_speed_within_all_limits(void **st)
{
	uint64_t s = seed + 1;

	(void)st;
	for (int i = 0; i < ROUNDS; i++) {
		const struct interp_scurve_limits l = random_limits(&s);
		const double to = uniform(&s, -1, 1) * l.v_max_mm_s;
		struct interp_scurve c;
		double v, a;

		random_state(&s, &l, &v, &a);
		interp_scurve_to_speed(&c, &l, v, a, to);
		check_plan(&c, &l);
		assert_true(c.end.v_mm_s == to && c.end.a_mm_s2 == 0);
		assert_true(near(c.end.x_mm, interp_scurve_way_mm(&l, v, a, to),
				 scale_mm(&c, &l)));
	}
}

/* Beyond its limits it never gets farther beyond, and comes within them. */
static void what_begins_beyond_its_limits_comes_within_them(void **st)
{
	uint64_t s = seed + 2;

	(void)st;
	for (int i = 0; i < ROUNDS; i++) {
		const struct interp_scurve_limits l = random_limits(&s);
		const double v = uniform(&s, -3, 3) * l.v_max_mm_s;
		const double a = uniform(&s, -3, 3) * l.a_up_mm_s2;
		const double way = random_way(&s, &l);
		const double top = fmax(fmax(fabs(v), fabs(let_go(&l, v, a))),
					l.v_max_mm_s);
		struct interp_scurve c;

		interp_scurve_to_place(&c, &l, v, a, way);
		assert_true(c.end.x_mm == way);
		for (int n = 0; n <= SAMPLES; n++) {
			const struct interp_scurve_state at = interp_scurve_at(
				&c, c.end_s * n / SAMPLES);

			assert_true(fabs(at.v_mm_s) <= top * (1 + ROUNDING));
			assert_true(at.a_mm_s2 <= fmax(a, l.a_up_mm_s2) *
				    (1 + ROUNDING));
			assert_true(at.a_mm_s2 >= fmin(a, -l.a_down_mm_s2) *
				    (1 + ROUNDING));
		}
	}
}

/* From any instant of a plan the rest of it is still the quickest. */
static void plan_again(uint64_t *s, double to_end)
{
	const struct interp_scurve_limits l = random_limits(s);
	const double way = random_way(s, &l);
	struct interp_scurve c, again;
	struct interp_scurve_state at;
	double v, a, t;

	random_state(s, &l, &v, &a);
	interp_scurve_to_place(&c, &l, v, a, way);
	t = (1 - to_end) * c.end_s;
	at = interp_scurve_at(&c, t);
	interp_scurve_to_place(&again, &l, at.v_mm_s, at.a_mm_s2,
			       way - at.x_mm);
	check_plan(&again, &l);
	assert_true(fabs(again.end_s + t - c.end_s) <= 1e-3 * c.end_s);
}

static void planned_again_on_its_way_it_takes_no_longer(void **st)
{
	uint64_t s = seed + 3;

	(void)st;
	for (int i = 0; i < ROUNDS; i++)
		plan_again(&s, uniform(&s, 0, 1));
}

static void planned_again_just_before_its_end_too(void **st)
{
	uint64_t s = seed + 9;

	(void)st;
	for (int i = 0; i < ROUNDS; i++)
		plan_again(&s, decades(&s, -3, 0));
}

static void what_can_stop_before_its_place_does_not_pass_it(void **st)
{
	uint64_t s = seed + 4;

	(void)st;
	for (int i = 0; i < ROUNDS; i++) {
		const struct interp_scurve_limits l = random_limits(&s);
		const double way = fabs(random_way(&s, &l));
		struct interp_scurve c;
		double v, a;

		random_state(&s, &l, &v, &a);
		/* It turns back, or its own braking ends beyond. */
		if ((v > 0 && let_go(&l, v, a) < 0) ||
		    interp_scurve_way_mm(&l, v, a, 0) > way)
			continue;
		interp_scurve_to_place(&c, &l, v, a, way);
		for (int n = 0; n <= SAMPLES; n++)
			assert_true(interp_scurve_at(&c, c.end_s * n / SAMPLES)
				    .x_mm <= way + ROUNDING *
				    scale_mm(&c, &l));
	}
}

/* Up and down again, each 3 mm, as a sinker lifts. */
static void a_jump_of_3_mm_takes_a_third_of_a_second(void **st)
{
	const struct interp_scurve_limits l = { 80, 1000, 1000, 20000 };
	struct interp_scurve up, down;

	(void)st;
	interp_scurve_to_place(&up, &l, 0, 0, 3);
	interp_scurve_to_place(&down, &l, 0, 0, -3);
	assert_true(fabs(up.end_s + down.end_s - 0.337) <= 0.00337);
}

/* From any state that can still meet it. */
static void it_passes_its_place_at_the_speed_asked_for(void **st)
{
	uint64_t s = seed + 7;

	(void)st;
	for (int i = 0; i < 2000; i++) {
		const struct interp_scurve_limits l = random_limits(&s);
		const double pass = uniform(&s, 0, 1) * l.v_max_mm_s;
		struct interp_scurve_state from = { 0, 0, 0 };
		struct interp_scurve c;
		double way;

		random_state(&s, &l, &from.v_mm_s, &from.a_mm_s2);
		way = interp_scurve_way_mm(&l, from.v_mm_s, from.a_mm_s2, pass);
		way = fabs(way) * (1 + uniform(&s, 0, 3)) + 1e-6;
		interp_scurve_to_pass(&c, &l, &from, way, pass);
		assert_true(c.end.v_mm_s == pass && c.end.a_mm_s2 == 0);
		assert_true(c.end.x_mm == way);
		check_plan(&c, &l);
	}
}

/* By walking along it. */
static void braking_it_falls_to_a_speed_where_it_says(void **st)
{
	uint64_t s = seed + 8;

	(void)st;
	for (int i = 0; i < 2000; i++) {
		const struct interp_scurve_limits l = random_limits(&s);
		const double top = uniform(&s, 0.1, 1) * l.v_max_mm_s;
		const double v = uniform(&s, 0.01, 0.99) * top;
		const double a = uniform(&s, -1, 1) *
				 fmin(l.a_up_mm_s2, l.a_down_mm_s2);
		double lo = 0, hi, x;
		struct interp_scurve c;

		/* Not so that it would first turn back. */
		if (let_go(&l, top, a) < 0)
			continue;
		interp_scurve_to_speed(&c, &l, top, a, 0);
		hi = c.end_s;
		/* The last time it is as fast. */
		for (int n = 0; n <= 1000; n++) {
			const double t = c.end_s * n / 1000;

			if (interp_scurve_at(&c, t).v_mm_s >= v)
				lo = t;
		}
		hi = lo + c.end_s / 1000;
		x = interp_scurve_falls_mm(&c, v);
		assert_true(x >= interp_scurve_at(&c, lo).x_mm -
			    1e-9 * fabs(c.end.x_mm) - 1e-12);
		assert_true(x <= interp_scurve_at(&c, hi).x_mm +
			    1e-9 * fabs(c.end.x_mm) + 1e-12);
	}
}

static void standing_at_its_place_it_plans_nothing(void **st)
{
	const struct interp_scurve_limits l = { 80, 1000, 1000, 20000 };
	struct interp_scurve c;

	(void)st;
	interp_scurve_to_place(&c, &l, 0, 0, 0);
	assert_true(c.n == 0 && c.end_s == 0);
	interp_scurve_to_speed(&c, &l, 5, 0, 5);
	assert_true(c.n == 0 && interp_scurve_at(&c, 2).x_mm == 10);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(it_stands_at_its_place_within_all_limits),
		cmocka_unit_test(it_comes_to_its_speed_within_all_limits),
		cmocka_unit_test(what_begins_beyond_its_limits_comes_within_them),
		cmocka_unit_test(planned_again_on_its_way_it_takes_no_longer),
		cmocka_unit_test(planned_again_just_before_its_end_too),
		cmocka_unit_test(what_can_stop_before_its_place_does_not_pass_it),
		cmocka_unit_test(a_jump_of_3_mm_takes_a_third_of_a_second),
		cmocka_unit_test(it_passes_its_place_at_the_speed_asked_for),
		cmocka_unit_test(braking_it_falls_to_a_speed_where_it_says),
		cmocka_unit_test(standing_at_its_place_it_plans_nothing),
	};

	seed = seed_take();
	return cmocka_run_group_tests(tests, NULL, NULL);
}
