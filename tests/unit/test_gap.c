/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_gap.c - promises of sensing: one reading, whatever the sensor
 */
#include "cycle_help.h"

static struct cycle_config with_source(enum gap_source s)
{
	struct cycle_config k = usual_config();

	k.gap.source = s;
	k.gap.share_v = 60;
	k.gap.share_set = 0.2;
	k.gap.share_weight = 1;
	k.gap.share_short = 0.5;
	k.gap.share_open = 0.95;
	return k;
}

/* Cutting, with a sensor that counts or compares. */
static void cut_by_shares(struct rig *r, const struct cycle_config *k)
{
	begin_cut(r, k);
	shares(r, 1, 0, 0, 0);
	until(r, STATE_APPROACH, OPEN_V, 1000);
	steps(r, OPEN_V, 3);
	shares(r, 0, 1, 0, 0);
	until(r, STATE_ERODE, SPARKING_V, 3);
}

/* -- Filters ------------------------------------------------------------- */

static void a_short_is_felt_at_once_and_believed_after_its_cycles(void **st)
{
	struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	k.gap.short_cycles = 4;
	k.gap.filter_cycles = 9;
	cut_at(&r, &k, 2);
	for (int i = 0; i < 3; i++) {
		step(&r, SHORTED_V);
		assert_int_equal(r.c.state, STATE_ERODE);
		assert_true(r.c.feed_mm_s <= 0);
	}
	step(&r, SPARKING_V);
	assert_true(r.c.feed_mm_s > 0);
	steps(&r, SHORTED_V, 3);
	assert_int_equal(r.c.state, STATE_ERODE);
	step(&r, SHORTED_V);
	assert_int_equal(r.c.state, STATE_RETRACT);
	assert_int_equal(r.c.totals.shorts, 2);
	rig_free(&r);
}

static void a_median_leaves_single_readings_out(void **st)
{
	struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	k.gap.filter_cycles = 5;
	cut_at(&r, &k, 2);
	for (int i = 0; i < 50; i++) {
		step(&r, i % 3 ? SPARKING_V : i % 2 ? OPEN_V : NARROW_V);
		assert_near(r.c.sensed.signal_v, SPARKING_V, 1e-9);
		assert_near(r.c.sensed.now_v, r.in.gap_v, 1e-9);
	}
	steps(&r, 45, 3);
	assert_near(r.c.sensed.signal_v, 45, 1e-9);
	rig_free(&r);
}

static void a_first_order_filter_settles_in_its_cycles(void **st)
{
	struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	k.gap.filter = GAP_FIRST_ORDER;
	k.gap.filter_cycles = 8;
	cut_at(&r, &k, 2);
	steps(&r, 42, 200);
	assert_near(r.c.sensed.signal_v, 42, 1e-6);
	for (int i = 1; i <= 30; i++) {
		step(&r, 62);
		assert_near(r.c.sensed.signal_v, 62 - 20 * pow(7 / 8.0, i),
			    1e-5);
	}
	rig_free(&r);
}

/* What was read with power says nothing without it. */
static void a_filter_begins_anew_when_power_goes(void **st)
{
	struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	k.gap.filter_cycles = 15;
	cut_at(&r, &k, 2);
	step(&r, SHORTED_V);
	assert_int_equal(r.c.state, STATE_RETRACT);
	step(&r, SPARKING_V);
	assert_int_equal(r.c.state, STATE_APPROACH);
	rig_free(&r);
}

/* -- Other sensors ------------------------------------------------------- */

