/* SPDX-License-Identifier: Apache-2.0 */
/* test_manual.c - jogs, limit switches, steps from node to node */
#include "manual_help.h"

/* -- Jogs ------------------------------------------------------------------ */

static void a_jog_goes_as_far_as_told(void **state)
{
	const struct cycle_config k = manual_config();
	struct bench b;

	(void)state;
	bench_init(&b, &k);
	assert_int_equal(jog(&b, INTERP_X, 1.2345), ANSWER_DONE);
	assert_int_equal(b.c.state, STATE_JOG);
	run_out(&b, STATE_IDLE);
	assert_int_equal(b.out.target[INTERP_X], 1235);
	assert_int_equal(b.out.target[INTERP_Z], 0);
	assert_int_equal(jog(&b, INTERP_X, -1.2345), ANSWER_DONE);
	run_out(&b, STATE_IDLE);
	assert_in_range(b.out.target[INTERP_X] + 1, 0, 1);
	assert_in_range(b.most, 1, 21);
}

static void a_jog_is_refused_where_it_cannot_go(void **state)
{
	const struct cycle_config k = manual_config();
	struct bench b;

	(void)state;
	bench_init(&b, &k);
	assert_int_equal(jog(&b, INTERP_X, 200.001), ANSWER_BEYOND);
	assert_int_equal(jog(&b, INTERP_X, 0), ANSWER_BAD_ARGUMENT);
	assert_int_equal(jog(&b, INTERP_X, (double)NAN), ANSWER_BAD_ARGUMENT);
	assert_int_equal(jog(&b, INTERP_U, 1), ANSWER_BAD_ARGUMENT);
	assert_int_equal(jog(&b, 77, 1), ANSWER_BAD_ARGUMENT);
	assert_int_equal(b.c.state, STATE_IDLE);
	assert_int_equal(jog(&b, INTERP_X, 1), ANSWER_DONE);
	assert_int_equal(jog(&b, INTERP_X, 1), ANSWER_WRONG_STATE);
}

/* One pulse in two periods, and lost motion to take up besides. */
static void a_jog_waits_for_a_slow_machine(void **state)
{
	struct cycle_config k = manual_config();
	struct bench b;

	(void)state;
	k.points_max = 1;
	k.comp.axis[INTERP_X].backlash = 9;
	k.comp.axis[INTERP_X].take_up = 5;
	bench_init(&b, &k);
	jog(&b, INTERP_X, -1);
	for (int i = 0; i < 5000; i++) {
		b.in.busy = i % 2;
		period(&b);
		if (b.in.busy)
			assert_memory_equal(b.before, b.out.target,
					    sizeof(b.before));
	}
	assert_int_equal(b.c.state, STATE_IDLE);
	assert_int_equal(b.most, 1);
	assert_int_equal(b.c.out.target[INTERP_X], -1000);
	assert_int_equal(b.out.target[INTERP_X], -1009);
}

/* It is busy for long, as where the host was late; then it takes any number. */
static void what_waited_follows_no_faster_than_the_axis_may(void **state)
{
	struct cycle_config k = manual_config();
	struct bench b;

	(void)state;
	k.axis[INTERP_X].jog_mm_s = k.axis[INTERP_X].v_max_mm_s;
	bench_init(&b, &k);
	jog(&b, INTERP_X, -20);
	for (int i = 0; i < 2000; i++) {
		b.in.busy = i % 100 < 30;
		period(&b);
	}
	assert_int_equal(b.c.state, STATE_IDLE);
	assert_int_equal(b.out.target[INTERP_X], -20000);
	assert_int_equal(b.most, 50);
}

static void a_hold_brakes_a_jog_and_ends_it(void **state)
{
	const struct cycle_config k = manual_config();
	struct bench b;

	(void)state;
	bench_init(&b, &k);
	jog(&b, INTERP_X, 100);
	for (int i = 0; i < 500; i++)
		period(&b);
	assert_int_equal(ask(&b, CYCLE_HOLD, 0, 0), ANSWER_DONE);
	run_out(&b, STATE_IDLE);
	assert_in_range(b.out.target[INTERP_X], 8000, 12000);
	assert_true(b.c.feed_mm_s == 0);
}

