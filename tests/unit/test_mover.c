/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_mover.c - promises of a move along the path
 *
 * Limits, places and speeds are random; the seed is printed.
 */
#include "walk_help.h"

#include "path/mover.h"
#include "seed.h"

#define ROUNDS	SEED_ROUNDS(20000)

/* Rounding of a sum of thousands of doubles. */
#define ROUNDING	1e-9

static uint64_t seed;

/* Full speed is come to in a third of a cycle, up to some hundred cycles. */
static struct mover_limits random_limits(uint64_t *s)
{
	static const double periods_s[] = { 50e-6, 250e-6, 1e-3, 4e-3 };
	const double t = periods_s[rnd(s) % 4];
	const double v = pow(10, uniform(s, -2, 2));
	const double a = v / t / pow(10, uniform(s, -0.5, 2.5));

	return (struct mover_limits) {
		.v_max_mm_s = v,
		.a_max_mm_s2 = a,
		.j_max_mm_s3 = a / t / pow(10, uniform(s, -0.5, 1.5)),
		.period_s = t,
	};
}

/* Worth a tenth of a cycle at full speed, up to a few hundred cycles. */
static double random_left(uint64_t *s, const struct mover_limits *l)
{
	const double far = l->v_max_mm_s * l->period_s *
			   pow(10, uniform(s, -1, 2.5));

	return rnd(s) % 2 ? far : -far;
}

/* The way from speed @v to a stand: half the speed, for the time it takes. */
static double braking_mm(const struct mover_limits *l, double v)
{
	const double a = l->a_max_mm_s2, j = l->j_max_mm_s3, u = fabs(v);

	return u / 2 * (u * j > a * a ? u / a + a / j : 2 * sqrt(u / j));
}

static uint64_t enough(const struct mover_limits *l, double v0, double left)
{
	const double way = fabs(left) + 2 * braking_mm(l, v0);
	const double s = way / l->v_max_mm_s +
			 8 * (fabs(v0) + l->v_max_mm_s) / l->a_max_mm_s2 +
			 16 * l->a_max_mm_s2 / l->j_max_mm_s3;

	return (uint64_t)(2 * s / l->period_s) + 100;
}

struct course {
	struct mover_limits l;
	double v0, left;		/* at the beginning */
	double way;			/* walked */
	double over;			/* farthest beyond the place */
	bool landed;
};

/* Walk until it stands there; all of it as it comes out in the distances. */
static void walk_course(struct course *k)
{
	const double at = k->l.a_max_mm_s2 * k->l.period_s;
	const double jt = k->l.j_max_mm_s3 * k->l.period_s * k->l.period_s;
	const double eps = ROUNDING / k->l.period_s;
	struct mover m = { .v_mm_s = k->v0 };
	double v = k->v0, dv = 0;

	for (uint64_t n = enough(&k->l, k->v0, k->left); n && !k->landed; n--) {
		const double ds = mover_step(&m, &k->l, k->left - k->way);
		const double now = ds / k->l.period_s;
		const double top = fmax(k->l.v_max_mm_s, fabs(k->v0));

		assert_true(fabs(now) <= top + eps);
		assert_true(fabs(now - v) <= at * (1 + ROUNDING) + eps);
		assert_true(fabs(now - v - dv) <= jt * (1 + ROUNDING) + eps);
		dv = now - v;
		v = now;
		k->way += ds;
		k->over = fmax(k->over, k->left > 0 ? k->way - k->left :
						       k->left - k->way);
		k->landed = m.v_mm_s == 0 && m.a_mm_s2 == 0 &&
			    fabs(k->left - k->way) <= ROUNDING;
	}
}

static void it_keeps_within_speed_and_acceleration_and_lands_exactly(void **st)
{
	uint64_t s = seed;

	(void)st;
	for (int i = 0; i < ROUNDS; i++) {
		struct course k = { .l = random_limits(&s) };
		struct mover m = { 0 };

		k.left = random_left(&s, &k.l);
		walk_course(&k);
		assert_true(k.landed);
		assert_true(k.over <= ROUNDING);
		assert_true(mover_step(&m, &k.l, 0) == 0);
	}
}

/* Any speed, toward the place or away from it, that it can still brake. */
static void it_never_passes_its_place_if_it_can_still_brake(void **st)
{
	uint64_t s = seed + 1;

	(void)st;
	for (int i = 0; i < ROUNDS; i++) {
		struct course k = { .l = random_limits(&s) };
		double room;

		k.left = random_left(&s, &k.l);
		k.v0 = uniform(&s, -2, 2) * k.l.v_max_mm_s;
		room = fabs(k.left);
		if (k.v0 * k.left > 0 && braking_mm(&k.l, k.v0) > room)
			continue;
		walk_course(&k);
		assert_true(k.landed);
		assert_true(k.over <= ROUNDING);
	}
}

