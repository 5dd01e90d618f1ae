/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_config_gpio.c - [gpio]: lines as text, and what they must agree on
 */
#include "config.h"
#include "keys.h"

#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#define COUNT(a)	(sizeof(a) / sizeof((a)[0]))

static char path[] = "/tmp/test_config_gpio.XXXXXX";

static int make_file(void **state)
{
	int fd = mkstemp(path);

	(void)state;
	return fd < 0 ? -1 : close(fd);
}

static int remove_file(void **state)
{
	(void)state;
	return unlink(path);
}

/* X alone, 10 mm/s: what the default period and times allow. */
static const char one_axis[] =
	"[machine]\nbackend = gpio\n[axis.Y]\npresent = no\n"
	"[axis.Z]\npresent = no\n[axis.A]\npresent = no\n"
	"[axis.B]\npresent = no\n[axis.C]\npresent = no\n"
	"[axis.U]\npresent = no\n[axis.V]\npresent = no\n"
	"[axis.X]\nv_max_mm_s = 10\n[jump]\nv_max_mm_s = 10\n[gpio]\n";

static int read_with(const char *more, struct machine_config *c,
		     struct interp_diag *d)
{
	FILE *f = fopen(path, "w");

	assert_non_null(f);
	fputs(one_axis, f);
	fputs(more, f);
	fclose(f);
	return config_read(c, path, d);
}

static void a_line_is_none_or_a_number_of_a_chip(void **state)
{
	struct config_line_at at;

	(void)state;
	assert_null(config_line_read("none", &at));
	assert_false(at.wired);
	assert_null(config_line_read("17", &at));
	assert_true(at.wired && !at.inverted && at.offset == 17);
	assert_string_equal(at.chip, "");
	assert_null(config_line_read("!pinctrl-rp1:4", &at));
	assert_true(at.wired && at.inverted && at.offset == 4);
	assert_string_equal(at.chip, "pinctrl-rp1");
	assert_null(config_line_read("6000000.gpio:a:3", &at));
	assert_string_equal(at.chip, "6000000.gpio:a");
}

static void what_is_no_line_is_refused(void **state)
{
	static const char *const bad[] = {
		"", "!", "x", "-1", "+1", "1x", "4096", "99999999999999999999",
		":5", "chip:", "chip:!5", "!!5", " 5",
		"a-chip-with-a-name-much-too-long-for-it:5",
	};
	struct config_line_at at;

	(void)state;
	for (size_t i = 0; i < COUNT(bad); i++)
		if (!config_line_read(bad[i], &at))
			fail_msg("'%s' was taken", bad[i]);
}

static void each_line_has_a_key_of_its_own(void **state)
{
	(void)state;
	for (int i = 0; i < CONFIG_NLINES; i++) {
		const int k = config_key_find(SECTION_GPIO,
					      config_line_name(i));

		assert_true(k >= 0);
		assert_int_equal(config_key(k)->kind, KEY_LINE);
		assert_int_equal(config_key(k)->offset,
				 offsetof(struct machine_config, gpio.line) +
				 (size_t)i * CONFIG_LINE_MAX);
	}
	assert_string_equal(config_line_name(LINE_STEP + INTERP_Z), "step_Z");
	assert_string_equal(config_line_name(LINE_HOME + INTERP_V), "home_V");
}

static void a_wired_machine_is_read(void **state)
{
	struct machine_config c;
	struct interp_diag d;

	(void)state;
	assert_int_equal(read_with("step_X = 2\ndir_X = !sim1:2\n"
				   "limit_X = 9\nhome_X = 9\n", &c, &d), 0);
	assert_int_equal(c.backend, BACKEND_GPIO);
	assert_int_equal(config_period_ns(&c), 50000);
	assert_false(config_gpio_has_gap(&c));
	assert_int_equal(read_with("step_X = 2\ndir_X = 3\ngap_open = 4\n"
				   "gap_short = 5\n[gap]\nsource = lines\n",
				   &c, &d), 0);
	assert_true(config_gpio_has_gap(&c));
	assert_int_equal(read_with("step_X = 2\ndir_X = 3\nspark = 4\n"
				   "watchdog_by = the generator times out\n"
				   "estop_by = contactor K1 cuts all\n",
				   &c, &d), 0);
}

