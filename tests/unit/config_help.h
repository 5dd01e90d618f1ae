/* SPDX-License-Identifier: Apache-2.0 */
/*
 * config_help.h - texts read as machine files
 */
#ifndef CONFIG_HELP_H
#define CONFIG_HELP_H

#include "config.h"
#include "cycle.h"
#include "keys.h"

#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#define COUNT(a)	(sizeof(a) / sizeof((a)[0]))

#define GPIO_AXES	"[machine]\nbackend = gpio\nperiod_us = 200\n" \
	"[axis.A]\npresent = no\n[axis.B]\npresent = no\n" \
	"[axis.C]\npresent = no\n[axis.U]\npresent = no\n" \
	"[axis.V]\npresent = no\n[axis.X]\nv_max_mm_s = 1\n" \
	"[axis.Y]\nv_max_mm_s = 1\n[axis.Z]\nv_max_mm_s = 1\n" \
	"[jump]\nv_max_mm_s = 1\n"
#define GPIO_LINES	"[gpio]\n" \
	"step_X = 1\ndir_X = 2\nstep_Y = 3\ndir_Y = 4\nstep_Z = 5\n" \
	"dir_Z = 6\n"

/* A machine of lines that has a gap; and one whose gap is read by a
 * converter. */
#define LINES_MACHINE	GPIO_AXES "[gap]\nsource = lines\n" GPIO_LINES \
	"gap_open = 7\ngap_short = 8\n"
#define ADC_MACHINE	GPIO_AXES GPIO_LINES "adc = adc0\nadc_ratio = 20\n"

static char path[] = "/tmp/test_config.XXXXXX";

static inline int make_file(void **state)
{
	int fd = mkstemp(path);

	(void)state;
	if (fd < 0)
		return -1;
	return close(fd);
}

static inline int remove_file(void **state)
{
	(void)state;
	return unlink(path);
}

static inline int read_bytes(const void *text, size_t n,
			     struct machine_config *c,
			     struct interp_diag *diag)
{
	FILE *f = fopen(path, "w");

	assert_non_null(f);
	assert_int_equal(fwrite(text, 1, n, f), n);
	assert_int_equal(fclose(f), 0);
	return config_read(c, path, diag);
}

static inline int read_text(const char *text, struct machine_config *c,
			    struct interp_diag *diag)
{
	return read_bytes(text, strlen(text), c, diag);
}

static inline void read_good(const char *text, struct machine_config *c)
{
	struct interp_diag diag;

	if (read_text(text, c, &diag) != 0)
		fail_msg("%u:%u: %s; %s", diag.line, diag.column, diag.found,
			 diag.wanted);
}

/* Equal key by key: padding between fields has no value. */
static inline void assert_same(const struct machine_config *a,
			       const struct machine_config *b)
{
	char x[CONFIG_TEXT_MAX], y[CONFIG_TEXT_MAX];

	for (int i = 0; config_key(i); i++) {
		const struct config_key *k = config_key(i);
		int n = config_section[k->section].ninstances;

		for (int j = 0; j < n; j++)
			assert_string_equal(
				config_key_format(k, j, a, x, sizeof(x)),
				config_key_format(k, j, b, y, sizeof(y)));
	}
}

static inline char *print_text(const struct machine_config *c)
{
	char *text = NULL;
	size_t n;
	FILE *f = open_memstream(&text, &n);

	assert_non_null(f);
	config_print(c, f);
	assert_int_equal(fclose(f), 0);
	return text;
}

#endif /* CONFIG_HELP_H */
