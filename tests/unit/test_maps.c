/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_maps.c - [axis.X] pitch_map and [geometry] maps: how they are read and
 * refused, and what the cycle gets
 */
#include "config.h"
#include "cycle.h"
#include "folder_help.h"

#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

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

static int32_t added(const struct cycle_config *k, int axis,
		     const int32_t *place)
{
	int32_t add[INTERP_NAXES];

	comp_map(&k->comp, place, add);
	return add[axis];
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
	assert_true(k.comp.mapped);
	assert_int_equal(added(&k, INTERP_X, (int32_t[8]) { 5000 }), 2);
	assert_int_equal(added(&k, INTERP_X, (int32_t[8]) { -10000 }), -3);
	assert_int_equal(added(&k, INTERP_X, (int32_t[8]) { 90000 }), 4);
	assert_int_equal(added(&k, INTERP_Y, (int32_t[8]) { 5000, 5000 }), 0);
	assert_int_equal(k.comp.axis[0].backlash, 7);
	assert_true(fabs(k.comp.axis[0].take_up - 2) < 1e-9);
}

static void what_is_no_map_is_refused_with_its_line(void **state)
{
	static const struct {
		const char *map, *found;
	} bad[] = {
		{ "0 0\n5 1\n5 2\n", "x.pitch:3:1: a place not above" },
		{ "0 0\n-5 1\n", "x.pitch:2:1: a place not above" },
		{ "0 0\n0.9 10\n", "x.pitch:2:1: too steep" },
		{ "0 0\n5\n", "x.pitch:2:2: not a point" },
		{ "0 0\n5 1 2\n", "x.pitch:2:5: not a point" },
		{ "0 0\nfive 1\n", "x.pitch:2:1: not a point" },
		{ "0 nan\n", "x.pitch:1:3: not a point" },
		{ "0 0\n100 10001\n", "x.pitch:2:1: an error of more" },
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
	char map[INTERP_ERRORMAP_POINTS * 16] = "";
	struct machine_config c;
	struct interp_diag d;
	size_t n = 0;

	(void)state;
	for (int i = 0; i < INTERP_ERRORMAP_POINTS; i++)
		n += (size_t)snprintf(map + n, sizeof(map) - n, "%d 0\n", i);
	assert_int_equal(read_with(map, &c, &d), 0);
	snprintf(map + n, sizeof(map) - n, "1000 0\n");
	assert_int_equal(read_with(map, &c, &d), -EINVAL);
	assert_non_null(strstr(d.found, "x.pitch:129:1: too many"));
}

/* -- [geometry] maps ------------------------------------------------------ */

static int read_maps(const char *machine, const char *maps,
		     struct machine_config *ret, struct interp_diag *diag)
{
	char path[64], text[256];

	snprintf(text, sizeof(text), "[axis.A]\npresent = no\n%s"
		 "[geometry]\nmaps = m.maps\n", machine);
	put("m.ini", text);
	put("m.maps", maps);
	put("x.pitch", "0 0\n10 5\n");
	snprintf(path, sizeof(path), "%s/m.ini", folder);
	return config_read(ret, path, diag);
}

static void each_kind_of_error_is_read_and_cured(void **state)
{
	struct machine_config c;
	struct cycle_config k;
	struct interp_diag d;

	(void)state;
	assert_int_equal(read_maps("", "# laser, 20 C\n"
		"straightness Y along X\n -100 0\n  100 20 # um\n"
		"pitch Z\n0 0\n100 -50\n"
		"squareness X along Z 40\n"
		"growth U 11.5 -100\n", &c, &d), 0);
	c.geometry.growth[INTERP_U].over_k = 10;
	config_cycle(&c, &k);
	assert_int_equal(added(&k, INTERP_Y, (int32_t[8]) { 0 }), -10);
	assert_int_equal(added(&k, INTERP_Z, (int32_t[8]) { 0, 0, 50000 }), 25);
	assert_int_equal(added(&k, INTERP_X, (int32_t[8]) { 0, 0, 100000 }),
			 -4);
	assert_int_equal(added(&k, INTERP_U, (int32_t[8]) {
		0, 0, 0, 0, 0, 0, 100000 }), -23);
}

static void the_temperature_is_that_of_the_machine_file(void **state)
{
	struct machine_config c;
	struct interp_diag d;

	(void)state;
	assert_int_equal(read_maps("", "growth X 11.5 0\n", &c, &d), 0);
	assert_true(c.geometry.growth[0].over_k == 0);
	put("m.ini", "[geometry]\nover_k = -3.5\nmaps = m.maps\n");
	char path[64];

	snprintf(path, sizeof(path), "%s/m.ini", folder);
	assert_int_equal(config_read(&c, path, &d), 0);
	assert_true(c.geometry.growth[0].over_k == -3.5);
}

static void what_is_no_geometry_is_refused_with_line_and_column(void **state)
{
	static const struct {
		const char *maps, *found;
	} bad[] = {
		{ "0 0\n", "m.maps:1:1: a point before any row" },
		{ "pitch X\n0 0\n", "m.maps:1: fewer than two" },
		{ "pitch X\n0 0\ngrowth X 1 0\n", "m.maps:1: fewer than two" },
		{ "pitch W\n", "m.maps:1:7: not an axis" },
		{ "pitch A\n", "m.maps:1:7: not an axis" },
		{ "pitch X Y\n", "m.maps:1:9: more than belongs" },
		{ "pitch X\n0 0\n5 1\npitch X\n", "m.maps:4:1: this row was" },
		{ "straightness Y\n", "m.maps:1:15: not `along`" },
		{ "straightness Y along Y\n", "m.maps:1:22: an axis along" },
		{ "squareness Z along Z 1\n", "m.maps:1:20: an axis along" },
		{ "squareness Y along X\n", "m.maps:1:21: not a number" },
		{ "squareness Y along X 10001\n", "m.maps:1:22: not a number" },
		{ "growth C 1 0\n", "m.maps:1:8: growth of a rotary" },
		{ "growth X 1\n", "m.maps:1:11: not a number" },
		{ "growth X 101 0\n", "m.maps:1:10: not a number" },
		{ "growth X 1 0\ngrowth X 1 0\n", "m.maps:2:1: this growth" },
		{ "squareness Y along X 1\nsquareness Y along X 1\n",
		  "m.maps:2:1: this angle" },
		{ "squareness Y along X 1\nsquareness X along Y 1\n",
		  "m.maps:2:1: this angle" },
		{ "", "m.maps:0: no error in it" },
		{ "# to be measured\n\n", "m.maps:2: no error in it" },
		{ "squareness Y along X 1\rgrowth X 1 0\r",
		  "m.maps:1:24: more than belongs" },
		{ "skew X\n", "m.maps:1:1: neither a point" },
		{ "pitch X\n0 0\n1 10.1\n", "m.maps:3:1: too steep" },
		{ "pitch X\n0 0\n0 1\n", "m.maps:3:1: a place not above" },
		{ "pitch X\n0 0 0\n", "m.maps:2:5: not a point" },
	};

	(void)state;
	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
		struct machine_config c;
		struct interp_diag d;

		assert_int_equal(read_maps("", bad[i].maps, &c, &d), -EINVAL);
		assert_int_equal(d.line, 4);
		if (!strstr(d.found, bad[i].found))
			fail_msg("%s, not %s", d.found, bad[i].found);
		assert_non_null(strstr(d.found, "geometry.maps"));
		assert_true(strlen(d.wanted) > 5);
	}
}

