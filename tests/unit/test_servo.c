/* SPDX-License-Identifier: Apache-2.0 */
/* test_servo.c - promises of the servo's laws: window, integral, approach */
#include "cycle_help.h"

#define LOW_V	35.0
#define HIGH_V	45.0

static struct cycle_config windowed(void)
{
	struct cycle_config k = usual_config();

	k.gap.window_low_v = LOW_V;
	k.gap.window_high_v = HIGH_V;
	return k;
}

/* -- The window ---------------------------------------------------------- */

static void
outside_the_window_it_feeds_in_proportion_inside_it_stands(void **st)
{
	const struct cycle_config k = windowed();
	struct rig r;

	(void)st;
	cut_at(&r, &k, 2);
	for (double v = k.gap.short_v; v < 69; v += 0.25) {
		const double feed = 0.1 * (v > HIGH_V ? v - HIGH_V :
					   v < LOW_V ? v - LOW_V : 0);

		step(&r, v);
		assert_int_equal(r.c.state, STATE_ERODE);
		assert_near(r.c.feed_mm_s, fmax(feed, -k.gap.creep_mm_s),
			    1e-8);
	}
	rig_free(&r);
}

static void it_creeps_back_no_farther_than_a_retract_may_go(void **st)
{
	const struct cycle_config k = windowed();
	struct rig r;

	(void)st;
	cut_at(&r, &k, 2);
	steps(&r, 20, 5000);
	assert_int_equal(r.c.state, STATE_ERODE);
	assert_near(place(&r), r.c.far_mm - k.gap.retract_limit_mm, 2e-9);
	assert_true(r.c.feed_mm_s == 0);
	rig_free(&r);
}

/* The gap stays narrow.  In short lines too, and after a stop among them. */
static void narrow_at_the_first_place_of_a_cut_it_stays_in_the_cut(void **st)
{
	const struct cycle_config k = windowed();

	(void)st;
	for (int i = 0; i < 4; i++) {
		struct interp_build *b = begin(INTERP_SIMULTANEOUS);
		struct rig r;

		rapid_to(b, -1);
		if (i == 3)
			action(b, INTERP_DWELL, 1);
		for (int n = 1; n <= 100 && i > 0; n++) {
			cut_to(b, -1 - n * 0.003);
			if (i == 2 && n == 10)
				action(b, INTERP_DWELL, 1);
		}
		cut_to(b, -5);
		rig_load(&r, b, &k);
		assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
		until(&r, STATE_APPROACH, OPEN_V, 1000);
		until(&r, STATE_ERODE, SPARKING_V, 100);
		cut_until(&r, 1 + i * 0.1);
		for (int n = 0; n < 2000; n++) {
			step(&r, 20);
			assert_int_equal(r.c.state, STATE_ERODE);
			assert_true(r.out.power);
			assert_true(place(&r) >= 1);
		}
		assert_near(place(&r), 1, 1e-8);
		assert_true(r.c.feed_mm_s == 0);
		cut_until(&r, 1.5);
		rig_free(&r);
	}
}

static void a_window_that_stands_on_its_head_is_no_window(void **st)
{
	struct rig r;

	(void)st;
	{
		const struct cycle_config k = windowed();

		cut_at(&r, &k, 2);
	}
	r.c.gap.window_low_v = 60;
	step(&r, HIGH_V + 1);
	assert_true(r.c.feed_mm_s > 0);
	step(&r, HIGH_V - 1);
	assert_true(r.c.feed_mm_s < 0);
	rig_free(&r);
}

static void a_servo_changes_its_speed_by_its_acceleration(void **st)
{
	static const double zones[] = { HIGH_V + 20, SHORTED_V, OPEN_V,
					HIGH_V, SHORTED_V, HIGH_V + 5 };
	struct cycle_config k = windowed();
	double v = 0;
	struct rig r;

	(void)st;
	k.gap.feed_a_mm_s2 = 100;
	k.gap.retract_limit_mm = 5;
	cut_at(&r, &k, 2);
	v = r.c.feed_mm_s;
	for (int i = 0; i < 6 * 40; i++) {
		step(&r, zones[i / 40]);
		assert_near(r.c.feed_mm_s, v, 0.1 + 1e-9);
		v = r.c.feed_mm_s;
		if (i % 40 == 39 && i / 40 == 0)
			assert_near(v, 2, 1e-6);
		if (i % 40 == 39 && i / 40 == 1)
			assert_near(v, -2, 0.11);
	}
	rig_free(&r);
}

