/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_couple.c - promises of lines in three to eight axes, one axis at a time
 *
 * The moves are random, and their seed is printed.  Each is walked there, back
 * and about.
 */
#include "walk_help.h"
#include "seed.h"

#include "pulse/couple.h"
#include "rule_help.h"

#include <errno.h>

#define MOVES	SEED_ROUNDS(10000)

struct move {
	struct interp_build_options o;
	int32_t d[INTERP_NAXES];
	uint32_t axes;
};

static int32_t span(uint64_t *seed)
{
	const int32_t most = rnd(seed) % 4 ? 40 : 400;
	const int32_t n = 1 + (int32_t)(rnd(seed) % (uint64_t)most);

	return rnd(seed) % 2 ? n : -n;
}

static struct move random_move(uint64_t *seed)
{
	static const enum interp_strategy rules[] = {
		INTERP_POINT_BY_POINT, INTERP_CENTRED, INTERP_MAIN_DIRECTION,
		INTERP_MIN_SWITCH, INTERP_MIN_SWITCH, INTERP_MIN_SWITCH,
	};
	struct move m = {
		.o = { .machine = &help_machine,
		       .strategy = rules[rnd(seed) % 6],
		       .tolerance_milli = 4000 +
				(uint32_t)(rnd(seed) % 8000),
		       .perpendicular = rnd(seed) % 2 },
		.axes = 3 + (uint32_t)(rnd(seed) % 6),
	};
	uint32_t left = INTERP_NAXES, need = m.axes;

	m.o.coupling = (enum interp_coupling)(rnd(seed) % INTERP_NCOUPLINGS);
	for (int i = 0; i < INTERP_NAXES; i++, left--) {
		if (rnd(seed) % left >= need)
			continue;
		m.d[i] = span(seed);
		need--;
	}
	return m;
}

static struct made make_move(const struct move *m)
{
	struct interp_build *b;
	double end[INTERP_NAXES];

	interp_build_destroy(begin(INTERP_SIMULTANEOUS));
	b = interp_build_create(&m->o);
	for (int i = 0; i < INTERP_NAXES; i++)
		end[i] = m->d[i] * 0.001;
	line(b, end);
	return finish(b);
}

/* -- Star: each axis against the longest ------------------------- */

static struct pair_tube axis_tube_of(const struct move *m)
{
	struct pair_tube t = { m->o.tolerance_milli, false };

	if (m->o.perpendicular)
		t.milli = (uint32_t)floor(t.milli / sqrt(m->axes - 1));
	return t;
}

static void check_axis(const struct move *m, const struct interp_cursor *c,
		       int main, int i)
{
	const int64_t a = abs(m->d[main]), b = abs(m->d[i]);
	const int64_t e = b * abs(c->pos[main]) - a * abs(c->pos[i]);
	const struct range r = rule_range(m->o.strategy, a, b,
					  axis_tube_of(m));

	if (e < r.lo || e > r.hi)
		fail_msg("axis %d: e %lld outside %lld %lld", i, (long long)e,
			 (long long)r.lo, (long long)r.hi);
}

static void check_flat(const struct move *m, const struct interp_cursor *c)
{
	const double mu_mm = m->o.tolerance_milli * 1e-6;
	struct interp_deviation d = { 0 };
	int main = 0;

	for (int i = 1; i < INTERP_NAXES; i++)
		main = abs(m->d[i]) > abs(m->d[main]) ? i : main;
	for (int i = 0; i < INTERP_NAXES; i++) {
		if (m->d[i] != 0 && i != main)
			check_axis(m, c, main, i);
	}
	if (m->o.perpendicular && m->o.strategy != INTERP_CENTRED)
		assert_true(interp_cursor_deviation_mm(c, &d) <= mu_mm + 1e-12);
}

/* -- Tree: every pair in its range, every leaf near its share ------------- */

static double pair_strays(const struct move *m, const struct interp_pair *p)
{
	const struct range r = rule_range(
		m->o.strategy, p->a, p->b,
		(struct pair_tube) { m->o.tolerance_milli,
				     m->o.perpendicular });

	if (p->dev < r.lo || p->dev > r.hi)
		fail_msg("pair %lld/%lld: e %lld outside %lld %lld",
			 (long long)p->b, (long long)p->a, (long long)p->dev,
			 (long long)r.lo, (long long)r.hi);
	return (double)(-r.lo > r.hi ? -r.lo : r.hi) / (double)(p->a + p->b);
}

static void check_node(const struct move *m, const struct interp_cursor *c,
		       int8_t code, double bound)
{
	const struct interp_pair *p;
	double stray, total;

	if (code >= 0) {
		const double share = (double)abs(m->d[code]) * c->tick /
				     c->seg.ticks;

		assert_true(fabs(abs(c->pos[code]) - share) <= bound + 1e-9);
		return;
	}
	p = &c->pair[~code];
	stray = pair_strays(m, p);
	total = (double)(p->a + p->b);
	check_node(m, c, p->in_a, stray + bound * (double)p->a / total);
	check_node(m, c, p->in_b, stray + bound * (double)p->b / total);
}

