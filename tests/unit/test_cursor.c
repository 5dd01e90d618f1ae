/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_cursor.c - promises of a walk along a program
 *
 * All cases are tested where that is possible; otherwise random programs, whose
 * seed is printed.
 */
#include "walk_help.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* -- Lines ---------------------------------------------------------------- */

static const int planes[][2] = {
	{ INTERP_X, INTERP_Y }, { INTERP_Y, INTERP_Z }, { INTERP_Z, INTERP_X },
	{ INTERP_U, INTERP_V },
};

static struct made line_of(enum interp_strategy s, const int axes[2], int dx,
			   int dy)
{
	struct interp_build *b = begin(s);
	double end[INTERP_NAXES] = { 0 };

	end[axes[0]] = dx * 0.001;
	end[axes[1]] = dy * 0.001;
	line(b, end);
	return finish(b);
}

/* Off the line by how much, along the shorter axis. */
static double axial(int dx, int dy, int x, int y)
{
	const double longer = fmax(abs(dx), abs(dy));

	return longer > 0 ? fabs((double)dx * y - (double)dy * x) / longer : 0;
}

static void check_line(enum interp_strategy s, const int axes[2], int dx,
		       int dy)
{
	const double bound = s == INTERP_SIMULTANEOUS ? 0.5 : 1.0;
	struct made m = line_of(s, axes, dx, dy);
	struct interp_cursor c;
	int points = 0;

	assert_int_equal(interp_cursor_init(&c, &m.p), 0);
	interp_cursor_aim(&c, 1e9);
	while (interp_cursor_step(&c) == INTERP_MOVED) {
		const int x = c.pos[axes[0]], y = c.pos[axes[1]];

		points++;
		assert_true(axial(dx, dy, x, y) <= bound + 1e-12);
		if (s == INTERP_POINT_BY_POINT)
			assert_int_equal(__builtin_popcount(c.moved), 1);
	}
	assert_int_equal(c.pos[axes[0]], dx);
	assert_int_equal(c.pos[axes[1]], dy);
	assert_int_equal(points, s == INTERP_POINT_BY_POINT ?
			 abs(dx) + abs(dy) :
			 (abs(dx) > abs(dy) ? abs(dx) : abs(dy)));
	unmake(&m);
}

static void lines_end_exactly_and_stay_near_in_all_octants_and_planes(void **st)
{
	(void)st;
	for (size_t p = 0; p < sizeof(planes) / sizeof(planes[0]); p++) {
		for (int dx = -13; dx <= 13; dx++) {
			for (int dy = -13; dy <= 13; dy++) {
				check_line(INTERP_SIMULTANEOUS, planes[p],
					   dx, dy);
				check_line(INTERP_POINT_BY_POINT, planes[p],
					   dx, dy);
			}
		}
	}
}

/* -- There and back ------------------------------------------------------- */

static void walk_retraces(const struct made *m)
{
	struct points out = walk_all(m, 1e9);
	struct interp_cursor c;
	size_t n = out.n;

	assert_int_equal(interp_cursor_init(&c, &m->p), 0);
	run(&c, 1e9, NULL);
	interp_cursor_aim(&c, -1e9);
	for (;;) {
		n--;
		assert_memory_equal(c.pos, out.at[n].pos, sizeof(c.pos));
		if (interp_cursor_step(&c) != INTERP_MOVED)
			break;
	}
	assert_int_equal(n, 0);
	points_free(&out);
}