static void a_retract_brakes_onto_its_limit(void **st)
{
	struct cycle_config k = windowed();
	double v;
	struct rig r;

	(void)st;
	k.gap.feed_a_mm_s2 = 500;
	cut_at(&r, &k, 2);
	v = r.c.feed_mm_s;
	while (r.c.fault.first == FAULT_NONE) {
		step(&r, SHORTED_V);
		assert_near(r.c.feed_mm_s, v, 1.001);
		v = r.c.feed_mm_s;
	}
	assert_near(place(&r), r.c.retract.floor_mm, 2e-9);
	rig_free(&r);
}

/* It is still going back out of one short when the next one comes, or when the
 * gap is narrow, and it may go less far back than it needs to brake. */
static void beyond_the_limit_it_brakes_as_the_axes_can(void **st)
{
	static const double then[] = { SHORTED_V, 20 };
	static const enum cycle_state in[] = { STATE_RETRACT, STATE_ERODE };
	const struct cycle_config k = windowed();
	struct rig r;

	(void)st;
	for (int i = 0; i < 2; i++) {
		double v = -5;

		cut_at(&r, &k, 2);
		steps(&r, SHORTED_V, 20);
		assert_near(r.c.feed_mm_s, v, 1e-6);
		r.c.gap.retract_limit_mm = 0.002;
		until(&r, STATE_APPROACH, HIGH_V, 1);
		v = r.c.feed_mm_s;
		assert_true(v < -3);
		for (int n = 0; n < 8; n++) {
			step(&r, then[i]);
			assert_int_equal(r.c.state, in[i]);
			assert_near(r.c.feed_mm_s, v, 1 + 1e-6);
			v = r.c.feed_mm_s;
		}
		assert_true(v == 0);
		rig_free(&r);
	}
}

/* -- The integral -------------------------------------------------------- */

static void an_integral_adds_the_proportional_feed_in_its_reset_time(void **st)
{
	struct cycle_config k = windowed();
	struct rig r;

	(void)st;
	k.gap.integral_s = 0.5;
	cut_at(&r, &k, 2);
	r.c.servo.integral_mm_s = 0;
	steps(&r, HIGH_V + 2, 500);
	assert_near(r.c.feed_mm_s, 0.4, 0.001);
	rig_free(&r);
}

static void inside_the_window_the_integral_is_held(void **st)
{
	struct cycle_config k = windowed();
	double kept;
	struct rig r;

	(void)st;
	k.gap.integral_s = 0.5;
	cut_at(&r, &k, 2);
	steps(&r, HIGH_V + 2, 200);
	kept = r.c.servo.integral_mm_s;
	assert_true(kept > 0.05);
	steps(&r, HIGH_V - 1, 1000);
	assert_true(r.c.feed_mm_s == 0);
	assert_near(r.c.servo.integral_mm_s, kept, 1e-12);
	steps(&r, LOW_V - 2, 10);
	assert_true(r.c.servo.integral_mm_s < kept && r.c.feed_mm_s < 0);
	rig_free(&r);
}

/* Nothing has wound up: below the window it goes back within the cycle, above
 * it again no faster than before. */
static void an_integral_does_not_wind_up_at_the_feed_s_limit(void **st)
{
	struct cycle_config k = windowed();
	struct rig r;

	(void)st;
	k.gap.integral_s = 0.1;
	k.gap.feed_max_mm_s = 1;
	cut_at(&r, &k, 1.5);
	steps(&r, HIGH_V + 15, 1000);
	assert_near(r.c.feed_mm_s, 1, 1e-9);
	assert_true(r.c.servo.integral_mm_s <= 1);
	steps(&r, HIGH_V + 0.001, 1);
	assert_true(r.c.feed_mm_s <= 1);
	step(&r, LOW_V - 1);
	assert_near(r.c.feed_mm_s, -0.1, 1e-9);
	rig_free(&r);
}

