/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_generator_dac.c - values by converters of industrial I/O, as files of a
 * folder: which count is written, when it is in force, what is refused
 */
#include "generator_help.h"

#include <sys/resource.h>
#include <sys/stat.h>

#define WAITS_MOST	20000

static char root[] = "/tmp/test_generator_dac.XXXXXX";

static const char layout[] =
	"[machine]\nbackend = null\nperiod_us = 1000\n[generator]\n"
	"interface = lines\nsettle_ms = 5\nconfirm_s = 0.05\n"
	"peak_a = dac dac1 voltage0 scale 6 to 10\n"
	"ignition_v = dac iio:device1 current0 scale 20 zero 4 to 20\n";

static const char *at(const char *name)
{
	static char full[192];

	snprintf(full, sizeof(full), "%s/%s", root, name);
	return full;
}

static void file(const char *name, const char *text)
{
	FILE *f = fopen(at(name), "w");

	assert_non_null(f);
	fputs(text, f);
	fclose(f);
}

static long has(const char *name)
{
	char line[64] = "";
	FILE *f = fopen(at(name), "r");

	assert_non_null(f);
	assert_non_null(fgets(line, sizeof(line), f));
	fclose(f);
	return strtol(line, NULL, 10);
}

#define PEAK		"iio:device0/out_voltage0_raw"
#define IGNITION	"iio:device1/out_current0_raw"

/* 12 bits over 10 V; 16 bits over 0 to 24 mA, which begin at -32768. */
static void devices_make(void)
{
	mkdir(at("iio:device0"), 0700);
	mkdir(at("iio:device1"), 0700);
	file("iio:device0/name", "dac1\n");
	file(PEAK, "77\n");
	file("iio:device0/out_voltage0_scale", "2.442002442\n");
	file("iio:device0/out_voltage0_raw_available", "[0 1 4095]\n");
	file("iio:device0/out_voltage0_powerdown", "1\n");
	file("iio:device0/in_voltage1_raw", "5\n");
	file("iio:device1/name", "dac2\n");
	file(IGNITION, "0\n");
	file("iio:device1/out_current_scale", "0.0003662109375\n");
	file("iio:device1/out_current_offset", "32768\n");
}

static int make(void **state)
{
	if (!mkdtemp(root))
		return -1;
	devices_make();
	return make_file(state);
}

static int unmake_all(void **state)
{
	char command[128];

	snprintf(command, sizeof(command), "rm -r %s", root);
	return system(command) || remove_file(state);
}

static void period(struct shop *s)
{
	s->axes.read(s->axes.self, &s->r.in);
	s->axes.write(s->axes.self, &s->r.out);
	s->r.out.reset = false;
}

/* The thread needs the time that it needs. */
static bool is_in_force(struct shop *s)
{
	for (int i = 0; i < WAITS_MOST; i++) {
		period(s);
		if (s->r.in.generator.trouble)
			return false;
		if (s->r.in.generator.in_force == s->r.out.asked)
			return true;
		usleep(200);
	}
	return false;
}

static void ask(struct shop *s, double peak_a, double ignition_v)
{
	s->r.out.pulse[INTERP_TECH_PEAK_A] = peak_a;
	s->r.out.pulse[INTERP_TECH_IGNITION_V] = ignition_v;
	s->r.out.asked++;
}

static struct generator *shop_of(struct shop *s, const char *text)
{
	struct interp_diag d = { .line = 0 };
	struct generator *g = shop_generator(s, text);

	if (generator_dac_open(g, root, &d) != 0)
		fail_msg("%s; %s", d.found, d.wanted);
	io_pulse_own(&s->r.out);
	/* Late is late by the clock of the cycle, and this one turns fast. */
	g->confirm = UINT32_MAX;
	return g;
}

static struct generator *shop_dac(struct shop *s)
{
	return shop_of(s, layout);
}

static void it_begins_and_ends_at_zero(void **state)
{
	struct shop s;

	(void)state;
	shop_dac(&s);
	assert_int_equal(has(PEAK), 0);
	assert_int_equal(has("iio:device0/out_voltage0_powerdown"), 0);
	assert_int_equal(has(IGNITION), lround(4 / 0.0003662109375) - 32768);
	ask(&s, 30, 180);
	assert_true(is_in_force(&s));
	assert_true(has(PEAK) > 0);
	s.axes.close(s.axes.self);
	assert_int_equal(has(PEAK), 0);
	assert_int_equal(has(IGNITION), lround(4 / 0.0003662109375) - 32768);
}

