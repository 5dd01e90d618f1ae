/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_arcs.c - promises of arcs by comparison and by stored runs
 *
 * The arcs are: every start on the lattice with a radius up to 24 pulses, in
 * both directions, with ends all around; whole circles; helices; and arcs of
 * less than a pulse.
 */
#include "walk_help.h"
#include "seed.h"

#include "pulse/pulse.h"

#include <errno.h>

/* Larger ones are among the random arcs. */
#ifdef __SANITIZE_ADDRESS__
#define RADIUS	12
#else
#define RADIUS	24
#endif
#define ARCS	SEED_ROUNDS(100000)

static const struct interp_build_word word = { .line = 1, .feed_mm_s = 1 };

struct way {
	enum interp_strategy s;
	uint32_t milli;
	int x0, y0, x1, y1;
	bool clockwise;
};

static struct interp_build *build_with(enum interp_strategy s, uint32_t milli)
{
	struct interp_build_options o = {
		.machine = &help_machine, .strategy = s,
		.tolerance_milli = milli,
	};

	interp_build_destroy(begin(s));
	return interp_build_create(&o);
}

static struct made make_arc(const struct way *w)
{
	struct interp_build *b = build_with(w->s, w->milli);
	double at[INTERP_NAXES] = { w->x0 * 0.001, w->y0 * 0.001 };

	line(b, at);
	at[0] = w->x1 * 0.001;
	at[1] = w->y1 * 0.001;
	arc(b, at, 0, 0, w->clockwise);
	return finish(b);
}

static double strays(const struct way *w)
{
	return w->s == INTERP_MIN_SWITCH ? w->milli / 1000.0 : 1;
}

static void check_points(const struct way *w, const struct points *out)
{
	const double r0 = hypot(w->x0, w->y0), r1 = hypot(w->x1, w->y1);
	const double bound = strays(w) + 1e-9;
	const int32_t *last = out->at[out->n - 1].pos;

	for (size_t i = 0; i < out->n; i++) {
		const double r = hypot(out->at[i].pos[0], out->at[i].pos[1]);

		if (out->at[i].kind != INTERP_ARC)
			continue;
		if (r < fmin(r0, r1) - bound || r > fmax(r0, r1) + bound)
			fail_msg("%s %u (%d,%d)-(%d,%d) %s: %f of %f",
				 interp_strategy_name(w->s), w->milli, w->x0,
				 w->y0, w->x1, w->y1,
				 w->clockwise ? "cw" : "ccw", r - r0, bound);
	}
	assert_int_equal(last[0], w->x1);
	assert_int_equal(last[1], w->y1);
}

static void check_back(const struct made *m, const struct points *out)
{
	struct interp_cursor c;
	size_t n = out->n;

	assert_int_equal(interp_cursor_init(&c, &m->p), 0);
	run(&c, 1e9, NULL);
	interp_cursor_aim(&c, -1e9);
	do
		assert_memory_equal(c.pos, out->at[--n].pos, sizeof(c.pos));
	while (interp_cursor_step(&c) == INTERP_MOVED);
	assert_int_equal(n, 0);
	run(&c, 1e9, NULL);
	assert_memory_equal(c.pos, out->at[out->n - 1].pos, sizeof(c.pos));
}

static void check_arc(const struct way *w)
{
	struct made m = make_arc(w);
	struct points out = walk_all(&m, 1e9);

	check_points(w, &out);
	check_back(&m, &out);
	points_free(&out);
	unmake(&m);
}

/* From every lattice point of the disc to @ends places of its circle. */
static void arcs_of(enum interp_strategy s, uint32_t milli, int ends)
{
	for (int x = -RADIUS; x <= RADIUS; x++) {
		for (int y = -RADIUS; y <= RADIUS; y++) {
			const double r = hypot(x, y);
			struct way w = { s, milli, x, y, x, y, x & 1 };

			if (r < 1 || r > RADIUS)
				continue;
			check_arc(&w);
			for (int i = 0; i < 2 * ends; i++) {
				const double t = 6.2832 * (i / 2) / ends +
						 0.03 * x;

				w.x1 = (int)lround(r * cos(t));
				w.y1 = (int)lround(r * sin(t));
				w.clockwise = i & 1;
				check_arc(&w);
			}
		}
	}
}

