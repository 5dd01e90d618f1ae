/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_plan_near.c - the sets of near pairs that edm-plan moves nodes with, and
 * distances that are asked for only if they are small
 *
 * EDM_SEED repeats a run, EDM_RUNS makes it longer.
 */
#include "near_set.h"
#include "plan_scene.h"
#include "spread.h"

#include <stdatomic.h>

/* A pose at which the lumps are apart; how far. */
static double draw_apart(const struct scene *s, struct pose *pose)
{
	double q[INTERP_NAXES], mm = 0;

	while (!(mm > 0.01)) {
		draw_axes(q, 60);
		motion_pose(&s->motion, q, pose);
		mm = brute(s, pose);
	}
	return mm;
}

static void a_distance_is_told_if_it_is_less(void **state)
{
	(void)state;
	for (int i = 0; i < 20 * runs; i++) {
		struct near_pair pair = { 0 }, was;
		struct pose pose;
		struct scene s;
		double mm;

		make_scene(&s, i);
		mm = draw_apart(&s, &pose);
		was = pair;
		assert_false(near_less(&s.bodies, &pose, mm - 1e-9, &pair));
		assert_memory_equal(&pair, &was, sizeof(pair));
		assert_true(near_less(&s.bodies, &pose,
				      mm + NEAR_SLACK_MM + 1e-6, &pair));
		assert_true(pair.mm >= mm - 1e-9 &&
			    pair.mm <= mm + NEAR_SLACK_MM + 1e-9);
		drop_scene(&s);
	}
}

/* Is there one in the set that stands for the pair @p @q? */
static bool stood_for(const struct near_set *set, double mm, const double p[3],
		      const double q[3])
{
	double n[3], m[3];

	v_sub(q, p, n);
	for (uint32_t i = 0; i < set->n; i++) {
		const struct near_pair *x = &set->pair[i];

		v_sub(x->q, x->p, m);
		if (x->mm <= mm + NEAR_SET_SLACK_MM + 1e-9 &&
		    v_distance(x->q, q) < 20)
			return true;
	}
	return false;
}

static void check_all(const struct scene *s, const struct pose *pose, double mm,
		      const struct near_set *set)
{
	const struct tree *t = &s->part.t;

	for (uint32_t j = 0; j < s->tool.t.ntris; j++) {
		struct triangle at;

		near_tri(&s->bodies, pose, j, &at);
		for (uint32_t i = 0; i < t->ntris; i++) {
			double p[3], q[3];
			const double d = tri_distance(&t->tri[i], &at, p, q);

			if (d < mm - NEAR_SET_SLACK_MM)
				assert_true(stood_for(set, d, p, q));
		}
	}
}

static void a_set_stands_for_all_that_are_near(void **state)
{
	static struct near_set set = { .max = NEAR_SET_MAX };

	(void)state;
	for (int i = 0; i < 20 * runs; i++) {
		double least = DBL_MAX, mm;
		struct pose pose;
		struct scene s;

		make_scene(&s, i);
		mm = draw_apart(&s, &pose);
		near_set_collect(&s.bodies, &pose, mm + 3, &set);
		assert_true(set.n > 0);
		for (uint32_t k = 0; k < set.n; k++) {
			const struct near_pair *x = &set.pair[k];

			assert_true(fabs(v_distance(x->p, x->q) - x->mm) <
				    1e-9);
			assert_true(x->mm >= mm - 1e-9 && x->mm < mm + 3);
			least = fmin(least, x->mm);
		}
		assert_true(least <= mm + NEAR_SET_SLACK_MM + 1e-9);
		if (set.n < set.max)
			check_all(&s, &pose, mm + 3, &set);
		drop_scene(&s);
	}
}

static void a_small_set_has_the_nearest(void **state)
{
	(void)state;
	for (int i = 0; i < 20 * runs; i++) {
		struct near_set set = { .max = 1 + (uint32_t)draw(0, 4) };
		double mm, least = DBL_MAX;
		struct pose pose;
		struct scene s;

		make_scene(&s, i);
		mm = draw_apart(&s, &pose);
		near_set_collect(&s.bodies, &pose, mm + 5, &set);
		assert_true(set.n <= set.max);
		for (uint32_t k = 0; k < set.n; k++)
			least = fmin(least, set.pair[k].mm);
		assert_true(least <= mm + NEAR_SET_SLACK_MM + 1e-9);
		drop_scene(&s);
	}
}

