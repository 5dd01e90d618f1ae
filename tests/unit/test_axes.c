/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_axes.c - promises of the power of the axes: a start that waits for it,
 * faults that take it away, and who may give it back
 */
#include "manual_help.h"

#define WAIT_CYCLES	40

/* A job, and drives that are up but not enabled. */
static void make(struct rig *r)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct cycle_config k = usual_config();

	k.axes_wait_cycles = WAIT_CYCLES;
	rapid_to(b, -2);
	cut_to(b, -5);
	rig_load(r, b, &k);
	r->in.axes_off = true;
	step(r, OPEN_V);
}

/* As a drive would: on its place some cycles after it was told. */
static void enable(struct rig *r)
{
	steps(r, OPEN_V, 10);
	assert_true(r->out.enable);
	r->in.axes_off = false;
}

static void start(struct rig *r)
{
	assert_int_equal(tell(r, CYCLE_START), ANSWER_DONE);
	enable(r);
	until(r, STATE_TRAVEL, OPEN_V, 2);
}

static void a_start_waits_for_the_axes_and_goes_on_by_itself(void **st)
{
	struct rig r;

	(void)st;
	make(&r);
	assert_false(r.out.enable);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	for (int i = 0; i < 10; i++) {
		step(&r, OPEN_V);
		assert_true(r.out.enable);
		assert_int_equal(r.c.state, STATE_HOLD);
		assert_int_equal(r.out.target[INTERP_Z], 0);
	}
	r.in.axes_off = false;
	until(&r, STATE_ERODE, SPARKING_V, 2000);
	rig_free(&r);
}

static void a_second_start_does_not_begin_the_wait_anew(void **st)
{
	struct rig r;
	int i = 0;

	(void)st;
	make(&r);
	while (r.c.state != STATE_FAULT && i++ < 10 * WAIT_CYCLES) {
		tell(&r, CYCLE_START);
		step(&r, OPEN_V);
	}
	assert_int_equal(r.c.fault.first, FAULT_DRIVE);
	assert_in_range(i, WAIT_CYCLES, WAIT_CYCLES + 2);
	assert_false(r.out.enable);
	rig_free(&r);
}

/* Power comes, and what a PLC commands is carried out behind the look at the
 * inputs and in front of what waits for power. */
static void a_start_replaces_a_retract_that_waited_for_power(void **st)
{
	struct rig r;

	(void)st;
	make(&r);
	assert_int_equal(tell_mm(&r, CYCLE_RETRACT, 0.1), ANSWER_DONE);
	steps(&r, OPEN_V, 5);
	r.in.axes_off = r.c.axes.off = false;
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	for (int i = 0; i < 100; i++) {
		step(&r, OPEN_V);
		assert_false(r.c.hold.moving);
	}
	assert_int_equal(r.c.state, STATE_TRAVEL);
	rig_free(&r);
}

static void drives_that_are_not_up_refuse_start_and_retract(void **st)
{
	struct rig r;

	(void)st;
	make(&r);
	r.in.starting = true;
	step(&r, OPEN_V);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_NOT_UP);
	assert_int_equal(tell_mm(&r, CYCLE_RETRACT, 1), ANSWER_NOT_UP);
	steps(&r, OPEN_V, 10);
	assert_false(r.out.enable);
	r.in.starting = false;
	step(&r, OPEN_V);
	start(&r);
	rig_free(&r);
}

static void a_hold_or_stop_ends_the_wait(void **st)
{
	const enum cycle_verb verbs[] = { CYCLE_HOLD, CYCLE_STOP };

	(void)st;
	for (int i = 0; i < 2; i++) {
		struct rig r;

		make(&r);
		tell(&r, CYCLE_START);
		steps(&r, OPEN_V, 3);
		assert_int_equal(tell(&r, verbs[i]), ANSWER_DONE);
		r.in.axes_off = false;
		steps(&r, OPEN_V, 2 * WAIT_CYCLES);
		assert_int_equal(r.c.state, i ? STATE_IDLE : STATE_HOLD);
		assert_int_equal(r.c.fault.first, FAULT_NONE);
		rig_free(&r);
	}
}

/* Nothing moves yet, so nothing has to brake: it is over before the drives have
 * power, and the drives are not told to be at fault. */
