/* SPDX-License-Identifier: Apache-2.0 */
/* test_eta.c - promises of daemon/jobs/eta.h */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "eta.c"

/* A hundred parts of a mm: ten positioned, then cut in condition 1 with a
 * dwell in the middle, then in condition 2. */
#define PARTS	100

static struct forecast forecast_of(double first_s, double second_s)
{
	struct forecast f = { .nparts = PARTS, .nconds = 3 };

	f.part = calloc(PARTS, sizeof(*f.part));
	f.cond = calloc(4, sizeof(*f.cond));
	assert_non_null(f.part);
	for (int i = 0; i < PARTS; i++) {
		struct forecast_part *p = &f.part[i];

		p->to_mm = i + 1;
		p->cond = i < 60 ? 1 : 2;
		p->cut_s[FORECAST_ALL] = i < 10 ? 0 : i < 60 ? first_s :
					 second_s;
		p->cut_s[FORECAST_HALF] = 2 * *p->cut_s;
		p->cut_s[FORECAST_TWICE] = *p->cut_s / 2;
		p->moved_s = i < 10 ? 0.1 : 0;
		p->other_s = i == 40 ? 30 : 0;
		f.cut_s += *p->cut_s;
		f.moved_s += p->moved_s;
		f.other_s += p->other_s;
	}
	return f;
}

static struct eta give(struct forecast f)
{
	struct eta l = { .n = 0 };

	assert_int_equal(eta_give(&l, &f, 7), 0);
	assert_null(f.part);
	return l;
}

static struct eta ready(double first_s, double second_s)
{
	return give(forecast_of(first_s, second_s));
}

static struct eta_told told(const struct eta *l)
{
	struct eta_told t;

	eta_tell(l, &t);
	return t;
}

/* A place belongs to the part that ends there. */
static double past(double mm)
{
	return mm + 1e-6;
}

/* Go on past @to_mm, where the cut takes @a and @b times what was forecast. */
static void go(struct eta *l, double to_mm, double a, double b)
{
	struct eta_spent s = l->now;

	for (uint32_t i = l->at; i < to_mm; i++) {
		const struct forecast_part *p = &l->forecast.part[i];

		s.cut_s += *p->cut_s * (p->cond == 1 ? a : b);
		s.moved_s += p->moved_s;
		s.other_s += p->other_s;
		eta_look(l, past(i + 1), &s);
	}
}

/* Look at @to_mm, when it has cut for @cut_s more. */
static void cut(struct eta *l, double to_mm, double cut_s)
{
	struct eta_spent s = l->now;

	s.cut_s += cut_s;
	eta_look(l, to_mm, &s);
}

static void begin(struct eta *l)
{
	cut(l, 0, 0);
}

static void before_the_cut_it_is_the_forecast_and_a_range(void **state)
{
	struct eta l = ready(10, 4);
	struct eta_told t;

	(void)state;
	begin(&l);
	t = told(&l);
	assert_int_equal(t.by, ETA_FORECAST);
	assert_float_equal(t.left_s, 500 + 160 + 31, 1e-6);
	assert_float_equal(t.min_s, 330 + 31, 1e-6);
	assert_float_equal(t.max_s, 1320 + 31, 1e-6);
	eta_fini(&l);
}

static void what_is_positioned_has_no_factor(void **state)
{
	struct eta l = ready(10, 4);

	(void)state;
	go(&l, 10, 1, 1);
	assert_float_equal(told(&l).left_s, 690, 1e-6);
	assert_int_equal(told(&l).by, ETA_FORECAST);
	eta_fini(&l);
}

/* At an override of 10 % each rapid takes ten times as long: no condition does,
 * and what will be positioned does. */
static void what_positioning_takes_is_no_slow_cut(void **state)
{
	struct forecast f = forecast_of(10, 4);
	struct eta_told t;
	struct eta l;

	(void)state;
	for (int i = 10; i < PARTS; i++) {
		f.part[i].moved_s = 1;
		f.moved_s += 1;
	}
	l = give(f);
	for (int i = 0; i < 50; i++) {
		struct eta_spent s = l.now;

		s.cut_s += *l.forecast.part[i].cut_s;
		s.moved_s += 10 * l.forecast.part[i].moved_s;
		s.other_s += l.forecast.part[i].other_s;
		eta_look(&l, past(i + 1), &s);
	}
	assert_float_equal(l.cond[1].passed_s, l.cond[1].expected_s, 1e-6);
	t = told(&l);
	assert_float_equal(t.left_s, 100 + 160 + 50 * 10, 20);
	assert_string_equal(l.forecast.cond[t.cond], "");
	assert_int_equal(t.cond, 3);
	assert_float_equal(t.factor, 10, 0.5);
	eta_fini(&l);
}

