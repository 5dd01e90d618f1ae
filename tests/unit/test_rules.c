/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_rules.c - promises of the rules for lines of two axes
 *
 * First the rules alone: all small lines, and random ones whose seed is
 * printed; then through the builder and the cursor.
 */
#include "walk_help.h"
#include "seed.h"

#include "rule_help.h"

#include <errno.h>

static const enum interp_strategy rules[] = {
	INTERP_POINT_BY_POINT, INTERP_CENTRED, INTERP_MAIN_DIRECTION,
	INTERP_MIN_SWITCH,
};
static const uint32_t mus[] = { 500, 1000, 1500, 2000, 3000 };

#define COUNT(x)	(sizeof(x) / sizeof((x)[0]))

/* -- One rule, one line --------------------------------------------------- */

/* Only in a tube that has a path at all is |e| <= M promised. */
static struct range promised(enum interp_strategy rule, int64_t a, int64_t b,
			     struct pair_tube t)
{
	if (rule != INTERP_MIN_SWITCH || pair_tube_ok(a, b, t))
		return rule_range(rule, a, b, t);
	return (struct range) { -(a + b), a + b };
}

/* There, back to the start, and there again: the same pulses, in range. */
static void check_rule(enum interp_strategy rule, int64_t a, int64_t b,
		       struct pair_tube t)
{
	const struct range r = promised(rule, a, b, t);
	struct interp_pair p = rule_pair(rule, a, b, t, false);
	const struct interp_pair start = p;
	const struct interp_pair end = rule_pair(rule, a, b, t, true);
	static bool main[4096];
	int64_t n = 0;

	assert_true(a + b <= 4096);
	while (n < a + b) {
		const struct interp_pair was = p;
		struct interp_pair q;

		main[n] = pair_forward(&p);
		if (p.dev < r.lo || p.dev > r.hi ||
		    p.dev != b * p.m - a * p.s || p.m > a || p.s > b)
			fail_msg("%s %lld/%lld mu %u: e %lld outside %lld %lld",
				 interp_strategy_name(rule), (long long)b,
				 (long long)a, t.milli, (long long)p.dev,
				 (long long)r.lo, (long long)r.hi);
		q = p;
		if (pair_back(&q) != main[n] || !pair_same(&q, &was))
			fail_msg("%s %lld/%lld mu %u: pulse %lld not undone",
				 interp_strategy_name(rule), (long long)b,
				 (long long)a, t.milli, (long long)n);
		n++;
	}
	assert_true(p.m == a && p.s == b && pair_same(&p, &end));
	p = end;
	while (n > 0)
		assert_true(pair_back(&p) == main[--n]);
	assert_true(pair_same(&p, &start));
}

static void every_small_line_ends_exactly_in_range_and_retraces(void **st)
{
	(void)st;
	for (int64_t a = 1; a <= 60; a++) {
		for (int64_t b = 0; b <= a; b++) {
			for (size_t i = 0; i < COUNT(rules) * COUNT(mus); i++) {
				struct pair_tube t = {
					mus[i % COUNT(mus)], false };

				check_rule(rules[i / COUNT(mus)], a, b, t);
				t.perpendicular = true;
				check_rule(rules[i / COUNT(mus)], a, b, t);
			}
		}
	}
}

static void random_lines_end_exactly_in_range_and_retrace(void **st)
{
	uint64_t seed = 20250601;

	(void)st;
	print_message("    seed %llu\n", (unsigned long long)seed);
	for (int i = 0; i < 3000; i++) {
		const int64_t a = 1 + (int64_t)(rnd(&seed) % 1900);
		const int64_t b = (int64_t)(rnd(&seed) % (uint64_t)(a + 1));
		const struct pair_tube t = {
			(uint32_t)(rnd(&seed) % 12000), rnd(&seed) % 2 };

		for (size_t j = 0; j < COUNT(rules); j++)
			check_rule(rules[j], a, b, t);
	}
}

/* A million lines of any length: both ends, and places in between. */
static void check_ends(enum interp_strategy rule, int64_t a, int64_t b,
		       struct pair_tube t)
{
	struct interp_pair p = rule_pair(rule, a, b, t, true);
	const struct range r = promised(rule, a, b, t);
	const struct interp_pair end = p;
	int n = 0;

	for (; n < 24 && p.m + p.s > 0; n++) {
		pair_back(&p);
		assert_true(p.dev >= r.lo && p.dev <= r.hi);
		assert_true(p.m >= 0 && p.s >= 0);
	}
	while (n-- > 0)
		pair_forward(&p);
	assert_true(pair_same(&p, &end));
	p = rule_pair(rule, a, b, t, false);
	for (n = 0; n < 24 && p.m + p.s < a + b; n++) {
		pair_forward(&p);
		assert_true(p.dev >= r.lo && p.dev <= r.hi);
	}
	while (n-- > 0)
		pair_back(&p);
	assert_true(p.m == 0 && p.s == 0 && p.dev == 0);
}

