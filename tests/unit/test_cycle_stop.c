/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_cycle_stop.c - promises of the cycle when it must not go on: hold, stop,
 * retract by command, faults
 */
#include "cycle_help.h"

/* Two millimetres of air, then a cut of three; begun. */
static void begin_job(struct rig *r, const struct cycle_config *k)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);

	rapid_to(b, -2);
	cut_to(b, -5);
	rig_load(r, b, k);
	assert_int_equal(tell(r, CYCLE_START), ANSWER_DONE);
}

/* Bring a fresh job to a state. */
static void drive_to(struct rig *r, enum cycle_state s)
{
	struct cycle_config k = usual_config();

	k.jump.height_mm = 0.5;
	begin_job(r, &k);
	if (s == STATE_IDLE || s == STATE_HOLD)
		tell(r, s == STATE_IDLE ? CYCLE_STOP : CYCLE_HOLD);
	else if (s == STATE_TRAVEL)
		steps(r, OPEN_V, 20);
	else if (s == STATE_RETRACT)
		cut_until(r, 3);
	until(r, s, s == STATE_RETRACT ? SHORTED_V :
		    s == STATE_APPROACH ? OPEN_V : SPARKING_V, 1000);
}

static const enum cycle_state drivable[] = {
	STATE_IDLE, STATE_TRAVEL, STATE_APPROACH, STATE_ERODE, STATE_RETRACT,
	STATE_JUMP, STATE_HOLD,
};

#define EACH_DRIVABLE(i) \
	for (size_t i = 0; i < sizeof(drivable) / sizeof(drivable[0]); i++)

/* -- The e-stop ---------------------------------------------------------- */

static void an_e_stop_stops_at_once_from_every_state(void **st)
{
	(void)st;
	EACH_DRIVABLE(i) {
		struct rig r;

		drive_to(&r, drivable[i]);
		r.in.estop = true;
		step(&r, SPARKING_V);
		assert_int_equal(r.c.state, STATE_FAULT);
		assert_int_equal(r.c.fault.first, FAULT_ESTOP);
		assert_false(r.out.power);
		assert_memory_equal(r.out.target, r.before.target,
				    sizeof(r.out.target));
		rig_free(&r);
	}
}

static void an_e_stop_by_command_stops_at_once_from_every_state(void **st)
{
	(void)st;
	EACH_DRIVABLE(i) {
		struct rig r;

		drive_to(&r, drivable[i]);
		assert_int_equal(tell(&r, CYCLE_ESTOP), ANSWER_DONE);
		step(&r, SPARKING_V);
		assert_int_equal(r.c.state, STATE_FAULT);
		assert_false(r.out.power);
		assert_memory_equal(r.out.target, r.before.target,
				    sizeof(r.out.target));
		rig_free(&r);
	}
}

static void nothing_moves_and_nothing_starts_in_a_fault(void **st)
{
	(void)st;
	EACH_DRIVABLE(i) {
		struct rig r;

		drive_to(&r, drivable[i]);
		tell(&r, CYCLE_ESTOP);
		steps(&r, SPARKING_V, 50);
		assert_int_not_equal(tell(&r, CYCLE_START), ANSWER_DONE);
		assert_int_not_equal(tell(&r, CYCLE_HOLD), ANSWER_DONE);
		assert_int_not_equal(tell_mm(&r, CYCLE_RETRACT, 1),
				     ANSWER_DONE);
		steps(&r, SHORTED_V, 50);
		assert_int_equal(r.c.state, STATE_FAULT);
		rig_free(&r);
	}
}

