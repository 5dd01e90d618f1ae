/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_encoder.c - an encoder on an axis of pulses: it counts, loses counts,
 * and makes up for them.  The lines are made by this file, the counter is a
 * file.
 */
#include "encoder.h"
#include "quadrature.h"

#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

/* -- Lines, in place of a chip's ------------------------------------------ */

struct lines {
	struct lines_event queue[256];
	int n, result;			/* result < 0: instead of events */
	uint8_t level[2];
};

static struct lines chip;
static uint64_t now;

int __wrap_lines_events(struct lines *l, struct lines_event *ret, int room);
int __wrap_lines_get(struct lines *l, uint8_t *value);
void __wrap_lines_release(struct lines *l);

/* Line by line, as from a file for each: their times are mixed. */
int __wrap_lines_events(struct lines *l, struct lines_event *ret, int room)
{
	int n = 0;

	if (l->result < 0)
		return l->result;
	for (int slot = 0; slot < 2; slot++)
		for (int i = 0; i < l->n; i++)
			if (l->queue[i].slot == slot)
				ret[n++] = l->queue[i];
	assert_in_range(n, 0, room);
	l->n = 0;
	return n;
}

int __wrap_lines_get(struct lines *l, uint8_t *value)
{
	memcpy(value, l->level, sizeof(l->level));
	return 0;
}

void __wrap_lines_release(struct lines *l)
{
	(void)l;
}

static void edge(int slot)
{
	chip.level[slot] ^= 1;
	chip.queue[chip.n++] = (struct lines_event) {
		.ns = ++now, .slot = (uint8_t)slot, .high = chip.level[slot],
	};
}

/* A quarter turn: A leads in the positive direction. */
static void turn(int sign)
{
	const bool same = chip.level[0] == chip.level[1];

	edge(same == (sign > 0) ? 0 : 1);
}

static int begin(void **state)
{
	(void)state;
	chip = (struct lines) { .level = { 1, 0 } };
	now = 0;
	return 0;
}

static void edges_are_counted_in_the_order_of_their_times(void **state)
{
	struct quadrature q;
	int64_t is = 0;

	(void)state;
	assert_int_equal(quadrature_edges(&q, &chip), 0);
	srand(7);
	for (int i = 0; i < 2000; i++) {
		const int64_t was = is;
		const int sign = rand() % 3 ? 1 : -1;

		for (int k = rand() % 15; k > 0; k--, is += sign)
			turn(sign);
		assert_true(quadrature_read(&q, ++now));
		/* Those of a period are used in the next. */
		assert_int_equal(q.count, was);
	}
	assert_true(quadrature_read(&q, ++now));
	assert_int_equal(q.count, is);
}

static void an_edge_that_is_missing_is_noticed(void **state)
{
	struct quadrature q;

	(void)state;
	quadrature_edges(&q, &chip);
	turn(1);
	chip.n = 0;			/* the kernel dropped it */
	for (int i = 0; i < 4; i++)
		turn(1);
	quadrature_read(&q, ++now);
	assert_false(quadrature_read(&q, ++now));
	quadrature_again(&q);
	turn(1);
	quadrature_read(&q, ++now);
	assert_true(quadrature_read(&q, ++now));
	chip.result = -EOVERFLOW;
	assert_false(quadrature_read(&q, ++now));
}

/* -- A counter ------------------------------------------------------------ */

static char root[] = "/tmp/test_encoder.XXXXXX";

static void file(const char *name, const char *text)
{
	char path[96];
	FILE *f;

	snprintf(path, sizeof(path), "%s/counter0/count0/%s", root, name);
	f = fopen(path, "w");
	assert_non_null(f);
	fputs(text, f);
	fclose(f);
}

static int counter_make(void **state)
{
	char path[64];

	(void)state;
	assert_non_null(mkdtemp(root));
	snprintf(path, sizeof(path), "%s/counter0", root);
	mkdir(path, 0755);
	snprintf(path, sizeof(path), "%s/counter0/count0", root);
	return mkdir(path, 0755);
}

static int counter_drop(void **state)
{
	char command[64];

	(void)state;
	snprintf(command, sizeof(command), "rm -r %s", root);
	return system(command);
}

static void a_counter_counts_round(void **state)
{
	static const struct {
		const char *raw;
		int64_t count;
	} row[] = {
		{ "65530\n", -4 }, { "65534\n", 0 }, { "3\n", 5 },
		{ "32000\n", 32002 }, { "60000\n", 60002 }, { "3\n", 65541 },
	};
	struct interp_diag d;
	struct quadrature q;

	(void)state;
	file("count", "65534\n");
	file("ceiling", "65535\n");
	file("enable", "1\n");
	assert_int_equal(quadrature_counter(&q, root, "counter0/count0", &d),
			 0);
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		file("count", row[i].raw);
		assert_true(quadrature_read(&q, 0));
		assert_int_equal(q.count, row[i].count);
	}
	file("count", "gone\n");
	assert_false(quadrature_read(&q, 0));
	quadrature_close(&q);
}