#define RANDOM_LINES	SEED_ROUNDS(1000000)

static void random_lines_up_to_two_metres_hold_at_both_ends(void **st)
{
	uint64_t seed = 7777;

	(void)st;
	print_message("    seed %llu\n", (unsigned long long)seed);
	for (int i = 0; i < RANDOM_LINES; i++) {
		const int bits = 1 + (int)(rnd(&seed) % 30);
		const int64_t a = 1 + (int64_t)(rnd(&seed) >> (64 - bits));
		const int64_t b = (int64_t)(rnd(&seed) % (uint64_t)(a + 1));
		const struct pair_tube t = {
			(uint32_t)(rnd(&seed) % (INTERP_TOLERANCE_MAX + 1)) >>
				rnd(&seed) % 12, rnd(&seed) % 2 };

		check_ends(rules[i % 4], a, b, t);
	}
}

static void a_line_of_two_metres_is_walked_whole(void **st)
{
	const int64_t a = 20000000, b = 12345679;
	const struct pair_tube t = { 2000, true };

	(void)st;
	for (size_t i = 0; i < COUNT(rules); i++) {
		struct interp_pair p = rule_pair(rules[i], a, b, t, false);
		const struct range r = rule_range(rules[i], a, b, t);
		int64_t lo = 0, hi = 0;

		for (int64_t n = 0; n < a + b; n++) {
			pair_forward(&p);
			lo = p.dev < lo ? p.dev : lo;
			hi = p.dev > hi ? p.dev : hi;
		}
		assert_true(p.m == a && p.s == b);
		assert_true(lo >= r.lo && hi <= r.hi);
	}
}

/* -- The fewest changes of axis ------------------------------------------- */

#define DP_MAX	31

/* Fewest runs to every place of the tube, by the axis of the last one. */
static int fewest_runs(int a, int b, int64_t half)
{
	static int best[DP_MAX + 1][DP_MAX + 1][2];
	const int never = 1 << 20;

	for (int m = 0; m <= a; m++) {
		for (int s = 0; s <= b; s++) {
			int *at = best[m][s];

			at[0] = at[1] = m + s == 0 ? 0 : never;
			if (llabs((int64_t)b * m - (int64_t)a * s) > half ||
			    m + s == 0)
				continue;
			if (m > 0) {
				const int *w = best[m - 1][s];
				const int first = m + s == 1;

				at[0] = first ? 1 :
					(w[0] < w[1] + 1 ? w[0] : w[1] + 1);
			}
			if (s > 0) {
				const int *w = best[m][s - 1];
				const int first = m + s == 1;

				at[1] = first ? 1 :
					(w[1] < w[0] + 1 ? w[1] : w[0] + 1);
			}
		}
	}
	return best[a][b][0] < best[a][b][1] ? best[a][b][0] : best[a][b][1];
}

static size_t changes(enum interp_strategy rule, int64_t a, int64_t b,
		      struct pair_tube t)
{
	struct interp_pair p = rule_pair(rule, a, b, t, false);
	bool was = false;
	size_t n = 0;

	for (int64_t i = 0; i < a + b; i++) {
		const bool main = pair_forward(&p);

		n += i > 0 && main != was;
		was = main;
	}
	return n;
}

static void greedy_is_the_optimum_on_every_small_line(void **st)
{
	int cases = 0, beaten = 0;

	(void)st;
	for (int a = 1; a <= 30; a++) {
		for (int b = 1; b <= a; b++) {
			for (uint32_t mu = 500; mu < 4000; mu += 125) {
				const struct pair_tube t = { mu, false };
				struct greedy_runs r = { .run = NULL };
				const struct greedy_line l = {
					a, b, pair_half_width(a, b, t) };
				size_t burst;

				if (!pair_tube_ok(a, b, t))
					continue;
				greedy_plan(&l, &r);
				assert_int_equal(r.n, fewest_runs(
					a, b, l.half_width));
				burst = changes(INTERP_MIN_SWITCH, a, b, t);
				assert_true(burst + 1 >= r.n);
				cases++;
				beaten += burst + 1 > r.n;
			}
		}
	}
	print_message("    %d lines; bursts as few on %d\n", cases,
		      cases - beaten);
	assert_true(cases > 10000);
}

