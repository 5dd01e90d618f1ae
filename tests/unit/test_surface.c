/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_surface.c - promises of surfaces and of rigid bodies along curves
 */
#include "walk_help.h"

#include "interp/pose.h"
#include "tried/surface.h"
#include "random_curve.h"
#include "seed.h"

#include <errno.h>

#define ROUNDS	SEED_ROUNDS(500)
#define ROOT	0.70710678118654752440

static uint64_t seed;

/* A quarter of a cylinder of radius 10 about Z, 20 high: u round, v up. */
static const double round_knots[] = { 0, 0, 0, 1, 1, 1 };
static const double up_knots[] = { 0, 0, 1, 1 };
static const double cylinder_points[] = {
	10, 0, 0, 1,			10, 0, 20, 1,
	10 * ROOT, 10 * ROOT, 0, ROOT,	10 * ROOT, 10 * ROOT, 20 * ROOT, ROOT,
	0, 10, 0, 1,			0, 10, 20, 1,
};

static const struct interp_surface cylinder = {
	{ 2, 1 }, { 3, 2 }, { round_knots, up_knots }, cylinder_points
};

static void a_cylinder_is_round_and_its_offset_too(void **state)
{
	(void)state;
	assert_int_equal(interp_surface_check(&cylinder), INTERP_NURBS_SOUND);
	for (int i = 0; i <= 10; i++) {
		struct interp_surface_point p;
		double off[3];

		interp_surface_at(&cylinder, i / 10.0, 0.3, &p);
		assert_true(fabs(hypot(p.at_mm[0], p.at_mm[1]) - 10) < 1e-12);
		assert_true(fabs(p.at_mm[2] - 6) < 1e-12);
		assert_int_equal(interp_surface_offset(&cylinder, i / 10.0, 0.3,
						       0.5, off), 0);
		assert_true(fabs(hypot(off[0], off[1]) - 10.5) < 1e-12);
		assert_true(fabs(off[2] - 6) < 1e-12);
	}
}

/* All of v in one point: no normal there. */
static void where_there_is_no_normal_is_no_offset(void **state)
{
	const double points[] = { 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 0, 1, 1, 1, 0,
				  1 };
	const struct interp_surface cone = {
		{ 1, 1 }, { 2, 2 }, { up_knots, up_knots }, points
	};
	double off[3];

	(void)state;
	assert_int_equal(interp_surface_offset(&cone, 0, 0.5, 1, off), -EDOM);
	assert_int_equal(interp_surface_offset(&cone, 0.5, 0.5, 1, off), 0);
	assert_true(fabs(fabs(off[2]) - 1) < 1e-12);
}

static void an_iso_curve_lies_in_the_surface(void **state)
{
	double knots[20], points[64];
	struct interp_nurbs_own own = { .knots = knots, .points = points,
					.room = 8 };
	uint64_t s = seed;

	(void)state;
	for (int k = 0; k < ROUNDS; k++) {
		const double u = curve_uniform(&s, 0, 1);
		const double v = curve_uniform(&s, 0, 1);

		for (int along = 0; along < 2; along++) {
			struct interp_surface_point p;
			struct interp_nurbs_eval e;
			struct interp_nurbs_point q;

			assert_int_equal(interp_surface_iso(&cylinder, along,
					 along ? u : v, &own), 0);
			interp_nurbs_open(&e, &own.c);
			interp_nurbs_at(&e, along ? v : u, 1, &q);
			interp_surface_at(&cylinder, u, v, &p);
			for (int j = 0; j < 3; j++) {
				const double d = along ? p.dv[j] : p.du[j];

				assert_true(fabs(q.d[0][j] - p.at_mm[j]) <
					    1e-12);
				assert_true(fabs(q.d[1][j] - d) < 1e-10);
			}
		}
	}
	own.room = 1;
	assert_int_equal(interp_surface_iso(&cylinder, 0, 0, &own), -ENOSPC);
}