/* -- Moves ---------------------------------------------------------------- */

static void check_move(const struct move *m, uint64_t *seed)
{
	const bool tree = m->o.coupling == INTERP_TREE ||
			  m->o.strategy == INTERP_POINT_BY_POINT;
	struct made made = make_move(m);
	struct points out = walk_all(&made, 1e9);
	struct interp_cursor c;
	size_t n = 1;

	assert_int_equal(interp_cursor_init(&c, &made.p), 0);
	interp_cursor_aim(&c, 1e9);
	for (; interp_cursor_step(&c) == INTERP_MOVED; n++) {
		assert_int_equal(__builtin_popcount(c.moved), 1);
		if (tree)
			check_node(m, &c, c.root, 0);
		else
			check_flat(m, &c);
	}
	assert_memory_equal(c.pos, m->d, sizeof(c.pos));
	interp_cursor_aim(&c, -1e9);
	while (n-- > 0) {
		assert_memory_equal(c.pos, out.at[n].pos, sizeof(c.pos));
		if (interp_cursor_step(&c) != INTERP_MOVED)
			break;
	}
	assert_int_equal(n, 0);
	assert_true(wander(&made, &out, seed, 20));
	points_free(&out);
	unmake(&made);
}

static void random_moves_end_exactly_in_range_and_retrace(void **st)
{
	uint64_t seed = 424242;

	(void)st;
	print_message("    seed %llu\n", (unsigned long long)seed);
	for (int i = 0; i < MOVES; i++) {
		const struct move m = random_move(&seed);

		check_move(&m, &seed);
	}
}

/* -- Changes of axis ------------------------------------------------------ */

static size_t changes_of(const int32_t d[INTERP_NAXES],
			 enum interp_coupling k, uint32_t milli)
{
	struct move m = { .o = { .machine = &help_machine,
				 .strategy = INTERP_MIN_SWITCH,
				 .tolerance_milli = milli, .coupling = k } };
	struct made made;
	struct interp_cursor c;
	uint32_t was = 0;
	size_t n = 0;

	memcpy(m.d, d, sizeof(m.d));
	made = make_move(&m);
	assert_int_equal(interp_cursor_init(&c, &made.p), 0);
	interp_cursor_aim(&c, 1e9);
	while (interp_cursor_step(&c) == INTERP_MOVED) {
		n += was != 0 && c.moved != was;
		was = c.moved;
	}
	unmake(&made);
	return n;
}

static void couplings_change_axis_as_often_as_is_known(void **st)
{
	static const int32_t three[INTERP_NAXES] = { 3000, 4000, 5000 };
	static const int32_t ramp[INTERP_NAXES] = { 17320, 10000, 10000 };
	static const int32_t six[INTERP_NAXES] = { 5000, 4700, 3100, 1900,
						   800, 333 };

	(void)st;
	assert_int_equal(changes_of(three, INTERP_TREE, 2000), 4000);
	assert_int_equal(changes_of(three, INTERP_TREE, 5000), 1667);
	assert_int_equal(changes_of(three, INTERP_STAR, 2000), 4000);
	assert_int_equal(changes_of(three, INTERP_STAR, 5000), 1536);
	assert_int_equal(changes_of(ramp, INTERP_STAR, 2000), 10002);
	assert_int_equal(changes_of(six, INTERP_STAR, 5000), 2317);
	assert_int_equal(changes_of(six, INTERP_TREE, 5000), 2759);
}

/* -- Refusals ------------------------------------------------------------- */

static int try_line(enum interp_strategy s, enum interp_coupling k,
		    uint32_t milli, struct interp_diag *d)
{
	static const double end[INTERP_NAXES] = { 0.03, 0.029, 0.028 };
	const struct interp_build_word w = { .line = 1, .feed_mm_s = 1 };
	const struct interp_build_options o = {
		.machine = &help_machine, .strategy = s,
		.tolerance_milli = milli, .coupling = k,
	};
	struct interp_build *b;
	int r;

	interp_build_destroy(begin(s));
	b = interp_build_create(&o);
	r = interp_build_line(b, end, &w, d);
	interp_build_destroy(b);
	return r;
}

static void what_a_coupling_cannot_do_is_refused(void **st)
{
	struct interp_diag d = { .found = "" };

	(void)st;
	assert_int_equal(try_line(INTERP_MIN_SWITCH, INTERP_STAR, 1000, &d), 0);
	assert_int_equal(try_line(INTERP_MIN_SWITCH, INTERP_STAR, 900, &d),
			 -EINVAL);
	assert_non_null(strstr(d.wanted, "pulses or more"));
	assert_int_equal(try_line(INTERP_MIN_SWITCH, INTERP_TREE, 1000, &d), 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(random_moves_end_exactly_in_range_and_retrace),
		cmocka_unit_test(couplings_change_axis_as_often_as_is_known),
		cmocka_unit_test(what_a_coupling_cannot_do_is_refused),
	};

	return cmocka_run_group_tests_name("interp/couple", tests, NULL, NULL);
}