static void greedy_walks_its_runs_both_ways(void **st)
{
	uint32_t run[200];
	struct greedy_runs r = { .run = run, .room = 200 };
	const struct greedy_line l = { 97, 61, 194 };
	struct greedy_walk w = { .r = &r };
	bool main[158];
	int64_t m = 0, s = 0;

	(void)st;
	greedy_plan(&l, &r);
	assert_true(r.n <= r.room);
	for (int i = 0; i < 158; i++) {
		main[i] = greedy_forward(&w);
		m += main[i];
		s += !main[i];
		assert_true(llabs(61 * m - 97 * s) <= 194);
	}
	assert_true(m == 97 && s == 61);
	for (int i = 157; i >= 0; i--)
		assert_int_equal(greedy_back(&w), main[i]);
	assert_true(w.i == 0 && w.sent == 0);
}

/* -- Figures that are known ----------------------------------------------- */

struct known {
	int64_t a, b;
	uint32_t mu;
	size_t pbp, greedy, burst;
};

/* q = 10000; exact integers, from an independent reckoning. */
static const struct known known[] = {
	{ 10000, 100, 1000, 200, 100, 100 },
	{ 10000, 3333, 2000, 6666, 2222, 2222 },
	{ 10000, 3333, 5000, 6666, 741, 742 },
	{ 10000, 6180, 2000, 12360, 4120, 4120 },
	{ 10000, 6180, 10000, 12360, 650, 652 },
	{ 10000, 7500, 5000, 15000, 1667, 1668 },
	{ 10000, 9000, 10000, 18000, 942, 948 },
	{ 10000, 10000, 5000, 19999, 2000, 2000 },
};

static void changes_of_axis_are_the_known_ones(void **st)
{
	(void)st;
	for (size_t i = 0; i < COUNT(known); i++) {
		const struct known *k = &known[i];
		const struct pair_tube t = { k->mu, false };
		const struct greedy_line l = {
			k->a, k->b, pair_half_width(k->a, k->b, t) };
		struct greedy_runs r = { .run = NULL };

		greedy_plan(&l, &r);
		assert_int_equal(r.n - 1, k->greedy);
		assert_int_equal(changes(INTERP_POINT_BY_POINT, k->a, k->b, t),
				 k->pbp);
		assert_int_equal(changes(INTERP_CENTRED, k->a, k->b, t),
				 k->pbp);
		assert_int_equal(changes(INTERP_MIN_SWITCH, k->a, k->b, t),
				 k->burst);
	}
}

static void main_direction_changes_axis_as_often_as_point_by_point(void **st)
{
	(void)st;
	for (uint32_t mu = 500; mu <= 10000; mu += 500) {
		for (int64_t b = 100; b <= 10000; b += 900) {
			const struct pair_tube t = { mu, false };
			const size_t pbp = changes(INTERP_POINT_BY_POINT,
						   10000, b, t);
			const size_t md = changes(INTERP_MAIN_DIRECTION,
						  10000, b, t);

			/* What it saves, it saves once a line. */
			assert_true(md <= pbp && pbp - md <= 2 * mu / 1000 + 2);
		}
	}
}

/* -- Through the builder and the cursor ----------------------------------- */

static const enum interp_strategy all[] = {
	INTERP_SIMULTANEOUS, INTERP_POINT_BY_POINT, INTERP_CENTRED,
	INTERP_MAIN_DIRECTION, INTERP_MIN_SWITCH,
};

static struct interp_build *build_with(enum interp_strategy s, uint32_t milli,
				       bool perpendicular)
{
	struct interp_build_options o = {
		.machine = &help_machine, .strategy = s,
		.tolerance_milli = milli, .perpendicular = perpendicular,
	};

	interp_build_destroy(begin(s));		/* fills help_machine */
	return interp_build_create(&o);
}

static int add_line(struct interp_build *b, int dx, int dy,
		    struct interp_diag *d)
{
	const struct interp_build_word w = { .line = 1, .feed_mm_s = 1 };
	const double end[INTERP_NAXES] = { dx * 0.001, dy * 0.001 };

	return interp_build_line(b, end, &w, d);
}

static void check_cursor(const struct made *m, int dx, int dy, double bound)
{
	struct points out = walk_all(m, 1e9);
	const double longer = fmax(abs(dx), abs(dy));
	uint64_t seed = 3;

	for (size_t i = 0; i < out.n; i++) {
		const int32_t *p = out.at[i].pos;

		if (fabs((double)dx * p[1] - (double)dy * p[0]) >
		    bound * longer + 1e-9)
			fail_msg("(%d, %d): (%d, %d) is off", dx, dy, p[0],
				 p[1]);
	}
	assert_int_equal(out.at[out.n - 1].pos[0], dx);
	assert_int_equal(out.at[out.n - 1].pos[1], dy);
	assert_true(wander(m, &out, &seed, 12));
	points_free(&out);
}

#ifdef __SANITIZE_ADDRESS__
#define REACH	20
#else
#define REACH	60
#endif

