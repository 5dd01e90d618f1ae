/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What tri.h, near.h, motion.h and prove.h of edm-plan promise.
 *
 * EDM_SEED repeats a run, EDM_RUNS makes it longer.
 */
#include "prove.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

static uint64_t seed;
static int runs = 1;

static double draw(double lo, double hi)
{
	seed = seed * UINT64_C(6364136223846793005) + 1442695040888963407u;
	return lo + (hi - lo) * (double)(seed >> 11) * 0x1p-53;
}

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

/* -- Bodies --------------------------------------------------------------- */

struct body {
	struct mesh m;
	struct tree t;
};

/* A closed lump: a sphere of @n by 2 @n faces with bumps. */
static void make_lump(struct body *b, uint32_t n, double r)
{
	const uint32_t around = 2 * n;
	const double bump = draw(0, 0.3), k = draw(2, 6), f = draw(0, 6);

	b->m = (struct mesh) { .name = "lump" };
	b->m.vert = malloc((n + 1) * around * sizeof(*b->m.vert));
	b->m.tri = malloc(2 * n * around * sizeof(*b->m.tri));
	for (uint32_t i = 0; i <= n; i++) {
		for (uint32_t j = 0; j < around; j++) {
			const double a = M_PI * i / n;
			const double c = 6.28318530717959 * j / around;
			const double s = r * (1 + bump * sin(k * a) *
					      cos(3 * c + f));
			double *v = b->m.vert[b->m.nverts++];

			v[0] = s * sin(a) * cos(c);
			v[1] = s * sin(a) * sin(c);
			v[2] = s * cos(a);
		}
	}
	for (uint32_t i = 0; i < n; i++) {
		for (uint32_t j = 0; j < around; j++) {
			const uint32_t p = i * around + j;
			const uint32_t q = i * around + (j + 1) % around;
			const uint32_t tri[2][3] = {
				{ p, p + around, q },
				{ q, p + around, q + around },
			};

			memcpy(b->m.tri[b->m.ntris], tri, sizeof(tri));
			b->m.ntris += 2;
		}
	}
	mesh_bounds(&b->m);
	assert_int_equal(tree_build(&b->t, &b->m), 0);
}

static void drop(struct body *b)
{
	tree_free(&b->t);
	mesh_free(&b->m);
}

struct scene {
	struct body part, tool;
	struct bodies bodies;
	struct interp_kinematics kin;
	struct machine_motion motion;
};

static const char *const chains[] = {
	"A(0 0 -60) B(0 0 -60) X Y Z C",
	"X Y Z C(0 0 3) A(0.5 0 210)",
	"C(4 5 -60) X Y Z B(0 0 180)",
	"B(0 0 0 / 0 0.70710678 0.70710678) C(0 0 -50) Y X Z",
	"X Y Z C",
};

static void make_scene(struct scene *s, int i)
{
	struct interp_diag d;

	make_lump(&s->part, 8, 10);
	make_lump(&s->tool, 6, 4);
	s->bodies = (struct bodies) { &s->part.t, &s->tool.t };
	interp_kin_clear(&s->kin);
	assert_int_equal(interp_kin_parse(&s->kin, chains[i % 5], &d), 0);
	motion_init(&s->motion, &s->kin, &s->tool.m);
}

static void drop_scene(struct scene *s)
{
	drop(&s->part);
	drop(&s->tool);
}

static void draw_axes(double q[INTERP_NAXES], double turn)
{
	memset(q, 0, INTERP_NAXES * sizeof(*q));
	for (int k = 0; k < 3; k++)
		q[k] = draw(-20, 20);
	for (int k = INTERP_A; k <= INTERP_C; k++)
		q[k] = draw(-turn, turn);
}

static double brute(const struct scene *s, const struct pose *pose)
{
	double least = DBL_MAX;

	for (uint32_t j = 0; j < s->tool.t.ntris; j++) {
		struct triangle at;

		for (int k = 0; k < 3; k++) {
			rot_apply(&pose->r, s->tool.t.tri[j].at[k], at.at[k]);
			v_add(at.at[k], pose->t, at.at[k]);
		}
		for (uint32_t i = 0; i < s->part.t.ntris; i++) {
			double p[3], q[3];

			least = fmin(least, tri_distance(&s->part.t.tri[i],
							 &at, p, q));
		}
	}
	return least;
}

