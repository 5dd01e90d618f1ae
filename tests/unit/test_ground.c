/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_ground.c - a short while positioning: over ground that was cut it is
 * debris, anywhere else a collision
 */
#include "cycle_help.h"

static void to(struct interp_build *b, double x, double z, bool rapid)
{
	const struct interp_build_word w = {
		.line = 1, .feed_mm_s = 10, .rapid = rapid,
	};
	double end[INTERP_NAXES];
	struct interp_diag d;

	memcpy(end, interp_build_here(b), sizeof(end));
	end[INTERP_X] = x;
	end[INTERP_Z] = z;
	assert_int_equal(interp_build_line(b, end, &w, &d), 0);
}

/* Down a slanted hole, over its top by an arc, out again, and beside it. */
static void begin_way_out(struct rig *r, const struct cycle_config *k)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);

	to(b, 0, -1, true);
	to(b, 0.5, -3, false);
	to(b, 0, -1, true);
	to(b, 3, -1, true);
	rig_load(r, b, k);
	assert_int_equal(tell(r, CYCLE_START), ANSWER_DONE);
	until(r, STATE_APPROACH, OPEN_V, 2000);
	for (int i = 0; i < 20000 && r->c.state != STATE_TRAVEL; i++)
		step(r, SPARKING_V);
	assert_int_equal(r->c.state, STATE_TRAVEL);
}

static void a_short_on_the_way_out_of_a_cut_is_a_retract(void **st)
{
	const struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	begin_way_out(&r, &k);
	steps(&r, OPEN_V, 20);
	for (int n = 0; n < 3; n++) {
		assert_int_equal(r.c.state, STATE_TRAVEL);
		steps(&r, SHORTED_V, 5);
		assert_int_equal(r.c.state, STATE_RETRACT);
		until(&r, STATE_TRAVEL, OPEN_V, 200);
		steps(&r, OPEN_V, 20);
	}
	until(&r, STATE_IDLE, OPEN_V, 20000);
	assert_int_equal(r.c.outcome, OUTCOME_DONE);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	assert_int_equal(r.c.totals.retracts, 3);
	rig_free(&r);
}

/* X and Z lag by 1/30 s and are led. */
static struct cycle_config led(void)
{
	struct cycle_config k = usual_config();

	k.contouring = (struct contouring_config) {
		.methods = INTERP_COMPENSATE_FEEDFORWARD,
		.axes = 1u << INTERP_X | 1u << INTERP_Z, .ahead = 2,
		.gains = { .velocity = 1, .lead_periods = 0.5 },
	};
	for (int i = 0; i < INTERP_NAXES; i++) {
		k.contouring.pulse_mm[i] = PULSE_MM;
		k.contouring.loop[i] = (struct interp_axis_loop) {
			.gain_1_s = 30, .velocity_hz = 60, .damping = 0.7,
		};
		k.contouring.most_mm[i] = 80 / 30.0;
	}
	return k;
}

static void axes_with_a_lead_brake_before_they_retract(void **st)
{
	const struct cycle_config k = led();
	int32_t leap = 0;
	struct rig r;

	(void)st;
	begin_way_out(&r, &k);
	steps(&r, OPEN_V, 40);
	assert_int_equal(r.c.state, STATE_TRAVEL);
	assert_true(r.c.mover.v_mm_s > 1);
	assert_false(contouring_rests(&r.c.contouring));
	for (int n = 0; n < 300 && r.c.state == STATE_TRAVEL; n++) {
		step(&r, SHORTED_V);
		for (int i = 0; i < INTERP_NAXES; i++)
			leap = (int32_t)fmax(leap, abs(r.out.target[i] -
						       r.before.target[i]));
	}
	assert_int_equal(r.c.state, STATE_RETRACT);
	assert_true(contouring_rests(&r.c.contouring));
	/* As far as it goes in a cycle at this speed, and no farther. */
	assert_true(leap < 100);
	until(&r, STATE_IDLE, OPEN_V, 20000);
	assert_int_equal(r.c.outcome, OUTCOME_DONE);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	rig_free(&r);
}

/* It brakes, and comes over ground that was not cut: a collision after all. */
static void with_a_lead_too_new_ground_is_a_collision(void **st)
{
	const struct cycle_config k = led();
	struct rig r;

	(void)st;
	begin_way_out(&r, &k);
	for (int n = 0; n < 2000 && r.out.target[INTERP_X] < 1000; n++)
		step(&r, OPEN_V);
	steps(&r, SHORTED_V, 5);
	assert_int_equal(r.c.fault.first, FAULT_CONTACT);
	rig_free(&r);
}

static void on_new_ground_it_is_a_collision(void **st)
{
	const struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	begin_way_out(&r, &k);
	for (int n = 0; n < 2000 && r.out.target[INTERP_X] < 1000; n++)
		step(&r, OPEN_V);
	assert_int_equal(r.c.state, STATE_TRAVEL);
	steps(&r, SHORTED_V, 5);
	assert_int_equal(r.c.fault.first, FAULT_CONTACT);
	rig_free(&r);
}

/* Out over the arc that was cut, against its sense. */
static void over_an_arc_that_was_cut_it_is_a_retract(void **st)
{
	const struct cycle_config k = usual_config();
	const double there[INTERP_NAXES] = { 2, 0 }, back[INTERP_NAXES] = { 0 };
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	const struct interp_build_arc a = {
		.axis_a = INTERP_X, .axis_b = INTERP_Y, .centre_a_mm = 1,
	};
	const struct interp_build_word w = { .line = 1, .rapid = true };
	struct interp_build_arc out = a;
	struct interp_diag d;
	struct rig r;

	(void)st;
	arc(b, there, 1, 0, true);
	out.clockwise = false;
	assert_int_equal(interp_build_arc(b, back, &out, &w, &d), 0);
	rig_load(&r, b, &k);
	tell(&r, CYCLE_START);
	until(&r, STATE_APPROACH, OPEN_V, 2000);
	for (int i = 0; i < 20000 && r.c.state != STATE_TRAVEL; i++)
		step(&r, SPARKING_V);
	steps(&r, OPEN_V, 30);
	steps(&r, SHORTED_V, 5);
	assert_int_equal(r.c.state, STATE_RETRACT);
	until(&r, STATE_IDLE, OPEN_V, 20000);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	rig_free(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_short_on_the_way_out_of_a_cut_is_a_retract),
		cmocka_unit_test(axes_with_a_lead_brake_before_they_retract),
		cmocka_unit_test(with_a_lead_too_new_ground_is_a_collision),
		cmocka_unit_test(on_new_ground_it_is_a_collision),
		cmocka_unit_test(over_an_arc_that_was_cut_it_is_a_retract),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