static void tube_arcs_from_every_start_end_exactly_and_retrace(void **st)
{
	(void)st;
	arcs_of(INTERP_MIN_SWITCH, 1000, 6);
	arcs_of(INTERP_MIN_SWITCH, 1500, 4);
	arcs_of(INTERP_MIN_SWITCH, 2000, 4);
	arcs_of(INTERP_MIN_SWITCH, 3000, 4);
}

static void arcs_of_the_line_rules_are_point_by_point(void **st)
{
	(void)st;
	arcs_of(INTERP_CENTRED, 0, 2);
	arcs_of(INTERP_MAIN_DIRECTION, 2000, 2);
}

static void random_arcs_end_exactly_in_range_and_retrace(void **st)
{
	uint64_t seed = 5150;

	(void)st;
	print_message("    seed %llu\n", (unsigned long long)seed);
	for (int i = 0; i < ARCS; i++) {
		const double r = exp(uniform(&seed, 0.7, i % 100 ? 5 : 8.5));
		const double t0 = uniform(&seed, 0, 6.2832);
		const double t1 = t0 + (rnd(&seed) % 4 ?
					uniform(&seed, 0, 6.2832) :
					uniform(&seed, 0, 2 / r));
		struct way w = {
			.s = rnd(&seed) % 3 ? INTERP_MIN_SWITCH :
					     INTERP_POINT_BY_POINT,
			.milli = 1000 + (uint32_t)(rnd(&seed) % 9000),
			.x0 = (int)lround(r * cos(t0)),
			.y0 = (int)lround(r * sin(t0)),
			.clockwise = rnd(&seed) % 2,
		};
		const double r0 = hypot(w.x0, w.y0);

		w.x1 = (int)lround(r0 * cos(t1));
		w.y1 = (int)lround(r0 * sin(t1));
		if (r0 >= 1)
			check_arc(&w);
	}
}

/* -- Changes of axis ------------------------------------------------------ */

static size_t changes_of_circle(enum interp_strategy s, uint32_t milli, int r)
{
	const struct way w = { s, milli, r, 0, r, 0, true };
	struct made m = make_arc(&w);
	struct interp_cursor c;
	uint32_t was = 0;
	size_t n = 0;

	assert_int_equal(interp_cursor_init(&c, &m.p), 0);
	interp_cursor_aim(&c, 1e9);
	while (interp_cursor_step(&c) == INTERP_MOVED) {
		if (c.seg.kind != INTERP_ARC)
			continue;
		n += was != 0 && c.moved != was;
		was = c.moved;
	}
	unmake(&m);
	return n;
}

/* Within a hundredth of what is known of a circle of 1000 pulses. */
static void circles_in_a_tube_change_axis_as_seldom_as_is_known(void **st)
{
	static const size_t known[][2] = {
		{ 1000, 3023 }, { 1500, 1711 }, { 2000, 1175 }, { 5000, 428 },
	};

	(void)st;
	assert_int_equal(changes_of_circle(INTERP_POINT_BY_POINT, 0, 1000),
			 4683);
	for (int i = 0; i < 4; i++) {
		const size_t n = changes_of_circle(INTERP_MIN_SWITCH,
				(uint32_t)known[i][0], 1000);

		print_message("    mu %zu: %zu changes, known %zu\n",
			      known[i][0], n, known[i][1]);
		assert_true(n <= known[i][1] + known[i][1] / 50);
	}
}

/* -- Helices, refusals, damage -------------------------------------------- */

static struct made random_program(enum interp_strategy s, uint64_t *seed)
{
	struct interp_build *b = build_with(s, 2000);

	for (int i = 0; i < 20; i++)
		random_segment(b, seed, s);
	return finish(b);
}

