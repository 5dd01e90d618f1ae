/* SPDX-License-Identifier: Apache-2.0 */
/* test_home.c - homing, and what a machine refuses before it is homed */
#include "manual_help.h"

static struct cycle_config home_config(enum home_method method)
{
	struct cycle_config k = manual_config();

	k.axis[INTERP_X].method = method;
	return k;
}

/* Where the switch is, the place is home_at; to a pulse a period's way. */
static void check_homed(const struct bench *b, int axis, int32_t at)
{
	const int32_t off = b->c.out.target[axis] - b->out.target[axis];

	assert_int_equal(b->c.manual.homed >> axis & 1, 1);
	assert_in_range(at + off + 10000 + 2, 0, 4);
}

static void a_switch_is_home(void **state)
{
	const int32_t places[] = { -50000, -1, 0, 30000 };

	(void)state;
	for (int i = 0; i < 4; i++) {
		const struct cycle_config k = home_config(HOME_SWITCH);
		struct bench b;

		bench_init(&b, &k);
		b.home[INTERP_X] = places[i];
		assert_int_equal(manual_unhomed(&b.c), X_BIT);
		assert_int_equal(ask(&b, CYCLE_HOME, INTERP_X, 0), ANSWER_DONE);
		assert_int_equal(b.c.state, STATE_HOME);
		run_out(&b, STATE_IDLE);
		check_homed(&b, INTERP_X, places[i]);
		assert_in_range(b.most, 1, 21);
	}
}

/* The mark after the switch, wherever the switch comes between two. */
static void an_index_mark_is_home(void **state)
{
	(void)state;
	for (int32_t at = -50000; at < -46000; at += 370) {
		const struct cycle_config k = home_config(HOME_SWITCH_INDEX);
		const int32_t mark = (int32_t)floor(at / 2000.0) * 2000;
		struct bench b;

		bench_init(&b, &k);
		b.home[INTERP_X] = at;
		ask(&b, CYCLE_HOME, INTERP_X, 0);
		run_out(&b, STATE_IDLE);
		check_homed(&b, INTERP_X, mark);
	}
}

static void an_absolute_drive_says_where_it_is(void **state)
{
	const struct cycle_config k = home_config(HOME_ABSOLUTE);
	struct bench b;

	(void)state;
	bench_init(&b, &k);
	jog(&b, INTERP_X, 3);
	run_out(&b, STATE_IDLE);
	assert_int_equal(ask(&b, CYCLE_HOME, MANUAL_ALL_AXES, 0), ANSWER_DONE);
	run_out(&b, STATE_IDLE);
	assert_int_equal(b.c.out.target[INTERP_X], 3000 - 10000);
	assert_int_equal(b.out.target[INTERP_X], 3000);
	assert_int_equal(manual_unhomed(&b.c), 0);
}

/* It counts from elsewhere, so that its other limit switch is near to the count
 * at which the first one was. */
static void a_limit_switch_is_where_the_drive_counts_now(void **state)
{
	const struct cycle_config k = home_config(HOME_ABSOLUTE);
	const int32_t more = 10900;
	struct bench b;

	(void)state;
	bench_init(&b, &k);
	b.limit_min = -11000;
	b.limit_max = 400;
	jog(&b, INTERP_X, 20);
	run_out(&b, STATE_FAULT);
	ask(&b, CYCLE_RESET, 0, 0);
	jog(&b, INTERP_X, -8);
	run_out(&b, STATE_IDLE);
	assert_int_equal(ask(&b, CYCLE_HOME, INTERP_X, 0), ANSWER_DONE);
	b.in.actual[INTERP_X] += more;
	cycle_step(&b.c, &b.in, &b.out);
	b.limit_min += more;
	b.limit_max += more;
	run_out(&b, STATE_IDLE);
	assert_in_range(b.out.target[INTERP_X], 0, b.limit_max);
	jog(&b, INTERP_X, -20);
	run_out(&b, STATE_FAULT);
	assert_int_equal(b.c.fault.first, FAULT_LIMIT_SWITCH);
	ask(&b, CYCLE_RESET, 0, 0);
	assert_int_equal(jog(&b, INTERP_X, -1), ANSWER_AT_LIMIT);
	assert_int_equal(jog(&b, INTERP_X, 1), ANSWER_DONE);
}

/* With lost motion too the same place is found from either side. */
static void backlash_does_not_move_home(void **state)
{
	struct cycle_config k = home_config(HOME_SWITCH);
	int32_t off[2];
	struct bench b;

	(void)state;
	k.comp.axis[INTERP_X].backlash = 30;
	k.comp.axis[INTERP_X].take_up = 1;
	for (int i = 0; i < 2; i++) {
		bench_init(&b, &k);
		jog(&b, INTERP_X, i ? 1 : -1);
		run_out(&b, STATE_IDLE);
		ask(&b, CYCLE_HOME, INTERP_X, 0);
		run_out(&b, STATE_IDLE);
		off[i] = b.c.comp.axis[INTERP_X].shift;
	}
	assert_in_range(off[1] - off[0] + 2, 0, 4);
	/* The drive was on -50000 at home: place -10000 approached from +. */
	assert_in_range(off[0] + 40000 - 30 + 2, 0, 4);
}

