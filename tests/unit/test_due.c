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

static void ask(struct due *d, int64_t now_us)
{
	due_guest(d);
	assert_true(due_now(d, KEY, now_us));
	due_sent(d, KEY, now_us);
}

static void a_client_that_has_come_is_answered_at_once(void **state)
{
	struct due d = sent();

	(void)state;
	for (int i = 0; i < 1000; i++)
		ask(&d, SENT_US + i * 10000);
}

static void ten_clients_may_come_at_the_same_time(void **state)
{
	struct due d = sent();

	(void)state;
	for (int i = 0; i < 10; i++)
		ask(&d, SENT_US + i);
}

/* It is not forgotten until the next tenth of a second. */
static void one_too_many_is_owed_an_answer(void **state)
{
	struct due d = sent();

	(void)state;
	for (int i = 0; i < 10; i++)
		ask(&d, SENT_US);
	due_guest(&d);
	assert_false(due_now(&d, KEY, SENT_US + 9999));
	assert_true(due_now(&d, KEY, SENT_US + 10000));
	due_sent(&d, KEY, SENT_US + 10000);
	assert_false(due_now(&d, KEY, SENT_US + 20000));
}

static void many_clients_get_100_answers_a_second(void **state)
{
	struct due d = sent();
	int answers = 0;

	(void)state;
	for (int64_t us = SENT_US; us < SENT_US + 1000000; us += 10) {
		due_guest(&d);
		if (due_now(&d, KEY, us)) {
			due_sent(&d, KEY, us);
			answers++;
		}
	}
	assert_in_range(answers, 100, 110);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_is_the_same_is_said_ten_times_a_second),
		cmocka_unit_test(what_has_changed_is_said_at_once),
		cmocka_unit_test(a_client_that_has_come_is_answered_at_once),
		cmocka_unit_test(ten_clients_may_come_at_the_same_time),
		cmocka_unit_test(one_too_many_is_owed_an_answer),
		cmocka_unit_test(many_clients_get_100_answers_a_second),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