static void a_jog_or_homing_that_ends_waits_no_longer(void **st)
{
	(void)st;
	for (int i = 0; i < 8; i++) {
		const bool fails = i & 1, drive = i & 2, home = i & 4;
		struct cycle_config k = manual_config();
		struct bench b;

		k.axes_wait_cycles = WAIT_CYCLES;
		k.axis[INTERP_Z].method = HOME_SWITCH;
		bench_init(&b, &k);
		b.in.axes_off = b.in.steers = true;
		period(&b);
		assert_int_equal(ask(&b, home ? CYCLE_HOME : CYCLE_JOG,
				     INTERP_Z, 1), ANSWER_DONE);
		period(&b);
		assert_true(b.out.enable);
		b.in.door_open = fails && !drive;
		b.in.trouble = fails && drive ? IO_FOLLOWING : IO_WELL;
		if (!fails)
			assert_int_equal(ask(&b, CYCLE_HOLD, 0, 0),
					 ANSWER_DONE);
		period(&b);
		period(&b);
		assert_int_equal(b.c.state, fails ? STATE_FAULT : STATE_IDLE);
		assert_int_equal(b.out.enable, !(fails && drive));
		for (int n = 0; n < 2 * WAIT_CYCLES; n++)
			period(&b);
		assert_int_equal(b.c.fault.first, !fails ? FAULT_NONE :
				 drive ? FAULT_FOLLOWING : FAULT_DOOR);
		assert_false(fault_is_latched(&b.c.fault, FAULT_DRIVE));
	}
}

static void troubles_are_faults_without_sparks_motion_or_power(void **st)
{
	const enum cycle_fault faults[IO_NTROUBLES] = {
		[IO_DRIVE] = FAULT_DRIVE, [IO_FOLLOWING] = FAULT_FOLLOWING,
		[IO_BUS] = FAULT_BUS,
	};

	(void)st;
	for (int t = IO_DRIVE; t < IO_NTROUBLES; t++) {
		struct rig r;

		make(&r);
		start(&r);
		until(&r, STATE_ERODE, SPARKING_V, 2000);
		r.in.trouble = (enum io_trouble)t;
		step(&r, SPARKING_V);
		assert_int_equal(r.c.state, STATE_FAULT);
		assert_int_equal(r.c.fault.first, faults[t]);
		assert_false(r.out.power);
		assert_false(r.out.enable);
		assert_memory_equal(r.out.target, r.before.target,
				    sizeof(r.out.target));
		rig_free(&r);
	}
}

/* Positioning at speed, with the other axes still following. */
static void where_the_others_follow_they_brake_before_power_is_taken(void **st)
{
	const enum io_trouble troubles[] = { IO_DRIVE, IO_FOLLOWING };

	(void)st;
	for (int t = 0; t < 2; t++) {
		struct rig r;
		double v;
		int n = 0;

		make(&r);
		start(&r);
		r.in.steers = true;
		steps(&r, OPEN_V, 100);
		v = r.c.mover.v_mm_s;
		assert_true(v > 1);
		r.in.trouble = troubles[t];
		r.in.axes_off = true;
		for (; r.c.state != STATE_FAULT; n++) {
			step(&r, OPEN_V);
			assert_false(r.out.power);
			assert_true(r.c.mover.v_mm_s <= v + 1e-9);
			assert_true(r.out.enable ||
				    r.c.state == STATE_FAULT);
			assert_int_equal(tell(&r, CYCLE_START),
					 ANSWER_WRONG_STATE);
		}
		assert_in_range(n, 3, 100);
		assert_false(r.out.enable);
		rig_free(&r);
	}
}

static void where_none_follows_any_more_the_braking_ends(void **st)
{
	struct rig r;

	(void)st;
	make(&r);
	start(&r);
	r.in.steers = true;
	steps(&r, OPEN_V, 60);
	r.in.trouble = IO_DRIVE;
	r.in.axes_off = true;
	step(&r, OPEN_V);
	assert_true(r.out.enable && r.c.state == STATE_HOLD);
	r.in.steers = false;
	step(&r, OPEN_V);
	assert_true(!r.out.enable && r.c.state == STATE_FAULT);
	assert_memory_equal(r.out.target, r.before.target,
			    sizeof(r.out.target));
	rig_free(&r);
}

static void a_reset_reaches_the_machine_and_starts_nothing(void **st)
{
	struct rig r;

	(void)st;
	make(&r);
	start(&r);
	r.in.trouble = IO_DRIVE;
	r.in.axes_off = true;
	step(&r, OPEN_V);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_WRONG_STATE);
	assert_int_equal(tell(&r, CYCLE_RESET), ANSWER_DONE);
	step(&r, OPEN_V);
	assert_true(r.out.reset);
	/* Nothing is cleared before the drives say that it is. */
	assert_int_equal(r.c.state, STATE_FAULT);
	r.in.trouble = IO_WELL;
	step(&r, OPEN_V);
	assert_int_equal(r.c.state, STATE_HOLD);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	for (int i = 0; i < 3 * WAIT_CYCLES; i++) {
		step(&r, OPEN_V);
		assert_false(r.out.reset);
		assert_false(r.out.enable);
		assert_int_equal(r.c.state, STATE_HOLD);
	}
	start(&r);
	rig_free(&r);
}