static void shares_at_their_set_value_hold_the_servo_voltage(void **st)
{
	const struct cycle_config k = with_source(GAP_SHARES);
	struct rig r;

	(void)st;
	cut_by_shares(&r, &k);
	shares(&r, 0.3, 0.6, 0.06, 0.04);
	step(&r, 0);
	assert_near(r.c.sensed.signal_v, k.gap.servo_v, 1e-5);
	assert_int_equal(r.c.state, STATE_ERODE);
	steps(&r, 0, 5);
	for (int i = 0; i <= 40; i++) {
		const double open = 0.3 + 0.01 * i;

		shares(&r, open, 1 - open, 0, 0);
		step(&r, 0);
		assert_near(r.c.feed_mm_s, 0.1 * 60 * (open - 0.2), 1e-5);
	}
	shares(&r, 0.1, 0.5, 0.2, 0.2);
	steps(&r, 0, 5);
	assert_true(r.c.feed_mm_s < 0);
	shares(&r, 0, 0.5, 0, 0.5);
	step(&r, 0);
	assert_int_equal(r.c.state, STATE_RETRACT);
	/* No power, no pulses: the sensing voltage clears it. */
	shares(&r, 0, 0, 0, 0);
	steps(&r, SHORTED_V, 5);
	assert_int_equal(r.c.state, STATE_RETRACT);
	step(&r, SPARKING_V);
	assert_int_equal(r.c.state, STATE_APPROACH);
	rig_free(&r);
}

/* A generator that counts a period late, as they all do. */
static void the_first_cycle_with_power_has_no_shares_yet(void **st)
{
	for (int voltage = 0; voltage < 2; voltage++) {
		const struct cycle_config k = with_source(GAP_SHARES);
		struct rig r;

		(void)st;
		begin_cut(&r, &k);
		until(&r, STATE_APPROACH, OPEN_V, 1000);
		r.in.gap_valid = voltage;
		step(&r, OPEN_V);
		assert_int_equal(r.c.fault.first, voltage ? FAULT_NONE :
							FAULT_GAP_LOST);
		step(&r, OPEN_V);
		assert_int_equal(r.c.fault.first, FAULT_GAP_LOST);
		rig_free(&r);
	}
}

/* Counts that come later than the pulses. */
static void it_does_not_feed_on_counts_that_are_not_there(void **st)
{
	struct cycle_config k = with_source(GAP_COUNTS);
	struct rig r;
	double at;

	(void)st;
	k.gap.share_mm = 0.005;
	begin_cut(&r, &k);
	until(&r, STATE_APPROACH, OPEN_V, 1000);
	r.in.shares_due = true;
	steps(&r, OPEN_V, 2);
	at = place(&r);
	/* Whatever the voltage says: with sparks it is another one. */
	for (int i = 0; i < 50; i++)
		step(&r, i % 2 ? SHORTED_V : OPEN_V);
	assert_near(place(&r), at, 0.003);
	assert_int_equal(r.c.state, STATE_APPROACH);
	assert_true(r.out.power);
	r.in.shares_due = false;
	shares(&r, 0.6, 0.4, 0, 0);
	step(&r, SHORTED_V);
	assert_int_equal(r.c.state, STATE_ERODE);
	at = place(&r);
	r.in.shares_old = true;
	steps(&r, SHORTED_V, 50);
	assert_in_range(lround(1e6 * (place(&r) - at)), 4900, 9000);
	r.in.shares_old = false;
	step(&r, SHORTED_V);
	r.in.shares_old = true;
	at = place(&r);
	steps(&r, SHORTED_V, 50);
	assert_true(place(&r) - at > 0.0049);
	r.in.shares_valid = false;
	step(&r, OPEN_V);
	assert_int_equal(r.c.fault.first, FAULT_GAP_LOST);
	rig_free(&r);
}

static void three_lines_are_three_zones(void **st)
{
	const struct cycle_config k = with_source(GAP_LINES);
	double met;
	struct rig r;

	(void)st;
	r.in.gap_valid = false;
	cut_by_shares(&r, &k);
	shares(&r, 0, 1, 0, 0);
	steps(&r, NAN, 100);
	assert_true(r.c.feed_mm_s == 0 && r.out.power);
	shares(&r, 1, 0, 0, 0);
	steps(&r, NAN, 10);
	assert_true(r.c.feed_mm_s > 0);
	shares(&r, 1, 1, 0, 1);
	step(&r, NAN);
	assert_int_equal(r.c.state, STATE_RETRACT);
	steps(&r, NAN, 5);
	assert_int_equal(r.c.state, STATE_RETRACT);
	shares(&r, 0, 1, 0, 0);
	/* Back to where the short was, and no farther. */
	met = r.c.retract.from_mm;
	until(&r, STATE_APPROACH, NAN, 10);
	assert_near(place(&r), met, 0.002);
	shares(&r, 0, 0, 0, 0);
	steps(&r, NAN, 2);
	assert_int_equal(r.c.fault.first, FAULT_GAP_LOST);
	rig_free(&r);
}

