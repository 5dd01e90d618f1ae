/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_curve.c - promises of NURBS in a program: the points are the same in
 * both directions
 *
 * The curves are random; the seed is printed.
 */
#include "walk_help.h"

#include "curves.h"
#include "random_curve.h"
#include "seed.h"

#include "interp/at.h"
#include "interp/limits.h"

#include <errno.h>

#define ROUNDS	SEED_ROUNDS(32)

static uint64_t seed;

static const enum interp_strategy strategies[] = {
	INTERP_SIMULTANEOUS, INTERP_CENTRED, INTERP_MIN_SWITCH,
};

/* Begin where @c does; its columns are axes @first and on. */
static struct interp_build *begin_at(const struct interp_nurbs *c,
				     uint32_t first, enum interp_strategy s,
				     struct interp_build_curve *ret)
{
	struct interp_build_options o = {
		.machine = &help_machine, .strategy = s,
		.tolerance_milli = 2000,
	};

	interp_build_destroy(begin(s));
	*ret = (struct interp_build_curve) { .nurbs = *c };
	for (uint32_t j = 0; j < c->naxes; j++) {
		ret->axis[j] = (uint8_t)((first + j) % INTERP_NAXES);
		o.start_mm[ret->axis[j]] = c->points[j] / c->points[c->naxes];
	}
	return interp_build_create(&o);
}

static struct made make(const struct interp_nurbs *c, uint32_t first,
			enum interp_strategy s)
{
	const struct interp_build_word w = { .line = 7, .feed_mm_s = 100 };
	struct interp_build_curve bc;
	struct interp_build *b = begin_at(c, first, s, &bc);
	struct interp_diag d = { 0 };

	if (interp_build_curve(b, &bc, &w, &d) != 0)
		fail_msg("%s; %s", d.found, d.wanted);
	return finish(b);
}

/* A random curve of this many axes that keeps to the travel. */
static void some_curve(uint64_t *s, struct random_curve *r, uint32_t naxes)
{
	do
		random_curve(s, r);
	while (r->c.naxes != naxes);
	/* Small, so that the walk is short. */
	for (uint32_t i = 0; i < r->c.npoints * (naxes + 1); i++) {
		if (i % (naxes + 1) != naxes)
			r->points[i] *= 0.02;
	}
}

static void check_steps(const struct points *p, bool one_axis)
{
	for (size_t i = 1; i < p->n; i++) {
		int moved = 0;

		for (int a = 0; a < INTERP_NAXES; a++) {
			const int d = p->at[i].pos[a] - p->at[i - 1].pos[a];

			assert_in_range(d + 1, 0, 2);
			moved += d != 0;
		}
		assert_true(moved > 0);
		assert_true(!one_axis || moved == 1);
	}
}

static void check_ends(const struct points *p, const struct interp_nurbs *c,
		       uint32_t first)
{
	const double *last = c->points +
			     (size_t)(c->npoints - 1) * (c->naxes + 1);

	for (uint32_t j = 0; j < c->naxes; j++) {
		const uint32_t a = (first + j) % INTERP_NAXES;

		assert_int_equal(p->at[0].pos[a],
				 lround(c->points[j] / c->points[c->naxes] *
					1000));
		assert_true(fabs(p->at[p->n - 1].pos[a] -
				 last[j] / last[c->naxes] * 1000) < 0.51);
	}
}

/* Back to the start and to the end again, by steps of @ds_mm. */
static void check_back(const struct made *m, const struct points *p,
		       double ds_mm)
{
	struct points again = { 0 };
	struct interp_cursor c;
	size_t i = p->n - 1;
	enum interp_step s;

	interp_cursor_init(&c, &m->p);
	run(&c, 1e9, NULL);
	do {
		interp_cursor_aim(&c, -ds_mm);
		while ((s = interp_cursor_step(&c)) == INTERP_MOVED) {
			assert_true(i-- > 0);
			assert_memory_equal(c.pos, p->at[i].pos, sizeof(c.pos));
		}
	} while (s == INTERP_ARRIVED);
	assert_int_equal(s, INTERP_AT_START);
	assert_int_equal(i, 0);
	points_add(&again, &c);
	run(&c, ds_mm, &again);
	assert_true(points_equal(p, &again));
	points_free(&again);
}