static void check_arc(enum interp_strategy s, const int from[2],
		      const int to[2], bool clockwise)
{
	const int x0 = from[0], y0 = from[1], x1 = to[0], y1 = to[1];
	struct interp_build *b = begin(s);
	const double r0 = hypot(x0, y0), r1 = hypot(x1, y1);
	double at[INTERP_NAXES] = { x0 * 0.001, y0 * 0.001 };
	const double bound = s == INTERP_SIMULTANEOUS ? 0.7072 : 1.0;
	struct points out;
	struct made m;

	line(b, at);
	at[0] = x1 * 0.001;
	at[1] = y1 * 0.001;
	arc(b, at, 0, 0, clockwise);
	m = finish(b);
	out = walk_all(&m, 1e9);
	for (size_t i = 0; i < out.n; i++) {
		const double r = hypot(out.at[i].pos[0], out.at[i].pos[1]);

		if (out.at[i].kind != INTERP_ARC)
			continue;
		assert_true(r >= fmin(r0, r1) - bound - 1e-9);
		assert_true(r <= fmax(r0, r1) + bound + 1e-9);
	}
	assert_int_equal(out.at[out.n - 1].pos[0], x1);
	assert_int_equal(out.at[out.n - 1].pos[1], y1);
	/* Once round at most: 8 R pulses, and the line to the start. */
	assert_true((double)out.n < 8 * fmax(r0, r1) + 9 + abs(x0) + abs(y0));
	points_free(&out);
	walk_retraces(&m);
	unmake(&m);
}

/* Every arc from a lattice start to a lattice point on the same circle. */
static void arcs_of(enum interp_strategy s, int rmax, int rstep)
{
	for (int x = -rmax; x <= rmax; x += rstep) {
		for (int y = -rmax; y <= rmax; y += rstep) {
			const double r = hypot(x, y);
			const int from[] = { x, y };

			if (r < 1 || r > rmax)
				continue;
			for (int i = 0; i < 24; i++) {
				const double t = i * 0.2618 + 0.03 * x;
				const int to[] = { (int)lround(r * cos(t)),
						   (int)lround(r * sin(t)) };

				check_arc(s, from, to, false);
				check_arc(s, from, to, true);
			}
			check_arc(s, from, from, i32_odd(x + y));
		}
	}
}

static void arcs_from_every_start_end_exactly_and_retrace(void **st)
{
	(void)st;
	arcs_of(INTERP_SIMULTANEOUS, 12, 1);
	arcs_of(INTERP_POINT_BY_POINT, 12, 1);
	arcs_of(INTERP_SIMULTANEOUS, 40, 7);
	arcs_of(INTERP_POINT_BY_POINT, 40, 7);
}

/* -- Random programs ------------------------------------------------------ */

static struct made random_program(enum interp_strategy s, uint64_t *seed,
				  int segs)
{
	struct interp_build *b = begin(s);

	for (int i = 0; i < segs; i++)
		random_segment(b, seed, s);
	return finish(b);
}

static void the_points_do_not_depend_on_how_the_walk_is_cut(void **st)
{
	(void)st;
	for (uint64_t seed = 1; seed <= 60; seed++) {
		uint64_t s = seed;
		struct made m = random_program((seed & 1), &s, 30);
		struct points whole = walk_all(&m, 1e9);
		struct points fine = walk_all(&m, 0.0007);
		struct points coarse = walk_all(&m, 0.0331);

		print_on_failure("seed", seed);
		assert_true(points_equal(&whole, &fine));
		assert_true(points_equal(&whole, &coarse));
		points_free(&whole);
		points_free(&fine);
		points_free(&coarse);
		unmake(&m);
	}
}

static void a_random_walk_back_and_forth_stays_on_the_points(void **st)
{
	(void)st;
	for (uint64_t seed = 1; seed <= 60; seed++) {
		uint64_t s = seed;
		struct made m = random_program((seed & 1), &s, 30);
		struct points out = walk_all(&m, 1e9);

		print_on_failure("seed", seed);
		assert_true(wander(&m, &out, &s, 400));
		points_free(&out);
		walk_retraces(&m);
		unmake(&m);
	}
}

