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

/* The mark after the switch, wherever the switch comes between two, and however
 * long the drive takes until it looks for it. */
static void an_index_mark_is_home(void **state)
{
	(void)state;
	for (int32_t at = -49900; at < -46000; at += 370) {
		const struct cycle_config k = home_config(HOME_SWITCH_INDEX);
		const int32_t mark = (int32_t)floor(at / 2000.0) * 2000;
		struct bench b;

		bench_init(&b, &k);
		b.home[INTERP_X] = at;
		b.latch_cycles = -at % 300;
		ask(&b, CYCLE_HOME, INTERP_X, 0);
		run_out(&b, STATE_IDLE);
		check_homed(&b, INTERP_X, mark);
	}
}

static void a_drive_that_cannot_latch_finds_no_home(void **state)
{
	const struct cycle_config k = home_config(HOME_SWITCH_INDEX);
	struct bench b;
	int32_t at;

	(void)state;
	bench_init(&b, &k);
	b.latch_cycles = 1000000;
	ask(&b, CYCLE_HOME, INTERP_X, 0);
	while (!b.out.latch)
		period(&b);
	for (int i = 0; i < 20; i++)
		period(&b);
	at = b.out.target[INTERP_X];
	for (int i = 0; i < 200; i++)
		period(&b);
	assert_int_equal(b.out.target[INTERP_X], at);
	assert_int_equal(b.c.state, STATE_HOME);
	b.in.unfound = X_BIT;
	run_out(&b, STATE_FAULT);
	assert_int_equal(b.c.fault.first, FAULT_HOME);
	assert_int_equal(b.out.latch, 0);
}

static void an_absolute_drive_says_where_it_is(void **state)
{
	const struct cycle_config k = home_config(HOME_ABSOLUTE);
	struct bench b;

	(void)state;
	bench_init(&b, &k);
	b.own_more = 25000;
	jog(&b, INTERP_X, 3);
	run_out(&b, STATE_IDLE);
	assert_int_equal(ask(&b, CYCLE_HOME, MANUAL_ALL_AXES, 0), ANSWER_DONE);
	run_out(&b, STATE_IDLE);
	assert_int_equal(b.c.out.target[INTERP_X], 28000 - 10000);
	assert_int_equal(b.out.target[INTERP_X], 3000);
	assert_int_equal(manual_unhomed(&b.c), 0);
}