static void a_curve_is_walked_back_by_the_points_it_came(void **state)
{
	uint64_t s = seed;

	(void)state;
	for (uint32_t k = 0; k < (uint32_t)ROUNDS; k++) {
		const enum interp_strategy how = strategies[k % 3];
		const uint32_t first = k % INTERP_NAXES;
		struct random_curve r;
		struct points p;
		struct made m;

		some_curve(&s, &r, 1 + k % INTERP_NAXES);
		m = make(&r.c, first, how);
		p = walk_all(&m, 1e9);
		check_steps(&p, how == INTERP_CENTRED ||
				how == INTERP_MIN_SWITCH);
		check_ends(&p, &r.c, first);
		check_back(&m, &p, curve_uniform(&s, 0.001, 0.5));
		points_free(&p);
		unmake(&m);
	}
}

static double worst_um(const struct made *m)
{
	struct interp_deviation d = { 0 };
	struct interp_cursor c;
	double worst = 0;

	interp_cursor_init(&c, &m->p);
	interp_cursor_aim(&c, 1e9);
	for (int i = 0; interp_cursor_step(&c) == INTERP_MOVED; i++) {
		if (i % 7 == 0)
			worst = fmax(worst, interp_cursor_deviation_mm(&c, &d));
	}
	return worst * 1000;
}

/* Half a pulse on each of two axes; one at a time, half of a place more. */
static void a_curve_is_kept_to(void **state)
{
	double points[CURVES_POINTS_MAX][3];

	(void)state;
	for (size_t i = 0; i < 4; i++) {
		const bool one = i % 2;
		struct interp_nurbs c;
		struct made m;

		curve_load(&curves_data[i < 2 ? 0 : 2], points, &c);
		m = make(&c, 0, one ? INTERP_CENTRED : INTERP_SIMULTANEOUS);
		assert_true(worst_um(&m) < (one ? 1.1 : 0.7072));
		unmake(&m);
	}
}

static void length_and_place_are_those_of_the_curve(void **state)
{
	static const double lengths_mm[] = { 314.1593, 1264.1829, 382.8596 };
	double points[CURVES_POINTS_MAX][3];

	(void)state;
	for (size_t i = 0; i < NCURVES; i++) {
		struct interp_nurbs c;
		struct made m;
		double s = 0;

		curve_load(&curves_data[i], points, &c);
		m = make(&c, 0, INTERP_SIMULTANEOUS);
		assert_true(fabs(m.p.head->length_mm - lengths_mm[i]) < 1e-3);
		for (uint32_t k = 0; k < m.p.head->nsegs; k++) {
			assert_true(fabs(m.p.segs[k].s_mm - s) < 1e-9);
			s += m.p.segs[k].length_mm;
		}
		unmake(&m);
	}
}

/* The tips of the butterfly, by chord error and the axes; its wings by F. */
static void feed_is_lowest_where_the_curve_bends_most(void **state)
{
	double points[CURVES_POINTS_MAX][3];
	struct interp_nurbs c;
	struct made m;
	double least = HUGE_VAL, most = 0;

	(void)state;
	curve_load(&curves_data[2], points, &c);
	m = make(&c, 0, INTERP_SIMULTANEOUS);
	for (uint32_t k = 1; k + 1 < m.p.head->nsegs; k++) {
		least = fmin(least, (double)m.p.segs[k].feed_max_mm_s);
		most = fmax(most, (double)m.p.segs[k].feed_max_mm_s);
	}
	/* Radius 0.0231 mm at 1000 mm/s2 and 20000 mm/s3, 1 um in 1 ms: the
	 * slower the tips, the more is left to be fast behind them. */
	assert_true(least > 0.3 && least < sqrt(1000 * 0.0231));
	assert_true(most > 60);
	unmake(&m);
}

static void a_cusp_is_a_node(void **state)
{
	const double knots[] = { 0, 0, 0, 1, 1, 1 };
	const double spine[] = { 0, 0, 1, 10, 10, 1, 0, 0, 1 };
	const struct interp_nurbs c = { 2, 2, 3, 2, 0, knots, spine };
	struct made m = make(&c, 0, INTERP_SIMULTANEOUS);
	bool there = false;

	(void)state;
	for (uint32_t k = 0; k < m.p.head->nsegs; k++)
		there |= interp_round_sub(m.p.nodes[2 * k]) == 5000;
	assert_true(there);
	assert_true(fabs(m.p.head->length_mm - 10 * sqrt(2)) < 1e-3);
	unmake(&m);
}

/* By how much column 0 and 1 go in a mm, at one end of segment @i. */
static void way_of(const struct made *m, uint32_t i, bool at_end, double ret[2])
{
	const double mm = m->p.segs[i].length_mm, in = 1e-6 * mm;
	struct interp_at_curve last = { .open = false };
	struct interp_contour_point at;

	assert_true(interp_program_at(&m->p, i, at_end ? mm - in : in, &last,
				      &at));
	ret[0] = at.per_u[0];
	ret[1] = at.per_u[1];
}

