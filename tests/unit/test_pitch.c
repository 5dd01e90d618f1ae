/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_pitch.c - [axis.X] pitch_map: read, refused, and as the cycle gets it
 */
#include "config.h"
#include "cycle.h"

#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static char folder[] = "/tmp/edmd-pitch-XXXXXX";

static void put(const char *name, const char *text)
{
	char path[64];
	FILE *f;

	snprintf(path, sizeof(path), "%s/%s", folder, name);
	f = fopen(path, "w");
	assert_non_null(f);
	fputs(text, f);
	fclose(f);
}

static int read_with(const char *map, struct machine_config *ret,
		     struct interp_diag *diag)
{
	char path[64];

	put("m.ini", "[axis.X]\npulse_mm = 0.001\nbacklash_um = 7\n"
		     "backlash_mm_s = 2\npitch_map = x.pitch\n");
	put("x.pitch", map);
	snprintf(path, sizeof(path), "%s/m.ini", folder);
	return config_read(ret, path, diag);
}

static void a_map_becomes_what_is_to_be_added(void **state)
{
	struct machine_config c;
	struct cycle_config k;
	struct interp_diag d;

	(void)state;
	assert_int_equal(read_with("# place error\n-10 2.5\n\n 0\t0 # zero\n"
				   "10 -4\n", &c, &d), 0);
	config_cycle(&c, &k);
	assert_int_equal(k.comp[0].n, 3);
	assert_int_equal(k.comp[0].at[0], -10000);
	assert_true(k.comp[0].add[0] == -2.5 && k.comp[0].add[2] == 4);
	assert_int_equal(comp_wanted(&k.comp[0], 5000, 1), 2);
	assert_int_equal(comp_wanted(&k.comp[0], 5000, -1), 2 - 7);
	assert_true(fabs(k.comp[0].take_up - 2) < 1e-9);
	assert_int_equal(k.comp[1].n, 0);
}

static void what_is_no_map_is_refused_with_its_line(void **state)
{
	static const struct {
		const char *map, *found;
	} bad[] = {
		{ "0 0\n5 1\n5 2\n", "x.pitch:3: a place not above" },
		{ "0 0\n-5 1\n", "x.pitch:2: a place not above" },
		{ "0 0\n0.01 10\n", "x.pitch:2: an error that changes as" },
		{ "0 0\n5\n", "x.pitch:2: not a point" },
		{ "0 0\n5 1 2\n", "x.pitch:2: not a point" },
		{ "0 0\nfive 1\n", "x.pitch:2: not a point" },
		{ "0 nan\n", "x.pitch:1: not a point" },
		{ "0 0\n100 10001\n", "x.pitch:2: an error of more" },
		{ "0 0\n", "x.pitch:1: fewer than two" },
		{ "", "x.pitch:0: fewer than two" },
	};

	(void)state;
	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
		struct machine_config c;
		struct interp_diag d;

		assert_int_equal(read_with(bad[i].map, &c, &d), -EINVAL);
		assert_int_equal(d.line, 5);
		assert_non_null(strstr(d.found, bad[i].found));
		assert_true(strlen(d.wanted) > 5);
	}
}

static void more_points_than_there_is_room_for_are_refused(void **state)
{
	char map[COMP_POINTS * 16] = "";
	struct machine_config c;
	struct interp_diag d;
	size_t n = 0;

	(void)state;
	for (int i = 0; i < COMP_POINTS; i++)
		n += (size_t)snprintf(map + n, sizeof(map) - n, "%d 0\n", i);
	assert_int_equal(read_with(map, &c, &d), 0);
	snprintf(map + n, sizeof(map) - n, "1000 0\n");
	assert_int_equal(read_with(map, &c, &d), -EINVAL);
	assert_non_null(strstr(d.found, "x.pitch:129: too many"));
}

static void a_map_that_is_not_there_is_refused(void **state)
{
	struct machine_config c;
	struct interp_diag d;
	char path[64];

	(void)state;
	put("n.ini", "[axis.Y]\npitch_map = none.such\n");
	snprintf(path, sizeof(path), "%s/n.ini", folder);
	assert_int_equal(config_read(&c, path, &d), -EINVAL);
	assert_int_equal(d.line, 2);
	assert_non_null(strstr(d.found, "axis.Y.pitch_map: none.such"));
}

static int make_folder(void **state)
{
	(void)state;
	return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
	static const char *const names[] = { "m.ini", "n.ini", "x.pitch" };
	char path[64];

	(void)state;
	for (int i = 0; i < 3; i++) {
		snprintf(path, sizeof(path), "%s/%s", folder, names[i]);
		unlink(path);
	}
	return rmdir(folder);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_map_becomes_what_is_to_be_added),
		cmocka_unit_test(what_is_no_map_is_refused_with_its_line),
		cmocka_unit_test(more_points_than_there_is_room_for_are_refused),
		cmocka_unit_test(a_map_that_is_not_there_is_refused),
	};

	return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
