/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_adc.c - a converter of industrial I/O, as files of a folder and a FIFO
 */
#include "adc.h"

#include "interp/diag.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

static char root[] = "/tmp/test_adc.XXXXXX";

static const char *at(const char *name)
{
	static char path[192];

	snprintf(path, sizeof(path), "%s/%s", root, name);
	return path;
}

static void file(const char *name, const char *text)
{
	FILE *f = fopen(at(name), "w");

	assert_non_null(f);
	fputs(text, f);
	fclose(f);
}

static void has(const char *name, const char *text)
{
	char line[64] = "";
	FILE *f = fopen(at(name), "r");

	assert_non_null(f);
	assert_non_null(fgets(line, sizeof(line), f));
	fclose(f);
	assert_string_equal(line, text);
}

/* A converter of two channels; the second is ours. */
static int make(void **state)
{
	static const char *const folders[] = {
		"iio:device3", "iio:device3/buffer", "iio:device3/trigger",
		"iio:device3/scan_elements", "dev"
	};

	(void)state;
	if (!mkdtemp(root))
		return -1;
	for (size_t i = 0; i < sizeof(folders) / sizeof(folders[0]); i++)
		mkdir(at(folders[i]), 0700);
	file("iio:device3/name", "adc1234\n");
	file("iio:device3/in_voltage_scale", "0.5\n");
	file("iio:device3/in_voltage1_offset", "-100\n");
	file("iio:device3/buffer/enable", "0");
	file("iio:device3/buffer/length", "2");
	file("iio:device3/trigger/current_trigger", "");
	file("iio:device3/scan_elements/in_voltage0_en", "1");
	file("iio:device3/scan_elements/in_voltage1_en", "0");
	file("iio:device3/scan_elements/in_voltage1_type", "be:s12/16>>4\n");
	file("iio:device3/scan_elements/in_timestamp_en", "1");
	file("iio:device3/buffer/watermark", "8");
	return mkfifo(at("dev/iio:device3"), 0600);
}

static int unmake(void **state)
{
	char command[128];

	(void)state;
	snprintf(command, sizeof(command), "rm -r %s", root);
	return system(command);
}

static int open_it(struct adc *a, const char *device, uint32_t channel,
		   struct interp_diag *d)
{
	static char dev[64];
	const struct adc_config c = {
		.sysfs = root, .dev = dev, .device = device,
		.channel = channel, .trigger = "timer1", .ratio = 20,
		.stale_periods = 3,
	};

	snprintf(dev, sizeof(dev), "%s/dev", root);
	memset(d, 0, sizeof(*d));
	return adc_open(a, &c, d);
}

static void formats_are_those_of_the_kernel(void **state)
{
	static const struct {
		const char *text;
		uint8_t bytes[4];
		long count;
	} rows[] = {
		{ "le:u16/16>>0", { 0x34, 0x12 }, 0x1234 },
		{ "be:u16/16>>0", { 0x12, 0x34 }, 0x1234 },
		{ "le:s12/16>>4", { 0xf0, 0xff }, -1 },
		{ "be:s12/16>>4", { 0x80, 0x00 }, -2048 },
		{ "le:u8/8>>0", { 0xfe }, 254 },
		{ "le:s24/32>>8", { 0, 0xff, 0xff, 0xff }, -1 },
		{ "le:s32/32>>0", { 0, 0, 0, 0x80 }, INT32_MIN },
		{ "be:u10/16", { 0xff, 0xff }, 1023 },
	};
	static const char *const bad[] = {
		"", "le", "me:u16/16>>0", "le:x16/16>>0", "le:u0/16>>0",
		"le:u16/24>>0", "le:u16/16>>1", "le:u40/64>>0",
		"le:s12/16X2>>4"
	};
	struct adc_format f;

	(void)state;
	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		assert_true(adc_format_read(rows[i].text, &f));
		assert_int_equal(adc_count(&f, rows[i].bytes), rows[i].count);
	}
	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++)
		assert_false(adc_format_read(bad[i], &f));
}

