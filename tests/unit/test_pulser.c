/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_pulser.c - levels on step and direction lines, read as a drive reads
 * them
 */
#include "pulser.h"
#include "seed.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define PERIODS		200000

/* A drive: counts steps, and measures what stands still around them. */
struct drive {
	int32_t at[IO_NAXES];
	uint32_t step, dir;		/* levels a period ago */
	uint32_t since_rise[IO_NAXES], since_fall[IO_NAXES];
	uint32_t since_dir[IO_NAXES];
	uint32_t high, low, setup, hold;	/* the least seen */
};

static uint32_t least(uint32_t a, uint32_t b)
{
	return a < b ? a : b;
}

static void drive_init(struct drive *d)
{
	memset(d, 0, sizeof(*d));
	for (int i = 0; i < IO_NAXES; i++)
		d->since_rise[i] = d->since_fall[i] = d->since_dir[i] = 1000;
	d->high = d->low = d->setup = d->hold = 1000;
}

static void drive_axis(struct drive *d, const struct pulser *p, int i)
{
	const bool step = p->step >> i & 1, was = d->step >> i & 1;
	const bool dir = p->dir >> i & 1;

	d->since_rise[i]++;
	d->since_fall[i]++;
	d->since_dir[i]++;
	if (dir != (d->dir >> i & 1)) {
		assert_false(was);
		d->hold = least(d->hold, d->since_fall[i]);
		d->since_dir[i] = 0;
	}
	if (step && !was) {
		d->low = least(d->low, d->since_fall[i]);
		d->setup = least(d->setup, d->since_dir[i]);
		d->since_rise[i] = 0;
		d->at[i] += dir ? 1 : -1;
	}
	if (!step && was) {
		d->high = least(d->high, d->since_rise[i]);
		d->since_fall[i] = 0;
	}
}

static void drive_see(struct drive *d, const struct pulser *p)
{
	for (int i = 0; i < IO_NAXES; i++)
		drive_axis(d, p, i);
	d->step = p->step;
	d->dir = p->dir;
}

/* An encoder's counter: A and B never change at once. */
static void encoder_see(struct drive *d, const struct pulser *p)
{
	static const int8_t turns[2][2] = { { 0, 3 }, { 1, 2 } };

	for (int i = 0; i < IO_NAXES; i++) {
		const int now = turns[p->step >> i & 1][p->dir >> i & 1];
		const int was = turns[d->step >> i & 1][d->dir >> i & 1];
		const int moved = (now - was + 4) % 4;

		assert_int_not_equal(moved, 2);
		d->at[i] += moved == 3 ? -1 : moved;
	}
	d->step = p->step;
	d->dir = p->dir;
}

static unsigned int seed;

static int set_seed(void **state)
{
	(void)state;
	seed = (unsigned int)seed_take();
	return 0;
}

/* A point or none, as the cycle gives them: none while busy. */
static void next_point(const struct pulser *p, int32_t *target)
{
	if (pulser_busy(p) || rand_r(&seed) % 3 == 0)
		return;
	for (int i = 0; i < IO_NAXES; i++)
		target[i] += (int)(rand_r(&seed) % 3) - 1;
}

static struct pulser_config random_config(void)
{
	return (struct pulser_config) {
		.high = 1 + (uint32_t)rand_r(&seed) % 4,
		.low = 1 + (uint32_t)rand_r(&seed) % 4,
		.dir_setup = 1 + (uint32_t)rand_r(&seed) % 4,
		.dir_hold = 1 + (uint32_t)rand_r(&seed) % 4,
	};
}

static void finish(struct pulser *p, struct drive *d, const int32_t *target,
		   void (*see)(struct drive *, const struct pulser *))
{
	for (int n = 0; n < 20; n++) {
		pulser_period(p, target);
		see(d, p);
	}
	assert_memory_equal(p->put, target, sizeof(p->put));
	assert_memory_equal(d->at, target, sizeof(d->at));
	assert_false(pulser_busy(p));
}

