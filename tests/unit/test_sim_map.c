/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_sim_map.c - the ground an electrode has been over: volumes of cuts are
 * those of solid geometry, and no ground is removed twice
 */
#include "sim_map.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>

#define AREA	19.635			/* 5 mm round */

static void near(double got, double wanted, double by)
{
	if (!(fabs(got - wanted) <= by))
		print_error("%g is not within %g of %g\n", got, by, wanted);
	assert_true(fabs(got - wanted) <= by);
}

static struct sim_map *fresh_map(double area_mm2, unsigned int across)
{
	struct sim_map *m = calloc(1, sizeof(*m));

	assert_non_null(m);
	sim_map_init(m, area_mm2, across);
	return m;
}

/* Cut straight to @to in steps.  Return: the volume by the whole area. */
static double cut_to(struct sim_map *m, const double to[3])
{
	const double from[3] = { m->at_mm[0], m->at_mm[1], m->at_mm[2] };
	const double way = hypot(hypot(to[0] - from[0], to[1] - from[1]),
				 to[2] - from[2]);
	const double n = ceil(way / sim_map_step_mm(m));
	double sum = 0;

	for (double k = 1; k <= n; k++) {
		double at[3];

		for (int i = 0; i < 3; i++)
			at[i] = from[i] + (to[i] - from[i]) * k / n;
		sum += sim_map_cut(m, at) * way / n;
	}
	return sum;
}

/* A turn of radius @r about 0 0, going down by @down from @z. */
static double turn(struct sim_map *m, double r, double z, double down)
{
	double sum = 0;

	for (int i = 1; i <= 360; i++)
		sum += cut_to(m, (double[]) { r * cos(i * M_PI / 180),
					      r * sin(i * M_PI / 180),
					      z - down * i / 360 });
	return sum;
}

static void put(struct sim_map *m, double x, double y, double z)
{
	sim_map_lift(m);
	sim_map_cut(m, (double[]) { x, y, z });
}

static void fresh_ground_meets_the_whole_area_whichever_way(void **st)
{
	const double to[][3] = {
		{ 0, 0, -1 }, { 3, 0, 0 },  { 0, -3, 0 },
		{ 2, 1, 0 },  { 1, 1, -1 }, { -1, 0.1, -0.01 }
	};

	(void)st;
	for (size_t i = 0; i < sizeof(to) / sizeof(to[0]); i++) {
		struct sim_map *m = fresh_map(AREA, 64);

		put(m, 0, 0, 0);
		near(cut_to(m, to[i]) / hypot(hypot(to[i][0], to[i][1]),
					      to[i][2]), 1, 0.03);
		free(m);
	}
}

static void ground_is_removed_once(void **st)
{
	struct sim_map *m = fresh_map(AREA, 64);

	(void)st;
	put(m, 0, 0, 0);
	cut_to(m, (double[]) { 0, 0, -1 });
	cut_to(m, (double[]) { 0.2, 0, -1 });
	assert_true(turn(m, 0.2, -1, 0) > 0.3);
	for (int i = 0; i < 3; i++)
		near(turn(m, 0.2, -1, 0), 0, 0.03);
	/* Up, and down again through free space. */
	put(m, 0.2, 0, -0.5);
	near(cut_to(m, (double[]) { 0.2, 0, -1 }), 0, 1e-6);
	free(m);
}

/* Wherever it began in free space, it removes what is solid. */
static void a_way_down_through_free_space_takes_nothing_from_the_rest(
	void **st)
{
	(void)st;
	for (double above = 0; above < 0.5; above += 0.03) {
		struct sim_map *m = fresh_map(AREA, 64);

		put(m, 0, 0, 0);
		cut_to(m, (double[]) { 0, 0, -1 });
		put(m, 0, 0, -1 + above);
		near(cut_to(m, (double[]) { 0, 0, -2 }), 1, 0.01);
		free(m);
	}
}