static void too_fast_to_stop_in_time_it_passes_and_comes_back(void **st)
{
	uint64_t s = seed + 2;

	(void)st;
	for (int i = 0; i < ROUNDS / 10; i++) {
		const struct mover_limits l = random_limits(&s);
		const double left = random_left(&s, &l) * 0.01;
		struct mover m = { .v_mm_s = copysign(l.v_max_mm_s, left) };
		double way = 0;

		for (uint64_t n = enough(&l, m.v_mm_s, left); n; n--) {
			way += mover_step(&m, &l, left - way);
			assert_true(fabs(way) <= fabs(left) +
				    braking_mm(&l, l.v_max_mm_s) +
				    l.v_max_mm_s * l.period_s);
		}
		assert_true(m.v_mm_s == 0);
		assert_true(fabs(left - way) <= ROUNDING);
	}
}

static void a_stop_takes_no_more_than_the_braking_distance(void **st)
{
	uint64_t s = seed + 3;

	(void)st;
	for (int i = 0; i < ROUNDS; i++) {
		const struct mover_limits l = random_limits(&s);
		const double v0 = uniform(&s, -2, 2) * l.v_max_mm_s;
		const double at = l.a_max_mm_s2 * l.period_s;
		struct mover m = { .v_mm_s = v0 };
		double way = 0, v = v0;
		uint64_t n = enough(&l, v0, 0);

		for (; n; n--) {
			const double ds = mover_stop(&m, &l);

			assert_true(ds * v0 >= -ROUNDING);
			assert_true(fabs(v - m.v_mm_s) <= at * (1 + ROUNDING));
			v = m.v_mm_s;
			way += ds;
		}
		assert_true(m.v_mm_s == 0);
		assert_true(fabs(fabs(way) - braking_mm(&l, v0)) <= ROUNDING);
	}
}

/* A hold, a new place, new limits: any of them at any instant. */
static void a_change_of_mind_is_no_step_of_acceleration(void **st)
{
	uint64_t s = seed + 4;

	(void)st;
	for (int i = 0; i < ROUNDS / 20; i++) {
		struct mover_limits l = random_limits(&s);
		const double v_max = l.v_max_mm_s;
		double goal = random_left(&s, &l), way = 0;
		struct mover m = { 0 };

		for (int n = 0; n < 500; n++) {
			const double v = m.v_mm_s, a = m.a_mm_s2;
			const uint64_t what = rnd(&s) % 60;
			double ds;

			if (what == 0)
				goal = way + random_left(&s, &l);
			if (what == 1)
				l.v_max_mm_s = uniform(&s, 0.1, 1) * v_max;
			ds = n / 30 % 3 ? mover_step(&m, &l, goal - way) :
			     rnd(&s) % 9 ? mover_stop(&m, &l) :
					   mover_run(&m, &l, v_max / 3);
			way += ds;
			assert_true(fabs(m.a_mm_s2 - a) <= l.j_max_mm_s3 *
				    l.period_s * (1 + ROUNDING));
			assert_true(fabs(m.v_mm_s - v) <= l.a_max_mm_s2 *
				    l.period_s * (1 + ROUNDING) + ROUNDING);
			assert_true(fabs(m.a_mm_s2) <= l.a_max_mm_s2 *
				    (1 + ROUNDING));
			assert_true(fabs(ds) <= fmax(fabs(v), fabs(m.v_mm_s)) *
				    l.period_s + l.a_max_mm_s2 * l.period_s *
				    l.period_s + ROUNDING);
		}
	}
}

static void standing_there_it_stays(void **st)
{
	const struct mover_limits l = { 10, 1000, 20000, 1e-3, 0 };
	struct mover m = { 0 };

	(void)st;
	for (int i = 0; i < 10; i++)
		assert_true(mover_step(&m, &l, 0) == 0 && m.v_mm_s == 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(it_keeps_within_speed_and_acceleration_and_lands_exactly),
		cmocka_unit_test(it_never_passes_its_place_if_it_can_still_brake),
		cmocka_unit_test(too_fast_to_stop_in_time_it_passes_and_comes_back),
		cmocka_unit_test(a_stop_takes_no_more_than_the_braking_distance),
		cmocka_unit_test(a_change_of_mind_is_no_step_of_acceleration),
		cmocka_unit_test(standing_there_it_stays),
	};

	seed = seed_take();
	return cmocka_run_group_tests(tests, NULL, NULL);
}