static void steps_add_up_and_keep_their_times(void **state)
{
	(void)state;
	for (int run = 0; run < 20; run++) {
		const struct pulser_config c = random_config();
		int32_t target[IO_NAXES] = { 0 };
		struct drive d;
		struct pulser p;

		pulser_init(&p, &c);
		drive_init(&d);
		for (int n = 0; n < PERIODS / 20; n++) {
			next_point(&p, target);
			pulser_period(&p, target);
			drive_see(&d, &p);
		}
		finish(&p, &d, target, drive_see);
		assert_int_equal(d.high, c.high);
		assert_true(d.low >= c.low);
		assert_int_equal(d.setup, c.dir_setup);
		assert_true(d.hold >= c.dir_hold);
	}
}

static void quarters_add_up_one_line_at_a_time(void **state)
{
	const struct pulser_config c = { .high = 1, .quadrature = true };
	int32_t target[IO_NAXES] = { 0 };
	struct drive d;
	struct pulser p;

	(void)state;
	pulser_init(&p, &c);
	drive_init(&d);
	for (int n = 0; n < PERIODS; n++) {
		next_point(&p, target);
		pulser_period(&p, target);
		encoder_see(&d, &p);
	}
	finish(&p, &d, target, encoder_see);
}

/* A point each time it may: no period is wasted. */
static void straight_on_it_pulses_as_fast_as_it_says(void **state)
{
	static const struct pulser_config configs[] = {
		{ 1, 1, 1, 1, false, 0, 0, 0 }, { 3, 2, 1, 4, false, 0, 0, 0 },
		{ 1, 1, 1, 1, true, 0, 0, 0 }, { 2, 1, 1, 1, true, 0, 0, 0 },
	};

	(void)state;
	for (size_t i = 0; i < sizeof(configs) / sizeof(configs[0]); i++) {
		int32_t target[IO_NAXES] = { 0 };
		struct pulser p;

		pulser_init(&p, &configs[i]);
		for (int n = 0; n < 6000; n++) {
			target[0] += !pulser_busy(&p);
			pulser_period(&p, target);
		}
		assert_in_range((uint32_t)p.put[0] *
					pulser_periods(&configs[i]),
				5980, 6000);
	}
}

static void axes_of_one_point_step_in_one_period(void **state)
{
	const struct pulser_config c = { 2, 1, 3, 1, false, 0, 0, 0 };
	const int32_t target[IO_NAXES] = { 1, -1, 0, 1 };
	struct pulser p;

	(void)state;
	pulser_init(&p, &c);
	for (int n = 0; n < 3; n++) {
		pulser_period(&p, target);
		assert_int_equal(p.dir, 0x9);
		assert_int_equal(p.step, 0);
	}
	pulser_period(&p, target);
	assert_int_equal(p.step, 0xb);
}

static void standing_elsewhere_by_word_makes_no_pulse(void **state)
{
	const struct pulser_config c = { 1, 1, 1, 1, false, 0, 0, 0 };
	const int32_t at[IO_NAXES] = { 1000000, -5 };
	struct pulser p;

	(void)state;
	pulser_init(&p, &c);
	pulser_stand_at(&p, at);
	for (int n = 0; n < 10; n++) {
		pulser_period(&p, at);
		assert_int_equal(p.step | p.dir, 0);
		assert_false(pulser_busy(&p));
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(steps_add_up_and_keep_their_times),
		cmocka_unit_test(quarters_add_up_one_line_at_a_time),
		cmocka_unit_test(straight_on_it_pulses_as_fast_as_it_says),
		cmocka_unit_test(axes_of_one_point_step_in_one_period),
		cmocka_unit_test(standing_elsewhere_by_word_makes_no_pulse),
	};

	return cmocka_run_group_tests_name("io/pulser", tests, set_seed, NULL);
}