static void a_touch_ends_a_jog_but_lets_it_come_away(void **state)
{
	const struct cycle_config k = manual_config();
	struct bench b;

	(void)state;
	bench_init(&b, &k);
	jog(&b, INTERP_Z, -5);
	for (int i = 0; i < 100; i++)
		period(&b);
	b.in.gap_v = SHORTED_V;
	run_out(&b, STATE_FAULT);
	assert_int_equal(b.c.fault.first, FAULT_CONTACT);
	assert_int_equal(ask(&b, CYCLE_RESET, 0, 0), ANSWER_DONE);
	assert_int_equal(b.c.state, STATE_IDLE);
	assert_int_equal(jog(&b, INTERP_Z, 1), ANSWER_DONE);
	run_out(&b, STATE_IDLE);
}

static void an_e_stop_ends_it_at_once(void **state)
{
	const struct cycle_config k = manual_config();
	struct bench b;

	(void)state;
	bench_init(&b, &k);
	jog(&b, INTERP_X, 100);
	for (int i = 0; i < 500; i++)
		period(&b);
	b.in.estop = true;
	period(&b);
	assert_int_equal(b.c.state, STATE_FAULT);
	assert_memory_equal(b.before, b.out.target, sizeof(b.before));
}

/* -- Limit switches ------------------------------------------------------- */

static void a_limit_switch_stops_at_once_and_lets_away_alone(void **state)
{
	const struct cycle_config k = manual_config();
	struct bench b;

	(void)state;
	bench_init(&b, &k);
	b.limit_max = 5000;
	jog(&b, INTERP_X, 20);
	run_out(&b, STATE_FAULT);
	assert_int_equal(b.c.fault.first, FAULT_LIMIT_SWITCH);
	assert_memory_equal(b.before, b.out.target, sizeof(b.before));
	assert_in_range(b.out.target[INTERP_X], 5001, 5020);
	assert_int_equal(jog(&b, INTERP_X, -1), ANSWER_WRONG_STATE);
	ask(&b, CYCLE_RESET, 0, 0);
	assert_int_equal(jog(&b, INTERP_X, 1), ANSWER_AT_LIMIT);
	assert_int_equal(jog(&b, INTERP_X, -1), ANSWER_DONE);
	run_out(&b, STATE_IDLE);
	assert_int_equal(b.c.limit.on, 0);
	assert_int_equal(jog(&b, INTERP_X, 0.5), ANSWER_DONE);
	run_out(&b, STATE_IDLE);
}

/* It comes on again while the axis leaves it. */
static void a_limit_switch_that_bounces_is_where_it_was(void **state)
{
	const struct cycle_config k = manual_config();
	struct bench b;

	(void)state;
	bench_init(&b, &k);
	b.limit_max = 5000;
	jog(&b, INTERP_X, 20);
	run_out(&b, STATE_FAULT);
	ask(&b, CYCLE_RESET, 0, 0);
	assert_int_equal(jog(&b, INTERP_X, -1), ANSWER_DONE);
	for (int i = 0; i < 10000 && (b.c.limit.on ||
				      b.c.state != STATE_JOG); i++)
		period(&b);
	assert_int_equal(b.c.limit.on, 0);
	b.limit_max = 4900;
	run_out(&b, STATE_FAULT);
	assert_int_equal(b.c.fault.first, FAULT_LIMIT_SWITCH);
	ask(&b, CYCLE_RESET, 0, 0);
	assert_int_equal(jog(&b, INTERP_X, 1), ANSWER_AT_LIMIT);
	assert_int_equal(jog(&b, INTERP_X, -10), ANSWER_DONE);
	run_out(&b, STATE_IDLE);
	/* Farther away it is the other one. */
	b.limit_min = -6000;
	b.limit_max = 300000;
	assert_int_equal(jog(&b, INTERP_X, -20), ANSWER_DONE);
	run_out(&b, STATE_FAULT);
	ask(&b, CYCLE_RESET, 0, 0);
	assert_int_equal(jog(&b, INTERP_X, -1), ANSWER_AT_LIMIT);
	assert_int_equal(jog(&b, INTERP_X, 1), ANSWER_DONE);
}