static void an_integral_does_not_wind_up_where_nothing_walks(void **st)
{
	struct cycle_config k = windowed();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	double before;
	struct rig r;

	(void)st;
	k.gap.integral_s = 0.1;
	cut_to(b, -1);
	action(b, INTERP_DWELL, 3000);
	cut_to(b, -3);
	rig_load(&r, b, &k);
	tell(&r, CYCLE_START);
	while (!r.c.job.dwelling)
		step(&r, HIGH_V + 1);
	step(&r, HIGH_V + 1);
	before = r.c.servo.integral_mm_s;
	steps(&r, HIGH_V + 1, 1000);
	assert_true(r.c.job.dwelling && r.out.power);
	assert_near(r.c.servo.integral_mm_s, before, 1e-12);
	rig_free(&r);
}

static void a_retract_and_a_hold_empty_the_integral(void **st)
{
	for (int i = 0; i < 2; i++) {
		struct cycle_config k = windowed();
		struct rig r;

		(void)st;
		k.gap.integral_s = 0.1;
		cut_at(&r, &k, 2);
		assert_true(r.c.servo.integral_mm_s > 0);
		if (i) {
			tell(&r, CYCLE_HOLD);
			steps(&r, HIGH_V, 100);
			tell(&r, CYCLE_START);
		}
		step(&r, SHORTED_V);
		steps(&r, HIGH_V, 3);
		assert_true(r.c.servo.integral_mm_s == 0);
		rig_free(&r);
	}
}

/* -- New values on the way ----------------------------------------------- */

struct change {
	double gain, high, integral_s;
};

static void a_change_of_gains_does_not_step_the_feed(void **st)
{
	static const struct change changes[] = {
		{ 0.2, HIGH_V, 0 }, { 0.02, HIGH_V, 0 }, { 0.1, 50, 0 },
		{ 0.1, 41, 0 }, { 0.3, 50, 0 }, { 0.2, HIGH_V, 0.5 },
		{ 0.05, 42, 0.5 },
	};

	(void)st;
	for (int i = 0; i < 14; i++) {
		const struct change *x = &changes[i / 2];
		struct cycle_config k = windowed();
		double was;
		struct rig r;

		k.gap.integral_s = i % 2 ? 0.2 : 0;
		cut_at(&r, &k, 1.5);
		steps(&r, 55, 30);
		was = r.c.feed_mm_s;
		assert_true(was > 0.9);
		r.c.gap.gain_mm_s_v = x->gain;
		r.c.gap.window_high_v = x->high;
		r.c.gap.integral_s = x->integral_s;
		for (int n = 0; n < 700; n++) {
			step(&r, 55);
			assert_near(r.c.feed_mm_s, was, 0.035);
			was = r.c.feed_mm_s;
		}
		if (x->integral_s == 0)
			assert_near(was, x->gain * (55 - x->high), 0.01);
		rig_free(&r);
	}
}

/* -- Touch-down ---------------------------------------------------------- */

/* A workpiece at a place, a cycle late as any sensor is. */
struct world {
	double front_mm, gap_mm;
};

static double voltage(const struct world *w, const struct rig *r)
{
	const double gap = w->front_mm - place(r);

	if (gap <= 0)
		return 0;
	return gap >= w->gap_mm ? OPEN_V : OPEN_V * gap / w->gap_mm;
}

/* How far beyond the workpiece, in three touches. */
static double beyond_contact(const struct cycle_config *k, double front_mm)
{
	const struct world w = { front_mm, 0 };
	double most = 0;
	struct rig r;

	begin_cut(&r, k);
	for (int n = 0; n < 3000 && r.c.totals.retracts < 3; n++) {
		step(&r, voltage(&w, &r));
		most = fmax(most, place(&r));
	}
	assert_int_equal(r.c.totals.retracts, 3);
	rig_free(&r);
	return most - front_mm;
}