static void a_counter_that_is_not_there_or_off_is_refused(void **state)
{
	struct interp_diag d;
	struct quadrature q;

	(void)state;
	assert_int_equal(quadrature_counter(&q, root, "counter3/count0", &d),
			 -ENOENT);
	assert_non_null(strstr(d.found, "counter3/count0"));
	quadrature_close(&q);
	file("count", "1\n");
	file("enable", "0\n");
	assert_int_equal(quadrature_counter(&q, root, "counter0/count0", &d),
			 -ENODATA);
	assert_non_null(strstr(d.wanted, "enable"));
	quadrature_close(&q);
}

/* -- What it means -------------------------------------------------------- */

struct axis {
	struct encoder e;
	int32_t target, put;
	int64_t stuck;			/* pulses that moved nothing */
	int64_t by;			/* of what the pulser counts from */
};

static const struct encoder_config config = {
	.counts = -8, .pulses = 3, .following_max = 10,
};

static void period(struct axis *a)
{
	a->put += a->target > a->put ? 1 : a->target < a->put ? -1 : 0;
	encoder_look(&a->e, (a->put - a->by - a->stuck) * -8 / 3 + 1000, true,
		     a->put, true);
}

static void run(struct axis *a, int periods)
{
	while (periods-- > 0)
		period(a);
}

static struct axis at_rest(int32_t put)
{
	struct axis a = { .target = put, .put = put };

	encoder_init(&a.e, &config);
	run(&a, 3);
	assert_false(a.e.too_far);
	return a;
}

static void it_goes_along_with_the_pulses(void **state)
{
	struct axis a = at_rest(500);

	(void)state;
	for (int i = 0; i < 5; i++) {
		a.target = i % 2 ? -3000 : 4000;
		run(&a, 8000);
		assert_false(a.e.too_far);
		assert_in_range(a.e.at - a.put + 1, 0, 2);
	}
	/* Another program counts from elsewhere. */
	a.target = a.put += 70;
	a.by = 70;
	encoder_shift(&a.e, 70);
	run(&a, 10);
	assert_false(a.e.too_far);
	assert_in_range(a.e.at - a.put + 1, 0, 2);
}

static void an_axis_that_lost_pulses_is_where_the_encoder_says(void **state)
{
	struct axis a = at_rest(0);

	(void)state;
	a.target = 100;
	run(&a, 200);
	a.stuck = 30;			/* it stalled for 30 of them */
	run(&a, 2);
	assert_true(a.e.too_far);
	assert_in_range(a.e.at, 69, 71);
	run(&a, 100);
	assert_true(a.e.too_far);
	assert_false(encoder_reset(&a.e));
	/* The pulses count from there on, and none is put out. */
	a.stuck = 0;
	a.target = a.put = a.e.at;
	run(&a, 100);
	assert_false(a.e.too_far);
	a.target = 0;
	run(&a, 300);
	assert_false(a.e.too_far);
}

static void missed_counts_lose_the_place(void **state)
{
	struct axis a = at_rest(0);

	(void)state;
	encoder_look(&a.e, a.e.count, false, a.put, true);
	assert_true(a.e.too_far && a.e.ill);
	assert_true(encoder_reset(&a.e));
	assert_false(a.e.too_far);
}

static void a_fast_axis_may_lag_and_a_standing_one_may_not(void **state)
{
	struct encoder e;
	const struct encoder_config c = { .counts = 1, .pulses = 1,
					  .following_max = 2,
					  .lag_cycles = 5 };

	(void)state;
	encoder_init(&e, &c);
	encoder_look(&e, 0, true, 0, true);
	/* 10 pulses a period, four periods behind. */
	for (int i = 1; i < 20; i++)
		encoder_look(&e, i < 4 ? 0 : 10 * (i - 4), true, 10 * i,
			     true);
	assert_false(e.too_far);
	for (int i = 0; i < 100; i++)
		encoder_look(&e, 150, true, 190, true);
	assert_true(e.too_far);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup(
			edges_are_counted_in_the_order_of_their_times, begin),
		cmocka_unit_test_setup(an_edge_that_is_missing_is_noticed,
				       begin),
		cmocka_unit_test(a_counter_counts_round),
		cmocka_unit_test(a_counter_that_is_not_there_or_off_is_refused),
		cmocka_unit_test(it_goes_along_with_the_pulses),
		cmocka_unit_test(an_axis_that_lost_pulses_is_where_the_encoder_says),
		cmocka_unit_test(missed_counts_lose_the_place),
		cmocka_unit_test(a_fast_axis_may_lag_and_a_standing_one_may_not),
	};

	return cmocka_run_group_tests(tests, counter_make, counter_drop);
}