static void a_trouble_that_stays_is_not_cleared_by_a_reset(void **st)
{
	struct rig r;

	(void)st;
	make(&r);
	start(&r);
	r.in.trouble = IO_BUS;
	step(&r, OPEN_V);
	r.c.fault.untold = 0;
	tell(&r, CYCLE_RESET);
	for (int i = 0; i < 3; i++) {
		step(&r, OPEN_V);
		assert_int_equal(r.c.state, STATE_FAULT);
		assert_int_equal(r.c.fault.first, FAULT_BUS);
	}
	/* Whoever asked for the reset is told again. */
	assert_true(r.c.fault.untold == fault_bit(FAULT_BUS));
	rig_free(&r);
}

static void axes_that_lose_power_in_motion_are_a_fault(void **st)
{
	struct rig r;

	(void)st;
	make(&r);
	start(&r);
	steps(&r, OPEN_V, 20);
	r.in.axes_off = true;
	step(&r, OPEN_V);
	assert_int_equal(r.c.fault.first, FAULT_DRIVE);
	assert_memory_equal(r.out.target, r.before.target,
			    sizeof(r.out.target));
	rig_free(&r);
}

static void a_retract_waits_for_the_axes_too(void **st)
{
	struct rig r;
	double at;

	(void)st;
	make(&r);
	start(&r);
	until(&r, STATE_ERODE, SPARKING_V, 2000);
	r.in.estop = r.in.axes_off = true;
	step(&r, SPARKING_V);
	assert_false(r.out.enable);
	r.in.estop = false;
	step(&r, OPEN_V);
	tell(&r, CYCLE_RESET);
	step(&r, OPEN_V);
	at = place(&r);
	assert_int_equal(tell_mm(&r, CYCLE_RETRACT, 0.5), ANSWER_DONE);
	enable(&r);
	assert_near(place(&r), at, 1e-12);
	steps(&r, OPEN_V, 1000);
	assert_near(place(&r), at - 0.5, 2e-3);
	assert_int_equal(r.c.state, STATE_HOLD);
	rig_free(&r);
}

static void faults_of_the_gap_leave_the_axes_under_power(void **st)
{
	struct rig r;

	(void)st;
	make(&r);
	start(&r);
	until(&r, STATE_ERODE, SPARKING_V, 2000);
	r.in.gap_valid = false;
	until(&r, STATE_FAULT, SPARKING_V, 100);
	assert_true(r.out.enable);
	rig_free(&r);
}

static void a_machine_begins_where_its_file_says(void **st)
{
	struct cycle_config k = usual_config();
	const struct io_inputs in = { .gap_valid = true };
	struct io_outputs out;
	struct cycle c;

	(void)st;
	k.start[INTERP_Y] = -1234;
	cycle_init(&c, &k);
	cycle_step(&c, &in, &out);
	assert_int_equal(out.target[INTERP_Y], -1234);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_start_waits_for_the_axes_and_goes_on_by_itself),
		cmocka_unit_test(a_second_start_does_not_begin_the_wait_anew),
		cmocka_unit_test(
			a_start_replaces_a_retract_that_waited_for_power),
		cmocka_unit_test(drives_that_are_not_up_refuse_start_and_retract),
		cmocka_unit_test(a_hold_or_stop_ends_the_wait),
		cmocka_unit_test(a_jog_or_homing_that_ends_waits_no_longer),
		cmocka_unit_test(troubles_are_faults_without_sparks_motion_or_power),
		cmocka_unit_test(where_the_others_follow_they_brake_before_power_is_taken),
		cmocka_unit_test(where_none_follows_any_more_the_braking_ends),
		cmocka_unit_test(a_reset_reaches_the_machine_and_starts_nothing),
		cmocka_unit_test(a_trouble_that_stays_is_not_cleared_by_a_reset),
		cmocka_unit_test(axes_that_lose_power_in_motion_are_a_fault),
		cmocka_unit_test(a_retract_waits_for_the_axes_too),
		cmocka_unit_test(faults_of_the_gap_leave_the_axes_under_power),
		cmocka_unit_test(a_machine_begins_where_its_file_says),
	};

	return cmocka_run_group_tests_name("rt/axes", tests, NULL, NULL);
}