static void what_does_not_agree_is_refused_with_the_remedy(void **state)
{
	static const struct {
		const char *text, *found, *wanted;
	} cases[] = {
		{ "step_X = 1\n", "axis.X is present and gpio.dir_X is none",
		  "gpio.dir_X = the number of a line" },
		{ "step_X = 1\ndir_X = gpiochip0:1\n",
		  "gpio.step_X and gpio.dir_X are both line 1",
		  "a line of its own" },
		{ "step_X = 1\ndir_X = 2\nestop = !2\n",
		  "gpio.dir_X and gpio.estop are both line 2",
		  "a line of its own" },
		{ "step_X = 1\ndir_X = 2\ngap_open = 3\n",
		  "without gpio.gap_short", "gap_open and gap_short" },
		{ "step_X = 1\ndir_X = 2\ngap_open = 3\ngap_short = 4\n",
		  "gap.source is sim and there are gap lines",
		  "source = lines" },
		{ "step_X = 1\ndir_X = 2\nadc = a\nadc_ratio = 0\n[gap]\n"
		  "source = voltage\n",
		  "gpio.adc_ratio is 0", "the divider" },
		{ "step_X = 1\ndir_X = 2\nspark = 3\nestop = 4\n",
		  "gpio.spark without gpio.watchdog", "or gpio.watchdog_by" },
		{ "step_X = 1\ndir_X = 2\nspark = 3\nwatchdog = 4\n",
		  "gpio.spark without gpio.estop", "or gpio.estop_by" },
		{ "step_X = 1\ndir_X = 2\nhigh_cycles = 2\n",
		  "axis.X.v_max_mm_s 10 mm/s is faster",
		  "at most 6.666666 mm/s" },
		{ "step_X = 1\ndir_X = 2\nencoder_X = 3 2\n",
		  "gpio.encoder_X \"3 2\" has a line that is used for "
		  "something else too",
		  "counter0/count0" },
		{ "step_X = 1\ndir_X = 2\nencoder_X = 3 gpiochip0:3\n",
		  "two chips", "two lines of one chip" },
		{ "step_X = 1\ndir_X = 2\nencoder_X = 3\n",
		  "has no line number", "two lines" },
		{ "step_X = 1\ndir_X = 2\nencoder_X = 3 !4\n", "has a !",
		  "two lines" },
		{ "step_X = 1\ndir_X = 2\nencoder_Y = 3 4\n",
		  "is of an axis that is not present", "two lines" },
		{ "step_X = 1\ndir_X = 2\nencoder_X = 3 4\n[axis.X]\n"
		  "encoder_counts = 0\n",
		  "has encoder_counts 0", "two lines" },
		{ "step_X = 1\ndir_X = two\n", "gpio.dir_X 'two' has no line",
		  "none, or [!][CHIP:]NUMBER" },
	};
	struct machine_config c;
	struct interp_diag d;

	(void)state;
	for (size_t i = 0; i < COUNT(cases); i++) {
		assert_int_equal(read_with(cases[i].text, &c, &d), -EINVAL);
		if (!strstr(d.found, cases[i].found) ||
		    !strstr(d.wanted, cases[i].wanted))
			fail_msg("%s\ngave %s; %s", cases[i].text, d.found,
				 d.wanted);
	}
}

static void an_encoder_is_two_lines_or_a_counter(void **state)
{
	struct config_encoder_at at;

	(void)state;
	assert_null(config_encoder_read("none", &at));
	assert_false(at.present);
	assert_null(config_encoder_read("sim0:24  sim0:25", &at));
	assert_true(at.present && at.lines);
	assert_int_equal(at.a.offset, 24);
	assert_int_equal(at.b.offset, 25);
	assert_string_equal(at.b.chip, "sim0");
	assert_null(config_encoder_read("counter1/count2", &at));
	assert_true(at.present && !at.lines);
	assert_string_equal(at.counter, "counter1/count2");
	assert_non_null(config_encoder_read("counter1/../../x", &at));
}

static void quadrature_is_twice_as_fast(void **state)
{
	struct machine_config c;
	struct interp_diag d;

	(void)state;
	assert_int_equal(read_with("step_X = 1\ndir_X = 2\nlow_cycles = 2\n",
				   &c, &d), -EINVAL);
	assert_int_equal(read_with("step_X = 1\ndir_X = 2\nlow_cycles = 2\n"
				   "signal = quadrature\n", &c, &d), 0);
}

/* Where one axis moves at a time, all axes share these points. */
static void it_makes_as_many_points_as_pulses(void **state)
{
	static const char lines[] = "step_X = 1\ndir_X = 2\n";
	struct machine_config c;
	struct interp_diag d;

	(void)state;
	assert_int_equal(read_with(lines, &c, &d), 0);
	assert_true(config_points_s(&c) == 10000);
	c.gpio.edges_per_period = 10;
	assert_true(config_points_s(&c) == 100000);
	c.gpio.edges_per_period = 1;
	c.gpio.signal = 1;
	assert_true(config_points_s(&c) == 20000);
	c.backend = BACKEND_SIM;
	assert_true(config_points_s(&c) > 1e6);
}

/* None of it is asked of a machine that has no lines. */
static void other_backends_need_no_lines(void **state)
{
	static const struct config_lines lines;
	struct machine_config c;
	struct interp_diag d;

	(void)state;
	assert_int_equal(read_with("step_X = 1\n", &c, &d), -EINVAL);
	config_defaults(&c);
	snprintf(c.gpio.line[LINE_STEP], sizeof(c.gpio.line[LINE_STEP]), "1");
	c.backend = BACKEND_SIM;
	assert_int_equal(config_check(&c, &lines, &d), 0);
	c.backend = BACKEND_GPIO;
	assert_int_equal(config_check(&c, &lines, &d), -EINVAL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_line_is_none_or_a_number_of_a_chip),
		cmocka_unit_test(what_is_no_line_is_refused),
		cmocka_unit_test(each_line_has_a_key_of_its_own),
		cmocka_unit_test(a_wired_machine_is_read),
		cmocka_unit_test(what_does_not_agree_is_refused_with_the_remedy),
		cmocka_unit_test(an_encoder_is_two_lines_or_a_counter),
		cmocka_unit_test(quadrature_is_twice_as_fast),
		cmocka_unit_test(it_makes_as_many_points_as_pulses),
		cmocka_unit_test(other_backends_need_no_lines),
	};

	return cmocka_run_group_tests_name("config/gpio", tests, make_file,
					   remove_file);
}