static void can_gives_shares_or_a_voltage(void **st)
{
	const struct cycle_config k = with_source(GAP_CAN);
	struct rig r;

	(void)st;
	cut_at(&r, &k, 2);
	step(&r, 45);
	assert_near(r.c.sensed.signal_v, 45, 1e-9);
	shares(&r, 0.2, 0.8, 0, 0);
	step(&r, 45);
	assert_near(r.c.sensed.signal_v, k.gap.servo_v, 1e-5);
	rig_free(&r);
}

/* -- What cannot be true ------------------------------------------------- */

static void a_voltage_that_cannot_be_is_a_lost_gap(void **st)
{
	static const double bad[] = { NAN, INFINITY, -INFINITY, -5.1, 181 };
	struct cycle_config k = usual_config();

	(void)st;
	k.gap.ignition_v = 120;
	for (int i = 0; i < 5; i++) {
		struct rig r;

		cut_at(&r, &k, 2);
		step(&r, bad[i]);
		assert_false(r.out.power);
		assert_int_equal(r.c.fault.first, FAULT_GAP_LOST);
		until(&r, STATE_FAULT, bad[i], 100);
		assert_true(r.c.gap_v == 0);
		rig_free(&r);
	}
	for (int i = 0; i < 2; i++) {
		struct rig r;

		cut_at(&r, &k, 2);
		step(&r, i ? -4.9 : 179);
		assert_int_equal(r.c.fault.first, FAULT_NONE);
		assert_int_equal(r.c.state, i ? STATE_RETRACT : STATE_ERODE);
		rig_free(&r);
	}
}

static void a_condition_s_ignition_voltage_sets_the_bound(void **st)
{
	struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	k.gap.ignition_v = 120;
	cut_at(&r, &k, 2);
	r.c.out.pulse[INTERP_TECH_IGNITION_V] = 200;
	step(&r, 179);
	step(&r, 299);
	/* The pulses that are read are still those of before. */
	r.c.out.pulse[INTERP_TECH_IGNITION_V] = 100;
	step(&r, 299);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	step(&r, 149);
	step(&r, 149);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	step(&r, 151);
	assert_int_equal(r.c.fault.first, FAULT_GAP_LOST);
	rig_free(&r);
}

static void shares_that_cannot_be_are_a_lost_gap(void **st)
{
	static const double bad[][4] = {
		{ 0.5, 0.5, 0.5, 0 }, { -0.1, 1, 0, 0 }, { 0, NAN, 0, 0 },
		{ 0, 1.1, 0, 0 }, { 0, 0, INFINITY, 0 }, { 0, 0, 0, -1 },
	};
	const struct cycle_config k = with_source(GAP_SHARES);
	struct rig r;

	(void)st;
	for (int i = 0; i < 6; i++) {
		cut_by_shares(&r, &k);
		shares(&r, bad[i][0], bad[i][1], bad[i][2], bad[i][3]);
		step_on(&r);
		assert_int_equal(r.c.fault.first, FAULT_GAP_LOST);
		rig_free(&r);
	}
	cut_by_shares(&r, &k);
	r.in.shares_valid = false;
	step_on(&r);
	assert_int_equal(r.c.fault.first, FAULT_GAP_LOST);
	rig_free(&r);
}

/* -- Is it alive? -------------------------------------------------------- */

static void a_signal_that_stands_still_while_it_moves_is_a_fault(void **st)
{
	const struct cycle_config k = usual_config();
	struct rig r;
	int n;

	(void)st;
	cut_at(&r, &k, 2);
	r.c.gap.stuck.cycles = 300;
	step(&r, SPARKING_V - 1);
	n = until(&r, STATE_FAULT, SPARKING_V, 400);
	assert_in_range(n, 300, 330);
	assert_int_equal(r.c.fault.first, FAULT_GAP_STUCK);
	assert_string_equal(fault_name(r.c.fault.first), "gap-stuck");
	tell(&r, CYCLE_RESET);
	tell(&r, CYCLE_START);
	until(&r, STATE_ERODE, SPARKING_V, 200);
	for (int i = 0; i < 1000; i++)
		step(&r, SPARKING_V + (i % 250 ? 0 : 0.01));
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	rig_free(&r);
}

