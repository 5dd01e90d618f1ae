/* SPDX-License-Identifier: Apache-2.0 */
/* test_store_electrode.c - the table of electrodes, in the store */
#include "folder_help.h"
#include "store_electrode.h"

#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <sqlite3.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static struct store *open_store(void)
{
	struct store *s = NULL;

	assert_int_equal(store_open(&s, folder, "m"), 0);
	return s;
}

static const struct store_electrode copper = {
	.n = 3, .name = "rib", .material = "copper", .note = "box 2",
	.undersize_mm = 0.1, .length_mm = 42.125, .wear_mm = 0.0625,
	.spark_s = 90, .life_mm = 0.5, .life_s = 3600,
	.state = ELECTRODE_WORN,
};

static void an_electrode_comes_back_as_it_was_put(void **state)
{
	struct store *s = open_store();
	struct store_electrode e;

	(void)state;
	assert_int_equal(store_electrode_find(s, 3, &e), -ENOENT);
	assert_int_equal(store_electrode_put(s, &copper), 0);
	store_close(s);
	s = open_store();
	memset(&e, 0, sizeof(e));
	assert_int_equal(store_electrode_find(s, 3, &e), 0);
	assert_memory_equal(&e, &copper, sizeof(e));
	e.wear_mm = 0.07;
	assert_int_equal(store_electrode_put(s, &e), 0);
	assert_int_equal(store_electrode_find(s, 3, &e), 0);
	assert_true(e.wear_mm == 0.07);
	assert_int_equal(store_electrode_remove(s, 3), 0);
	assert_int_equal(store_electrode_find(s, 3, &e), -ENOENT);
	store_close(s);
}

static void all_of_them_are_listed_in_pages_that_fit(void **state)
{
	static struct store_electrode all[STORE_ELECTRODES_MAX];
	struct store_electrode e = copper;
	struct store *s = open_store();
	uint32_t seen = 0, last = 0;

	(void)state;
	/* The longest JSON that a name and a note can make. */
	memset(e.name, '"', sizeof(e.name) - 1);
	memset(e.material, '"', sizeof(e.material) - 1);
	memset(e.note, '\\', sizeof(e.note) - 1);
	assert_int_equal(store_together(s, true), 0);
	for (e.n = 100; e.n < 100 + STORE_ELECTRODES_MAX; e.n++)
		assert_int_equal(store_electrode_put(s, &e), 0);
	assert_int_equal(store_commit(s), 0);
	assert_int_equal(store_electrodes(s, all, STORE_ELECTRODES_MAX),
			 STORE_ELECTRODES_MAX);
	assert_int_equal(all[255].n, 355);
	for (;;) {
		char *text = store_electrodes_json(s, last);

		assert_non_null(text);
		assert_true(strlen(text) < STORE_JSON_MAX);
		if (strcmp(text, "[]") == 0) {
			free(text);
			break;
		}
		for (const char *at = text; (at = strstr(at, "{\"n\":"));
		     at++) {
			last = (uint32_t)strtoul(at + 5, NULL, 10);
			seen++;
		}
		free(text);
	}
	assert_int_equal(seen, STORE_ELECTRODES_MAX);
	store_close(s);
}

static void numbers_of_pumps_are_no_electrodes(void **state)
{
	(void)state;
	assert_true(store_electrode_ok(1));
	assert_true(store_electrode_ok(79));
	assert_true(store_electrode_ok(100));
	assert_true(store_electrode_ok(9999));
	assert_false(store_electrode_ok(0));
	assert_false(store_electrode_ok(84));
	assert_false(store_electrode_ok(10000));
	assert_false(store_electrode_ok(1.5));
	assert_false(store_electrode_ok((double)NAN));
}

static void a_store_without_electrodes_is_brought_up(void **state)
{
	char path[100], text[16384] = "";
	struct store_electrode e;
	struct store_job j;
	sqlite3 *db = NULL;
	struct store *s;
	char *at;
	FILE *f = fopen("tests/data/store-4.sql", "re");

	(void)state;
	assert_non_null(f);
	assert_true(fread(text, 1, sizeof(text) - 1, f) > 0);
	fclose(f);
	snprintf(path, sizeof(path), "%s/m.db", folder);
	assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
	assert_int_equal(sqlite3_exec(db, text, NULL, NULL, NULL), SQLITE_OK);
	sqlite3_close(db);
	s = open_store();
	assert_int_equal(store_find(s, "cut-short", &j), 0);
	assert_int_equal(j.state, JOB_INTERRUPTED);
	at = store_resume_at(s, j.n);
	assert_string_equal(at, "00");
	free(at);
	assert_int_equal(store_find(s, "waits", &j), 0);
	assert_int_equal(j.state, JOB_QUEUED);
	assert_int_equal(store_electrode_find(s, 3, &e), -ENOENT);
	assert_int_equal(store_electrode_put(s, &copper), 0);
	store_close(s);
	s = open_store();
	assert_int_equal(store_electrode_find(s, 3, &e), 0);
	store_close(s);
}

#define T(f)	cmocka_unit_test_setup_teardown(f, folder_make, folder_remove)

int main(void)
{
	const struct CMUnitTest tests[] = {
		T(an_electrode_comes_back_as_it_was_put),
		T(all_of_them_are_listed_in_pages_that_fit),
		T(numbers_of_pumps_are_no_electrodes),
		T(a_store_without_electrodes_is_brought_up),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