static void an_e_stop_still_pressed_is_not_reset(void **st)
{
	struct rig r;

	(void)st;
	drive_to(&r, STATE_ERODE);
	r.in.estop = true;
	step(&r, SPARKING_V);
	assert_int_equal(tell(&r, CYCLE_RESET), ANSWER_STILL_THERE);
	step(&r, SPARKING_V);
	assert_int_equal(r.c.state, STATE_FAULT);
	r.in.estop = false;
	step(&r, SPARKING_V);
	assert_int_equal(tell(&r, CYCLE_RESET), ANSWER_DONE);
	step(&r, SPARKING_V);
	assert_int_equal(r.c.state, STATE_HOLD);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	until(&r, STATE_IDLE, SPARKING_V, 100000);
	assert_int_equal(r.c.outcome, OUTCOME_DONE);
	rig_free(&r);
}

static void an_e_stop_while_braking_stops_at_once(void **st)
{
	static const enum cycle_verb brakes[] = { CYCLE_HOLD, CYCLE_STOP };

	(void)st;
	for (int i = 0; i < 2; i++) {
		struct rig r;

		drive_to(&r, STATE_TRAVEL);
		tell(&r, brakes[i]);
		steps(&r, OPEN_V, 5);
		assert_int_equal(r.c.state, STATE_HOLD);
		assert_true(r.c.feed_mm_s > 0);
		r.in.estop = true;
		step(&r, OPEN_V);
		assert_int_equal(r.c.state, STATE_FAULT);
		assert_memory_equal(r.out.target, r.before.target,
				    sizeof(r.out.target));
		rig_free(&r);
	}
}

/* -- Hold, stop, retract by command -------------------------------------- */

static void a_hold_brakes_within_the_braking_distance(void **st)
{
	(void)st;
	for (int n = 1; n < 60; n++) {
		const struct cycle_config k = usual_config();
		struct interp_scurve_limits l = { 1, k.travel_a_mm_s2,
						  k.travel_a_mm_s2,
						  k.travel_j_mm_s3 };
		double way, from;
		struct rig r;

		begin_job(&r, &k);
		steps(&r, OPEN_V, n);
		way = interp_scurve_way_mm(&l, r.c.mover.v_mm_s,
					   r.c.mover.a_mm_s2, 0);
		from = place(&r);
		assert_int_equal(tell(&r, CYCLE_HOLD), ANSWER_DONE);
		steps(&r, OPEN_V, 200);
		assert_int_equal(r.c.state, STATE_HOLD);
		assert_true(r.c.feed_mm_s == 0);
		assert_true(place(&r) >= from - 1e-9);
		assert_near(place(&r) - from, way, 1e-8);
		rig_free(&r);
	}
}

static void a_held_job_goes_on_where_it_stood(void **st)
{
	(void)st;
	EACH_DRIVABLE(i) {
		struct rig r;

		if (drivable[i] == STATE_IDLE)
			continue;
		drive_to(&r, drivable[i]);
		tell(&r, CYCLE_HOLD);
		steps(&r, SPARKING_V, 300);
		assert_int_equal(r.c.state, STATE_HOLD);
		assert_int_equal(tell(&r, CYCLE_RESUME), ANSWER_DONE);
		until(&r, STATE_IDLE, SPARKING_V, 200000);
		assert_int_equal(r.c.outcome, OUTCOME_DONE);
		assert_int_equal(r.out.target[INTERP_Z], -5000);
		rig_free(&r);
	}
}

static void a_stop_ends_the_job_with_outcome_stopped(void **st)
{
	(void)st;
	EACH_DRIVABLE(i) {
		struct rig r;

		if (drivable[i] == STATE_IDLE)
			continue;
		drive_to(&r, drivable[i]);
		assert_int_equal(tell(&r, CYCLE_STOP), ANSWER_DONE);
		until(&r, STATE_IDLE, SPARKING_V, 300);
		assert_int_equal(r.c.outcome, OUTCOME_STOPPED);
		assert_string_equal(cycle_outcome_name(r.c.outcome), "stopped");
		assert_int_equal(tell(&r, CYCLE_START), ANSWER_NO_PROGRAM);
		rig_free(&r);
	}
}

