/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What tri.h, near.h, motion.h and prove.h of edm-plan promise.
 *
 * EDM_SEED repeats a run, EDM_RUNS makes it longer.
 */
#include "plan_scene.h"
#include "proved.h"

/* -- Triangles ------------------------------------------------------------ */

static void draw_triangle(struct triangle *t, double size)
{
	double at[3] = { draw(-size, size), draw(-size, size),
			 draw(-size, size) };

	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 3; i++)
			t->at[k][i] = at[i] + draw(-1, 1);
	/* Some flat, some without any length. */
	if (draw(0, 1) < 0.1)
		memcpy(t->at[2], t->at[1], sizeof(t->at[2]));
	if (draw(0, 1) < 0.05)
		memcpy(t->at[1], t->at[0], sizeof(t->at[1]));
}

/* Is @p a point of @t?  Its nearest one is, if they are one. */
static double from_triangle(const struct triangle *t, const double p[3])
{
	struct triangle point;
	double a[3], b[3];

	for (int k = 0; k < 3; k++)
		memcpy(point.at[k], p, sizeof(point.at[k]));
	return tri_distance(t, &point, a, b);
}

/* No corner of either is between the planes through @p and @q. */
static void assert_apart(const struct triangle *a, const struct triangle *b,
			 const double p[3], const double q[3])
{
	const double d = v_distance(p, q);
	double n[3];

	v_sub(p, q, n);
	for (int k = 0; k < 3; k++) {
		double to[3];

		v_sub(a->at[k], p, to);
		assert_true(v_dot(to, n) / d > -1e-9);
		v_sub(b->at[k], q, to);
		assert_true(v_dot(to, n) / d < 1e-9);
	}
}

/* Two points at that distance bound it from above, the planes square to the
 * way between them from below. */
static void triangle_distance_is_exact(void **state)
{
	int met = 0;

	(void)state;
	for (int i = 0; i < 5000 * runs; i++) {
		struct triangle a, b;
		double p[3], q[3], d;

		draw_triangle(&a, 1);
		draw_triangle(&b, 1);
		d = tri_distance(&a, &b, p, q);
		assert_true(fabs(v_distance(p, q) - d) < 1e-12);
		assert_true(from_triangle(&a, p) < 1e-9);
		assert_true(from_triangle(&b, q) < 1e-9);
		met += d == 0;
		if (d > 1e-7)
			assert_apart(&a, &b, p, q);
	}
	assert_true(met > 0);
}

static void every_box_holds_its_triangles(void **state)
{
	struct body b;

	(void)state;
	make_lump(&b, 20, 10);
	for (uint32_t i = 0; i < b.t.nnodes; i++) {
		const struct box *x = &b.t.node[i];

		for (uint32_t k = x->first; k < x->first + x->n; k++)
			for (int c = 0; c < 3; c++)
				for (int a = 0; a < 3; a++) {
					double d[3];

					v_sub(b.t.tri[k].at[c], x->centre, d);
					assert_true(fabs(along(x, a, d)) <=
						    (double)x->half[a]);
				}
	}
	drop(&b);
}

static void distance_is_that_of_all_pairs(void **state)
{
	(void)state;
	for (int i = 0; i < 4 * runs; i++) {
		struct near_pair pair = { 0 };
		struct scene s;

		make_scene(&s, i);
		for (int k = 0; k < 4; k++) {
			double q[INTERP_NAXES], d;
			struct pose pose;

			draw_axes(q, 170);
			motion_pose(&s.motion, q, &pose);
			d = near_distance(&s.bodies, &pose, &pair);
			assert_true(fabs(d - brute(&s, &pose)) < 1e-9);
			assert_false(near_below(&s.bodies, &pose, d, &pair));
			assert_true(near_below(&s.bodies, &pose, d + 1e-6,
					       &pair));
		}
		drop_scene(&s);
	}
}

