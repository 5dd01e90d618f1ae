/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plan_scene.h - two lumps, a machine that moves one of them, random numbers
 *
 * EDM_SEED repeats a run, EDM_RUNS makes it longer.
 */
#ifndef PLAN_SCENE_H
#define PLAN_SCENE_H

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

static inline double draw(double lo, double hi)
{
	seed = seed * UINT64_C(6364136223846793005) + 1442695040888963407u;
	return lo + (hi - lo) * (double)(seed >> 11) * 0x1p-53;
}

/* -- Bodies --------------------------------------------------------------- */

struct body {
	struct mesh m;
	struct tree t;
};

/* A closed lump: a sphere of @n by 2 @n faces with bumps. */
static inline void make_lump(struct body *b, uint32_t n, double r)
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

static inline void drop(struct body *b)
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

static inline void make_scene(struct scene *s, int i)
{
	struct interp_diag d;

	make_lump(&s->part, 8, 10);
	make_lump(&s->tool, 6, 4);
	s->bodies = (struct bodies) { &s->part.t, &s->tool.t, NULL };
	interp_kin_clear(&s->kin);
	assert_int_equal(interp_kin_parse(&s->kin, chains[i % 5], &d), 0);
	motion_init(&s->motion, &s->kin, &s->tool.m);
}

static inline void drop_scene(struct scene *s)
{
	drop(&s->part);
	drop(&s->tool);
}

static inline void draw_axes(double q[INTERP_NAXES], double turn)
{
	memset(q, 0, INTERP_NAXES * sizeof(*q));
	for (int k = 0; k < 3; k++)
		q[k] = draw(-20, 20);
	for (int k = INTERP_A; k <= INTERP_C; k++)
		q[k] = draw(-turn, turn);
}

static inline double brute(const struct scene *s, const struct pose *pose)
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

static inline double least_sampled(const struct scene *s, const struct block *b,
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

static inline double along(const struct box *b, int axis, const double d[3])
{
	double sum = 0;

	for (int k = 0; k < 3; k++)
		sum += (double)b->axis[k][axis] * d[k];
	return sum;
}

/* Read EDM_SEED and EDM_RUNS. */
static inline void scene_seed(void)
{
	const char *given = getenv("EDM_SEED"), *more = getenv("EDM_RUNS");

	seed = given ? strtoull(given, NULL, 10) : (uint64_t)time(NULL);
	runs = more ? atoi(more) : 1;
	printf("EDM_SEED=%llu\n", (unsigned long long)seed);
}

#endif /* PLAN_SCENE_H */
