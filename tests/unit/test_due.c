/* SPDX-License-Identifier: Apache-2.0 */
/* test_due.c - promises of daemon/jobs/due.h */
#include "due.c"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#define KEY	7
#define SENT_US	1000000

static struct due sent(void)
{
	struct due d = { .owed = false };

	due_sent(&d, KEY, SENT_US);
	return d;
}

static void what_is_the_same_is_said_ten_times_a_second(void **state)
{
	const struct due d = sent();

	(void)state;
	assert_false(due_now(&d, KEY, SENT_US + 99999));
	assert_true(due_now(&d, KEY, SENT_US + 100000));
}

static void what_has_changed_is_said_at_once(void **state)
{
	const struct due d = sent();

	(void)state;
	assert_true(due_now(&d, KEY + 1, SENT_US));
}

static void a_client_that_comes_later_is_answered_at_once(void **state)
{
	struct due d = sent();

	(void)state;
	due_guest(&d);
	assert_true(due_now(&d, KEY, SENT_US + 6000));
}

/* The one in whose answer it was too late to be is not forgotten. */
static void a_client_right_behind_the_last_is_owed_an_answer(void **state)
{
	struct due d = sent();

	(void)state;
	due_guest(&d);
	assert_false(due_now(&d, KEY, SENT_US + 100));
	assert_true(due_now(&d, KEY, SENT_US + 2000));
	due_sent(&d, KEY, SENT_US + 2000);
	assert_false(due_now(&d, KEY, SENT_US + 20000));
}

static void many_clients_at_once_get_one_answer(void **state)
{
	struct due d = sent();
	int answers = 0;

	(void)state;
	for (int64_t us = SENT_US; us < SENT_US + 20000; us += 10) {
		due_guest(&d);
		if (due_now(&d, KEY, us)) {
			due_sent(&d, KEY, us);
			answers++;
		}
	}
	assert_int_equal(answers, 9);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_is_the_same_is_said_ten_times_a_second),
		cmocka_unit_test(what_has_changed_is_said_at_once),
		cmocka_unit_test(a_client_that_comes_later_is_answered_at_once),
		cmocka_unit_test(
			a_client_right_behind_the_last_is_owed_an_answer),
		cmocka_unit_test(many_clients_at_once_get_one_answer),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