static void random_programs_with_helices_are_walked_about(void **st)
{
	(void)st;
	for (uint64_t seed = 1; seed <= 300; seed++) {
		uint64_t s = seed;
		const enum interp_strategy strategy =
			INTERP_CENTRED + (int)(seed % 3);
		struct made m = random_program(strategy, &s);
		struct points out = walk_all(&m, 1e9);
		struct points fine = walk_all(&m, 0.0007);

		print_on_failure("seed", seed);
		assert_true(points_equal(&out, &fine));
		assert_true(wander(&m, &out, &s, 300));
		check_back(&m, &out);
		for (size_t i = 1; i < out.n; i++) {
			for (int a = 0; a < INTERP_NAXES; a++)
				assert_true(abs(out.at[i].pos[a] -
						out.at[i - 1].pos[a]) <= 1);
		}
		points_free(&out);
		points_free(&fine);
		unmake(&m);
	}
}

static void a_steep_helix_keeps_its_axes_in_step(void **st)
{
	(void)st;
	for (int i = 0; i < 2; i++) {
		struct interp_build *b = build_with(i ? INTERP_MIN_SWITCH :
						    INTERP_CENTRED, 2000);
		const double start[INTERP_NAXES] = { 0.02 };
		const double end[INTERP_NAXES] = { -0.02, 0, 5 };
		struct made m;
		struct interp_deviation d = { 0 };
		struct interp_cursor c;

		line(b, start);
		arc(b, end, 0, 0, false);
		m = finish(b);
		assert_int_equal(interp_cursor_init(&c, &m.p), 0);
		interp_cursor_aim(&c, 1e9);
		while (interp_cursor_step(&c) == INTERP_MOVED)
			assert_true(interp_cursor_deviation_mm(&c, &d) <
				    0.0035);
		assert_int_equal(c.pos[0], -20);
		assert_int_equal(c.pos[2], 5000);
		unmake(&m);
	}
}

/* From a line 0 0 to 3 1, or from a circle about 0 0 through 3 1. */
static double plain_deviation_mm(bool circle, double x, double y)
{
	const long double r = hypotl(x, y), dot = 3.0L * x + y;
	const long double t = dot <= 0 ? 0 : dot >= 10 ? 1 : dot / 10;

	return (double)(circle ? fabsl(r - sqrtl(10)) :
				 hypotl(x - 3 * t, y - t));
}

static void points_lie_as_far_from_lines_and_circles_as_they_do(void **st)
{
	const struct way w = { .s = INTERP_CENTRED, .x0 = 3000, .y0 = 1000,
			       .x1 = 3000, .y1 = 1000 };
	struct made m = make_arc(&w);
	uint64_t seed = 1;

	(void)st;
	for (uint32_t i = 0; i < 2; i++) {
		struct interp_deviation d = { 0 };
		struct interp_cursor c;

		assert_int_equal(interp_cursor_init(&c, &m.p), 0);
		assert_int_equal(interp_cursor_seek(&c, i + 1, 0), 0);
		assert_int_equal(c.seg.kind == INTERP_ARC, i);
		for (int n = 0; n < 20000; n++) {
			const int far = n % 2 ? 5000 : 50;
			double is, shall;

			c.pos[0] = n ? (int)uniform(&seed, -far, far) : 0;
			c.pos[1] = n % 8 ? (int)uniform(&seed, -far, far) : 0;
			is = interp_cursor_deviation_mm(&c, &d);
			shall = plain_deviation_mm(i, c.pos[0] * 0.001,
						   c.pos[1] * 0.001);
			assert_true(fabs(is - shall) < 2e-15);
		}
	}
	unmake(&m);
}

static void a_tolerance_too_narrow_for_an_arc_is_refused(void **st)
{
	const double start[INTERP_NAXES] = { 5 };
	const double end[INTERP_NAXES] = { 0, 5 };
	const struct interp_build_arc a = {
		.axis_a = INTERP_X, .axis_b = INTERP_Y,
	};
	struct interp_build *b = build_with(INTERP_MIN_SWITCH, 700);
	struct interp_diag d = { .found = "" };

	(void)st;
	line(b, start);
	assert_int_equal(interp_build_arc(b, end, &a, &word, &d), -EINVAL);
	assert_string_equal(d.found, "a tolerance of 0.7 pulses is too narrow "
			    "for this arc under min-switch");
	assert_non_null(strstr(d.wanted, "0.708 pulses or more"));
	interp_build_destroy(b);
}