/* Whichever comes first, in which period, and however the motion ends. */
static void a_stop_counts_although_a_fault_comes_too(void **st)
{
	(void)st;
	for (int way = 0; way < 12; way++) {
		const bool ends = way % 2, fault_first = way / 2 % 2;
		struct rig r;

		drive_to(&r, STATE_TRAVEL);
		if (fault_first)
			r.in.door_open = true;
		else
			tell(&r, CYCLE_STOP);
		steps(&r, OPEN_V, 1 + way / 4);
		if (fault_first)
			assert_int_equal(tell(&r, CYCLE_STOP), ANSWER_DONE);
		r.in.door_open = !ends;
		r.in.lost = ends;
		steps(&r, OPEN_V, 300);
		assert_int_equal(r.c.state, STATE_FAULT);
		assert_false(r.c.loaded);
		assert_int_equal(r.c.outcome, OUTCOME_STOPPED);
		r.in.lost = r.in.door_open = false;
		step(&r, OPEN_V);
		assert_int_equal(tell(&r, CYCLE_RESET), ANSWER_DONE);
		assert_int_equal(r.c.state, STATE_IDLE);
		rig_free(&r);
	}
}

static void held_at_mm(struct rig *r, double mm)
{
	drive_to(r, STATE_APPROACH);
	cut_until(r, mm);
	tell(r, CYCLE_HOLD);
	steps(r, SPARKING_V, 300);
}

static void a_retract_by_command_goes_back_that_far_and_holds(void **st)
{
	static const double mm[] = { 0.001, 0.5, 1.7, 2.5 };

	(void)st;
	for (int i = 0; i < 4; i++) {
		struct rig r;
		double from;

		held_at_mm(&r, 3);
		from = place(&r);
		assert_int_equal(tell_mm(&r, CYCLE_RETRACT, mm[i]),
				 ANSWER_DONE);
		steps(&r, SPARKING_V, 2000);
		assert_int_equal(r.c.state, STATE_HOLD);
		assert_false(r.c.hold.moving);
		assert_near(from - place(&r), mm[i], 2e-9);
		rig_free(&r);
	}
}

static void a_retract_by_command_works_while_the_job_runs(void **st)
{
	struct rig r;

	(void)st;
	drive_to(&r, STATE_APPROACH);
	cut_until(&r, 3);
	assert_int_equal(tell_mm(&r, CYCLE_RETRACT, 1), ANSWER_DONE);
	steps(&r, SPARKING_V, 2000);
	assert_int_equal(r.c.state, STATE_HOLD);
	assert_near(place(&r), 2, 0.01);
	rig_free(&r);
}

static void a_retract_beyond_the_start_ends_at_the_start(void **st)
{
	struct rig r;

	(void)st;
	held_at_mm(&r, 3);
	assert_int_equal(tell_mm(&r, CYCLE_RETRACT, 1e9), ANSWER_DONE);
	steps(&r, SPARKING_V, 2000);
	assert_int_equal(r.c.state, STATE_HOLD);
	assert_false(r.c.hold.moving);
	assert_true(place(&r) == 0 && r.out.target[INTERP_Z] == 0);
	rig_free(&r);
}

static void commands_that_make_no_sense_are_refused(void **st)
{
	static const double bad[] = { 0, -1, NAN, INFINITY, -INFINITY };
	static const enum cycle_verb of_a_job[] = {
		CYCLE_START, CYCLE_HOLD, CYCLE_RESUME, CYCLE_STOP,
		CYCLE_RETRACT, CYCLE_SET, CYCLE_STEP, CYCLE_CONFIRM,
	};
	const struct cycle_config k = usual_config();
	struct cycle_command odd = { .verb = CYCLE_NVERBS };
	struct rig r;

	(void)st;
	held_at_mm(&r, 3);
	for (int i = 0; i < 5; i++)
		assert_int_equal(tell_mm(&r, CYCLE_RETRACT, bad[i]),
				 ANSWER_BAD_ARGUMENT);
	assert_int_equal(cycle_command(&r.c, &odd), ANSWER_BAD_ARGUMENT);
	odd.verb = UINT32_MAX;
	assert_int_equal(cycle_command(&r.c, &odd), ANSWER_BAD_ARGUMENT);
	assert_int_equal(tell(&r, CYCLE_RESET), ANSWER_WRONG_STATE);
	assert_int_equal(cycle_load(&r.c, &r.m.p), ANSWER_WRONG_STATE);
	cycle_init(&r.c, &k);
	for (size_t i = 0; i < sizeof(of_a_job) / sizeof(of_a_job[0]); i++)
		assert_int_equal(tell_mm(&r, of_a_job[i], 1),
				 ANSWER_NO_PROGRAM);
	rig_free(&r);
}