/* Aim at a place near by.  Return: did it creep there? */
static bool creep_as_a_step_does(struct interp_cursor *c, double ds_mm)
{
	struct interp_cursor beside;
	bool crept;

	interp_cursor_aim(c, ds_mm);
	beside = *c;
	crept = interp_cursor_creep(c);
	if (crept) {
		assert_int_equal(interp_cursor_step(&beside), INTERP_ARRIVED);
		assert_memory_equal(&beside, c, sizeof(beside));
	}
	while (!crept && interp_cursor_step(c) == INTERP_MOVED)
		;
	return crept;
}

static void a_creep_goes_where_a_step_would_arrive(void **st)
{
	int crept = 0;

	(void)st;
	for (uint64_t seed = 1; seed <= 60; seed++) {
		uint64_t s = seed;
		struct made m = random_program((seed & 1), &s, 30);
		struct interp_cursor c;

		print_on_failure("seed", seed);
		assert_int_equal(interp_cursor_init(&c, &m.p), 0);
		for (int i = 0; i < 4000; i++)
			crept += creep_as_a_step_does(&c,
						      uniform(&s, -3e-4, 1e-3));
		unmake(&m);
	}
	assert_true(crept > 60 * 400);
}

static void no_axis_ever_moves_more_than_one_pulse(void **st)
{
	(void)st;
	for (uint64_t seed = 100; seed <= 160; seed++) {
		uint64_t s = seed;
		struct made m = random_program((seed & 1), &s, 40);
		struct points out = walk_all(&m, 1e9);

		print_on_failure("seed", seed);
		for (size_t i = 1; i < out.n; i++) {
			for (int a = 0; a < INTERP_NAXES; a++)
				assert_true(abs(out.at[i].pos[a] -
						out.at[i - 1].pos[a]) <= 1);
		}
		points_free(&out);
		unmake(&m);
	}
}

static void simultaneous_points_are_within_half_a_pulse_of_the_path(void **st)
{
	(void)st;
	for (uint64_t seed = 200; seed <= 240; seed++) {
		uint64_t s = seed;
		struct made m = random_program(INTERP_SIMULTANEOUS, &s, 30);
		struct interp_deviation d = { 0 };
		struct interp_cursor c;

		print_on_failure("seed", seed);
		assert_int_equal(interp_cursor_init(&c, &m.p), 0);
		interp_cursor_aim(&c, 1e9);
		/* Five linear axes, half a pulse each. */
		while (interp_cursor_step(&c) == INTERP_MOVED)
			assert_true(interp_cursor_deviation_mm(&c, &d) <
				    0.0005 * sqrt(5) + 1e-9);
		unmake(&m);
	}
}

static void point_by_point_points_are_near_the_path(void **st)
{
	(void)st;
	for (uint64_t seed = 300; seed <= 340; seed++) {
		uint64_t s = seed;
		struct made m = random_program(INTERP_POINT_BY_POINT, &s, 30);
		struct interp_deviation d = { 0 };
		struct interp_cursor c;

		print_on_failure("seed", seed);
		assert_int_equal(interp_cursor_init(&c, &m.p), 0);
		interp_cursor_aim(&c, 1e9);
		/* A tree is three levels deep at the most, a pulse each. */
		while (interp_cursor_step(&c) == INTERP_MOVED)
			assert_true(interp_cursor_deviation_mm(&c, &d) <
				    0.001 * 3);
		unmake(&m);
	}
}

static void a_place_can_be_sought(void **st)
{
	uint64_t s = 7;
	struct made m = random_program(INTERP_POINT_BY_POINT, &s, 20);
	struct interp_cursor c, d;

	(void)st;
	assert_int_equal(interp_cursor_init(&c, &m.p), 0);
	interp_cursor_aim(&c, 1e9);
	for (int i = 0; interp_cursor_step(&c) == INTERP_MOVED; i++) {
		if (i % 97)
			continue;
		assert_int_equal(interp_cursor_init(&d, &m.p), 0);
		assert_int_equal(interp_cursor_seek(&d, c.index, c.tick), 0);
		assert_memory_equal(c.pos, d.pos, sizeof(c.pos));
	}
	assert_int_equal(interp_cursor_seek(&d, m.p.head->nsegs, 0), -34);
	unmake(&m);
}

