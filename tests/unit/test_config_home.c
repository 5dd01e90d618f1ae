/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_config_home.c - what each backend can find its places by, and what the
 * machine file therefore refuses
 */
#include "config_help.h"

#include "backends.h"

/* One axis, Z, and all that each backend wants besides. */
static const char *const rest[CONFIG_NBACKENDS] = {
	[BACKEND_SIM] = "",
	[BACKEND_NULL] = "",
	[BACKEND_GPIO] = "[axis.Z]\nv_max_mm_s = 1\n[jump]\nv_max_mm_s = 1\n"
			 "[gpio]\nstep_Z = 2\ndir_Z = 3\n",
	[BACKEND_CAN402] = "[can402]\nnode_Z = 1\n[axis.Z]\nbrake = free\n",
};

static const char *const methods[] = {
	"none", "switch", "switch-index", "absolute",
	"drive",
};

#define LINE	2			/* home_method in text_of() */

static int check(int backend, int method, const char *more,
		 struct interp_diag *d)
{
	static const char axes[] = "XYABCUV";
	char text[1024];
	struct machine_config c;
	int n = snprintf(text, sizeof(text),
			 "[axis.Z]\nhome_method = %s\n[machine]\n"
			 "backend = %s\n%s%s", methods[method],
			 config_backend_name(backend), rest[backend], more);

	for (const char *a = axes; *a; a++)
		n += snprintf(text + n, sizeof(text) - (size_t)n,
			      "[axis.%c]\npresent = no\n", *a);
	return read_text(text, &c, d);
}

/* '-': refused; 'y': taken; 'k': taken with a key of its own. */
static const char *const can[CONFIG_NBACKENDS] = {
	/*		   none, switch, switch-index, absolute, drive */
	[BACKEND_SIM] = "yyyy-",
	[BACKEND_NULL] = "y----",
	[BACKEND_GPIO] = "yk---",
	[BACKEND_CAN402] = "ykkkk",
};

static const char *const key[CONFIG_NBACKENDS] = {
	[BACKEND_GPIO] = "[gpio]\nhome_Z = 4\n",
	[BACKEND_CAN402] = "[axis.Z]\nabsolute = yes\n"
			   "drive_home = 17\ndrive_inputs = home:!31\n",
};

static void a_method_that_the_backend_cannot_do_is_refused(void **state)
{
	struct interp_diag d;

	(void)state;
	for (int b = 0; b < CONFIG_NBACKENDS; b++)
		for (int m = 0; m < (int)COUNT(methods); m++) {
			const bool taken = can[b][m] == 'y';

			if ((check(b, m, "", &d) == 0) != taken)
				fail_msg("%s, %s: %s", config_backend_name(b),
					 methods[m], d.found);
			if (taken)
				continue;
			assert_int_equal(d.line, LINE);
			assert_non_null(strstr(d.found, "axis.Z.home_method"));
			assert_non_null(strstr(d.found, methods[m]));
			assert_non_null(strstr(d.wanted, "none"));
			if (can[b][m] == 'k')
				assert_int_equal(check(b, m, key[b], &d), 0);
		}
}

/* Neither says which switch a drive is to look for. */
static void what_is_accepted_is_named(void **state)
{
	struct interp_diag d;

	(void)state;
	assert_true(check(BACKEND_CAN402, 1, "", &d) < 0);
	assert_non_null(strstr(d.wanted, "drive_inputs = home:2"));
	assert_true(check(BACKEND_CAN402, 2, "", &d) < 0);
	assert_non_null(strstr(d.wanted, "drive_inputs = home:2"));
	assert_true(check(BACKEND_GPIO, 2, "", &d) < 0);
	assert_string_equal(d.wanted, "one of none, switch");
	assert_true(check(BACKEND_GPIO, 1, "", &d) < 0);
	assert_non_null(strstr(d.wanted, "gpio.home_Z = the number"));
	assert_true(check(BACKEND_CAN402, 3, "", &d) < 0);
	assert_non_null(strstr(d.wanted, "absolute = yes"));
	assert_true(check(BACKEND_CAN402, 4, "", &d) < 0);
	assert_non_null(strstr(d.wanted, "drive_home = the number"));
}

/* Limit switches on a bus, or without lines: nobody would read them. */
static void limit_switches_that_nobody_reads_are_refused(void **state)
{
	struct interp_diag d;

	(void)state;
	assert_true(check(BACKEND_CAN402, 0, "[gpio]\nlimit_Z = 4\n", &d) < 0);
	assert_non_null(strstr(d.found, "limit_Z"));
	assert_int_equal(check(BACKEND_GPIO, 0, "[gpio]\nlimit_Z = 4\n", &d),
			 0);
}

static void inputs_of_a_drive_are_read_as_a_list(void **state)
{
	static const char *const good[] = {
		"none", "home:0", "limit_low:0 limit_high:!1 home:2 estop:!16",
		"limit_low:31, limit_high:31",
	};
	static const char *const bad[] = {
		"home", "home:", "home:!", "home:32", "home:-1", "home:2x",
		"door:3", "home:1 home:2", "home:2:3", ":2", "homes:1",
	};
	struct interp_diag d;
	char text[128];

	(void)state;
	for (size_t i = 0; i < COUNT(good); i++) {
		snprintf(text, sizeof(text), "[axis.Z]\ndrive_inputs = %s\n",
			 good[i]);
		assert_int_equal(check(BACKEND_CAN402, 0, text, &d), 0);
	}
	for (size_t i = 0; i < COUNT(bad); i++) {
		snprintf(text, sizeof(text), "[axis.Z]\ndrive_inputs = %s\n",
			 bad[i]);
		if (check(BACKEND_CAN402, 0, text, &d) == 0)
			fail_msg("%s was taken", bad[i]);
		assert_non_null(strstr(d.found, "axis.Z.drive_inputs"));
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(
			a_method_that_the_backend_cannot_do_is_refused),
		cmocka_unit_test(what_is_accepted_is_named),
		cmocka_unit_test(limit_switches_that_nobody_reads_are_refused),
		cmocka_unit_test(inputs_of_a_drive_are_read_as_a_list),
	};

	return cmocka_run_group_tests(tests, make_file, remove_file);
}
