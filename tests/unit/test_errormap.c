/* SPDX-License-Identifier: Apache-2.0 */
/* test_errormap.c - promises of the maps of geometric errors */
#include "contour_help.h"

#include "interp/errormap.h"

#include <errno.h>

static struct interp_errormap map;

static int setup(void **state)
{
	(void)state;
	map = (struct interp_errormap) { .nrows = 2, .nleans = 1 };
	for (int r = 0; r < 2; r++) {
		map.row[r] = (struct interp_errormap_row) {
			.along = 0, .across = (uint8_t)r, .n = 21,
		};
		for (int i = 0; i < 21; i++) {
			map.row[r].at_mm[i] = -100 + i * 10;
			map.row[r].error_mm[i] = 0.02 * sin(i * (1 + r));
		}
	}
	map.lean[0] = (struct interp_errormap_lean) { 2, 0, 300e-6 };
	map.growth[1] = (struct interp_errormap_growth) { 11.5e-6, 50, 4 };
	return interp_errormap_check(&map);
}

static void errors_add_up(void **state)
{
	const double at[INTERP_NAXES] = { -85, 20, 30 };
	double e[INTERP_NAXES];

	(void)state;
	interp_errormap_error(&map, at, e);
	assert_near(e[0], 0.02 * (sin(1) + sin(2)) / 2 + 30 * 300e-6,
			   1e-12);
	assert_near(e[1], 0.02 * (sin(2) + sin(4)) / 2 -
			   30 * 11.5e-6 * 4, 1e-12);
	assert_near(e[2], 0, 1e-15);
}

static void rows_end_flat(void **state)
{
	double at[INTERP_NAXES] = { 100 }, e[INTERP_NAXES], f[INTERP_NAXES];

	(void)state;
	interp_errormap_error(&map, at, e);
	at[0] = 1e6;
	interp_errormap_error(&map, at, f);
	assert_near(e[0], 0.02 * sin(20), 1e-12);
	assert_near(f[0], e[0], 1e-15);
	at[0] = -1e6;
	interp_errormap_error(&map, at, f);
	assert_near(f[0], 0, 1e-15);
}

static void corrected_machine_stands_where_it_should(void **state)
{
	(void)state;
	for (int i = 0; i < 4000; i++) {
		const double at[INTERP_NAXES] = {
			-110 + i * 0.055, 90 * sin(i), 70 * cos(3 * i)
		};
		double add[INTERP_NAXES], told[INTERP_NAXES];
		double e[INTERP_NAXES];

		interp_errormap_apply(&map, at, add);
		for (int k = 0; k < INTERP_NAXES; k++)
			told[k] = at[k] + add[k];
		interp_errormap_error(&map, told, e);
		for (int k = 0; k < INTERP_NAXES; k++)
			assert_near(told[k] + e[k], at[k], 1e-8);
	}
}

static void way_back_undoes_the_way_there_to_the_bit(void **state)
{
	double there[500][INTERP_NAXES];

	(void)state;
	for (int i = 0; i < 500; i++)
		interp_errormap_apply(&map, (double[INTERP_NAXES]) {
			i * 0.2 - 50, i * 0.1, 3 }, there[i]);
	for (int i = 499; i >= 0; i--) {
		double back[INTERP_NAXES];

		interp_errormap_apply(&map, (double[INTERP_NAXES]) {
			i * 0.2 - 50, i * 0.1, 3 }, back);
		assert_memory_equal(back, there[i], sizeof(back));
	}
}

static void what_is_no_machine_is_refused(void **state)
{
	struct interp_errormap bad = map;

	(void)state;
	bad.row[0].error_mm[4] += 0.2;		/* too steep to be undone */
	assert_int_equal(interp_errormap_check(&bad), -EINVAL);
	bad = map;
	bad.row[1].error_mm[20] = NAN;
	assert_int_equal(interp_errormap_check(&bad), -EINVAL);
	bad = map;
	bad.row[1].n = INTERP_ERRORMAP_POINTS + 1;
	assert_int_equal(interp_errormap_check(&bad), -EINVAL);
	bad = map;
	bad.row[1].across = INTERP_NAXES;
	assert_int_equal(interp_errormap_check(&bad), -EINVAL);
	bad = map;
	bad.lean[0].rad = 0.02;
	assert_int_equal(interp_errormap_check(&bad), -EINVAL);
	bad = map;
	bad.growth[0].over_k = NAN;
	assert_int_equal(interp_errormap_check(&bad), -EINVAL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup(errors_add_up, setup),
		cmocka_unit_test_setup(rows_end_flat, setup),
		cmocka_unit_test_setup(corrected_machine_stands_where_it_should,
				       setup),
		cmocka_unit_test_setup(way_back_undoes_the_way_there_to_the_bit,
				       setup),
		cmocka_unit_test_setup(what_is_no_machine_is_refused, setup),
	};

	return cmocka_run_group_tests_name("interp/errormap", tests, NULL,
					   NULL);
}
