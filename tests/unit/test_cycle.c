/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_cycle.c - promises of the cycle while a job runs: gap, retract, jump,
 * actions
 */
#include "cycle_help.h"

/* -- The gap ------------------------------------------------------------- */

#define Z_A	1000			/* mm/s2 */

/* Cycles from the speed of a cut to that of a retract, by what Z can do. */
#define RAMP	6

static void in_three_zones_it_feeds_in_proportion_stands_or_goes_back(void **st)
{
	const struct cycle_config k = usual_config();
	const double low = (k.gap.short_v + k.gap.servo_v) / 2;
	struct rig r;

	(void)st;
	cut_at(&r, &k, 2);
	steps(&r, k.gap.servo_v, 5);
	for (double v = k.gap.servo_v; v < 60; v += 0.5) {
		step(&r, v);
		assert_near(r.c.feed_mm_s, k.gap.gain_mm_s_v *
				   (v - k.gap.servo_v), 1e-9);
	}
	step(&r, k.gap.servo_v);
	for (double v = low; v <= k.gap.servo_v; v += 0.5) {
		step(&r, v);
		assert_true(r.c.feed_mm_s == 0 && r.out.power);
		assert_int_equal(r.c.state, STATE_ERODE);
	}
	for (double v = k.gap.short_v; v < low; v += 0.5) {
		step(&r, v);
		assert_near(r.c.feed_mm_s,
			    -fmin(k.gap.gain_mm_s_v * (low - v),
				  k.gap.creep_mm_s), 1e-9);
		assert_true(r.out.power);
	}
	step(&r, k.gap.short_v - 0.01);
	assert_int_equal(r.c.state, STATE_RETRACT);
	assert_false(r.out.power);
	steps(&r, k.gap.short_v - 0.01, RAMP);
	assert_near(r.c.feed_mm_s, -k.gap.retract_mm_s, 1e-9);
	rig_free(&r);
}

static void the_feed_is_limited_by_machine_and_program(void **st)
{
	struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	k.gap.gain_mm_s_v = 1000;
	cut_at(&r, &k, 2);
	for (int i = 0; i < RAMP; i++) {
		step(&r, SPARKING_V);
		assert_true(r.c.feed_mm_s <= k.gap.feed_max_mm_s + 1e-9);
	}
	assert_near(r.c.feed_mm_s, k.gap.feed_max_mm_s, 1e-9);
	rig_free(&r);
	k.gap.feed_max_mm_s = 1000;
	cut_at(&r, &k, 2);
	for (int i = 0; i < 2 * RAMP; i++) {
		step(&r, SPARKING_V);
		assert_true(r.c.feed_mm_s <= 10 + 1e-6);
	}
	assert_near(r.c.feed_mm_s, 10, 1e-6);
	rig_free(&r);
}

static void it_approaches_until_the_first_spark(void **st)
{
	const struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	begin_cut(&r, &k);
	until(&r, STATE_APPROACH, OPEN_V, 1000);
	assert_near(place(&r), 1, 0.01);
	steps(&r, OPEN_V, 100);
	assert_int_equal(r.c.state, STATE_APPROACH);
	assert_near(r.c.feed_mm_s, k.gap.approach_mm_s, 1e-9);
	step(&r, SPARKING_V);
	assert_int_equal(r.c.state, STATE_ERODE);
	rig_free(&r);
}

/* What the time left is learnt from: what waits is none of the three. */
static void a_period_is_cut_or_positioned_or_something_else(void **st)
{
	const struct cycle_config k = usual_config();
	const struct cycle_totals *t;
	struct cycle_totals was;
	struct rig r;

	(void)st;
	begin_cut(&r, &k);
	t = &r.c.totals;
	r.c.override = 0;
	steps(&r, OPEN_V, 50);
	was = *t;
	assert_in_range(was.cycles, 49, 51);
	assert_int_equal(t->cut_cycles + t->moved_cycles + t->other_cycles, 0);
	r.c.override = 0.1;
	until(&r, STATE_APPROACH, OPEN_V, 10000);
	assert_in_range(t->cycles - was.cycles - t->moved_cycles, 0, 1);
	assert_true(t->moved_cycles > 50);
	assert_int_equal(t->cut_cycles, 0);
	was = *t;
	steps(&r, OPEN_V, 100);			/* through air */
	assert_int_equal(t->other_cycles - was.other_cycles, 100);
	assert_int_equal(t->cut_cycles, 0);
	was = *t;
	steps(&r, SPARKING_V, 100);
	until(&r, STATE_RETRACT, SHORTED_V, 100);
	until(&r, STATE_ERODE, SPARKING_V, 1000);
	assert_in_range(t->cycles - was.cycles -
			(t->cut_cycles - was.cut_cycles), 0, 1);
	rig_free(&r);
}