/* From piece to piece a smooth curve keeps its way, at a cusp it turns back. */
static void pieces_tell_which_way_they_go(void **state)
{
	const double knots[] = { 0, 0, 0, 1, 1, 1 };
	const double spine[] = { 0, 0, 1, 10, 10, 1, 0, 0, 1 };
	const struct interp_nurbs cusp = { 2, 2, 3, 2, 0, knots, spine };
	double points[CURVES_POINTS_MAX][3];

	(void)state;
	for (int turned = 0; turned < 2; turned++) {
		double last[2], next[2];
		struct interp_nurbs c = cusp;
		struct made m;
		bool back = false;

		if (!turned)
			curve_load(&curves_data[2], points, &c);
		m = make(&c, 0, INTERP_SIMULTANEOUS);
		assert_true(m.p.head->nsegs > 3);
		for (uint32_t i = 1; i + 2 < m.p.head->nsegs; i++) {
			double dot;

			way_of(&m, i, true, last);
			way_of(&m, i + 1, false, next);
			dot = last[0] * next[0] + last[1] * next[1];
			assert_true(fabs(fabs(dot) - 1) < 1e-5);
			back |= dot < 0;
			/* What is smooth slows nothing, but for what cannot be
			 * come to, as beside a cusp; a cusp stops it. */
			if (dot > 0 && fmin(m.p.segs[i].length_mm,
					    m.p.segs[i + 1].length_mm) < 0.02)
				continue;
			assert_true(dot > 0 ? m.p.segs[i].node_mm_s >= 0.4f *
				    fminf(m.p.segs[i].feed_max_mm_s,
					  m.p.segs[i + 1].feed_max_mm_s) :
				    m.p.segs[i].node_mm_s < 5);
		}
		assert_int_equal(back, turned);
		unmake(&m);
	}
}

/* How the direction of column @j changes in a mm, at one end of segment @i. */
static double bend_of(const struct made *m, uint32_t i, bool at_end, uint32_t j)
{
	const double mm = m->p.segs[i].length_mm, h = 1e-4 * mm;
	struct interp_at_curve last = { .open = false };
	const double from = at_end ? mm - h : 0;
	struct interp_contour_point a, b;

	assert_true(interp_program_at(&m->p, i, from, &last, &a));
	assert_true(interp_program_at(&m->p, i, from + h, &last, &b));
	return (b.per_u[j] - a.per_u[j]) / h;
}

/* At each knot of a curve of degree 2 acceleration makes a step.  An axis
 * follows it with its jerk within corner_um, as from a line onto an arc. */
static void where_the_bend_makes_a_step_is_a_node(void **state)
{
	const double knots[] = { 0, 0, 0, 0.3, 0.5, 1, 1, 1 };
	const double j = help_machine.axis[0].j_max_mm_s3;
	const double step = cbrt(24 * INTERP_CORNER_MM * j * j);
	uint64_t s = seed;
	double most = 0;

	(void)state;
	for (int n = 0; n < ROUNDS; n++) {
		double points[5 * 3];
		const struct interp_nurbs c = { 2, 2, 5, 2, 0, knots, points };
		uint32_t nodes = 0;
		struct made m;

		for (int i = 0; i < 5; i++) {
			points[3 * i] = 10 * i;
			points[3 * i + 1] = uniform(&s, 4, 20) * (i % 2);
			points[3 * i + 2] = 1;
		}
		m = make(&c, 0, INTERP_SIMULTANEOUS);
		for (uint32_t i = 1; i + 2 < m.p.head->nsegs; i++) {
			const double v = fmin(fmin(m.p.segs[i].feed_max_mm_s,
						   m.p.segs[i].node_mm_s),
					      m.p.segs[i + 1].feed_max_mm_s);

			for (uint32_t k = 0; k < 2; k++) {
				const double d = bend_of(&m, i, true, k) -
						 bend_of(&m, i + 1, false, k);

				/* Beside a cusp nobody sees it. */
				if (fabs(d) < 1)
					most = fmax(most, v * v * fabs(d));
			}
			nodes++;
		}
		assert_true(nodes >= 2);
		unmake(&m);
	}
	assert_true(most < 1.001 * step && most > 0.5 * step);
}

/* Control points that are one, five of them: the curve stands for a while. */
static void a_curve_may_stand_on_the_way(void **state)
{
	const double knots[] = { 0, 0, 0, 0, .2, .4, .6, .7, .8, 1, 1, 1, 1 };
	const double still[] = { 0, 0, 1, 1, 0, 1, 2, 2, 1, 2, 2, 1, 2, 2, 1,
				 2, 2, 1, 2, 2, 1, 3, 1, 1, 4, 0, 1 };
	const struct interp_nurbs c = { 3, 2, 9, 2, 0, knots, still };
	struct made m = make(&c, 0, INTERP_SIMULTANEOUS);
	struct points p = walk_all(&m, 1e9);

	(void)state;
	check_steps(&p, false);
	check_back(&m, &p, 0.01);
	points_free(&p);
	unmake(&m);
}

