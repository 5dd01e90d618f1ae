/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_edges.c - promises of io/edges.h, with a real thread: what it puts out,
 * with any lateness.  How even it is, is tested in the virtual machine.
 */
#include "clock.h"
#include "edges.h"

#include <sched.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

struct rig {
	struct edges *e;
	struct edges_told told;
	struct edges_shown shown;
	uint32_t step;			/* levels, the thread's own */
	_Atomic int32_t at[IO_NAXES];	/* counted from the lines */
	_Atomic bool gone;
	uint32_t slow;			/* one of so many writes; 0: none */
	uint32_t writes;		/* the thread's own, as what follows */
	int64_t changed_ns, least_ns;	/* last change; shortest level */
};

#define PERIOD_NS	2000000
#define SLOTS		40
#define SLOT_NS		(PERIOD_NS / SLOTS)

static int64_t now_ns(void)
{
	struct timespec t;

	clock_gettime(CLOCK_MONOTONIC, &t);
	return t.tv_sec * INT64_C(1000000000) + t.tv_nsec;
}

/* The lines change when a write ends, and some take longer than a slot. */
static void take_time(struct rig *r)
{
	const int64_t until = now_ns() + SLOT_NS * 6 / 5;
	int64_t now;

	if (r->slow && ++r->writes % r->slow == 0)
		while (now_ns() < until)
			;
	now = now_ns();
	if (r->changed_ns && now - r->changed_ns < r->least_ns)
		r->least_ns = now - r->changed_ns;
	r->changed_ns = now;
}

/* Counts as a drive does, at each step that rises. */
static bool lines(void *arg, uint32_t step, uint32_t dir)
{
	struct rig *r = arg;
	const uint32_t rises = step & ~r->step;

	if (step != r->step)
		take_time(r);
	r->step = step;
	for (int i = 0; i < IO_NAXES; i++)
		if (rises >> i & 1)
			r->at[i] += dir >> i & 1 ? 1 : -1;
	return !r->gone;
}

static void begin(struct rig *r)
{
	const struct edges_config c = {
		.pulser = { 1, 1, 1, 1, false, 0, 0, 0 },
		.period_ns = PERIOD_NS,
		.slots = SLOTS, .cpu = -1, .write = lines, .arg = r,
	};

	*r = (struct rig) { .least_ns = INT64_MAX };
	assert_int_equal(edges_start(&r->e, &c), 0);
	edges_tell(r->e, &r->told);
}

static void look(struct rig *r)
{
	usleep(1000);
	edges_ask(r->e, &r->shown);
}

/* Periods pass until it stands still and has nothing more. */
static void settle(struct rig *r)
{
	uint32_t from;

	edges_ask(r->e, &r->shown);
	from = r->shown.periods;
	do {
		look(r);
	} while (r->shown.periods - from < 4 || r->shown.busy ||
		 memcmp(r->shown.put, r->told.target, sizeof(r->told.target)));
}

static void what_is_told_is_put_out_to_the_pulse(void **state)
{
	struct rig r;

	(void)state;
	begin(&r);
	for (int i = 1; i <= 100; i++) {
		do
			look(&r);
		while (r.shown.busy);
		r.told.target[0] = 17 * i;
		r.told.target[2] = -(i % 2 ? 20 * i : 20 * (i - 1));
		edges_tell(r.e, &r.told);
	}
	settle(&r);
	assert_int_equal(r.at[0], 1700);
	assert_int_equal(r.at[2], -1980);
	assert_int_equal(r.at[1], 0);
	assert_memory_equal(r.shown.put, r.told.target, sizeof(r.told.target));
	edges_end(r.e);
}

static void more_than_a_period_holds_is_put_out_later_not_lost(void **state)
{
	struct rig r;

	(void)state;
	begin(&r);
	settle(&r);
	r.told.target[1] = 500;
	edges_tell(r.e, &r.told);
	settle(&r);
	assert_int_equal(r.at[1], 500);
	edges_end(r.e);
}

/* So many whole periods of the thread, however seldom it runs. */
static void pass(struct rig *r, uint32_t periods)
{
	uint32_t from;

	edges_ask(r->e, &r->shown);
	from = r->shown.periods;
	while (r->shown.periods - from <= periods)
		look(r);
}