/* Half is removed of what was believed: at a sixth of the cut it is known. */
static void a_process_that_is_slower_is_noticed(void **state)
{
	struct eta l = ready(10, 4);
	struct eta_told t;

	(void)state;
	go(&l, 20, 2, 2);
	t = told(&l);
	assert_int_equal(t.by, ETA_CUT);
	assert_int_equal(t.cond, 1);
	assert_in_range((int)(t.factor * 100), 175, 200);
	assert_in_range((int)t.left_s, 1000, 1150);	/* truth: 1150 */
	assert_true(t.min_s < t.left_s && t.left_s < t.max_s);
	eta_fini(&l);
}

static void each_condition_has_its_own_factor(void **state)
{
	struct eta l = ready(10, 10);

	(void)state;
	go(&l, 60, 1, 1);
	assert_float_equal(told(&l).left_s, 400, 20);
	go(&l, 80, 1, 3);
	assert_in_range((int)told(&l).left_s, 540, 620);	/* truth: 600 */
	assert_int_equal(told(&l).cond, 2);
	eta_fini(&l);
}

/* At one place the time still goes down, and never below what is to come. */
static void a_dwell_counts_down(void **state)
{
	struct eta l = ready(10, 4);
	struct eta_spent s;
	double was;

	(void)state;
	go(&l, 40, 1, 1);
	was = told(&l).left_s;
	s = l.now;
	s.other_s += 25;
	eta_look(&l, past(40), &s);
	assert_float_equal(told(&l).left_s, was - 25, 1e-6);
	eta_fini(&l);
}

/* It waits, and what it says rises only as it gets too late. */
static void a_stall_does_not_rise_at_once(void **state)
{
	struct eta l = ready(10, 4);
	struct eta_told t;
	double was;

	(void)state;
	go(&l, 30, 1, 1);
	was = told(&l).left_s;
	for (int more = 0; more < 20; more++) {
		cut(&l, past(30), 1);
		assert_true(told(&l).left_s <= was * 1.1);
	}
	assert_false(eta_rose(&l, &t));
	cut(&l, past(30), 280);
	assert_true(told(&l).left_s > was * 1.1);
	assert_true(eta_rose(&l, &t));
	assert_false(eta_rose(&l, &t));	/* told once */
	eta_fini(&l);
}

/* Ever slower: by the same condition it is told once. */
static void it_is_told_once_for_each_cause(void **state)
{
	struct eta l = ready(10, 4);
	struct eta_told t;
	int told_times = 0;

	(void)state;
	begin(&l);
	for (int mm = 1; mm <= 40; mm++) {
		cut(&l, past(mm), 10 * (1 + mm / 5.0));
		told_times += eta_rose(&l, &t);
	}
	assert_int_equal(told_times, 1);
	eta_fini(&l);
}

static void what_was_learnt_is_where_it_begins(void **state)
{
	struct eta l = ready(10, 4);
	struct eta_told t;

	(void)state;
	eta_learnt(&l, 1, 2);
	begin(&l);
	t = told(&l);
	assert_int_equal(t.by, ETA_LEARNT);
	assert_float_equal(t.left_s, 1000 + 160 + 31, 1e-6);
	assert_true(t.max_s < 1.3 * t.left_s);
	go(&l, 40, 2, 1);
	assert_float_equal(told(&l).factor, 2, 0.01);
	/* What is learnt from this job is of the forecast itself. */
	assert_true(fabs(l.cond[1].passed_s - 2 * l.cond[1].expected_s) < 1e-6);
	eta_fini(&l);
}

/* Condition 1 is cut at the programmed feed, whatever the process removes. */
static struct eta half_at_the_feed(void)
{
	struct forecast f = forecast_of(10, 10);

	for (int i = 0; i < 60; i++)
		f.part[i].cut_s[FORECAST_HALF] =
		f.part[i].cut_s[FORECAST_TWICE] = *f.part[i].cut_s;
	return give(f);
}