static void a_signal_may_stand_still_where_nothing_moves(void **st)
{
	const struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	cut_at(&r, &k, 2);
	r.c.gap.stuck.cycles = 300;
	steps(&r, k.gap.servo_v, 2000);
	assert_int_equal(r.c.state, STATE_ERODE);
	rig_free(&r);
}

static void lines_and_open_shares_may_stand_still(void **st)
{
	for (int i = 0; i < 2; i++) {
		struct cycle_config k = with_source(i ? GAP_LINES :
							GAP_SHARES);
		struct rig r;

		(void)st;
		k.gap.stuck.cycles = 50;
		begin_cut(&r, &k);
		shares(&r, 1, 0, 0, 0);
		until(&r, STATE_APPROACH, OPEN_V, 1000);
		steps(&r, OPEN_V, 200);
		assert_int_equal(r.c.state, STATE_APPROACH);
		assert_true(r.c.feed_mm_s > 0);
		rig_free(&r);
	}
}

static void a_signal_that_is_noise_is_a_fault(void **st)
{
	struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	k.gap.noise_limit_v = 20;
	cut_at(&r, &k, 2);
	for (int i = 0; i < 3000; i++)
		step(&r, k.gap.servo_v - (i % 2 ? 18 : 0));
	assert_int_equal(r.c.state, STATE_ERODE);
	for (int i = 0; i < 5000 && r.c.fault.first == FAULT_NONE; i++)
		step(&r, k.gap.servo_v - (i % 2 ? 22 : 0));
	assert_int_equal(r.c.fault.first, FAULT_GAP_STUCK);
	rig_free(&r);
}

static void energy_is_the_sum_of_what_was_counted_or_is_not_told(void **st)
{
	struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	cut_at(&r, &k, 2);
	/* Up to here nobody counted, and the power was on. */
	assert_true(isnan(r.c.totals.energy_j));
	r.c.totals.energy_j = 0;
	r.in.energy_valid = true;
	r.in.energy_j = 0.5;
	steps(&r, SPARKING_V, 4);
	assert_near(r.c.totals.energy_j, 2, 1e-12);
	/* Without power there is nothing to count. */
	r.c.out.power = false;
	r.in.energy_valid = false;
	step(&r, SPARKING_V);
	assert_near(r.c.totals.energy_j, 2, 1e-12);
	assert_true(r.c.out.power);
	step(&r, SPARKING_V);
	assert_true(isnan(r.c.totals.energy_j));
	rig_free(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_short_is_felt_at_once_and_believed_after_its_cycles),
		cmocka_unit_test(a_median_leaves_single_readings_out),
		cmocka_unit_test(a_first_order_filter_settles_in_its_cycles),
		cmocka_unit_test(a_filter_begins_anew_when_power_goes),
		cmocka_unit_test(shares_at_their_set_value_hold_the_servo_voltage),
		cmocka_unit_test(the_first_cycle_with_power_has_no_shares_yet),
		cmocka_unit_test(it_does_not_feed_on_counts_that_are_not_there),
		cmocka_unit_test(three_lines_are_three_zones),
		cmocka_unit_test(can_gives_shares_or_a_voltage),
		cmocka_unit_test(a_voltage_that_cannot_be_is_a_lost_gap),
		cmocka_unit_test(a_condition_s_ignition_voltage_sets_the_bound),
		cmocka_unit_test(shares_that_cannot_be_are_a_lost_gap),
		cmocka_unit_test(a_signal_that_stands_still_while_it_moves_is_a_fault),
		cmocka_unit_test(a_signal_may_stand_still_where_nothing_moves),
		cmocka_unit_test(lines_and_open_shares_may_stand_still),
		cmocka_unit_test(a_signal_that_is_noise_is_a_fault),
		cmocka_unit_test(energy_is_the_sum_of_what_was_counted_or_is_not_told),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