/* Helix of many turns: its volume is that of the hole it leaves. */
static void a_helix_removes_the_hole_it_leaves(void **st)
{
	struct sim_map *m = fresh_map(AREA, 64);
	double sum = 0;
	int turns = 0;

	(void)st;
	put(m, 0.2, 0, 0);
	turn(m, 0.2, 0, 0);			/* round the edge first */
	for (double z = 0; z > -1 + 1e-9; z -= 0.05, turns++)
		sum += turn(m, 0.2, z, 0.05);
	sum += turn(m, 0.2, -1, 0);
	assert_int_equal(turns, 20);
	near(sum * AREA / (M_PI * 2.7 * 2.7), 1, 0.05);
	free(m);
}

/* A second pass beside the first one removes the strip between them. */
static void a_wire_removes_the_strip_that_is_left(void **st)
{
	struct sim_map *m = fresh_map(M_PI / 4 * 0.3 * 0.3, 8);

	(void)st;
	put(m, 0, 0, 0);
	near(cut_to(m, (double[]) { 20, 0, 0 }) / 20, 1, 0.03);
	put(m, 0, 0.1, 0);
	near(cut_to(m, (double[]) { 20, 0.1, 0 }) / 20, 0.1 / 0.3, 0.1);
	put(m, 0, 0.05, 0);
	near(cut_to(m, (double[]) { 20, 0.05, 0 }), 0, 0.02);
	free(m);
}

static void another_ground_is_fresh(void **st)
{
	struct sim_map *m = fresh_map(AREA, 64);

	(void)st;
	for (int i = 0; i < 3; i++) {
		sim_map_clear(m);
		put(m, 0, 0, 0);
		near(cut_to(m, (double[]) { 3, 0, 0 }) / 3, 1, 0.03);
	}
	free(m);
}

/* Old ground is given up when the blocks are spent, never invented. */
/* Each turn of a rotary axis is another ground. */
static void a_ground_does_not_come_back(void **st)
{
	(void)st;
	for (int more = -1; more <= 1; more++) {
		struct sim_map *m = fresh_map(AREA, 64);
		double first;

		put(m, 0, 0, 0);
		first = cut_to(m, (double[]) { 0, 0, -1 });
		for (int i = 0; i < SIM_MAP_GROUNDS + more; i++)
			sim_map_clear(m);
		put(m, 0, 0, 0);
		near(cut_to(m, (double[]) { 0, 0, -1 }), first, 1e-9);
		free(m);
	}
}

static void a_plane_without_end_fits_into_few_blocks(void **st)
{
	struct sim_map *m = fresh_map(AREA, 64);

	(void)st;
	put(m, -1000, -1000, 0);
	for (int i = 1; i < 50; i++)
		assert_true(cut_to(m, (double[]) { -1000 + 40 * i, i % 2 * 60 -
						   1000, 0 }) > 20);
	near(cut_to(m, m->at_mm), 0, 1e-9);
	free(m);
}

static void no_place_is_too_far(void **st)
{
	const double far[] = { 0, -0.0, 1e-9, 1e3, -1e3, 1e6, -1e6 };
	struct sim_map *m = fresh_map(AREA, 64);

	(void)st;
	for (int i = 0; i < 343; i++) {
		const double share = sim_map_cut(m, (double[]) {
			far[i % 7], far[i / 7 % 7], far[i / 49] });

		assert_true(share >= 0 && share <= 1);
	}
	free(m);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(fresh_ground_meets_the_whole_area_whichever_way),
		cmocka_unit_test(ground_is_removed_once),
		cmocka_unit_test(
		a_way_down_through_free_space_takes_nothing_from_the_rest),
		cmocka_unit_test(a_helix_removes_the_hole_it_leaves),
		cmocka_unit_test(a_wire_removes_the_strip_that_is_left),
		cmocka_unit_test(another_ground_is_fresh),
		cmocka_unit_test(a_ground_does_not_come_back),
		cmocka_unit_test(a_plane_without_end_fits_into_few_blocks),
		cmocka_unit_test(no_place_is_too_far),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