/* Refused if and only if there is no path in the tube. */
static void check_octant(enum interp_strategy s, uint32_t mu, int dx, int dy)
{
	const bool tube = s >= INTERP_MAIN_DIRECTION;
	const int a = abs(dx) > abs(dy) ? abs(dx) : abs(dy);
	const int small = abs(dx) + abs(dy) - a;
	const bool ok = !tube || small == 0 ||
			pair_tube_ok(a, small, (struct pair_tube) { mu, 0 });
	struct interp_build *b = build_with(s, mu, false);
	struct interp_diag d;
	struct made m;

	assert_int_equal(add_line(b, dx, dy, &d), ok ? 0 : -EINVAL);
	if (!ok) {
		interp_build_destroy(b);
		return;
	}
	m = finish(b);
	if (dx || dy)
		check_cursor(&m, dx, dy, tube ? mu / 1000.0 : 1);
	unmake(&m);
}

static void every_strategy_walks_every_octant(void **st)
{
	(void)st;
	for (size_t i = 0; i < COUNT(all) * COUNT(mus); i++) {
		const enum interp_strategy s = all[i / COUNT(mus)];
		const uint32_t mu = mus[i % COUNT(mus)];

		/* The others have no tolerance. */
		if (s < INTERP_MAIN_DIRECTION && mu != mus[0])
			continue;
		for (int dx = -REACH; dx <= REACH; dx++) {
			for (int dy = -REACH; dy <= REACH; dy++)
				check_octant(s, mu, dx, dy);
		}
	}
}

static void a_tolerance_too_narrow_is_refused_with_the_least(void **st)
{
	struct interp_diag d = { .found = "" };
	struct interp_build *b = build_with(INTERP_MIN_SWITCH, 500, false);

	(void)st;
	/* 2*floor(3*mu) + 1 >= 5: mu is 2/3 of a pulse, in thousandths. */
	assert_int_equal(add_line(b, 3, 2, &d), -EINVAL);
	assert_string_equal(d.found, "a tolerance of 0.5 pulses is too narrow "
			    "for this line under min-switch");
	assert_non_null(strstr(d.wanted, "0.667 pulses or more"));
	interp_build_destroy(b);
	b = build_with(INTERP_MIN_SWITCH, 667, false);
	assert_int_equal(add_line(b, 3, 2, &d), 0);
	interp_build_destroy(b);
	b = build_with(INTERP_MAIN_DIRECTION, 499, false);
	assert_int_equal(add_line(b, 50, 1, &d), -EINVAL);
	assert_non_null(strstr(d.wanted, "0.5 pulses or more"));
	interp_build_destroy(b);
	b = build_with(INTERP_MIN_SWITCH, 0, true);
	assert_int_equal(add_line(b, 3, 2, &d), -EINVAL);
	/* sqrt(13)*mu >= 2 */
	assert_non_null(strstr(d.wanted, "0.555 pulses or more"));
	interp_build_destroy(b);
}

static void the_least_tolerance_named_is_enough_and_no_less_is(void **st)
{
	uint64_t seed = 99;

	(void)st;
	print_message("    seed %llu\n", (unsigned long long)seed);
	for (int i = 0; i < 3000; i++) {
		const int64_t a = 1 + (int64_t)(rnd(&seed) % 500);
		const int64_t b = 1 + (int64_t)(rnd(&seed) % (uint64_t)a);
		struct pair_tube t = { 0, rnd(&seed) % 2 };

		while (!pair_tube_ok(a, b, t))
			t.milli++;
		assert_true(t.milli <= 1000);
		check_rule(INTERP_MIN_SWITCH, a, b, t);
		if (t.milli == 0)
			continue;
		t.milli--;
		assert_false(pair_tube_ok(a, b, t));
		if (a <= DP_MAX)
			assert_true(fewest_runs((int)a, (int)b,
					pair_half_width(a, b, t)) > 100);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_small_line_ends_exactly_in_range_and_retraces),
		cmocka_unit_test(random_lines_end_exactly_in_range_and_retrace),
		cmocka_unit_test(random_lines_up_to_two_metres_hold_at_both_ends),
		cmocka_unit_test(a_line_of_two_metres_is_walked_whole),
		cmocka_unit_test(greedy_is_the_optimum_on_every_small_line),
		cmocka_unit_test(greedy_walks_its_runs_both_ways),
		cmocka_unit_test(changes_of_axis_are_the_known_ones),
		cmocka_unit_test(main_direction_changes_axis_as_often_as_point_by_point),
		cmocka_unit_test(every_strategy_walks_every_octant),
		cmocka_unit_test(a_tolerance_too_narrow_is_refused_with_the_least),
		cmocka_unit_test(the_least_tolerance_named_is_enough_and_no_less_is),
	};

	return cmocka_run_group_tests_name("interp/rules", tests, NULL, NULL);
}