/* Held in front of what is to be done, it is not done. */
static void no_action_is_done_while_held(void **st)
{
	struct cycle_config k = usual_config();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct rig r;

	(void)st;
	k.dry_run = true;
	cut_to(b, -0.1);
	action(b, INTERP_DWELL, 50);
	action(b, INTERP_AUX, INTERP_AUX_PUMP_ON);
	rig_load(&r, b, &k);
	tell(&r, CYCLE_START);
	while (!r.c.job.dwelling)
		step(&r, OPEN_V);
	steps(&r, OPEN_V, 10);
	tell(&r, CYCLE_HOLD);
	steps(&r, OPEN_V, 200);
	assert_int_equal(r.c.state, STATE_HOLD);
	assert_false(r.out.pump);
	tell(&r, CYCLE_START);
	assert_in_range(until(&r, STATE_IDLE, OPEN_V, 100), 39, 45);
	assert_true(r.out.pump);
	assert_int_equal(r.c.outcome, OUTCOME_DONE);
	rig_free(&r);
}

/* -- Faults -------------------------------------------------------------- */

static void a_short_while_positioning_is_a_contact(void **st)
{
	const struct cycle_config k = usual_config();
	double v, from;
	struct rig r;

	(void)st;
	begin_job(&r, &k);
	steps(&r, OPEN_V, 20);
	v = r.c.feed_mm_s;
	from = place(&r);
	step(&r, SHORTED_V);
	assert_int_equal(r.c.fault.first, FAULT_CONTACT);
	until(&r, STATE_FAULT, SHORTED_V, 100);
	assert_true(place(&r) - from <= braking_mm(&k, v));
	assert_int_equal(r.c.outcome, OUTCOME_FAULT);
	rig_free(&r);
}

static void a_short_that_was_there_before_is_no_contact(void **st)
{
	const struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	begin_job(&r, &k);
	steps(&r, SHORTED_V, 20);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	steps(&r, OPEN_V, 2);
	step(&r, SHORTED_V);
	assert_int_equal(r.c.fault.first, FAULT_CONTACT);
	rig_free(&r);
}

/* check_always() sees that no target ever lies outside. */
static void the_path_is_stopped_at_the_soft_limit(void **st)
{
	(void)st;
	for (int dry = 0; dry < 2; dry++) {
		struct cycle_config k = usual_config();
		struct rig r;

		k.travel_min[INTERP_Z] = -3000;
		k.dry_run = dry;
		begin_job(&r, &k);
		until(&r, STATE_FAULT, SPARKING_V, 100000);
		assert_int_equal(r.c.fault.first, FAULT_SOFT_LIMIT);
		assert_in_range(-r.out.target[INTERP_Z], 2950, 3000);
		tell(&r, CYCLE_RESET);
		assert_int_equal(tell_mm(&r, CYCLE_RETRACT, 1), ANSWER_DONE);
		steps(&r, SPARKING_V, 2000);
		assert_int_equal(r.c.state, STATE_HOLD);
		assert_near(z_mm(&r), -2, 0.01);
		rig_free(&r);
	}
}