/* -- Distrust ------------------------------------------------------------- */

static void a_damaged_block_never_leads_astray(void **st)
{
	(void)st;
	for (uint64_t seed = 1; seed <= 1500; seed++) {
		uint64_t s = seed;
		struct made m = random_program((seed & 1), &s, 6);

		print_on_failure("seed", seed);
		damage(&m, &s);
		walk_damaged(&m);
		unmake(&m);
	}
}

/* All that it says of its pulses is where it is, also from inside. */
static void an_arc_of_a_negative_radius_says_each_pulse(void **st)
{
	const double end[INTERP_NAXES] = { 0, 0, 2 };
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	uint16_t pulses[20];
	struct interp_cursor c;
	uint32_t n;
	int32_t at[2];
	struct made m;

	(void)st;
	arc(b, end, -0.1, 0, false);
	m = finish(b);
	((struct interp_arc *)m.p.arcs)->r_mm = -1;
	if (interp_cursor_init(&c, &m.p) == 0 &&
	    interp_cursor_seek(&c, 1, 1001) == 0) {
		memcpy(at, c.pos, sizeof(at));
		interp_cursor_aim(&c, 1e9);
		n = interp_cursor_run(&c, pulses, 20);
		for (uint32_t i = 0; i < n && n <= 20; i++)
			for (int a = 0; a < 2; a++)
				at[a] += !(pulses[i] >> a & 1) ? 0 :
					 pulses[i] >> (a + 8) & 1 ? -1 : 1;
		if (n <= 20)
			assert_memory_equal(at, c.pos, sizeof(at));
	}
	unmake(&m);
}

/* Where the way breaks off it stands where it was told that it came to. */
static void a_run_into_damage_goes_nowhere(void **st)
{
	const double end[INTERP_NAXES] = { 0, 0.2 };
	struct interp_build *b = begin(INTERP_POINT_BY_POINT);
	struct interp_seg *s;
	uint16_t pulses[64];
	struct interp_cursor c;
	int32_t at[INTERP_NAXES];
	struct made m;

	(void)st;
	arc(b, end, 0, 0.1, false);
	m = finish(b);
	s = (struct interp_seg *)m.p.segs + 1;
	((struct interp_arc *)m.p.arcs)->circle_ticks--;
	s->ticks--;
	assert_int_equal(interp_cursor_init(&c, &m.p), 0);
	assert_int_equal(interp_cursor_seek(&c, 1, s->ticks - 20), 0);
	memcpy(at, c.pos, sizeof(at));
	interp_cursor_aim(&c, 1e9);
	assert_int_equal(interp_cursor_run(&c, pulses, 64), 0);
	assert_int_equal(interp_cursor_step(&c), INTERP_BAD_SEGMENT);
	assert_memory_equal(at, c.pos, sizeof(at));
	unmake(&m);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(lines_end_exactly_and_stay_near_in_all_octants_and_planes),
		cmocka_unit_test(arcs_from_every_start_end_exactly_and_retrace),
		cmocka_unit_test(the_points_do_not_depend_on_how_the_walk_is_cut),
		cmocka_unit_test(a_random_walk_back_and_forth_stays_on_the_points),
		cmocka_unit_test(a_creep_goes_where_a_step_would_arrive),
		cmocka_unit_test(no_axis_ever_moves_more_than_one_pulse),
		cmocka_unit_test(simultaneous_points_are_within_half_a_pulse_of_the_path),
		cmocka_unit_test(point_by_point_points_are_near_the_path),
		cmocka_unit_test(a_place_can_be_sought),
		cmocka_unit_test(a_damaged_block_never_leads_astray),
		cmocka_unit_test(an_arc_of_a_negative_radius_says_each_pulse),
		cmocka_unit_test(a_run_into_damage_goes_nowhere),
	};

	return cmocka_run_group_tests_name("interp/cursor", tests, NULL, NULL);
}