/* -- Refusals ------------------------------------------------------------- */

static void refused(const struct interp_build_curve *bc, struct interp_build *b,
		    const char *found)
{
	const struct interp_build_word w = { .line = 7, .feed_mm_s = 100 };
	struct interp_diag d = { 0 };

	assert_int_equal(interp_build_curve(b, bc, &w, &d), -EINVAL);
	assert_non_null(strstr(d.found, found));
	assert_true(d.wanted[0] != 0);
	interp_build_destroy(b);
}

static void what_cannot_be_walked_is_refused(void **state)
{
	double knots[] = { 0, 0, 0, 1, 1, 1 };
	double points[] = { 0, 0, 1, 5, 500, 1, 10, 0, 1 };
	const struct interp_nurbs c = { 2, 2, 3, 2, 0, knots, points };
	struct interp_build_curve bc;
	struct interp_build *b;

	(void)state;
	/* Both ends inside the travel, the way is not. */
	b = begin_at(&c, 0, INTERP_SIMULTANEOUS, &bc);
	refused(&bc, b, "beyond the travel");
	points[4] = 5;
	b = begin_at(&c, 0, INTERP_SIMULTANEOUS, &bc);
	points[0] = 0.1;
	refused(&bc, b, "not where the program stands");
	points[0] = 0;
	b = begin_at(&c, 0, INTERP_SIMULTANEOUS, &bc);
	points[5] = -1;
	refused(&bc, b, "weight of zero or less, number 2");
	points[5] = 1;
	b = begin_at(&c, 0, INTERP_SIMULTANEOUS, &bc);
	knots[3] = -1;
	refused(&bc, b, "a knot below");
	knots[3] = 1;
	b = begin_at(&c, 0, INTERP_SIMULTANEOUS, &bc);
	bc.nurbs.degree = 3;
	refused(&bc, b, "too few control points");
	b = begin_at(&c, 0, INTERP_SIMULTANEOUS, &bc);
	help_machine.present = 1;
	refused(&bc, b, "no axis Y");
	help_machine.present = 0xff;
}

/* A damaged block: the walk ends or goes on, no axis leaps. */
static void damage_never_makes_an_axis_leap(void **state)
{
	uint64_t s = seed;

	(void)state;
	for (int k = 0; k < SEED_ROUNDS(300); k++) {
		const bool one = k % 2;
		struct random_curve r;
		struct interp_cursor c;
		struct interp_program p;
		struct points seen = { 0 };
		struct made m;
		size_t from, at;

		some_curve(&s, &r, 2);
		for (uint32_t i = 0; i < 2 * 3; i++)
			r.points[i] *= i % 3 == 2 ? 1 : 0.1;
		m = make(&r.c, 0, one ? INTERP_CENTRED : INTERP_SIMULTANEOUS);
		from = m.p.head->curves_at;
		at = from + rnd(&s) % (m.p.head->runs_at - from);
		((uint8_t *)m.block)[at] ^= (uint8_t)(1u << rnd(&s) % 8);
		if (interp_program_map(&p, m.block, m.bytes) == 0 &&
		    interp_cursor_init(&c, &p) == 0) {
			points_add(&seen, &c);
			interp_cursor_aim(&c, 5);
			while (interp_cursor_step(&c) == INTERP_MOVED)
				points_add(&seen, &c);
			/* A node of a block is where the next segment begins,
			 * whatever its neighbour did. */
			check_steps(&seen, one);
		}
		points_free(&seen);
		unmake(&m);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_curve_is_walked_back_by_the_points_it_came),
		cmocka_unit_test(a_curve_is_kept_to),
		cmocka_unit_test(length_and_place_are_those_of_the_curve),
		cmocka_unit_test(feed_is_lowest_where_the_curve_bends_most),
		cmocka_unit_test(a_cusp_is_a_node),
		cmocka_unit_test(pieces_tell_which_way_they_go),
		cmocka_unit_test(where_the_bend_makes_a_step_is_a_node),
		cmocka_unit_test(a_curve_may_stand_on_the_way),
		cmocka_unit_test(what_cannot_be_walked_is_refused),
		cmocka_unit_test(damage_never_makes_an_axis_leap),
	};

	seed = seed_take();
	return cmocka_run_group_tests_name("interp/curve", tests, NULL, NULL);
}