/* Inputs of drives tell the end. */
static void a_limit_switch_of_a_known_end_bars_the_way_there(void **state)
{
	const struct cycle_config k = manual_config();
	struct bench b;

	(void)state;
	bench_init(&b, &k);
	b.limit_max = 5000;
	b.ends_told = true;
	jog(&b, INTERP_X, 20);
	run_out(&b, STATE_FAULT);
	assert_int_equal(b.c.fault.first, FAULT_LIMIT_SWITCH);
	ask(&b, CYCLE_RESET, 0, 0);
	assert_int_equal(jog(&b, INTERP_X, 1), ANSWER_AT_LIMIT);
	assert_int_equal(jog(&b, INTERP_Y, 1), ANSWER_DONE);
	run_out(&b, STATE_IDLE);
	assert_int_equal(jog(&b, INTERP_X, -1), ANSWER_DONE);
	run_out(&b, STATE_IDLE);
	/* The other one is there: they are swapped, or of another axis. */
	bench_init(&b, &k);
	b.limit_max = 5000;
	b.ends_told = b.ends_swapped = true;
	jog(&b, INTERP_X, 20);
	run_out(&b, STATE_FAULT);
	ask(&b, CYCLE_RESET, 0, 0);
	assert_int_equal(jog(&b, INTERP_X, -1), ANSWER_AT_LIMIT);
	assert_int_equal(jog(&b, INTERP_X, 1), ANSWER_AT_LIMIT);
	b.limit_max = 300000;
	period(&b);
	assert_int_equal(jog(&b, INTERP_X, 1), ANSWER_DONE);
}

static void a_limit_switch_stops_a_job_and_its_start(void **state)
{
	const struct cycle_config k = manual_config();
	struct rig r;

	(void)state;
	cut_at(&r, &k, 2);
	r.in.limit = X_BIT;
	step(&r, SPARKING_V);
	assert_int_equal(r.c.state, STATE_FAULT);
	assert_string_equal(fault_name(r.c.fault.first), "limit-switch");
	assert_int_equal(tell(&r, CYCLE_RESET), ANSWER_DONE);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_AT_LIMIT);
	r.in.limit = 0;
	step(&r, OPEN_V);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	rig_free(&r);
}

/* Z came down onto it: back up is away, down again is not. */
static void held_on_a_switch_only_the_way_away_is_gone(void **state)
{
	const struct cycle_config k = manual_config();
	struct rig r;

	(void)state;
	cut_at(&r, &k, 2);
	r.in.limit = Z_BIT;
	step(&r, SPARKING_V);
	tell(&r, CYCLE_RESET);
	assert_int_equal(tell_mm(&r, CYCLE_RETRACT, 0.5), ANSWER_DONE);
	steps(&r, OPEN_V, 500);
	assert_int_equal(r.c.state, STATE_HOLD);
	assert_false(r.c.hold.moving);
	assert_int_equal(tell_mm(&r, CYCLE_STEP, 1), ANSWER_NOT_PASSED);
	rig_free(&r);
}

/* -- Steps ---------------------------------------------------------------- */

/* Nodes at 1, 3, 5 and 7 mm; an action at 5. */
static void begin_nodes(struct rig *r, const struct cycle_config *k)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);

	rapid_to(b, -1);
	cut_to(b, -3);
	cut_to(b, -5);
	action(b, INTERP_STOP, 0);
	cut_to(b, -7);
	rig_load(r, b, k);
	tell(r, CYCLE_START);
}