/* -- Rigid bodies --------------------------------------------------------- */

struct body {
	double knots[8], move[16], turn[20];
	struct interp_nurbs m, t;
	struct interp_pose_path path;
};

static void random_body(uint64_t *s, struct body *b)
{
	for (int i = 0; i < 8; i++)
		b->knots[i] = i < 4 ? 0 : 1;
	for (int i = 0; i < 20; i++) {
		b->turn[i] = i % 5 == 4 ? 1 : curve_uniform(s, -1, 1);
		if (i % 5 == 0)
			b->turn[i] += 3;
		if (i < 16)
			b->move[i] = i % 4 == 3 ? 1 :
				     curve_uniform(s, -50, 50);
	}
	b->m = (struct interp_nurbs) { 3, 3, 4, 3, 0, b->knots, b->move };
	b->t = (struct interp_nurbs) { 3, 4, 4, 4, 0, b->knots, b->turn };
	assert_int_equal(interp_pose_open(&b->path, &b->m, &b->t), 0);
}

static double apart(const double a[3], const double b[3])
{
	return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

static void a_body_stays_rigid(void **state)
{
	const double one[3] = { 10, 0, 3 }, other[3] = { -2, 7, 1 };
	uint64_t s = seed;

	(void)state;
	for (int k = 0; k < ROUNDS; k++) {
		struct interp_pose p;
		double a[3], b[3], d[3];
		struct body body;

		random_body(&s, &body);
		assert_int_equal(interp_pose_at(&body.path,
				 curve_uniform(&s, 0, 1), &p), 0);
		interp_pose_apply(&p, one, a, d);
		interp_pose_apply(&p, other, b, d);
		assert_true(fabs(apart(a, b) - apart(one, other)) < 1e-11);
	}
}

static void a_body_moves_as_its_speed_says(void **state)
{
	const double point[3] = { 10, -4, 3 }, h = 1e-5;
	uint64_t s = seed;

	(void)state;
	for (int k = 0; k < ROUNDS; k++) {
		const double u = curve_uniform(&s, 0.1, 0.9);
		double before[3], after[3], at[3], d[3], unused[3];
		struct interp_pose p;
		struct body body;

		random_body(&s, &body);
		interp_pose_at(&body.path, u - h, &p);
		interp_pose_apply(&p, point, before, unused);
		interp_pose_at(&body.path, u + h, &p);
		interp_pose_apply(&p, point, after, unused);
		interp_pose_at(&body.path, u, &p);
		interp_pose_apply(&p, point, at, d);
		for (int i = 0; i < 3; i++)
			assert_true(fabs((after[i] - before[i]) / (2 * h) -
					 d[i]) < 1e-4);
	}
}

static void curves_that_make_no_pair_are_refused(void **state)
{
	uint64_t s = seed;
	struct interp_pose p;
	struct body body;

	(void)state;
	random_body(&s, &body);
	assert_int_equal(interp_pose_open(&body.path, &body.t, &body.m),
			 -EINVAL);
	memset(body.turn, 0, sizeof(body.turn));
	for (int i = 4; i < 20; i += 5)
		body.turn[i] = 1;
	assert_int_equal(interp_pose_open(&body.path, &body.m, &body.t), 0);
	assert_int_equal(interp_pose_at(&body.path, 0.5, &p), -EDOM);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_cylinder_is_round_and_its_offset_too),
		cmocka_unit_test(where_there_is_no_normal_is_no_offset),
		cmocka_unit_test(an_iso_curve_lies_in_the_surface),
		cmocka_unit_test(a_body_stays_rigid),
		cmocka_unit_test(a_body_moves_as_its_speed_says),
		cmocka_unit_test(curves_that_make_no_pair_are_refused),
	};

	seed = seed_take();
	return cmocka_run_group_tests_name("interp/surface", tests, NULL, NULL);
}