static void a_lost_gap_is_a_fault_while_anything_moves(void **st)
{
	(void)st;
	EACH_DRIVABLE(i) {
		struct rig r;

		drive_to(&r, drivable[i]);
		r.in.gap_valid = false;
		steps(&r, SPARKING_V, 3);
		assert_int_equal(r.c.fault.first,
				 drivable[i] == STATE_IDLE ||
				 drivable[i] == STATE_HOLD ?
				 FAULT_NONE : FAULT_GAP_LOST);
		rig_free(&r);
	}
}

/* Braking reaches the end of the program: the fault is not forgotten. */
static void a_fault_just_before_the_end_is_no_job_done(void **st)
{
	(void)st;
	for (int um = 1; um < 15; um++) {
		struct cycle_config k = usual_config();
		struct rig r;

		k.gap.gain_mm_s_v = 1;
		begin_job(&r, &k);
		until(&r, STATE_APPROACH, OPEN_V, 1000);
		cut_until(&r, 5 - um * 1e-3);
		if (r.c.state == STATE_IDLE) {
			rig_free(&r);
			continue;
		}
		r.in.gap_valid = false;
		until(&r, STATE_FAULT, SPARKING_V, 100);
		assert_int_equal(r.c.outcome, OUTCOME_FAULT);
		assert_int_equal(r.c.fault.first, FAULT_GAP_LOST);
		rig_free(&r);
	}
}

static void a_lost_machine_is_a_fault_at_once(void **st)
{
	(void)st;
	EACH_DRIVABLE(i) {
		struct rig r;

		drive_to(&r, drivable[i]);
		r.in.lost = true;
		step(&r, SPARKING_V);
		assert_int_equal(r.c.state, STATE_FAULT);
		assert_int_equal(r.c.fault.first, FAULT_IO_LOST);
		rig_free(&r);
	}
}

static void too_many_missed_periods_in_a_row_are_a_fault(void **st)
{
	struct rig r;

	(void)st;
	drive_to(&r, STATE_ERODE);
	for (int i = 0; i < 100; i++) {
		cycle_overrun(&r.c, 9);
		step(&r, NARROW_V);
		step(&r, NARROW_V);
	}
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	assert_int_equal(r.c.totals.overruns, 900);
	for (int i = 0; i < 10; i++) {
		assert_int_equal(r.c.fault.first, FAULT_NONE);
		cycle_overrun(&r.c, 1);
		step(&r, NARROW_V);
	}
	assert_int_equal(r.c.fault.first, FAULT_OVERRUN);
	rig_free(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(an_e_stop_stops_at_once_from_every_state),
		cmocka_unit_test(an_e_stop_by_command_stops_at_once_from_every_state),
		cmocka_unit_test(nothing_moves_and_nothing_starts_in_a_fault),
		cmocka_unit_test(an_e_stop_still_pressed_is_not_reset),
		cmocka_unit_test(an_e_stop_while_braking_stops_at_once),
		cmocka_unit_test(a_hold_brakes_within_the_braking_distance),
		cmocka_unit_test(a_held_job_goes_on_where_it_stood),
		cmocka_unit_test(a_stop_ends_the_job_with_outcome_stopped),
		cmocka_unit_test(a_stop_counts_although_a_fault_comes_too),
		cmocka_unit_test(a_retract_by_command_goes_back_that_far_and_holds),
		cmocka_unit_test(a_retract_by_command_works_while_the_job_runs),
		cmocka_unit_test(a_retract_beyond_the_start_ends_at_the_start),
		cmocka_unit_test(commands_that_make_no_sense_are_refused),
		cmocka_unit_test(no_action_is_done_while_held),
		cmocka_unit_test(a_short_while_positioning_is_a_contact),
		cmocka_unit_test(a_short_that_was_there_before_is_no_contact),
		cmocka_unit_test(the_path_is_stopped_at_the_soft_limit),
		cmocka_unit_test(a_lost_gap_is_a_fault_while_anything_moves),
		cmocka_unit_test(a_fault_just_before_the_end_is_no_job_done),
		cmocka_unit_test(a_lost_machine_is_a_fault_at_once),
		cmocka_unit_test(too_many_missed_periods_in_a_row_are_a_fault),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
