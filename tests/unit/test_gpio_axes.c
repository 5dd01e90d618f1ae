/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_gpio_axes.c - lines of power and brakes, and an encoder behind them
 */
#include "gpio_own.h"
#include "clocks.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#define BRAKE	4			/* periods */
#define ENABLE	(UINT64_C(1) << LINE_ENABLE)
#define BRAKE_Z	(UINT64_C(1) << (LINE_BRAKE + 2))

struct rig {
	struct gpio g;
	struct io_inputs in;
	struct io_outputs out;
	FILE *count;			/* a counter's file */
};

/* As io_gpio_open() leaves it, without a chip. */
static int make(void **state)
{
	struct rig *r = calloc(1, sizeof(*r));

	assert_non_null(r);
	for (int i = 0; i < IO_NAXES; i++)
		r->g.quadrature[i].fd = -1;
	r->g.has_power = true;
	r->g.brake_periods = BRAKE;
	r->g.open_left = BRAKE + 1;
	*state = r;
	return 0;
}

static int drop(void **state)
{
	struct rig *r = *state;

	if (r->count)
		fclose(r->count);
	free(r);
	return 0;
}

static void period(struct rig *r)
{
	r->in = (struct io_inputs) { .trouble = IO_WELL };
	gpio_axes_read(&r->g, &r->in);
	r->g.out = gpio_axes_write(&r->g, &r->out);
	r->out.reset = false;
}

static int periods_until(struct rig *r, bool off)
{
	int n = 0;

	for (period(r); r->in.axes_off != off && n < 100; n++)
		period(r);
	return n;
}

static void brakes_open_under_power_and_close_before_it_goes(void **state)
{
	struct rig *r = *state;

	period(r);
	assert_true(r->in.axes_off && r->g.out == 0);
	r->out.enable = true;
	period(r);
	assert_true(r->g.out & ENABLE && r->g.out & BRAKE_Z);
	assert_in_range(periods_until(r, false), BRAKE - 1, BRAKE + 1);
	r->out.enable = false;
	for (int i = 0; i < BRAKE; i++) {
		period(r);
		assert_true(r->g.out == ENABLE);
		assert_true(i == 0 || r->in.axes_off);
	}
	period(r);
	assert_true(r->g.out == 0);
}

static void power_that_comes_back_while_brakes_close_waits_for_them(
	void **state)
{
	struct rig *r = *state;

	r->out.enable = true;
	periods_until(r, false);
	r->out.enable = false;
	period(r);
	r->out.enable = true;
	period(r);
	assert_in_range(periods_until(r, false), BRAKE - 1, BRAKE + 1);
	/* A chip that is gone takes the power away. */
	r->g.lost = true;
	period(r);
	assert_false(r->g.out & BRAKE_Z);
}

static void without_such_lines_there_always_is_power(void **state)
{
	struct rig *r = *state;

	r->g.has_power = false;
	period(r);
	assert_false(r->in.axes_off);
}

static void counts(struct rig *r, int n)
{
	rewind(r->count);
	fprintf(r->count, "%d\n", n);
	fflush(r->count);
}

static bool told(struct rig *r, const char *what)
{
	char line[160] = "";
	const bool said = gpio_note(&r->g, line, sizeof(line));

	return said && strstr(line, what);
}

/* An encoder on Z, a count a pulse. */
static void with_encoder(struct rig *r, int n)
{
	const struct encoder_config c = { .counts = 1, .pulses = 1,
					  .following_max = 5 };

	r->count = tmpfile();
	assert_non_null(r->count);
	counts(r, n);
	r->g.has_power = false;
	r->g.encoders = 1u << 2;
	r->g.quadrature[2] = (struct quadrature) {
		.fd = fileno(r->count), .round = UINT64_C(1) << 32,
		.raw = (uint64_t)n,
	};
	encoder_init(&r->g.encoder[2], &c);
	r->out.enable = true;
	period(r);
	period(r);
	assert_false(r->in.axes_off);
}

static void an_axis_that_is_off_is_a_trouble_until_a_reset(void **state)
{
	struct rig *r = *state;

	with_encoder(r, 1000);
	counts(r, 990);
	period(r);
	assert_int_equal(r->in.trouble, IO_FOLLOWING);
	assert_int_equal(r->in.actual[2], -10);
	assert_true(told(r, "axis Z: by its encoder"));
	r->out.enable = false;		/* as the cycle does */
	r->out.reset = true;
	period(r);
	period(r);
	assert_true(r->in.axes_off && r->in.unplaced == 0);
	assert_int_equal(r->in.stands_at[2], -10);
}

static void one_that_missed_counts_has_lost_its_place(void **state)
{
	struct rig *r = *state;

	with_encoder(r, 0);
	r->g.encoder[2].ill = true;
	period(r);
	assert_true(told(r, "axis Z: counts of its encoder were missed"));
	r->out.reset = true;
	period(r);
	period(r);
	assert_int_equal(r->in.trouble, IO_WELL);
	assert_int_equal(r->in.unplaced, 1u << 2);
	assert_true(told(r, "axis Z: its place is lost"));
	assert_false(told(r, ""));
	period(r);
	assert_int_equal(r->in.unplaced, 0);
}

/* The cycle wakes at any time: after most of a period, or at once. */
static void levels_of_its_own_writes_last_as_long_as_the_file_says(void **state)
{
	static const struct pulser_config c = { 1, 1, 1, 1, false,
						200000, 100000, 50000 };
	struct rig *r = *state;
	int64_t since = 0;
	bool high = false;

	for (int i = 0; i < CONFIG_NLINES; i++)
		r->g.at[i].chip = -1;
	r->g.has_power = false;
	r->g.adc.fd = -1;
	pulser_init(&r->g.pulser, &c);
	gpio_read(&r->g, &r->in);
	gpio_write(&r->g, &r->out);
	r->out.target[0] = 20;
	while (r->g.pulser.put[0] < 20 || high) {
		const int64_t before = clock_ns(CLOCK_MONOTONIC);

		gpio_read(&r->g, &r->in);
		gpio_write(&r->g, &r->out);
		if (high == (r->g.pulser.step & 1))
			continue;
		assert_true(since == 0 ||
			    clock_ns(CLOCK_MONOTONIC) - since >=
				    (high ? c.high_ns : c.low_ns));
		since = before;
		high = !high;
	}
}

int main(void)
{
#define TEST(name)	cmocka_unit_test_setup_teardown(name, make, drop)
	const struct CMUnitTest tests[] = {
		TEST(brakes_open_under_power_and_close_before_it_goes),
		TEST(power_that_comes_back_while_brakes_close_waits_for_them),
		TEST(without_such_lines_there_always_is_power),
		TEST(levels_of_its_own_writes_last_as_long_as_the_file_says),
		TEST(an_axis_that_is_off_is_a_trouble_until_a_reset),
		TEST(one_that_missed_counts_has_lost_its_place),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