static void an_approach_goes_no_farther_than_a_cycle_beyond_contact(void **st)
{
	/* Those of Z are 1000. */
	static const double as[] = { 0, 2000, 500, 100 };
	struct cycle_config k = usual_config();
	const double v = k.gap.approach_mm_s;

	(void)st;
	for (int i = 0; i < 160; i++) {
		const double own = as[i % 4];
		const double a = own > 0 && own < 1000 ? own : 1000;
		const double stop = v > a * PERIOD_S ? v * v / (2 * a) : 0;

		k.gap.feed_a_mm_s2 = own;
		assert_true(beyond_contact(&k, 1.5 + 0.0037 * i) <=
			    v * PERIOD_S + stop + 1e-9);
	}
}

static void an_approach_slows_with_the_voltage_and_does_not_touch(void **st)
{
	const struct world w = { 1.5, 0.1 };
	struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	begin_cut(&r, &k);
	for (int n = 0; n < 3000; n++) {
		step(&r, voltage(&w, &r));
		assert_true(place(&r) < w.front_mm);
	}
	assert_int_equal(r.c.state, STATE_ERODE);
	assert_int_equal(r.c.totals.shorts, 0);
	assert_near(voltage(&w, &r), k.gap.servo_v, 1);
	rig_free(&r);
}

static void after_a_retract_it_erodes_from_the_place_of_reversal(void **st)
{
	const struct cycle_config k = usual_config();
	struct rig r;
	double far;

	(void)st;
	cut_at(&r, &k, 3);
	far = r.c.far_mm;
	steps(&r, SHORTED_V, 60);
	steps(&r, OPEN_V, 10);
	while (r.c.state == STATE_APPROACH) {
		assert_true(place(&r) < far + k.gap.approach_mm_s * PERIOD_S);
		step(&r, SPARKING_V + 15);
		assert_near(r.c.feed_mm_s, k.gap.approach_mm_s, 0.6);
	}
	assert_int_equal(r.c.state, STATE_ERODE);
	assert_near(place(&r), far, 0.005);
	rig_free(&r);
}

/* Debris on the way back: there the servo takes over. */
static void what_it_meets_on_the_way_back_is_eroded(void **st)
{
	const struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	cut_at(&r, &k, 3);
	steps(&r, SHORTED_V, 60);
	step(&r, OPEN_V);
	steps(&r, SPARKING_V, 10);
	assert_int_equal(r.c.state, STATE_APPROACH);
	step(&r, k.gap.servo_v - 1);
	assert_int_equal(r.c.state, STATE_ERODE);
	assert_true(r.c.feed_mm_s == 0 && place(&r) < 2.9);
	rig_free(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(outside_the_window_it_feeds_in_proportion_inside_it_stands),
		cmocka_unit_test(it_creeps_back_no_farther_than_a_retract_may_go),
		cmocka_unit_test(
			narrow_at_the_first_place_of_a_cut_it_stays_in_the_cut),
		cmocka_unit_test(a_window_that_stands_on_its_head_is_no_window),
		cmocka_unit_test(a_servo_changes_its_speed_by_its_acceleration),
		cmocka_unit_test(a_retract_brakes_onto_its_limit),
		cmocka_unit_test(beyond_the_limit_it_brakes_as_the_axes_can),
		cmocka_unit_test(an_integral_adds_the_proportional_feed_in_its_reset_time),
		cmocka_unit_test(inside_the_window_the_integral_is_held),
		cmocka_unit_test(an_integral_does_not_wind_up_at_the_feed_s_limit),
		cmocka_unit_test(an_integral_does_not_wind_up_where_nothing_walks),
		cmocka_unit_test(a_retract_and_a_hold_empty_the_integral),
		cmocka_unit_test(a_change_of_gains_does_not_step_the_feed),
		cmocka_unit_test(an_approach_goes_no_farther_than_a_cycle_beyond_contact),
		cmocka_unit_test(an_approach_slows_with_the_voltage_and_does_not_touch),
		cmocka_unit_test(after_a_retract_it_erodes_from_the_place_of_reversal),
		cmocka_unit_test(what_it_meets_on_the_way_back_is_eroded),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
