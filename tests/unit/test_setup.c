/* SPDX-License-Identifier: Apache-2.0 */
/* test_setup.c - how the clock counts periods, and the real-time report */
#include "clock.h"
#include "clocks.h"
#include "rt.h"

#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define MS	1000000LL

static void a_wake_in_time_is_followed_by_one_a_period_later(void **state)
{
	struct setup_clock c = { .period_ns = MS, .next_ns = 10 * MS };
	struct setup_wake w = setup_clock_woke(&c, 10 * MS);

	(void)state;
	assert_int_equal(w.late_ns, 0);
	assert_int_equal(w.missed, 0);
	assert_int_equal(c.next_ns, 11 * MS);
}

static void lateness_within_a_period_is_not_carried_on(void **state)
{
	struct setup_clock c = { .period_ns = MS, .next_ns = 10 * MS };

	(void)state;
	for (int n = 0; n < 1000; n++) {
		int64_t due = c.next_ns;
		struct setup_wake w = setup_clock_woke(&c, due + MS - 1);

		assert_int_equal(w.late_ns, MS - 1);
		assert_int_equal(w.missed, 0);
		assert_int_equal(c.next_ns, due + MS);
	}
}

static void missed_periods_are_counted_and_skipped(void **state)
{
	struct setup_clock c = { .period_ns = MS, .next_ns = 10 * MS };
	struct setup_wake w = setup_clock_woke(&c, 13 * MS + 5);

	(void)state;
	assert_int_equal(w.late_ns, 3 * MS + 5);
	assert_int_equal(w.missed, 3);
	assert_int_equal(c.next_ns, 14 * MS);
	w = setup_clock_woke(&c, 15 * MS);
	assert_int_equal(w.missed, 1);
	assert_int_equal(c.next_ns, 16 * MS);
}

static void every_period_is_either_a_wake_or_missed(void **state)
{
	struct setup_clock c = { .period_ns = 50000, .next_ns = 50000 };
	int64_t now = 0;
	uint64_t wakes = 0, missed = 0;

	(void)state;
	srand(1);
	while (wakes < 100000) {
		struct setup_wake w;

		if (now < c.next_ns)
			now = c.next_ns;
		now += rand() % 400000 * (rand() % 10 == 0);
		w = setup_clock_woke(&c, now);
		wakes++;
		missed += w.missed;
		assert_int_equal(c.next_ns % c.period_ns, 0);
		assert_int_equal((uint64_t)(c.next_ns / c.period_ns),
				 wakes + missed + 1);
		assert_true(c.next_ns > now && c.next_ns <= now + c.period_ns);
	}
	assert_true(missed > 1000);
}

static void the_wait_wakes_when_due_and_not_before(void **state)
{
	struct setup_clock c;

	(void)state;
	setup_clock_start(&c, MS / 2);
	assert_int_equal(c.next_ns % (MS / 2), MS / 4);
	assert_in_range(c.next_ns, clock_ns(CLOCK_MONOTONIC) - MS / 2,
			clock_ns(CLOCK_MONOTONIC) + MS);
	for (int n = 0; n < 20; n++) {
		int64_t due = c.next_ns;
		struct setup_wake w = setup_clock_wait(&c);

		assert_true(w.woke_ns >= due);
		assert_int_equal(w.late_ns, w.woke_ns - due);
	}
}

static void a_latency_falls_into_its_microsecond(void **state)
{
	(void)state;
	assert_int_equal(setup_latency_bin(-1, 256), 0);
	assert_int_equal(setup_latency_bin(999, 256), 0);
	assert_int_equal(setup_latency_bin(1000, 256), 1);
	assert_int_equal(setup_latency_bin(254999, 256), 254);
	assert_int_equal(setup_latency_bin(255000, 256), 255);
	assert_int_equal(setup_latency_bin(INT64_MAX, 256), 255);
}

static void *set_up_thread(void *arg)
{
	/* No host has this core or this priority. */
	struct setup_wanted w = { .cpu = 1023, .priority = 1000 };

	setup_thread(arg, &w);
	return NULL;
}

static void what_is_refused_is_said_with_why_and_what_mends_it(void **state)
{
	struct setup_report r;
	pthread_t t;

	(void)state;
	setup_process(&r);
	assert_int_equal(pthread_create(&t, NULL, set_up_thread, &r), 0);
	pthread_join(t, NULL);
	assert_true(r.item[SETUP_STACK].got);
	assert_false(r.item[SETUP_CPU].got);
	assert_false(r.item[SETUP_PRIORITY].got);
	for (int i = 0; i < SETUP_NITEMS; i++) {
		const struct setup_item *item = &r.item[i];

		assert_non_null(item->what);
		assert_non_null(item->mend);
		assert_true(item->wanted);
		assert_true(item->got == (item->why[0] == '\0'));
		print_message("%-22s %s %s\n", item->what,
			      item->got ? "got" : "not got:", item->why);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_wake_in_time_is_followed_by_one_a_period_later),
		cmocka_unit_test(lateness_within_a_period_is_not_carried_on),
		cmocka_unit_test(missed_periods_are_counted_and_skipped),
		cmocka_unit_test(every_period_is_either_a_wake_or_missed),
		cmocka_unit_test(the_wait_wakes_when_due_and_not_before),
		cmocka_unit_test(a_latency_falls_into_its_microsecond),
		cmocka_unit_test(what_is_refused_is_said_with_why_and_what_mends_it),
	};

	return cmocka_run_group_tests_name("setup", tests, NULL, NULL);
}