static void pose_is_that_of_the_kinematics(void **state)
{
	(void)state;
	for (int i = 0; i < 50; i++) {
		struct interp_kin_pose want;
		double q[INTERP_NAXES], at[3];
		struct scene s;
		struct pose pose;

		make_scene(&s, i);
		for (int k = 0; k < 3; k++)
			s.kin.tip_mm[k] = draw(-90, 90);
		draw_axes(q, 170);
		motion_pose(&s.motion, q, &pose);
		interp_kin_forward(&s.kin, q, &want);
		rot_apply(&pose.r, s.kin.tip_mm, at);
		v_add(at, pose.t, at);
		assert_true(v_distance(at, want.tip_mm) < 1e-9);
		drop_scene(&s);
	}
}

/* -- Blocks --------------------------------------------------------------- */

/* Of blocks that pass near: proved means no sample is nearer; the proved
 * clearance is within 2 um of the least that samples find, and never more. */
static void what_is_proved_no_pose_breaks(void **state)
{
	int proved = 0, refused = 0;

	(void)state;
	for (int i = 0; i < 16 * runs; i++) {
		double from[INTERP_NAXES], to[INTERP_NAXES], least, keep;
		struct proof p = { 0 };
		struct clearance c;
		struct scene s;
		struct block b;

		make_scene(&s, i);
		draw_axes(from, 60);
		draw_axes(to, 60);
		block_init(&b, &s.motion, from, to);
		least = least_sampled(&s, &b, 150);
		keep = prove_least(&s.bodies, &b, PROVE_FINE_MM, &p);
		assert_true(keep <= least);
		if (p.least_mm > 0.003) {
			struct near_pair pair = { 0 };
			struct pose pose;

			block_pose(&b, p.t, &pose, NULL);
			assert_true(fabs(near_distance(&s.bodies, &pose,
						&pair) - p.least_mm) < 1e-9);
			assert_true(keep >= fmin(p.least_mm, 100) - 0.002);
		}
		clearance_init(&c, 0.5);
		if (prove_block(&s.bodies, &b, &c, &p)) {
			assert_true(least >= 0.5);
			proved++;
		} else {
			assert_true(p.pair.mm < 0.502);
			assert_true(keep < 0.502);
			refused++;
		}
		drop_scene(&s);
	}
	assert_true(proved > 0 && refused > 0);
}

/* More is asked for than the end pose has, but not there. */
static void a_clearance_that_falls_is_kept(void **state)
{
	int proved = 0, by_fall = 0;

	(void)state;
	for (int i = 0; i < 40 * runs; i++) {
		double from[INTERP_NAXES], to[INTERP_NAXES], end;
		struct near_pair pair = { 0 };
		struct proof p = { 0 };
		struct clearance c, whole;
		struct scene s;
		struct pose pose;
		struct block b;
		bool ok;

		make_scene(&s, i);
		draw_axes(from, 60);
		draw_axes(to, 60);
		for (int k = 0; k < INTERP_NAXES; k++)
			from[k] = to[k] + (from[k] - to[k]) * 0.15;
		motion_pose(&s.motion, to, &pose);
		end = near_distance(&s.bodies, &pose, &pair);
		clearance_init(&c, 1.05 * end);
		whole = c;
		clearance_end(&c, &s.tool.m, &pose, 5, 0.5 * end);
		block_init(&b, &s.motion, from, to);
		ok = end > 0.1 && prove_block(&s.bodies, &b, &c, &p);
		for (int k = 0; k <= 60 && ok; k++) {
			block_pose(&b, k / 60.0, &pose, NULL);
			assert_true(near_distance(&s.bodies, &pose, &pair) >=
				    clearance_at(&c, &pose));
		}
		proved += ok;
		by_fall += ok && !prove_block(&s.bodies, &b, &whole, &p);
		drop_scene(&s);
	}
	assert_true(proved > 0 && by_fall > 0);
}

static void what_a_pose_refutes_is_not_proved(void **state)
{
	int refuted = 0;

	(void)state;
	for (int i = 0; i < 16 * runs; i++) {
		double from[INTERP_NAXES], to[INTERP_NAXES];
		struct proof p = { 0 };
		struct clearance c;
		struct scene s;
		struct block b;

		make_scene(&s, i);
		draw_axes(from, 60);
		draw_axes(to, 60);
		block_init(&b, &s.motion, from, to);
		clearance_init(&c, 0.5);
		if (prove_refuted(&s.bodies, &b, &c, &p)) {
			assert_false(prove_block(&s.bodies, &b, &c, &p));
			refuted++;
		}
		drop_scene(&s);
	}
	assert_true(refuted > 0);
}

