/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_press.c - jogs that last as long as a person presses a key
 */
#include "manual_help.h"
#include "seed.h"
#include "verbs.h"

#define STAND_CYCLES	200		/* VERB_PRESS_S at 1 ms */
#define SIGN_CYCLES	40

static enum cycle_answer sign(struct bench *b, uint32_t axis, uint32_t press,
			      double mm_s)
{
	return ask(b, CYCLE_JOG_ON, axis | press << 8, mm_s);
}

static enum cycle_answer press_on(struct bench *b, uint32_t axis,
				  uint32_t press, double mm_s)
{
	return ask(b, CYCLE_JOG_ON, axis | VERB_PRESS_BEGINS | press << 8,
		   mm_s);
}

static bool moved(const struct bench *b)
{
	return memcmp(b->before, b->out.target, sizeof(b->before)) != 0;
}

/* Cycles from now to the last pulse. */
static int ends_after(struct bench *b)
{
	int last = 0;

	for (int i = 1; i <= 1000; i++) {
		period(b);
		if (moved(b))
			last = i;
	}
	assert_int_equal(b->c.state, STATE_IDLE);
	return last;
}

/* Press, with a sign each SIGN_CYCLES, the last of them in the last cycle. */
static void press(struct bench *b, uint32_t axis, double mm_s, int signs)
{
	assert_int_equal(press_on(b, axis, 1, mm_s), ANSWER_DONE);
	for (int i = 0; i < signs; i++) {
		for (int k = 0; k < SIGN_CYCLES; k++)
			period(b);
		assert_int_equal(sign(b, axis, 1, mm_s), ANSWER_DONE);
	}
}

static void it_goes_on_while_it_is_pressed(void **state)
{
	const struct cycle_config k = manual_config();
	struct bench b;

	(void)state;
	bench_init(&b, &k);
	press(&b, INTERP_X, 5, 100);
	/* Four seconds at 5 mm/s, less the ramp. */
	assert_in_range(b.out.target[INTERP_X], 19500, 20000);
	assert_int_equal(b.c.state, STATE_JOG);
	assert_int_equal(b.out.target[INTERP_Z], 0);
}

static void it_stands_in_time_after_the_last_sign(void **state)
{
	struct cycle_config k = manual_config();

	(void)state;
	/* While it speeds up, at speed, for slow and for heavy axes. */
	for (int signs = 0; signs < 20; signs++) {
		struct bench b;

		k.axis[INTERP_X].a_max_mm_s2 = signs % 2 ? 1000 : 300;
		k.axis[INTERP_X].j_max_mm_s3 = signs % 3 ? 20000 : 2000;
		bench_init(&b, &k);
		press(&b, INTERP_X, signs % 5 ? 50 : 0.5, signs);
		assert_in_range(ends_after(&b), 60, STAND_CYCLES);
		assert_true(b.out.target[INTERP_X] > 0);
	}
}

/* Whatever the axis, whenever the signs end, with a change of speed before. */
static void it_stands_in_time_whatever_the_axis(void **state)
{
	uint64_t s = seed_take();

	(void)state;
	for (int run = 0; run < 300; run++) {
		struct cycle_config k = manual_config();
		struct manual_axis *a = &k.axis[INTERP_X];
		double v = uniform(&s, 0.05, 200);
		struct bench b;

		a->a_max_mm_s2 = exp(uniform(&s, log(1), log(1e5)));
		a->j_max_mm_s3 = exp(uniform(&s, log(10), log(1e7)));
		a->v_max_mm_s = uniform(&s, 1, 200);
		a->jog_mm_s = a->v_max_mm_s;
		bench_init(&b, &k);
		assert_int_equal(press_on(&b, INTERP_X, 1, v), ANSWER_DONE);
		for (uint64_t n = rnd(&s) % 30; n > 0; n--) {
			for (uint64_t i = rnd(&s) % 60; i > 0; i--)
				period(&b);
			v = rnd(&s) % 4 ? v : uniform(&s, 0.05, 200);
			assert_int_equal(sign(&b, INTERP_X, 1, v),
					 ANSWER_DONE);
		}
		assert_in_range(ends_after(&b), 0, STAND_CYCLES);
	}
}

static void a_release_ends_it_sooner(void **state)
{
	const struct cycle_config k = manual_config();
	struct bench b;

	(void)state;
	bench_init(&b, &k);
	press(&b, INTERP_X, -20, 10);
	assert_int_equal(sign(&b, INTERP_X, 1, 0), ANSWER_DONE);
	assert_in_range(ends_after(&b), 1, 100);
	assert_true(b.out.target[INTERP_X] < 0);
}

/* What was delayed on the way comes in a heap: nothing moves of it. */
static void a_press_that_is_over_is_not_taken_up_again(void **state)
{
	const struct cycle_config k = manual_config();
	struct bench b;

	(void)state;
	bench_init(&b, &k);
	press(&b, INTERP_X, 5, 3);
	ends_after(&b);
	for (int i = 0; i < 5; i++) {
		assert_int_equal(sign(&b, INTERP_X, 1, 5), ANSWER_WRONG_STATE);
		assert_int_equal(press_on(&b, INTERP_X, 1, 5),
				 ANSWER_WRONG_STATE);
	}
	/* A sign that begins nothing, of a press unknown to this edmd. */
	assert_int_equal(sign(&b, INTERP_X, 7, 5), ANSWER_WRONG_STATE);
	/* A release that overtook its beginning. */
	assert_int_equal(sign(&b, INTERP_X, 2, 0), ANSWER_DONE);
	assert_int_equal(press_on(&b, INTERP_X, 2, 5), ANSWER_WRONG_STATE);
	assert_int_equal(ends_after(&b), 0);
	assert_int_equal(press_on(&b, INTERP_X, 3, 5), ANSWER_DONE);
}