/* -- Many at once --------------------------------------------------------- */

#define MANY	1000

struct asked {
	atomic_int times[MANY];
	uint32_t from, step;		/* true for those */
};

static bool ask(void *arg, uint32_t i)
{
	struct asked *a = arg;

	atomic_fetch_add(&a->times[i], 1);
	return i >= a->from && (i - a->from) % a->step == 0;
}

static void the_first_answer_is_that_of_a_loop(void **state)
{
	(void)state;
	for (int run = 0; run < 200 * runs; run++) {
		const uint32_t n = (uint32_t)draw(0, MANY);
		struct asked a = { .from = (uint32_t)draw(0, 1.5 * n),
				   .step = 1 + (uint32_t)draw(0, 5) };
		const uint32_t first = spread_first(n, ask, &a);

		assert_int_equal(first, a.from < n ? a.from : n);
		for (uint32_t i = 0; i < n; i++)
			assert_true(atomic_load(&a.times[i]) <= 1 &&
				    (i > first || i == n ||
				     atomic_load(&a.times[i]) == 1));
	}
}

/* -- Boxes ---------------------------------------------------------------- */

#define CELLS	8u		/* of a wall, each way; two triangles each */

/* A wall of a block, of right triangles with legs of 1 and 2 mm. */
static void put_wall(struct mesh *m, const struct rot *turn, uint32_t wall)
{
	static const uint32_t corner[2][3] = { { 0, 1, 3 }, { 0, 3, 2 } };
	const int k = (int)wall / 2, i = (k + 1) % 3, j = (k + 2) % 3;

	for (uint32_t c = 0; c < CELLS * CELLS; c++) {
		for (uint32_t v = 0; v < 4; v++) {
			double at[3];

			at[k] = wall % 2 * 8.0;
			at[i] = c % CELLS + v % 2;
			at[j] = 2.0 * (c / CELLS + v / 2);
			rot_apply(turn, at, m->vert[m->nverts + v]);
		}
		for (uint32_t t = 0; t < 2; t++, m->ntris++)
			for (int v = 0; v < 3; v++)
				m->tri[m->ntris][v] = m->nverts + corner[t][v];
		m->nverts += 4;
	}
}

static void boxes_lie_in_their_walls_up_to_the_rim(void **state)
{
	const double u[3] = { 0.48, 0.6, 0.64 };
	uint32_t thick = 0;
	struct body b;

	(void)state;
	b.m = (struct mesh) { .name = "walls" };
	b.m.vert = malloc(6 * 4 * CELLS * CELLS * sizeof(*b.m.vert));
	b.m.tri = malloc(6 * 2 * CELLS * CELLS * sizeof(*b.m.tri));
	for (uint32_t wall = 0; wall < 6; wall++) {
		const struct rot turn = rot_about(u, 0.7);

		put_wall(&b.m, &turn, wall);
	}
	mesh_bounds(&b.m);
	assert_int_equal(tree_build(&b.t, &b.m), 0);
	for (uint32_t i = 0; i < b.t.nnodes; i++) {
		const struct box *x = &b.t.node[i];
		const float least = fminf(x->half[0],
					  fminf(x->half[1], x->half[2]));

		if (x->n)
			assert_true(x->half[3] < 1.501f);
		thick += least > 1e-3f;
	}
	/* One for each cut between walls, where no cut goes across them. */
	assert_true(thick < 10);
	drop(&b);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_distance_is_told_if_it_is_less),
		cmocka_unit_test(a_set_stands_for_all_that_are_near),
		cmocka_unit_test(a_small_set_has_the_nearest),
		cmocka_unit_test(the_first_answer_is_that_of_a_loop),
		cmocka_unit_test(boxes_lie_in_their_walls_up_to_the_rim),
	};

	scene_seed();
	return cmocka_run_group_tests_name("plan/near", tests, NULL, NULL);
}
