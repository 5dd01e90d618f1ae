/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_joined.c - cut lines in a row, joined into curves within a tolerance
 */
#include "walk_help.h"

#define FIT_MM	0.002
#define N	1000

static struct interp_build *begin_fit(void)
{
	struct interp_build_options o = { .machine = &help_machine,
					  .fit_mm = FIT_MM };

	interp_build_destroy(begin(INTERP_SIMULTANEOUS));
	return interp_build_create(&o);
}

static void go(struct interp_build *b, double x, double y, uint32_t line_no)
{
	const struct interp_build_word w = { .line = line_no, .feed_mm_s = 9 };
	const double end[INTERP_NAXES] = { x, y };
	struct interp_diag d = { 0 };

	assert_int_equal(interp_build_line(b, end, &w, &d), 0);
}

static struct made finish_fit(struct interp_build *b)
{
	struct interp_diag d = { 0 };

	assert_int_equal(interp_build_flush(b, &d), 0);
	return finish(b);
}

static uint32_t count(const struct made *m, enum interp_kind kind)
{
	uint32_t n = 0;

	for (uint32_t i = 0; i < m->p.head->nsegs; i++)
		n += m->p.segs[i].kind == kind;
	return n;
}

/* To (20, 0) and once round the origin, rounded as a postprocessor does. */
static void round_and_round(struct interp_build *b, double turns)
{
	for (uint32_t i = 0; i <= N; i++) {
		const double a = turns * 6.283185307179586 * i / N;

		go(b, round(20000 * cos(a)) / 1000,
		   round(20000 * sin(a)) / 1000, i + 2);
	}
}

static void a_thousand_lines_are_a_few_curves(void **state)
{
	struct interp_build *b = begin_fit();
	struct interp_cursor c;
	struct made m;

	(void)state;
	round_and_round(b, 1);
	m = finish_fit(b);
	assert_int_equal(count(&m, INTERP_LINE), 1);
	assert_in_range(count(&m, INTERP_CURVE), 1, 32);
	assert_int_equal(m.p.segs[1].line, 2);
	assert_int_equal(m.p.segs[2].line, 3);
	assert_true(m.bytes < 16000);
	interp_cursor_init(&c, &m.p);
	interp_cursor_aim(&c, 1e9);
	while (interp_cursor_step(&c) == INTERP_MOVED) {
		const double r = hypot(c.pos[0] * 0.001, c.pos[1] * 0.001);

		/* Off the lines, their own chords and rounding, a pulse. */
		assert_true(c.seg.kind != INTERP_CURVE ||
			    fabs(r - 20) < FIT_MM + 0.0002 + 2 * 0.00071);
	}
	unmake(&m);
}

/* Two arcs that meet at a right angle: the corner is a node. */
static void a_corner_stays_where_it_is(void **state)
{
	struct interp_build *b = begin_fit();
	struct made m;
	bool there = false;

	(void)state;
	round_and_round(b, 0.25);
	for (uint32_t i = 1; i <= N; i++)
		go(b, 20.0 * i / N, 20 + 1 - cos(3.0 * i / N), N + 2 + i);
	m = finish_fit(b);
	for (uint32_t i = 0; i < m.p.head->nsegs; i++)
		there |= m.p.nodes[2 * i] == 0 &&
			 m.p.nodes[2 * i + 1] == INT64_C(20000) * INTERP_SUB;
	assert_true(there);
	assert_in_range(count(&m, INTERP_CURVE), 2, 20);
	unmake(&m);
}

static void what_is_between_parts_the_curves(void **state)
{
	const struct interp_build_word w = { .line = 500, .feed_mm_s = 9 };
	struct interp_build *b = begin_fit();
	struct interp_diag d = { 0 };
	struct made m;
	bool there = false;

	(void)state;
	round_and_round(b, 0.5);
	assert_true(interp_build_here(b)[0] == -20);
	assert_int_equal(interp_build_action(b, INTERP_DWELL, 9, &w, &d), 0);
	round_and_round(b, -0.5);
	m = finish_fit(b);
	for (uint32_t i = 1; i < m.p.head->nsegs; i++)
		there |= m.p.segs[i].kind == INTERP_DWELL &&
			 m.p.segs[i - 1].kind == INTERP_CURVE &&
			 m.p.nodes[2 * (size_t)i] ==
				 INT64_C(-20000) * INTERP_SUB;
	assert_true(there);
	unmake(&m);
}

/* A polygon of long sides is what it is. */
static void lines_that_are_no_curve_stay_lines(void **state)
{
	struct interp_build *b = begin_fit();
	struct made m;

	(void)state;
	for (uint32_t i = 0; i < 40; i++)
		go(b, 20 * cos(i * 0.3), 20 * sin(i * 0.3), i);
	m = finish_fit(b);
	assert_int_equal(count(&m, INTERP_CURVE), 0);
	assert_int_equal(count(&m, INTERP_LINE), 40);
	unmake(&m);
}

/* Along the end of the travel a curve would leave it by its tolerance. */
static void a_curve_beyond_the_travel_stays_lines(void **state)
{
	struct interp_build *b = begin_fit();
	struct points p;
	struct made m;

	(void)state;
	go(b, 200, 0, 1);
	for (uint32_t i = 1; i < 400; i++)
		go(b, 200 - 0.0025 * (i % 2), 0.1 * i, i + 1);
	m = finish_fit(b);
	p = walk_all(&m, 1e9);
	for (size_t i = 0; i < p.n; i++)
		assert_true(p.at[i].pos[0] <= 200000);
	assert_int_equal(p.at[p.n - 1].pos[1], 39900);
	points_free(&p);
	unmake(&m);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_thousand_lines_are_a_few_curves),
		cmocka_unit_test(a_corner_stays_where_it_is),
		cmocka_unit_test(what_is_between_parts_the_curves),
		cmocka_unit_test(lines_that_are_no_curve_stay_lines),
		cmocka_unit_test(a_curve_beyond_the_travel_stays_lines),
	};

	return cmocka_run_group_tests_name("build/fit", tests, NULL, NULL);
}