/* In the time that it brakes in, a sign is too late. */
static void a_sign_while_it_brakes_is_too_late(void **state)
{
	const struct cycle_config k = manual_config();
	struct bench b;

	(void)state;
	bench_init(&b, &k);
	press(&b, INTERP_X, 20, 10);
	for (int i = 0; i < 120; i++)
		period(&b);
	assert_int_equal(sign(&b, INTERP_X, 1, 20), ANSWER_WRONG_STATE);
	assert_in_range(ends_after(&b), 1, STAND_CYCLES - 120);
}

static void another_press_axis_or_way_is_refused_while_it_goes(void **state)
{
	const struct cycle_config k = manual_config();
	struct bench b;

	(void)state;
	bench_init(&b, &k);
	press(&b, INTERP_X, 5, 2);
	assert_int_equal(press_on(&b, INTERP_X, 2, 5), ANSWER_WRONG_STATE);
	assert_int_equal(sign(&b, INTERP_Z, 1, 5), ANSWER_WRONG_STATE);
	assert_int_equal(sign(&b, INTERP_X, 1, -5), ANSWER_WRONG_STATE);
	assert_int_equal(jog(&b, INTERP_X, 1), ANSWER_WRONG_STATE);
	/* Nor does the end of another press end it. */
	assert_int_equal(sign(&b, INTERP_X, 2, 0), ANSWER_DONE);
	period(&b);
	assert_int_equal(sign(&b, INTERP_X, 1, 5), ANSWER_DONE);
}

static void it_is_refused_where_it_cannot_go(void **state)
{
	const struct cycle_config k = manual_config();
	struct bench b;

	(void)state;
	bench_init(&b, &k);
	assert_int_equal(press_on(&b, INTERP_X, 0, 5), ANSWER_BAD_ARGUMENT);
	assert_int_equal(press_on(&b, INTERP_U, 1, 5), ANSWER_BAD_ARGUMENT);
	assert_int_equal(press_on(&b, 77, 1, 5), ANSWER_BAD_ARGUMENT);
	assert_int_equal(press_on(&b, INTERP_X, 1, (double)NAN),
			 ANSWER_BAD_ARGUMENT);
	assert_int_equal(press_on(&b, INTERP_X, 1, (double)INFINITY),
			 ANSWER_BAD_ARGUMENT);
	assert_int_equal(b.c.state, STATE_IDLE);
}

static void it_ends_at_the_end_of_the_travel(void **state)
{
	struct cycle_config k = manual_config();
	struct bench b;

	(void)state;
	k.travel_max[INTERP_X] = 3000;
	bench_init(&b, &k);
	press_on(&b, INTERP_X, 1, 20);
	for (int i = 0; i < 1000; i++) {
		if (i % SIGN_CYCLES == 0)
			sign(&b, INTERP_X, 1, 20);
		period(&b);
	}
	assert_int_equal(b.out.target[INTERP_X], 3000);
	assert_int_equal(b.c.state, STATE_IDLE);
	assert_int_equal(press_on(&b, INTERP_X, 2, 20), ANSWER_BEYOND);
	assert_int_equal(press_on(&b, INTERP_X, 2, -20), ANSWER_DONE);
}

/* The press is over before the drives have power: then nothing moves. */
static void power_that_comes_late_moves_nothing(void **state)
{
	struct cycle_config k = manual_config();
	struct bench b;

	(void)state;
	k.axes_wait_cycles = 5000;
	bench_init(&b, &k);
	b.in.axes_off = true;
	period(&b);
	press(&b, INTERP_X, 20, 5);
	for (int i = 0; i < 1000; i++)
		period(&b);
	b.in.axes_off = false;
	assert_int_equal(ends_after(&b), 0);
}

static void a_fault_ends_it_and_it_stays_ended(void **state)
{
	const struct cycle_config k = manual_config();
	struct bench b;

	(void)state;
	bench_init(&b, &k);
	press(&b, INTERP_Z, -5, 5);
	b.in.gap_v = SHORTED_V;
	run_out(&b, STATE_FAULT);
	assert_int_equal(b.c.fault.first, FAULT_CONTACT);
	assert_int_equal(sign(&b, INTERP_Z, 1, -5), ANSWER_WRONG_STATE);
	b.in.gap_v = OPEN_V;
	period(&b);
	assert_int_equal(ask(&b, CYCLE_RESET, 0, 0), ANSWER_DONE);
	assert_int_equal(sign(&b, INTERP_Z, 1, -5), ANSWER_WRONG_STATE);
	assert_int_equal(ends_after(&b), 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(it_goes_on_while_it_is_pressed),
		cmocka_unit_test(it_stands_in_time_after_the_last_sign),
		cmocka_unit_test(it_stands_in_time_whatever_the_axis),
		cmocka_unit_test(a_release_ends_it_sooner),
		cmocka_unit_test(a_press_that_is_over_is_not_taken_up_again),
		cmocka_unit_test(a_sign_while_it_brakes_is_too_late),
		cmocka_unit_test(another_press_axis_or_way_is_refused_while_it_goes),
		cmocka_unit_test(it_is_refused_where_it_cannot_go),
		cmocka_unit_test(it_ends_at_the_end_of_the_travel),
		cmocka_unit_test(power_that_comes_late_moves_nothing),
		cmocka_unit_test(a_fault_ends_it_and_it_stays_ended),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