/* -- Retract ------------------------------------------------------------- */

static void a_short_that_clears_is_cut_again(void **st)
{
	const struct cycle_config k = usual_config();
	double met, v;
	struct rig r;

	(void)st;
	cut_at(&r, &k, 2);
	met = place(&r);
	v = r.c.mover.v_mm_s;
	steps(&r, SHORTED_V, 20);
	assert_near(place(&r), met + ramp_mm(v, -5, Z_A, 20), 1e-9);
	steps(&r, NARROW_V, 10);
	assert_near(place(&r), met + ramp_mm(v, -5, Z_A, 30), 1e-9);
	assert_int_equal(r.c.state, STATE_RETRACT);
	step(&r, SPARKING_V);
	assert_int_equal(r.c.state, STATE_APPROACH);
	until(&r, STATE_ERODE, SPARKING_V, 500);
	assert_near(place(&r), 2, 0.002);
	assert_int_equal(r.c.totals.retracts, 1);
	assert_int_equal(r.c.totals.shorts, 1);
	assert_near(r.c.totals.retract_mm_max, -ramp_mm(v, -5, Z_A, 30), 1e-9);
	rig_free(&r);
}

static void a_short_that_stays_is_a_fault_after_limit_and_wait(void **st)
{
	const struct cycle_config k = usual_config();
	const int back = (int)(k.gap.retract_limit_mm /
			       (k.gap.retract_mm_s * PERIOD_S));
	struct rig r;
	int n;

	(void)st;
	cut_at(&r, &k, 3);
	n = until(&r, STATE_FAULT, SHORTED_V, 1000);
	assert_in_range(n, back + 50, back + 50 + RAMP);
	assert_int_equal(r.c.fault.first, FAULT_SHORT_NOT_CLEARED);
	assert_string_equal(fault_name(r.c.fault.first), "short-not-cleared");
	assert_int_equal(r.c.outcome, OUTCOME_FAULT);
	assert_near(place(&r), 3 - k.gap.retract_limit_mm, 0.01);
	steps(&r, SPARKING_V, 100);
	assert_int_equal(r.c.state, STATE_FAULT);
	rig_free(&r);
}

/* It cuts a little, and a short takes it back to where its path starts. */
static void back_to_the_start(struct rig *r, struct interp_build *b,
			      const struct cycle_config *k)
{
	rig_load(r, b, k);
	assert_int_equal(tell(r, CYCLE_START), ANSWER_DONE);
	cut_until(r, 0.1);
	steps(r, SHORTED_V, 60);
	assert_int_equal(r->c.state, STATE_RETRACT);
	assert_int_equal(r->out.target[INTERP_Z], 0);
}

static void it_goes_back_no_farther_than_the_start_of_the_path(void **st)
{
	const struct cycle_config k = usual_config();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct rig r;

	(void)st;
	cut_to(b, -5);
	back_to_the_start(&r, b, &k);
	assert_near(place(&r), 0, 2e-9);
	until(&r, STATE_FAULT, SHORTED_V, 60);
	assert_int_equal(r.c.fault.first, FAULT_RETRACT_AT_START);
	rig_free(&r);
}

/* Behind the actions that a program begins with, it positions: at its start
 * there is nothing to cut. */
static void at_the_start_it_does_not_spark_in_front_of_a_positioning(void **st)
{
	const struct cycle_config k = usual_config();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct rig r;

	(void)st;
	action(b, INTERP_DWELL, 0);
	rapid_to(b, -0.05);
	cut_to(b, -5);
	back_to_the_start(&r, b, &k);
	/* A walk back may end at the program's begin itself, and go on only
	 * when the machine takes points again. */
	assert_int_equal(interp_cursor_seek(&r.c.cursor, 0, 0), 0);
	r.in.busy = true;
	step(&r, SPARKING_V);
	assert_int_equal(r.c.state, STATE_APPROACH);
	assert_int_equal(r.c.cursor.index, 0);
	assert_false(r.out.power);
	r.in.busy = false;
	for (int n = 0; n < 1000 && place(&r) < 0.05 - 2e-9; n++) {
		step(&r, SPARKING_V);
		assert_true(!r.out.power || place(&r) > 0.05 - 4e-9);
	}
	until(&r, STATE_ERODE, SPARKING_V, 1000);
	rig_free(&r);
}

/* -- Jumps --------------------------------------------------------------- */

struct flight {
	double from, top;		/* places */
	int cycles;
};

/* From the first cycle of a jump to the first after it. */
static struct flight fly(struct rig *r)
{
	const double at = r->c.config.jump.a_max_mm_s2 * PERIOD_S;
	struct flight f = { .top = 1e9 };
	double v;