/* What the lines say and what it says it put out are one, at any time. */
static void a_stop_ends_the_pulses_until_another_target(void **state)
{
	struct rig r;
	int32_t stood;

	(void)state;
	begin(&r);
	settle(&r);
	r.told.target[0] = 1000000;
	edges_tell(r.e, &r.told);
	while (r.at[0] < 100)
		look(&r);
	r.told.stop = 1;
	edges_tell(r.e, &r.told);
	pass(&r, 2);
	stood = r.at[0];
	assert_true(stood < 1000000);
	r.told.stop = 0;
	edges_tell(r.e, &r.told);
	pass(&r, 8);
	assert_int_equal(r.at[0], stood);
	assert_int_equal(r.shown.put[0], stood);
	assert_true(r.shown.busy);
	r.told.target[0] = stood + 99;
	edges_tell(r.e, &r.told);
	settle(&r);
	assert_int_equal(r.at[0], stood + 99);
	edges_end(r.e);
}

/* Whenever the two start, each has half a period for the other's lateness. */
static void the_thread_and_the_cycle_run_half_a_period_apart(void **state)
{
	const int64_t periods[] = { 50000, 250000, 1000000, 2000000 };

	(void)state;
	for (int i = 0; i < 400; i++) {
		const int64_t period = periods[i % 4];
		const int64_t now = now_ns() + i * 7919;
		const int64_t next = edges_next_ns(now, period);
		struct setup_clock c;

		setup_clock_start(&c, period);
		assert_true(next > now && next <= now + period);
		assert_int_equal((next - c.next_ns) % period % (period / 2), 0);
		assert_int_not_equal((next - c.next_ns) % period, 0);
	}
}

/* Counted as slots are, so a write quicker than those before is left off. */
static void levels_last_as_long_as_the_file_says(void **state)
{
	struct edges_config c = {
		.pulser = { 1, 1, 1, 1, false, 3 * SLOT_NS, 2 * SLOT_NS, 0 },
		.period_ns = PERIOD_NS, .slots = SLOTS, .cpu = -1,
		.write = lines,
	};
	struct rig r = { .least_ns = INT64_MAX };

	(void)state;
	c.arg = &r;
	assert_int_equal(edges_start(&r.e, &c), 0);
	edges_tell(r.e, &r.told);
	settle(&r);
	r.told.target[0] = 30;
	edges_tell(r.e, &r.told);
	settle(&r);
	edges_end(r.e);
	assert_int_equal(r.at[0], 30);
	assert_true(r.least_ns > 2 * SLOT_NS - SLOT_NS / 4);
}

static void a_right_that_the_host_does_not_give_is_told(void **state)
{
	struct rig r;
	const struct edges_config c = {
		.pulser = { 1, 1, 1, 1, false, 0, 0, 0 },
		.period_ns = PERIOD_NS,
		.slots = SLOTS, .cpu = CPU_SETSIZE - 1, .write = lines,
		.arg = &r,
	};
	char line[200] = "";

	(void)state;
	r = (struct rig) { .least_ns = INT64_MAX };
	assert_int_equal(edges_start(&r.e, &c), 0);
	assert_true(edges_note(r.e, line, sizeof(line)));
	assert_non_null(strstr(line, "edge thread: core of its own"));
	assert_false(edges_note(r.e, line, sizeof(line)));
	edges_end(r.e);
}

/* A write that was interrupted before the lines changed is such a one. */
static void a_level_is_long_enough_behind_a_slow_write_too(void **state)
{
	struct rig r;

	(void)state;
	begin(&r);
	settle(&r);
	r.slow = 3;
	r.told.target[0] = 400;
	edges_tell(r.e, &r.told);
	settle(&r);
	edges_end(r.e);
	assert_int_equal(r.at[0], 400);
	assert_true(r.least_ns > SLOT_NS / 2);
}

static void lines_that_are_gone_are_told(void **state)
{
	struct rig r;
	int32_t at;

	(void)state;
	begin(&r);
	settle(&r);
	r.gone = true;
	r.told.target[0] = 10;
	edges_tell(r.e, &r.told);
	while (!r.shown.lost)
		look(&r);
	at = r.at[0];
	r.told.target[0] = 20;
	edges_tell(r.e, &r.told);
	for (int i = 0; i < 10; i++)
		look(&r);
	assert_int_equal(r.at[0], at);
	edges_end(r.e);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_is_told_is_put_out_to_the_pulse),
		cmocka_unit_test(more_than_a_period_holds_is_put_out_later_not_lost),
		cmocka_unit_test(a_stop_ends_the_pulses_until_another_target),
		cmocka_unit_test(a_level_is_long_enough_behind_a_slow_write_too),
		cmocka_unit_test(the_thread_and_the_cycle_run_half_a_period_apart),
		cmocka_unit_test(levels_last_as_long_as_the_file_says),
		cmocka_unit_test(a_right_that_the_host_does_not_give_is_told),
		cmocka_unit_test(lines_that_are_gone_are_told),
	};

	return cmocka_run_group_tests_name("io/edges", tests, NULL, NULL);
}