/* Cut to 4.2 mm, and held there. */
static void hold_between_nodes(struct rig *r)
{
	const struct cycle_config k = manual_config();

	begin_nodes(r, &k);
	until(r, STATE_APPROACH, OPEN_V, 1000);
	cut_until(r, 4.2);
	tell(r, CYCLE_HOLD);
	step(r, OPEN_V);
}

static void step_and_rest(struct rig *r, double n, enum cycle_answer a)
{
	assert_int_equal(tell_mm(r, CYCLE_STEP, n), a);
	for (int i = 0; i < 5000 && r->c.hold.moving; i++)
		step(r, OPEN_V);
	assert_false(r->c.hold.moving);
	assert_int_equal(r->c.state, STATE_HOLD);
}

static void steps_lead_from_node_to_node(void **state)
{
	struct rig r;

	(void)state;
	hold_between_nodes(&r);
	step_and_rest(&r, -1, ANSWER_DONE);
	assert_near(place(&r), 3, 1e-6);
	step_and_rest(&r, -2, ANSWER_DONE);
	assert_near(place(&r), 0, 1e-6);
	step_and_rest(&r, -1, ANSWER_NO_NODE);
	step_and_rest(&r, 2, ANSWER_DONE);
	assert_near(place(&r), 3, 1e-6);
	step_and_rest(&r, 1, ANSWER_NOT_PASSED);
	step_and_rest(&r, 40, ANSWER_NO_NODE);
	step_and_rest(&r, 0, ANSWER_BAD_ARGUMENT);
	step_and_rest(&r, 0.5, ANSWER_BAD_ARGUMENT);
	step_and_rest(&r, 1e9, ANSWER_BAD_ARGUMENT);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	rig_free(&r);
}

static void a_short_ends_a_step_forward(void **state)
{
	struct rig r;

	(void)state;
	hold_between_nodes(&r);
	step_and_rest(&r, -2, ANSWER_DONE);
	assert_int_equal(tell_mm(&r, CYCLE_STEP, 1), ANSWER_DONE);
	steps(&r, OPEN_V, 100);
	steps(&r, SHORTED_V, 200);
	assert_false(r.c.hold.moving);
	assert_true(place(&r) > 1 && place(&r) < 2.9);
	rig_free(&r);
}

static void dry_steps_stand_in_front_of_an_action(void **state)
{
	struct cycle_config k = manual_config();
	struct rig r;

	(void)state;
	k.dry_run = true;
	begin_nodes(&r, &k);
	steps(&r, OPEN_V, 50);
	tell(&r, CYCLE_HOLD);
	steps(&r, OPEN_V, 200);
	step_and_rest(&r, 4, ANSWER_DONE);
	assert_near(place(&r), 5, 1e-6);
	rig_free(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_jog_goes_as_far_as_told),
		cmocka_unit_test(a_jog_is_refused_where_it_cannot_go),
		cmocka_unit_test(a_jog_waits_for_a_slow_machine),
		cmocka_unit_test(what_waited_follows_no_faster_than_the_axis_may),
		cmocka_unit_test(a_hold_brakes_a_jog_and_ends_it),
		cmocka_unit_test(a_touch_ends_a_jog_but_lets_it_come_away),
		cmocka_unit_test(an_e_stop_ends_it_at_once),
		cmocka_unit_test(a_limit_switch_stops_at_once_and_lets_away_alone),
		cmocka_unit_test(a_limit_switch_that_bounces_is_where_it_was),
		cmocka_unit_test(
			a_limit_switch_of_a_known_end_bars_the_way_there),
		cmocka_unit_test(a_limit_switch_stops_a_job_and_its_start),
		cmocka_unit_test(held_on_a_switch_only_the_way_away_is_gone),
		cmocka_unit_test(steps_lead_from_node_to_node),
		cmocka_unit_test(a_short_ends_a_step_forward),
		cmocka_unit_test(dry_steps_stand_in_front_of_an_action),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