	until(r, STATE_JUMP, SPARKING_V, 1000);
	f.from = r->c.lift.from_mm;
	v = r->c.feed_mm_s;
	assert_true(fabs(v) <= at + 1e-6);
	while (r->c.state == STATE_JUMP) {
		assert_false(r->out.power);
		f.top = fmin(f.top, place(r));
		f.cycles++;
		step(r, SPARKING_V);
		if (r->c.state != STATE_JUMP)
			break;
		assert_true(fabs(r->c.feed_mm_s - v) <= at + 1e-6);
		v = r->c.feed_mm_s;
		assert_true(fabs(v) <= r->c.config.jump.v_max_mm_s + 1e-6);
	}
	return f;
}

static void a_jump_goes_up_by_its_height_and_comes_back_just_short(void **st)
{
	struct cycle_config k = usual_config();
	struct flight f;
	struct rig r;

	(void)st;
	k.jump.height_mm = 1.5;
	cut_at(&r, &k, 1.1);
	f = fly(&r);
	for (int i = 0; i < 5; i++) {
		cut_until(&r, f.from + 0.05);
		f = fly(&r);
		assert_near(f.from - f.top, fmin(1.5, f.from), 2e-9);
		assert_int_equal(r.c.state, STATE_APPROACH);
		assert_true(r.out.power);
		assert_near(place(&r), f.from - k.jump.short_of_mm,
				   0.0021);
	}
	assert_int_equal(r.c.totals.jumps, 6);
	rig_free(&r);
}

static void a_jump_near_the_start_goes_up_as_far_as_there_is_path(void **st)
{
	struct cycle_config k = usual_config();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct flight f;
	struct rig r;

	(void)st;
	k.jump.height_mm = 2;
	cut_to(b, -5);
	rig_load(&r, b, &k);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	f = fly(&r);
	assert_true(f.top == 0);
	assert_true(f.from > 0.09 && f.from < 0.2);
	assert_int_equal(r.c.state, STATE_APPROACH);
	assert_near(place(&r), f.from - k.jump.short_of_mm, 0.0021);
	rig_free(&r);
}

static void jumps_are_counted_in_cycles_of_erosion(void **st)
{
	struct cycle_config k = usual_config();
	uint64_t eroded;
	struct rig r;

	(void)st;
	k.jump.height_mm = 0.5;
	cut_at(&r, &k, 1.2);
	fly(&r);
	eroded = r.c.totals.erode_cycles;
	until(&r, STATE_JUMP, NARROW_V + 15, 200);
	assert_int_equal(r.c.totals.erode_cycles - eroded, 100);
	rig_free(&r);
}

static void a_short_on_the_way_down_ends_the_jump_in_a_retract(void **st)
{
	struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	k.jump.height_mm = 0.5;
	cut_at(&r, &k, 2);
	until(&r, STATE_JUMP, SPARKING_V, 1000);
	while (r.c.lift.up)
		step(&r, SHORTED_V);
	assert_int_equal(r.c.state, STATE_JUMP);
	steps(&r, SPARKING_V, 5);
	step(&r, SHORTED_V);
	assert_int_equal(r.c.state, STATE_RETRACT);
	rig_free(&r);
}

/* -- Actions ------------------------------------------------------------- */

static uint64_t cycles_with_dwell(uint32_t ms, int64_t period_ns)
{
	struct cycle_config k = usual_config();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct rig r;
	uint64_t n;

	k.dry_run = true;
	k.period_ns = period_ns;
	cut_to(b, -0.1);
	action(b, INTERP_DWELL, ms);
	cut_to(b, -0.2);
	rig_load(&r, b, &k);
	tell(&r, CYCLE_START);
	until(&r, STATE_IDLE, OPEN_V, 1000000);
	assert_int_equal(r.c.outcome, OUTCOME_DONE);
	n = r.c.totals.cycles;
	rig_free(&r);
	return n;
}

static void a_dwell_lasts_its_cycles(void **st)
{
	(void)st;
	for (uint32_t ms = 1; ms < 2000; ms = ms * 3 + 1) {
		assert_int_equal(cycles_with_dwell(ms, 1000000) -
				 cycles_with_dwell(0, 1000000), ms);
		assert_int_equal(cycles_with_dwell(ms, 250000) -
				 cycles_with_dwell(0, 250000), 4 * ms);
	}
}