/* 30 A are 5 V; never more than was asked for. */
static void a_value_is_the_count_that_makes_it(void **state)
{
	struct shop s;

	(void)state;
	shop_dac(&s);
	ask(&s, 30, 180);
	assert_true(is_in_force(&s));
	assert_int_equal(has(PEAK), 2047);
	assert_int_equal(has(IGNITION), lround(13 / 0.0003662109375) - 32768);
	for (double a = 0.1; a <= 60; a += 0.37) {
		ask(&s, a, NAN);
		assert_true(is_in_force(&s));
		assert_true((double)has(PEAK) * 2.442002442e-3 * 6 <=
			    a + 1e-6);
		assert_true((double)(has(PEAK) + 1) * 2.442002442e-3 * 6 > a);
	}
	assert_int_equal(has(IGNITION), lround(4 / 0.0003662109375) - 32768);
	s.axes.close(s.axes.self);
}

/* A count up is a step down. */
static void a_device_that_counts_down_gives_no_more_current_either(void **state)
{
	struct shop s;

	(void)state;
	file("iio:device0/out_voltage0_scale", "-2.5\n");
	file("iio:device0/out_voltage0_offset", "-4095\n");
	shop_dac(&s);
	assert_int_equal(has(PEAK), 4095);
	ask(&s, 30.01, NAN);
	assert_true(is_in_force(&s));
	assert_int_equal(has(PEAK), 4095 - 2000);
	s.axes.close(s.axes.self);
	devices_make();
	unlink(at("iio:device0/out_voltage0_offset"));
}

static void it_is_in_force_settle_ms_after_it_is_there(void **state)
{
	struct shop s;
	int there = 0;

	(void)state;
	shop_dac(&s);
	ask(&s, 12, 100);
	for (int i = 0; i < WAITS_MOST && there < 1; i++) {
		period(&s);
		there += has(PEAK) == 819;
		assert_int_not_equal(s.r.in.generator.in_force, s.r.out.asked);
	}
	/* It was there before the last period; from there on 5 ms. */
	for (int i = 0; i < 4; i++) {
		period(&s);
		assert_int_not_equal(s.r.in.generator.in_force, s.r.out.asked);
	}
	assert_true(is_in_force(&s));
	s.axes.close(s.axes.self);
}

/* A step is 14.65 mA.  It tells the nearest 1 mA. */
static void what_it_tells_is_a_step_beside_it_or_within(void **state)
{
	static const struct {
		const char *within;
		uint64_t told_ma;
		bool is_that;
	} rows[] = {
		{ "", 6000, true }, { "", 5985, true }, { "", 6015, true },
		{ "", 5984, false }, { "", 6016, false },
		{ "within 0.2", 5786, true }, { "within 0.2", 5784, false },
	};

	(void)state;
	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		struct shop s;
		struct generator *g;
		char text[400];

		snprintf(text, sizeof(text), "[machine]\nbackend = null\n"
			 "period_us = 1000\n[generator]\ninterface = can\n"
			 "settle_ms = 5\nsilent_ms = 60000\n"
			 "peak_a = dac dac1 voltage0 scale 6 to 10\n"
			 "told_peak_a = can 1011 byte 0 scale 0.001 %s\n",
			 rows[i].within);
		g = shop_of(&s, text);
		ask(&s, 6, NAN);
		period(&s);
		for (int n = 0; n < WAITS_MOST && generator_dac_waits(g); n++) {
			period(&s);
			usleep(200);
		}
		for (int n = 0; n < 20; n++) {
			generator_hears(g, INTERP_TECH_PEAK_A, rows[i].told_ma);
			period(&s);
		}
		assert_int_equal(s.r.in.generator.in_force == s.r.out.asked,
				 rows[i].is_that);
		s.axes.close(s.axes.self);
	}
}

static bool log_has(struct shop *s, const char *text)
{
	char line[160];
	bool any = false;

	while (s->axes.note(s->axes.self, line, sizeof(line)))
		any = any || strstr(line, text);
	return any;
}