static void what_is_cut_at_the_feed_says_nothing_of_the_process(void **state)
{
	struct eta l = half_at_the_feed();

	(void)state;
	go(&l, 50, 1.01, 1);
	assert_float_equal(told(&l).left_s, 500, 10);
	go(&l, 70, 1.01, 2);
	assert_float_equal(told(&l).left_s, 600, 30);	/* truth: 600 */
	/* An override slows all alike. */
	eta_fini(&l);
	l = half_at_the_feed();
	go(&l, 50, 2, 2);
	assert_float_equal(told(&l).left_s, 1000, 60);
	eta_fini(&l);
}

static void a_process_that_is_slower_leaves_what_is_cut_at_the_feed(
	void **state)
{
	struct forecast f = forecast_of(10, 10);
	struct eta l;

	(void)state;
	for (int i = 0; i < PARTS; i++) {
		f.part[i].cond = i < 10 ? 0 : 1;
		if (i >= 60)
			f.part[i].cut_s[FORECAST_HALF] = *f.part[i].cut_s;
	}
	l = give(f);
	go(&l, 40, 2, 2);
	assert_float_equal(told(&l).left_s, 30 + 400 + 400, 30);
	eta_fini(&l);
}

static void a_dwell_at_the_end_of_the_cut_is_still_to_come(void **state)
{
	struct forecast f = forecast_of(10, 4);
	struct eta l;

	(void)state;
	f.part[89].other_s = 60;
	l = give(f);
	go(&l, 89, 1, 1);
	cut(&l, 90, 0);
	assert_true(told(&l).left_s >= 60);
	eta_fini(&l);
}

/* A service that comes back in the middle of a job sees it for the first
 * time. */
static void it_may_come_in_the_middle(void **state)
{
	struct eta a = ready(10, 4), b = ready(10, 4);

	(void)state;
	go(&a, 50, 2, 2);
	eta_look(&b, past(50), &a.now);
	assert_float_equal(told(&b).left_s, told(&a).left_s, 15);
	eta_fini(&a);
	eta_fini(&b);
}

static void a_job_that_cuts_nothing_has_an_estimate(void **state)
{
	struct eta l = ready(0, 0);

	(void)state;
	begin(&l);
	assert_float_equal(told(&l).left_s, 31, 1e-6);
	go(&l, 50, 1, 1);
	assert_float_equal(told(&l).left_s, 0, 1e-6);
	eta_fini(&l);
}

static void without_a_forecast_there_is_none(void **state)
{
	struct forecast f = { .why_not = "no-contact" };
	struct eta_told t;
	struct eta l = { .n = 0 };

	(void)state;
	cut(&l, 3, 4);
	assert_float_equal(told(&l).left_s, -1, 0);
	assert_int_equal(eta_give(&l, &f, 7), 0);
	cut(&l, 3, 4);
	assert_int_equal(told(&l).by, ETA_NONE);
	assert_false(eta_rose(&l, &t));
	eta_fini(&l);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(before_the_cut_it_is_the_forecast_and_a_range),
		cmocka_unit_test(what_is_positioned_has_no_factor),
		cmocka_unit_test(what_positioning_takes_is_no_slow_cut),
		cmocka_unit_test(a_process_that_is_slower_is_noticed),
		cmocka_unit_test(each_condition_has_its_own_factor),
		cmocka_unit_test(a_dwell_counts_down),
		cmocka_unit_test(a_stall_does_not_rise_at_once),
		cmocka_unit_test(it_is_told_once_for_each_cause),
		cmocka_unit_test(what_was_learnt_is_where_it_begins),
		cmocka_unit_test(
			what_is_cut_at_the_feed_says_nothing_of_the_process),
		cmocka_unit_test(
		a_process_that_is_slower_leaves_what_is_cut_at_the_feed),
		cmocka_unit_test(
			a_dwell_at_the_end_of_the_cut_is_still_to_come),
		cmocka_unit_test(it_may_come_in_the_middle),
		cmocka_unit_test(a_job_that_cuts_nothing_has_an_estimate),
		cmocka_unit_test(without_a_forecast_there_is_none),
	};

	return cmocka_run_group_tests_name("jobs/eta", tests, NULL, NULL);
}