static void the_mean_of_what_came_is_the_gap_until_nothing_comes(void **state)
{
	const uint8_t samples[] = { 0x25, 0x80, 0x28, 0x00, 0x2a, 0x80 };
	struct interp_diag d;
	struct adc a;
	double v;
	int fd;

	(void)state;
	assert_int_equal(open_it(&a, "adc1234", 1, &d), 0);
	has("iio:device3/buffer/enable", "1");
	has("iio:device3/trigger/current_trigger", "timer1");
	has("iio:device3/scan_elements/in_voltage0_en", "0");
	has("iio:device3/scan_elements/in_timestamp_en", "0");
	has("iio:device3/buffer/watermark", "1");
	has("iio:device3/buffer/length", "4096");
	has("iio:device3/scan_elements/in_voltage1_en", "1");
	assert_false(adc_read(&a, &v));
	fd = open(at("dev/iio:device3"), O_WRONLY | O_NONBLOCK);
	assert_true(fd >= 0);
	assert_int_equal(write(fd, samples, sizeof(samples)), 6);
	/* 600, 640 and 680 less 100, of 0.5 mV, by 20. */
	assert_true(adc_read(&a, &v));
	assert_true(fabs(v - 540 * 0.5e-3 * 20) < 1e-9);
	assert_true(adc_read(&a, &v));
	assert_true(fabs(v - 5.4) < 1e-9);
	assert_true(adc_read(&a, &v));
	assert_false(adc_read(&a, &v));
	/* It comes back with another voltage. */
	assert_int_equal(write(fd, samples, 2), 2);
	assert_true(adc_read(&a, &v));
	assert_true(fabs(v - 5.0) < 1e-9);
	adc_close(&a);
	has("iio:device3/buffer/enable", "0");
	close(fd);
}

static void puts_n(int fd, int count, int n)
{
	const uint8_t sample[] = { (uint8_t)(count >> 4),
				   (uint8_t)(count * 16) };

	for (int i = 0; i < n; i++)
		assert_int_equal(write(fd, sample, 2), 2);
}

static bool told(struct adc *a, const char *what)
{
	char line[200] = "";

	return adc_note(a, line, sizeof(line)) && strstr(line, what);
}

static void a_full_buffer_is_emptied_and_is_no_reading(void **state)
{
	struct interp_diag d;
	struct adc a;
	char line[8];
	double v;
	int fd;

	(void)state;
	assert_int_equal(open_it(&a, "adc1234", 1, &d), 0);
	fd = open(at("dev/iio:device3"), O_WRONLY | O_NONBLOCK);
	puts_n(fd, 600, ADC_SAMPLES);
	assert_false(adc_read(&a, &v));
	assert_true(told(&a, "samples were lost"));
	assert_false(adc_note(&a, line, sizeof(line)));
	/* Nothing old is left: the next one is what the gap is now. */
	puts_n(fd, 300, 1);
	assert_true(adc_read(&a, &v));
	assert_true(fabs(v - 200 * 0.5e-3 * 20) < 1e-9);
	puts_n(fd, 300, ADC_SAMPLES - 1);
	assert_true(adc_read(&a, &v));
	assert_false(adc_note(&a, line, sizeof(line)));
	adc_close(&a);
	close(fd);
}

static void the_end_of_the_range_is_no_voltage(void **state)
{
	struct interp_diag d;
	struct adc a;
	double v;
	int fd;

	(void)state;
	assert_int_equal(open_it(&a, "adc1234", 1, &d), 0);
	fd = open(at("dev/iio:device3"), O_WRONLY | O_NONBLOCK);
	puts_n(fd, 2047, 3);
	puts_n(fd, 1000, 1);
	assert_true(adc_read(&a, &v));
	for (int i = 0; i < 3; i++) {
		puts_n(fd, 2047, 4);
		assert_int_equal(adc_read(&a, &v), i < 2);
	}
	assert_true(told(&a, "end of its range"));
	/* A short is at no end of it, unless the divider inverts. */
	puts_n(fd, -2048, 4);
	assert_true(adc_read(&a, &v));
	adc_close(&a);
	close(fd);
}