static void one_that_fails_is_trouble_until_a_reset(void **state)
{
	const struct rlimit none = { 0, RLIM_INFINITY };
	const struct rlimit any = { RLIM_INFINITY, RLIM_INFINITY };
	struct shop s;

	(void)state;
	shop_dac(&s);
	ask(&s, 12, 100);
	assert_true(is_in_force(&s));
	assert_int_equal(setrlimit(RLIMIT_FSIZE, &none), 0);
	ask(&s, 18, 100);
	assert_false(is_in_force(&s));
	assert_true(s.r.in.generator.trouble);
	assert_int_equal(setrlimit(RLIMIT_FSIZE, &any), 0);
	assert_true(log_has(&s, "the converter of peak_a: asked 18: File too "
				"large"));
	s.r.out.reset = true;
	period(&s);
	assert_true(is_in_force(&s));
	assert_int_equal(has(PEAK), 1228);
	s.axes.close(s.axes.self);
}

/* -- What cannot be -------------------------------------------------------- */

static const struct {
	const char *ways;
	const char *found, *wanted;
} refusals[] = {
	{ "peak_a = dac dac7 voltage0 to 10\n", "generator.peak_a: dac7: No "
	  "such device", "iio:deviceN" },
	{ "peak_a = dac dac1 voltage1 to 10\n", "out_voltage1_raw: No such "
	  "file", "a channel that is an output" },
	{ "peak_a = dac dac1 current0 to 10\n", "out_current0_raw: No such "
	  "file", "a channel that is an output" },
	{ "peak_a = dac dac1 voltage0 to 12\n", "gives no 0 V to 12 V",
	  "between 0 V and 10 V" },
	{ "peak_a = dac dac1 voltage0 zero -1 to 5\n", "gives no -1 V to 5 V",
	  "between 0 V and 10 V" },
	{ "peak_a = dac dac1 voltage0 to 10\n"
	  "ignition_v = dac iio:device0 voltage0 scale 30 to 10\n",
	  "generator.ignition_v: ", "a channel of its own" },
	{ "peak_a = dac twin voltage0 to 10\n", "twin: Name not unique",
	  "lists once" },
	{ "peak_a = dac dac3 voltage0 to 10\n", "its scale is 0 a count",
	  "a scale that is not 0" },
	{ "peak_a = dac dac4 voltage0 to 10\n", "No space left",
	  "a device that takes what is written" },
};

static void what_cannot_be_is_refused_and_nothing_is_driven(void **state)
{
	(void)state;
	mkdir(at("iio:device3"), 0700);
	file("iio:device3/name", "dac3\n");
	file("iio:device3/out_voltage0_raw", "0\n");
	file("iio:device3/out_voltage_scale", "0\n");
	for (int i = 5; i < 7; i++) {
		char folder[32];

		snprintf(folder, sizeof(folder), "iio:device%d", i);
		mkdir(at(folder), 0700);
		strcat(folder, "/name");
		file(folder, "twin\n");
	}
	mkdir(at("iio:device4"), 0700);
	file("iio:device4/name", "dac4\n");
	assert_int_equal(symlink("/dev/full",
				 at("iio:device4/out_voltage0_raw")), 0);
	for (size_t i = 0; i < COUNT(refusals); i++) {
		struct interp_diag d = { .line = 0 };
		struct io_machine axes;
		struct generator *g;
		struct shop s;
		char text[700];

		snprintf(text, sizeof(text), "[machine]\nbackend = null\n"
			 "[generator]\ninterface = lines\n%s",
			 refusals[i].ways);
		g = shop_generator(&s, text);
		axes = g->axes;
		assert_true(generator_dac_open(g, root, &d) < 0);
		if (!strstr(d.found, refusals[i].found) ||
		    !strstr(d.wanted, refusals[i].wanted))
			fail_msg("%s; %s", d.found, d.wanted);
		generator_dac_close(g);
		axes.close(axes.self);
		generator_forget(g);
		assert_int_equal(has(PEAK), 0);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(it_begins_and_ends_at_zero),
		cmocka_unit_test(a_value_is_the_count_that_makes_it),
		cmocka_unit_test(
			a_device_that_counts_down_gives_no_more_current_either),
		cmocka_unit_test(it_is_in_force_settle_ms_after_it_is_there),
		cmocka_unit_test(what_it_tells_is_a_step_beside_it_or_within),
		cmocka_unit_test(one_that_fails_is_trouble_until_a_reset),
		cmocka_unit_test(
			what_cannot_be_is_refused_and_nothing_is_driven),
	};

	return cmocka_run_group_tests(tests, make, unmake_all);
}
