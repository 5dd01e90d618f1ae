/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_drive_eds.c - what a drive would refuse, by its EDS
 */
#include "drive_steps.h"

#include "interp/diag.h"

#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static char path[] = "/tmp/test_drive_eds.XXXXXX";

static const struct {
	uint16_t index;
	uint8_t sub;
} objects[] = {
	{ 0x1000, 0 }, { 0x1016, 1 }, { 0x1017, 0 }, { 0x1400, 1 },
	{ 0x1400, 2 }, { 0x1600, 0 }, { 0x1600, 1 }, { 0x1600, 2 },
	{ 0x1800, 1 }, { 0x1800, 2 }, { 0x1a00, 0 }, { 0x1a00, 1 },
	{ 0x1a00, 2 }, { 0x6060, 0 }, { 0x60c2, 1 }, { 0x60c2, 2 },
	{ 0x6065, 0 },
};

/* All that is asked, but for @leave; @keys are those of 6065. */
static void write_eds(uint16_t leave, const char *keys)
{
	FILE *f = fopen(path, "w");

	assert_non_null(f);
	fputs("[FileInfo]\nFileName=x.eds\n[DeviceInfo]\n"
	      "VendorName=Nobody\n\n", f);
	for (size_t i = 0; i < sizeof(objects) / sizeof(objects[0]); i++) {
		const bool last = objects[i].index == 0x6065;

		if (objects[i].index == leave)
			continue;
		fprintf(f, objects[i].sub ? "[%04xSub%X]\n" : "[%04X]\n",
			objects[i].index, objects[i].sub);
		fprintf(f, "ParameterName=any\nDataType=0x0007\n%s\n",
			last ? keys : "AccessType=rw\nLowLimit=\nHighLimit=");
	}
	fclose(f);
}

static int check(const char *file, struct interp_diag *d)
{
	const struct drive_config c = {
		.node = 5, .master = 127, .period_us = 2000,
		.heartbeat_ms = 100,
		.write = { { 0x6065, 0, 4, 1000, false } }, .nwrites = 1,
	};

	memset(d, 0, sizeof(*d));
	return drive_eds_check(file, &c, d);
}

static void a_drive_that_has_all_of_it_is_taken(void **state)
{
	struct interp_diag d;

	(void)state;
	write_eds(0, "AccessType=rw\nLowLimit=0\nHighLimit=0xFFFFFFFF\n");
	assert_int_equal(check(path, &d), 0);
	write_eds(0, "AccessType=rww\nLowLimit=0x3e8\nHighLimit=1000");
	assert_int_equal(check(path, &d), 0);
	/* Signed limits in hexadecimal: -2147483648 to 2147483647. */
	write_eds(0, "AccessType=rw\nLowLimit=0x80000000\n"
		     "HighLimit=0x7FFFFFFF\n");
	assert_int_equal(check(path, &d), 0);
}

static void add(const char *text)
{
	FILE *f = fopen(path, "a");

	assert_non_null(f);
	fputs(text, f);
	fclose(f);
}

/* CompactSubObj and CompactPDO of CiA 306; and a line longer than a reader of
 * ini files takes. */
static void a_compact_eds_is_understood(void **state)
{
	char line[700];
	struct interp_diag d;

	(void)state;
	write_eds(0x1016, "AccessType=rw");
	add("[1016]\nParameterName=Consumer heartbeat time\nObjectType=0x8\n"
	    "DataType=0x0007\nAccessType=rw\nCompactSubObj=1\n");
	assert_int_equal(check(path, &d), 0);
	write_eds(0x1016, "AccessType=rw");
	add("[1016]\nAccessType=ro\nCompactSubObj=1\n");
	assert_int_equal(check(path, &d), -EINVAL);
	assert_non_null(strstr(d.found, "1016:01, value 7f00fa: it is read"));
	write_eds(0x1016, "AccessType=rw");
	add("[1016]\nAccessType=rw\nCompactSubObj=0\n");
	assert_int_equal(check(path, &d), -EINVAL);
	write_eds(0x1a00, "AccessType=rw");
	add("[DeviceInfo]\nCompactPDO=3\n");
	assert_int_equal(check(path, &d), 0);
	write_eds(0, "AccessType=rw");
	memset(line, 'x', sizeof(line));
	line[sizeof(line) - 1] = '\0';
	add("[Comments]\nLine1=");
	add(line);
	assert_int_equal(check(path, &d), 0);
}

/* It says nothing, and what stands behind it still counts. */
static void a_line_without_a_sign_is_passed_over(void **state)
{
	struct interp_diag d;

	(void)state;
	write_eds(0x1016, "AccessType=rw");
	add("a line of the maker\n[1016]\nAccessType\nCompactSubObj\n"
	    "AccessType=rw\nCompactSubObj=1\n");
	assert_int_equal(check(path, &d), 0);
	write_eds(0x1016, "AccessType=rw");
	add("a line of the maker\n[1016]\nAccessType=ro\nCompactSubObj\n"
	    "CompactSubObj=1\n");
	assert_int_equal(check(path, &d), -EINVAL);
	assert_non_null(strstr(d.found, "1016:01, value 7f00fa: it is read"));
}

static void what_it_would_refuse_is_refused_at_the_start(void **state)
{
	static const struct {
		uint16_t leave;
		const char *keys, *found;
	} cases[] = {
		{ 0x1017, "AccessType=rw",
		  "object 1017:00, value 64: it is not" },
		{ 0x1016, "AccessType=rw", "object 1016:01" },
		{ 0x6065, "", "object 6065:00, value 3e8: it is not there" },
		{ 0, "AccessType=ro", "object 6065:00, value 3e8: it is read" },
		{ 0, "AccessType=rw\nHighLimit=999\n", "its limits are" },
		{ 0, "AccessType=rw\nLowLimit=0x3e9\n", "its limits are" },
		{ 0, "AccessType=rw\nLowLimit=0xfffffff0\nHighLimit=999\n",
		  "its limits are" },
	};

	(void)state;
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct interp_diag d;

		write_eds(cases[i].leave, cases[i].keys);
		assert_int_equal(check(path, &d), -EINVAL);
		assert_non_null(strstr(d.found, cases[i].found));
		assert_non_null(strstr(d.wanted, "drive_leave"));
	}
}

static void a_file_that_is_none_is_told(void **state)
{
	struct interp_diag d;

	(void)state;
	assert_int_equal(check("/nowhere/x.eds", &d), -ENOENT);
	assert_non_null(strstr(d.found, "/nowhere/x.eds"));
	write_eds(0, "");
	assert_int_equal(check("/etc/passwd", &d), -EINVAL);
	assert_non_null(strstr(d.found, "not the lines"));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_drive_that_has_all_of_it_is_taken),
		cmocka_unit_test(a_compact_eds_is_understood),
		cmocka_unit_test(a_line_without_a_sign_is_passed_over),
		cmocka_unit_test(what_it_would_refuse_is_refused_at_the_start),
		cmocka_unit_test(a_file_that_is_none_is_told),
	};
	const int fd = mkstemp(path);
	int failed;

	if (fd < 0)
		return 1;
	close(fd);
	failed = cmocka_run_group_tests_name("io/drive_eds", tests, NULL, NULL);
	unlink(path);
	return failed;
}