/* Its battery was empty: it says something that can be nowhere here. */
static void a_place_out_of_the_travel_is_no_home(void **state)
{
	const struct cycle_config k = home_config(HOME_ABSOLUTE);
	struct bench b;

	(void)state;
	bench_init(&b, &k);
	b.own_more = k.travel_max[INTERP_X] + 10000 + 5000 + 1;
	ask(&b, CYCLE_HOME, INTERP_X, 0);
	run_out(&b, STATE_FAULT);
	assert_int_equal(b.c.fault.first, FAULT_HOME);
	assert_int_equal(manual_unhomed(&b.c), X_BIT);
	b.own_more--;
	ask(&b, CYCLE_RESET, 0, 0);
	ask(&b, CYCLE_HOME, INTERP_X, 0);
	run_out(&b, STATE_IDLE);
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

/* Travel of 3 mm to both sides, and no switch. */
static struct cycle_config switchless(struct bench *b, double at_mm, int toward)
{
	struct cycle_config k = home_config(HOME_SWITCH);

	k.travel_min[INTERP_X] = -3000;
	k.travel_max[INTERP_X] = 3000;
	k.axis[INTERP_X].home_at_mm = at_mm;
	k.axis[INTERP_X].home_toward = toward;
	bench_init(b, &k);
	b->home[INTERP_X] = INT32_MIN;
	return k;
}

static void home_in_vain(struct bench *b)
{
	assert_int_equal(ask(b, CYCLE_HOME, INTERP_X, 0), ANSWER_DONE);
	run_out(b, STATE_FAULT);
	assert_string_equal(fault_name(b->c.fault.first), "home-not-found");
	assert_int_equal(manual_unhomed(&b->c), X_BIT);
	assert_int_equal(ask(b, CYCLE_RESET, 0, 0), ANSWER_DONE);
}

/* The way of the period in which it is seen, and of the one before. */
#define OVER	42

/* From the far end of the travel to the switch, and home_search_mm. */
static void a_search_ends_where_the_switch_is_at_last(void **state)
{
	static const struct { double at_mm; int32_t most; } rows[] = {
		{ -3, 6000 }, { 0, 3000 }, { 2, 1000 }, { -3.5, 6500 },
		{ 5, 0 },
	};

	(void)state;
	for (int i = 0; i < 10; i++) {
		const int toward = i % 2 ? 1 : -1;
		struct bench b;

		switchless(&b, -toward * rows[i / 2].at_mm, toward);
		home_in_vain(&b);
		assert_in_range(toward * b.out.target[INTERP_X],
				rows[i / 2].most + 5000,
				rows[i / 2].most + 5000 + OVER);
	}
}

/* However often it is asked, and from wherever: not a pulse farther. */
static void a_search_in_vain_is_not_begun_anew(void **state)
{
	struct bench b;

	(void)state;
	switchless(&b, -3, -1);
	home_in_vain(&b);
	for (int i = 0; i < 20; i++) {
		if (i % 2)
			jog(&b, INTERP_X, 2);
		run_out(&b, STATE_IDLE);
		home_in_vain(&b);
		assert_in_range(-b.out.target[INTERP_X], 11000, 11000 + OVER);
	}
	/* The switch is mended, and the axis is jogged onto it. */
	b.home[INTERP_X] = -12000;
	jog(&b, INTERP_X, -3);
	run_out(&b, STATE_IDLE);
	assert_int_equal(ask(&b, CYCLE_HOME, INTERP_X, 0), ANSWER_DONE);
	run_out(&b, STATE_IDLE);
	assert_int_equal(manual_unhomed(&b.c), 0);
}

static void a_known_place_is_not_left_by_more_than_the_search(void **state)
{
	struct bench b;

	(void)state;
	switchless(&b, -3, -1);
	b.home[INTERP_X] = -2500;
	ask(&b, CYCLE_HOME, INTERP_X, 0);
	run_out(&b, STATE_IDLE);
	jog(&b, INTERP_X, 4);
	run_out(&b, STATE_IDLE);
	b.home[INTERP_X] = INT32_MIN;
	home_in_vain(&b);
	assert_in_range(-b.out.target[INTERP_X], 2500 + 5000,
			2500 + 5000 + OVER);
}

/* Stuck, or one that comes and goes: the way off it has an end too. */
static void a_switch_that_stays_on_is_left_only_so_far(void **state)
{
	(void)state;
	for (int every = 0; every < 3; every++) {
		struct bench b;

		switchless(&b, 0, -1);
		b.home[INTERP_X] = INT32_MAX;
		assert_int_equal(ask(&b, CYCLE_HOME, INTERP_X, 0),
				 ANSWER_DONE);
		for (int i = 0; i < 200000 && b.c.state == STATE_HOME; i++) {
			b.home[INTERP_X] = every && i % (50 * every) > 40 ?
					   INT32_MIN : INT32_MAX;
			period(&b);
		}
		assert_int_equal(b.c.fault.first, FAULT_HOME);
		assert_in_range(b.out.target[INTERP_X], 8000, 8000 + OVER);
	}
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

/* Nothing moves, and the axis counts on from there. */
/* The drive moves by itself, and then counts from its own zero. */
static void a_drive_homes_by_itself(void **state)
{
	const struct cycle_config k = home_config(HOME_DRIVE);
	struct bench b;

	(void)state;
	bench_init(&b, &k);
	b.in.limit = X_BIT;		/* its own method may begin there */
	period(&b);
	assert_int_equal(ask(&b, CYCLE_HOME, INTERP_X, 0), ANSWER_DONE);
	for (int i = 0; i < 100; i++) {
		b.in.homing = i > 2 ? X_BIT : 0;
		b.in.limit = i < 50 ? X_BIT : 0;
		period(&b);
		assert_int_equal(b.c.state, STATE_HOME);
		assert_int_equal(b.c.manual.unplaced, X_BIT);
	}
	assert_int_equal(b.out.home, X_BIT);
	b.in.homing = 0;
	b.in.homed = X_BIT;
	b.own_more = 25000;
	run_out(&b, STATE_IDLE);
	assert_int_equal(b.out.home, 0);
	assert_int_equal(b.c.out.target[INTERP_X], 25000 - 10000);
	assert_int_equal(b.out.target[INTERP_X], 0);
	assert_int_equal(manual_unhomed(&b.c), 0);
	assert_int_equal(b.most, 0);
}

static void a_stop_waits_until_the_drive_has_ended_its_homing(void **state)
{
	const struct cycle_config k = home_config(HOME_DRIVE);
	struct bench b;

	(void)state;
	bench_init(&b, &k);
	ask(&b, CYCLE_HOME, INTERP_X, 0);
	b.in.homing = X_BIT;
	for (int i = 0; i < 10; i++)
		period(&b);
	ask(&b, CYCLE_HOLD, 0, 0);
	for (int i = 0; i < 10; i++) {
		period(&b);
		assert_int_equal(b.out.home, 0);
		assert_int_equal(b.c.state, STATE_HOME);
	}
	b.in.homing = 0;
	b.in.unfound = X_BIT;
	run_out(&b, STATE_IDLE);
	assert_int_equal(b.c.manual.unplaced, X_BIT);
	b.in.unfound = 0;
	ask(&b, CYCLE_HOME, INTERP_X, 0);
	period(&b);
	b.in.unfound = X_BIT;
	run_out(&b, STATE_FAULT);
	assert_int_equal(b.c.fault.first, FAULT_HOME);
	assert_int_equal(b.out.home, 0);
}

static void a_person_says_where_an_axis_stands(void **state)
{
	struct bench b;
	struct cycle_config k = manual_config();
	int32_t drive;

	(void)state;
	k.axis[INTERP_X].method = HOME_SWITCH;
	k.comp.axis[INTERP_Z].backlash = 12;
	bench_init(&b, &k);
	period(&b);
	assert_int_equal(jog(&b, INTERP_Z, -3), ANSWER_DONE);
	assert_int_equal(ask(&b, CYCLE_PLACE, INTERP_Z, 5), ANSWER_WRONG_STATE);
	run_out(&b, STATE_IDLE);
	period(&b);
	drive = b.out.target[INTERP_Z];
	assert_int_equal(ask(&b, CYCLE_PLACE, INTERP_Z, 12.345), ANSWER_DONE);
	for (int i = 0; i < 100; i++)
		period(&b);
	assert_int_equal(b.out.target[INTERP_Z], drive);
	assert_int_equal(b.c.out.target[INTERP_Z],
			 lround(12.345 / PULSE_MM));
	assert_int_equal(jog(&b, INTERP_Z, -1), ANSWER_DONE);
	run_out(&b, STATE_IDLE);
	assert_int_equal(b.c.out.target[INTERP_Z],
			 lround(11.345 / PULSE_MM));
	assert_int_equal(b.out.target[INTERP_Z],
			 drive - lround(1 / PULSE_MM));
	assert_int_equal(ask(&b, CYCLE_PLACE, INTERP_X, 1),
			 ANSWER_BAD_ARGUMENT);
	assert_int_equal(ask(&b, CYCLE_PLACE, INTERP_Z, 1e9), ANSWER_BEYOND);
	assert_int_equal(ask(&b, CYCLE_PLACE, INTERP_Z, NAN),
			 ANSWER_BAD_ARGUMENT);
	assert_int_equal(ask(&b, CYCLE_PLACE, INTERP_NAXES, 1),
			 ANSWER_BAD_ARGUMENT);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_switch_is_home),
		cmocka_unit_test(an_index_mark_is_home),
		cmocka_unit_test(a_drive_that_cannot_latch_finds_no_home),
		cmocka_unit_test(an_absolute_drive_says_where_it_is),
		cmocka_unit_test(a_limit_switch_is_where_the_drive_counts_now),
		cmocka_unit_test(backlash_does_not_move_home),
		cmocka_unit_test(axes_are_homed_in_their_order),
		cmocka_unit_test(a_place_out_of_the_travel_is_no_home),
		cmocka_unit_test(a_search_ends_where_the_switch_is_at_last),
		cmocka_unit_test(a_search_in_vain_is_not_begun_anew),
		cmocka_unit_test(
			a_known_place_is_not_left_by_more_than_the_search),
		cmocka_unit_test(a_switch_that_stays_on_is_left_only_so_far),
		cmocka_unit_test(a_stop_leaves_it_unhomed),
		cmocka_unit_test(only_axes_with_a_method_are_homed),
		cmocka_unit_test(unhomed_nothing_is_cut_if_so_configured),
		cmocka_unit_test(a_program_from_elsewhere_is_refused),
		cmocka_unit_test(a_drive_homes_by_itself),
		cmocka_unit_test(
			a_stop_waits_until_the_drive_has_ended_its_homing),
		cmocka_unit_test(a_person_says_where_an_axis_stands),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