static void a_letter_that_is_no_axis_is_told_the_axes_there_are(void **state)
{
	struct machine_config c;
	struct interp_diag d;

	(void)state;
	assert_int_equal(read_maps("[axis.C]\npresent = no\n", "pitch C\n", &c,
				   &d), -EINVAL);
	assert_string_equal(d.wanted, "a letter of those it has: X Y Z B U V");
}

static void a_map_may_come_from_any_editor(void **state)
{
	struct machine_config c;
	struct interp_diag d;

	(void)state;
	assert_int_equal(read_maps("",
				   "\xef\xbb\xbfpitch X\r\n"
				   "\t0\t0\r\n10 \t 5 # um\r\n\r\n",
				   &c, &d),
			 0);
	assert_int_equal(c.geometry.row[0].n, 2);
	assert_int_equal(read_with("\xef\xbb\xbf" "0 0\r\n10 5", &c, &d), 0);
	assert_int_equal(read_maps("", "\xef\xbb\xbfskew X\n", &c, &d),
			 -EINVAL);
	assert_non_null(strstr(d.found, "m.maps:1:1: neither"));
}

static void a_pitch_is_given_once(void **state)
{
	struct machine_config c;
	struct interp_diag d;

	(void)state;
	assert_int_equal(read_maps("[axis.X]\npitch_map = x.pitch\n",
				   "pitch X\n0 0\n1 1\n", &c, &d), -EINVAL);
	assert_non_null(strstr(d.found, "this row was given before"));
	assert_int_equal(read_maps("[axis.X]\npitch_map = x.pitch\n",
				   "pitch Y\n0 0\n1 1\n", &c, &d), 0);
	assert_int_equal(c.geometry.nrows, 2);
}

static void more_rows_than_there_is_room_for_are_refused(void **state)
{
	char maps[2048] = "";
	struct machine_config c;
	struct interp_diag d;
	size_t n = 0;

	(void)state;
	for (int i = 0; i <= INTERP_ERRORMAP_ROWS; i++)
		n += (size_t)snprintf(maps + n, sizeof(maps) - n,
			i % 4 == 0 ? "pitch %c\n0 0\n9 0\n" :
			"straightness %c along %c\n0 0\n9 0\n",
			"XYZUV"[i / 4], "XYZUV"[(i / 4 + i % 4) % 5]);
	assert_int_equal(read_maps("", maps, &c, &d), -EINVAL);
	assert_non_null(strstr(d.found, "too many rows"));
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

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_map_becomes_what_is_to_be_added),
		cmocka_unit_test(what_is_no_map_is_refused_with_its_line),
		cmocka_unit_test(more_points_than_there_is_room_for_are_refused),
		cmocka_unit_test(each_kind_of_error_is_read_and_cured),
		cmocka_unit_test(the_temperature_is_that_of_the_machine_file),
		cmocka_unit_test(what_is_no_geometry_is_refused_with_line_and_column),
		cmocka_unit_test(a_letter_that_is_no_axis_is_told_the_axes_there_are),
		cmocka_unit_test(a_map_may_come_from_any_editor),
		cmocka_unit_test(a_pitch_is_given_once),
		cmocka_unit_test(more_rows_than_there_is_room_for_are_refused),
		cmocka_unit_test(a_map_that_is_not_there_is_refused),
	};

	return cmocka_run_group_tests(tests, folder_make, folder_remove);
}