/* A plate of 0.02 mm, passed in a block of 40 mm: 64 poses are 0.6 mm apart. */
static void a_thin_wall_between_samples_is_met(void **state)
{
	static double wall[4][3] = { { 0.31, -9, -9 }, { 0.31, 9, -9 },
				     { 0.31, 9, 9 }, { 0.31, -9, 9 } };
	static uint32_t tris[2][3] = { { 0, 1, 2 }, { 0, 2, 3 } };
	static double needle[3][3] = { { 0, 0, 0 }, { 0, 0.1, 0 },
				       { 0, 0, 0.1 } };
	static uint32_t one[1][3] = { { 0, 1, 2 } };
	struct scene s = {
		.part.m = { .nverts = 4, .ntris = 2, .vert = wall,
			    .tri = tris },
		.tool.m = { .nverts = 3, .ntris = 1, .vert = needle,
			    .tri = one },
	};
	const double from[INTERP_NAXES] = { -20 }, to[INTERP_NAXES] = { 20 };
	struct proof p = { 0 };
	struct clearance c;
	struct block b;

	(void)state;
	tree_build(&s.part.t, &s.part.m);
	tree_build(&s.tool.t, &s.tool.m);
	mesh_bounds(&s.tool.m);
	s.bodies = (struct bodies) { &s.part.t, &s.tool.t, NULL };
	interp_kin_clear(&s.kin);
	motion_init(&s.motion, &s.kin, &s.tool.m);
	block_init(&b, &s.motion, from, to);
	clearance_init(&c, 0.01);
	assert_true(least_sampled(&s, &b, 64) > 0.1);
	assert_false(prove_block(&s.bodies, &b, &c, &p));
	assert_true(fabs(p.t - (20.31 - 0.012) / 40) < 1e-4);
	assert_true(prove_least(&s.bodies, &b, PROVE_FINE_MM, &p) < 0);
	tree_free(&s.part.t);
	tree_free(&s.tool.t);
}

/* What is known of a block holds for it alone, and no more than it keeps. */
static void a_block_is_proved_once(void **state)
{
	static struct proved known;
	double to[INTERP_NAXES] = { 0, 0, 300 };
	const double from[INTERP_NAXES] = { 0, 0, 200 };
	struct scene s;
	struct proof p = { 0 };
	struct clearance c;
	struct block b, other;
	uint64_t poses;

	(void)state;
	make_scene(&s, 4);
	proved_init(&known);
	s.bodies.proved = &known;
	block_init(&b, &s.motion, from, to);
	clearance_init(&c, 1);
	assert_true(prove_block(&s.bodies, &b, &c, &p));
	poses = p.queries;
	assert_true(poses > 0);
	assert_true(prove_block(&s.bodies, &b, &c, &p));
	clearance_init(&c, 0.5);
	assert_true(prove_block(&s.bodies, &b, &c, &p));
	assert_int_equal(p.queries, poses);
	assert_false(proved_keeps(&known, &b, 1.5));
	to[0] = 0.001;
	block_init(&other, &s.motion, from, to);
	assert_false(proved_keeps(&known, &other, 0.5));
	for (int i = 0; i < PROVED_MAX; i++)
		proved_put(&known, &other, 2);
	assert_true(proved_keeps(&known, &other, 2));
	assert_false(proved_keeps(&known, &b, 0.5));
	drop_scene(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(triangle_distance_is_exact),
		cmocka_unit_test(every_box_holds_its_triangles),
		cmocka_unit_test(distance_is_that_of_all_pairs),
		cmocka_unit_test(pose_is_that_of_the_kinematics),
		cmocka_unit_test(what_is_proved_no_pose_breaks),
		cmocka_unit_test(a_clearance_that_falls_is_kept),
		cmocka_unit_test(what_a_pose_refutes_is_not_proved),
		cmocka_unit_test(a_thin_wall_between_samples_is_met),
		cmocka_unit_test(a_block_is_proved_once),
	};

	scene_seed();
	return cmocka_run_group_tests_name("plan/core", tests, NULL, NULL);
}