static double along(const struct box *b, int axis, const double d[3])
{
	double sum = 0;

	for (int k = 0; k < 3; k++)
		sum += (double)b->axis[k][axis] * d[k];
	return sum;
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

static double least_sampled(const struct scene *s, const struct block *b,
			    int n)
{
	struct near_pair pair = { 0 };
	double least = DBL_MAX;

	for (int i = 0; i <= n; i++) {
		struct pose pose;

		block_pose(b, (double)i / n, &pose, NULL);
		least = fmin(least, near_distance(&s->bodies, &pose, &pair));
	}
	return least;
}

/* The bounds of the points' ways, against small differences. */
static void no_point_moves_more_than_bounded(void **state)
{
	const double h = 1e-4;

	(void)state;
	for (int i = 0; i < 15 * runs; i++) {
		double from[INTERP_NAXES], to[INTERP_NAXES];
		struct pose pose[3];
		struct pose_rate rate;
		struct scene s;
		struct block b;

		make_scene(&s, i);
		draw_axes(from, 100);
		draw_axes(to, 100);
		block_init(&b, &s.motion, from, to);
		for (int k = 0; k < 20; k++) {
			const double t = draw(h, 1 - h);
			const double *v = s.tool.m.vert[k * 5 %
						       (int)s.tool.m.nverts];
			double at[3][3], bend[3], go[3], x[3];

			for (int n = 0; n < 3; n++) {
				block_pose(&b, t + (n - 1) * h, &pose[n],
					   n == 1 ? &rate : NULL);
				rot_apply(&pose[n].r, v, at[n]);
				v_add(at[n], pose[n].t, at[n]);
			}
			v_cross(rate.w, at[1], x);
			for (int n = 0; n < 3; n++) {
				bend[n] = (at[2][n] - 2 * at[1][n] + at[0][n]) /
					  h / h;
				go[n] = (at[2][n] - at[0][n]) / 2 / h;
				assert_true(fabs(go[n] - rate.v[n] - x[n]) <
					    1e-3);
			}
			assert_true(v_length(bend) <= b.accel_mm + 1e-3);
			assert_true(v_length(go) <= b.way_mm + 1e-6);
		}
		drop_scene(&s);
	}
}

/* A point of the box, often on its faces, edges and corners. */
static void draw_in(const struct box *b, double ret[3])
{
	for (int k = 0; k < 3; k++)
		ret[k] = b->centre[k];
	for (int i = 0; i < 3; i++) {
		const double s = (double)b->half[i] * fmin(fmax(draw(-2, 2),
								-1), 1);

		for (int k = 0; k < 3; k++)
			ret[k] += s * (double)b->axis[k][i];
	}
}

/* Far from the origin as well, where single precision has little left. */
static void boxes_stay_apart_as_long_as_they_say(void **state)
{
	int apart = 0, held = 0;

	(void)state;
	for (int i = 0; i < 40 * runs; i++) {
		const double far = i % 2 ? 0 : 4e4;
		double from[INTERP_NAXES], to[INTERP_NAXES];
		struct box_keep keep = { .mm = 0.3f, .enough = 1 };
		struct box_placed now;
		struct box_pose at;
		struct pose_rate rate;
		struct pose pose;
		struct scene s;
		struct block b;
		float x;

		make_scene(&s, i);
		draw_axes(from, 100);
		draw_axes(to, 100);
		from[INTERP_X] += far;
		to[INTERP_X] += far;
		block_init(&b, &s.motion, from, to);
		block_pose(&b, 0, &pose, &rate);
		near_pose(&pose, &rate, &at);
		keep.accel = (float)b.accel_mm;
		for (int k = 0; k < 60; k++) {
			struct box part = s.part.t.node[k];
			const struct box *tool = &s.tool.t.node[k * 7 % 60];
			double d;

			part.centre[0] += far;
			box_move(tool, &at, &now);
			d = (double)box_distance(&part, &now.at);
			x = box_time(&part, &now, &keep);
			apart += d > 0;
			held += x > 0;
			for (int n = 0; n < 30; n++) {
				double p[3], q[3], moved[3];
				struct pose then;

				draw_in(&part, p);
				draw_in(tool, q);
				rot_apply(&pose.r, q, moved);
				v_add(moved, pose.t, moved);
				assert_true(v_distance(p, moved) >= d);
				block_pose(&b, (double)x * draw(0, 1), &then,
					   NULL);
				rot_apply(&then.r, q, moved);
				v_add(moved, then.t, moved);
				assert_true(x <= 0 ||
					    v_distance(p, moved) >= 0.3);
			}
		}
		drop_scene(&s);
	}
	assert_true(apart > 500 && held > 500);
}

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
		keep = prove_least(&s.bodies, &b, &p);
		assert_true(keep <= least);
		if (p.least_mm > 0.003) {
			struct near_pair pair = { 0 };
			struct pose pose;

			block_pose(&b, p.t, &pose, NULL);
			assert_true(fabs(near_distance(&s.bodies, &pose,
						&pair) - p.least_mm) < 1e-9);
			assert_true(keep >= p.least_mm - 0.002);
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
	s.bodies = (struct bodies) { &s.part.t, &s.tool.t };
	interp_kin_clear(&s.kin);
	motion_init(&s.motion, &s.kin, &s.tool.m);
	block_init(&b, &s.motion, from, to);
	clearance_init(&c, 0.01);
	assert_true(least_sampled(&s, &b, 64) > 0.1);
	assert_false(prove_block(&s.bodies, &b, &c, &p));
	assert_true(fabs(p.t - (20.31 - 0.012) / 40) < 1e-4);
	assert_true(prove_least(&s.bodies, &b, &p) < 0);
	tree_free(&s.part.t);
	tree_free(&s.tool.t);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(triangle_distance_is_exact),
		cmocka_unit_test(every_box_holds_its_triangles),
		cmocka_unit_test(distance_is_that_of_all_pairs),
		cmocka_unit_test(pose_is_that_of_the_kinematics),
		cmocka_unit_test(no_point_moves_more_than_bounded),
		cmocka_unit_test(boxes_stay_apart_as_long_as_they_say),
		cmocka_unit_test(what_is_proved_no_pose_breaks),
		cmocka_unit_test(a_clearance_that_falls_is_kept),
		cmocka_unit_test(what_a_pose_refutes_is_not_proved),
		cmocka_unit_test(a_thin_wall_between_samples_is_met),
	};
	const char *given = getenv("EDM_SEED"), *more = getenv("EDM_RUNS");

	seed = given ? strtoull(given, NULL, 10) : (uint64_t)time(NULL);
	runs = more ? atoi(more) : 1;
	printf("EDM_SEED=%llu\n", (unsigned long long)seed);
	return cmocka_run_group_tests_name("plan/core", tests, NULL, NULL);
}