static void one_that_is_gone_is_no_reading_at_once(void **state)
{
	struct interp_diag d;
	struct adc a;
	double v;
	int fd;

	(void)state;
	assert_int_equal(open_it(&a, "adc1234", 1, &d), 0);
	fd = open(at("dev/iio:device3"), O_WRONLY | O_NONBLOCK);
	puts_n(fd, 600, 1);
	assert_true(adc_read(&a, &v));
	close(fd);
	close(a.fd);
	a.fd = open(root, O_RDONLY);	/* read() fails */
	assert_false(adc_read(&a, &v));
	assert_true(told(&a, "start edmd again"));
	assert_false(adc_read(&a, &v));
	assert_false(told(&a, ""));
	adc_close(&a);
}

static void samples_that_come_too_seldom_are_told_once(void **state)
{
	struct interp_diag d;
	struct adc a;
	double v;
	int fd, n = 0;

	(void)state;
	assert_int_equal(open_it(&a, "adc1234", 1, &d), 0);
	fd = open(at("dev/iio:device3"), O_WRONLY | O_NONBLOCK);
	for (int i = 0; i < 5 * ADC_WINDOW; i++) {
		if (i < ADC_WINDOW || i % 3 == 0)
			puts_n(fd, 600, 1);
		adc_read(&a, &v);
		n += told(&a, "at least one in each");
	}
	assert_int_equal(n, 1);
	adc_close(&a);
	close(fd);
}

static void a_scan_of_more_than_its_channel_is_refused(void **state)
{
	struct interp_diag d;
	struct adc a;

	(void)state;
	mkdir(at("iio:device3/scan_elements/in_voltage2_en"), 0700);
	assert_true(open_it(&a, "iio:device3", 1, &d) < 0);
	assert_non_null(strstr(d.found, "in_voltage2_en"));
	assert_non_null(strstr(d.wanted, "one channel alone"));
	adc_close(&a);
	rmdir(at("iio:device3/scan_elements/in_voltage2_en"));
}

static void files_that_cannot_be_true_are_refused(void **state)
{
	static const struct {
		const char *name, *bad, *good, *wanted;
	} rows[] = {
		{ "iio:device3/in_voltage_scale", "0\n", "0.5\n",
		  "a scale that is not 0" },
		{ "iio:device3/in_voltage_scale", "off\n", "0.5\n", "numbers" },
		{ "iio:device3/scan_elements/in_voltage1_type",
		  "le:s12/16X2>>4\n", "be:s12/16>>4\n", "one number" },
	};
	struct interp_diag d;
	struct adc a;

	(void)state;
	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		file(rows[i].name, rows[i].bad);
		assert_true(open_it(&a, "iio:device3", 1, &d) < 0);
		assert_non_null(strstr(d.wanted, rows[i].wanted));
		adc_close(&a);
		file(rows[i].name, rows[i].good);
	}
}

static void what_is_not_there_is_refused_with_the_remedy(void **state)
{
	struct interp_diag d;
	struct adc a;

	(void)state;
	assert_int_equal(open_it(&a, "nothing", 1, &d), -ENODEV);
	assert_non_null(strstr(d.wanted, "iio:deviceN"));
	adc_close(&a);
	assert_true(open_it(&a, "iio:device3", 7, &d) < 0);
	assert_non_null(strstr(d.wanted, "adc_channel"));
	adc_close(&a);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(formats_are_those_of_the_kernel),
		cmocka_unit_test(the_mean_of_what_came_is_the_gap_until_nothing_comes),
		cmocka_unit_test(a_full_buffer_is_emptied_and_is_no_reading),
		cmocka_unit_test(the_end_of_the_range_is_no_voltage),
		cmocka_unit_test(one_that_is_gone_is_no_reading_at_once),
		cmocka_unit_test(samples_that_come_too_seldom_are_told_once),
		cmocka_unit_test(a_scan_of_more_than_its_channel_is_refused),
		cmocka_unit_test(files_that_cannot_be_true_are_refused),
		cmocka_unit_test(what_is_not_there_is_refused_with_the_remedy),
	};

	return cmocka_run_group_tests_name("io/adc", tests, make, unmake);
}