static void a_programmed_stop_holds_once_however_often_it_is_walked(void **st)
{
	const struct cycle_config k = usual_config();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct rig r;

	(void)st;
	cut_to(b, -1);
	action(b, INTERP_STOP, 0);
	cut_to(b, -3);
	rig_load(&r, b, &k);
	tell(&r, CYCLE_START);
	until(&r, STATE_HOLD, SPARKING_V, 10000);
	steps(&r, SPARKING_V, 100);
	assert_int_equal(r.c.state, STATE_HOLD);
	assert_near(place(&r), 1, 1e-9);
	for (int i = 0; i < 3; i++) {
		if (r.c.state == STATE_HOLD)
			tell(&r, CYCLE_START);
		cut_until(&r, 1.1);
		while (place(&r) > 0.9)
			step(&r, SHORTED_V);
		assert_int_equal(r.c.state, STATE_RETRACT);
	}
	tell(&r, CYCLE_HOLD);
	tell_mm(&r, CYCLE_RETRACT, 0.5);
	steps(&r, SPARKING_V, 1000);
	tell(&r, CYCLE_RESUME);
	until(&r, STATE_IDLE, SPARKING_V, 10000);
	assert_int_equal(r.c.outcome, OUTCOME_DONE);
	rig_free(&r);
}

static void an_optional_stop_holds_only_if_asked_for(void **st)
{
	struct cycle_config k = usual_config();

	(void)st;
	for (int asked = 0; asked < 2; asked++) {
		struct interp_build *b = begin(INTERP_SIMULTANEOUS);
		struct rig r;

		k.optional_stop = asked;
		cut_to(b, -0.1);
		action(b, INTERP_OPTIONAL_STOP, 0);
		cut_to(b, -0.2);
		rig_load(&r, b, &k);
		tell(&r, CYCLE_START);
		until(&r, asked ? STATE_HOLD : STATE_IDLE, SPARKING_V, 10000);
		rig_free(&r);
	}
}

static void m5_walks_without_power_until_m3(void **st)
{
	const struct cycle_config k = usual_config();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	bool sparked = false;
	struct rig r;

	(void)st;
	cut_to(b, -1);
	action(b, INTERP_AUX, INTERP_AUX_POWER_OFF);
	cut_to(b, -2);
	action(b, INTERP_AUX, INTERP_AUX_POWER_NEGATIVE);
	action(b, INTERP_AUX, INTERP_AUX_PUMP_ON);
	cut_to(b, -3);
	action(b, INTERP_AUX, INTERP_AUX_POWER_POSITIVE);
	action(b, INTERP_AUX, INTERP_AUX_PUMP_OFF);
	rig_load(&r, b, &k);
	tell(&r, CYCLE_START);
	while (r.c.state != STATE_IDLE) {
		const double z = -z_mm(&r);

		step(&r, SPARKING_V);
		if (z > 1.005 && z < 1.995)
			assert_int_equal(r.c.state, STATE_TRAVEL);
		if (z > 2.005 && z < 2.995) {
			sparked = sparked || r.out.power;
			assert_true(io_is_negative(&r.out) && r.out.pump);
		}
	}
	assert_true(sparked);
	assert_false(io_is_negative(&r.out));
	assert_false(r.out.pump);
	assert_int_equal(r.c.outcome, OUTCOME_DONE);
	rig_free(&r);
}

static void the_end_of_the_program_ends_the_job(void **st)
{
	const struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	begin_cut(&r, &k);
	until(&r, STATE_IDLE, SPARKING_V, 100000);
	assert_int_equal(r.c.outcome, OUTCOME_DONE);
	assert_int_equal(r.out.target[INTERP_Z], -5000);
	assert_int_equal(r.c.totals.pulses[INTERP_Z], 5000);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_NO_PROGRAM);
	rig_free(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(in_three_zones_it_feeds_in_proportion_stands_or_goes_back),
		cmocka_unit_test(the_feed_is_limited_by_machine_and_program),
		cmocka_unit_test(it_approaches_until_the_first_spark),
		cmocka_unit_test(
			a_period_is_cut_or_positioned_or_something_else),
		cmocka_unit_test(a_short_that_clears_is_cut_again),
		cmocka_unit_test(a_short_that_stays_is_a_fault_after_limit_and_wait),
		cmocka_unit_test(it_goes_back_no_farther_than_the_start_of_the_path),
		cmocka_unit_test(at_the_start_it_does_not_spark_in_front_of_a_positioning),
		cmocka_unit_test(a_jump_goes_up_by_its_height_and_comes_back_just_short),
		cmocka_unit_test(a_jump_near_the_start_goes_up_as_far_as_there_is_path),
		cmocka_unit_test(jumps_are_counted_in_cycles_of_erosion),
		cmocka_unit_test(a_short_on_the_way_down_ends_the_jump_in_a_retract),
		cmocka_unit_test(a_dwell_lasts_its_cycles),
		cmocka_unit_test(a_programmed_stop_holds_once_however_often_it_is_walked),
		cmocka_unit_test(an_optional_stop_holds_only_if_asked_for),
		cmocka_unit_test(m5_walks_without_power_until_m3),
		cmocka_unit_test(the_end_of_the_program_ends_the_job),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