static void a_damaged_block_never_leads_astray(void **st)
{
	(void)st;
	for (uint64_t seed = 1; seed <= 4000; seed++) {
		uint64_t s = seed;
		struct made m = random_program(INTERP_CENTRED + (int)(seed % 3),
					       &s);
		struct interp_program_head *h = m.block;
		const uint32_t nruns = h->nruns;
		int32_t *runs = (void *)((char *)m.block + h->runs_at);

		print_on_failure("seed", seed);
		damage(&m, &s);
		/* The runs are where it hurts; be sure to meet them. */
		if (nruns > 0)
			runs[rnd(&s) % nruns % 4] = (int32_t)rnd(&s);
		walk_damaged(&m);
		unmake(&m);
	}
}

/* By differences of the places that are walked: the most that C, which turns by
 * @deg beside a circle of @r_mm, goes farther in a step than it may. */
static double most_of_c(enum interp_strategy strategy, double r_mm, double deg)
{
	struct interp_build *b = begin(strategy);
	const double end[INTERP_NAXES] = { [INTERP_C] = deg };
	enum interp_step is = INTERP_ARRIVED;
	struct interp_cursor c;
	double most = 0, ds_mm, may;
	struct made m;

	arc(b, end, r_mm, 0, false);
	m = finish(b);
	assert_int_equal(interp_cursor_init(&c, &m.p), 0);
	ds_mm = m.p.segs[1].length_mm / 5000;
	may = deg * 1000 / 5000;
	for (int leg = 1; leg >= -1; leg -= 2) {
		for (is = INTERP_ARRIVED; is == INTERP_ARRIVED; ) {
			const int32_t from = c.pos[INTERP_C];

			interp_cursor_aim(&c, leg * ds_mm);
			do
				is = interp_cursor_step(&c);
			while (is == INTERP_MOVED);
			most = fmax(most,
				    abs(c.pos[INTERP_C] - from) - may);
		}
		assert_int_equal(is, leg > 0 ? INTERP_AT_END :
					       INTERP_AT_START);
	}
	unmake(&m);
	return most;
}

static void an_axis_beside_a_circle_goes_evenly(void **st)
{
	static const enum interp_strategy one_at_a_time[] = {
		INTERP_POINT_BY_POINT, INTERP_CENTRED, INTERP_MAIN_DIRECTION,
	};
	static const double r_mm[] = { 0.02, 0.183, 1 };
	static const double deg[] = { 1, 24.2, 180 };

	(void)st;
	for (int i = 0; i < 3 * 3 * 3; i++) {
		const double most = most_of_c(one_at_a_time[i % 3],
					      r_mm[i / 3 % 3], deg[i / 9]);

		if (most > 3)
			fail_msg("strategy %d, %g mm, %g degrees: %g pulses "
				 "more", i % 3, r_mm[i / 3 % 3], deg[i / 9],
				 most);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(an_axis_beside_a_circle_goes_evenly),
		cmocka_unit_test(tube_arcs_from_every_start_end_exactly_and_retrace),
		cmocka_unit_test(arcs_of_the_line_rules_are_point_by_point),
		cmocka_unit_test(random_arcs_end_exactly_in_range_and_retrace),
		cmocka_unit_test(circles_in_a_tube_change_axis_as_seldom_as_is_known),
		cmocka_unit_test(random_programs_with_helices_are_walked_about),
		cmocka_unit_test(a_steep_helix_keeps_its_axes_in_step),
		cmocka_unit_test(points_lie_as_far_from_lines_and_circles_as_they_do),
		cmocka_unit_test(a_tolerance_too_narrow_for_an_arc_is_refused),
		cmocka_unit_test(a_damaged_block_never_leads_astray),
	};

	return cmocka_run_group_tests_name("interp/arcs", tests, NULL, NULL);
}