static void axes_are_homed_in_their_order(void **state)
{
	struct cycle_config k = home_config(HOME_SWITCH);
	struct bench b;

	(void)state;
	k.axis[INTERP_Z].method = HOME_SWITCH;
	k.axis[INTERP_Z].home_toward = 1;
	k.axis[INTERP_X].home_order = 1;
	bench_init(&b, &k);
	b.home[INTERP_Z] = INT32_MIN;
	b.home[INTERP_X] = -2000;
	ask(&b, CYCLE_HOME, MANUAL_ALL_AXES, 0);
	for (int i = 0; i < 300; i++)
		period(&b);
	assert_true(b.out.target[INTERP_Z] > 1000);
	assert_int_equal(b.out.target[INTERP_X], 0);
	b.home[INTERP_Z] = INT32_MAX;
	for (int i = 0; i < 300; i++)
		period(&b);
	b.home[INTERP_Z] = INT32_MIN;
	for (int i = 0; i < 3000; i++)
		period(&b);
	b.home[INTERP_Z] = INT32_MAX;
	run_out(&b, STATE_IDLE);
	assert_int_equal(manual_unhomed(&b.c), 0);
	check_homed(&b, INTERP_X, -2000);
}

static void no_switch_is_a_fault(void **state)
{
	struct cycle_config k = home_config(HOME_SWITCH);
	struct bench b;

	(void)state;
	k.travel_min[INTERP_X] = -3000;
	k.travel_max[INTERP_X] = 3000;
	bench_init(&b, &k);
	ask(&b, CYCLE_HOME, INTERP_X, 0);
	run_out(&b, STATE_FAULT);
	assert_string_equal(fault_name(b.c.fault.first), "home-not-found");
	assert_in_range(-b.out.target[INTERP_X], 6000, 6020);
	assert_int_equal(manual_unhomed(&b.c), X_BIT);
}

static void a_stop_leaves_it_unhomed(void **state)
{
	const struct cycle_config k = home_config(HOME_SWITCH);
	struct bench b;

	(void)state;
	bench_init(&b, &k);
	ask(&b, CYCLE_HOME, INTERP_X, 0);
	for (int i = 0; i < 200; i++)
		period(&b);
	assert_int_equal(ask(&b, CYCLE_STOP, 0, 0), ANSWER_DONE);
	run_out(&b, STATE_IDLE);
	assert_int_equal(manual_unhomed(&b.c), X_BIT);
}

static void only_axes_with_a_method_are_homed(void **state)
{
	const struct cycle_config k = home_config(HOME_SWITCH);
	struct bench b;

	(void)state;
	bench_init(&b, &k);
	assert_int_equal(ask(&b, CYCLE_HOME, INTERP_Z, 0), ANSWER_BAD_ARGUMENT);
	assert_int_equal(ask(&b, CYCLE_HOME, 9, 0), ANSWER_BAD_ARGUMENT);
}

static void unhomed_nothing_is_cut_if_so_configured(void **state)
{
	struct cycle_config k = home_config(HOME_SWITCH);
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct rig r;

	(void)state;
	k.require_home = true;
	cut_to(b, -5);
	rig_load(&r, b, &k);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_NOT_HOMED);
	r.c.manual.homed = X_BIT;
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	rig_free(&r);
}

static void a_program_from_elsewhere_is_refused(void **state)
{
	const struct cycle_config k = manual_config();
	struct interp_build *p = begin(INTERP_SIMULTANEOUS);
	struct bench b;
	struct made m;

	(void)state;
	cut_to(p, -5);
	m = finish(p);
	bench_init(&b, &k);
	jog(&b, INTERP_X, 1);
	run_out(&b, STATE_IDLE);
	assert_int_equal(cycle_load(&b.c, &m.p), ANSWER_ELSEWHERE);
	jog(&b, INTERP_X, -1);
	run_out(&b, STATE_IDLE);
	assert_int_equal(cycle_load(&b.c, &m.p), ANSWER_DONE);
	assert_int_equal(jog(&b, INTERP_X, 1), ANSWER_WRONG_STATE);
	unmake(&m);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_switch_is_home),
		cmocka_unit_test(an_index_mark_is_home),
		cmocka_unit_test(an_absolute_drive_says_where_it_is),
		cmocka_unit_test(a_limit_switch_is_where_the_drive_counts_now),
		cmocka_unit_test(backlash_does_not_move_home),
		cmocka_unit_test(axes_are_homed_in_their_order),
		cmocka_unit_test(no_switch_is_a_fault),
		cmocka_unit_test(a_stop_leaves_it_unhomed),
		cmocka_unit_test(only_axes_with_a_method_are_homed),
		cmocka_unit_test(unhomed_nothing_is_cut_if_so_configured),
		cmocka_unit_test(a_program_from_elsewhere_is_refused),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
