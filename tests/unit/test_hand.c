/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_hand.c - jogs, homing, limit switches, steps from node to node
 */
#include "cycle_help.h"

#define Z_BIT	(1u << INTERP_Z)
#define X_BIT	(1u << INTERP_X)

/* A machine whose drives do not know where they are: pulses of its switches. */
struct bench {
	struct cycle c;
	struct io_inputs in;
	struct io_outputs out;
	int32_t home[INTERP_NAXES];	/* on at and below */
	int32_t index;			/* pulses from mark to mark */
	int32_t limit_min, limit_max;
	int32_t before[INTERP_NAXES];
	int32_t most;			/* pulses in one period, of any axis */
};

static struct cycle_config hand_config(void)
{
	struct cycle_config k = usual_config();

	for (int i = 0; i < INTERP_NAXES; i++)
		k.axis[i] = (struct hand_axis) {
			.present = i < 3,
			.pulse_mm = PULSE_MM, .v_max_mm_s = 50,
			.a_max_mm_s2 = 1000, .j_max_mm_s3 = 20000,
			.jog_mm_s = 20, .home_toward = -1,
			.home_fast_mm_s = 20, .home_slow_mm_s = 1,
			.home_at_mm = -10, .home_back_mm = 0.5,
		};
	return k;
}

static void bench_init(struct bench *b, const struct cycle_config *k)
{
	*b = (struct bench) {
		.index = 2000, .limit_min = -300000, .limit_max = 300000,
		.in = { .gap_valid = true, .gap_v = OPEN_V },
	};
	for (int i = 0; i < INTERP_NAXES; i++)
		b->home[i] = -50000;
	cycle_init(&b->c, k);
}

static bool passed(const struct bench *b, int i)
{
	return floor((double)b->out.target[i] / b->index) !=
	       floor((double)b->before[i] / b->index);
}

static void sense(struct bench *b)
{
	b->in.home = b->in.limit = b->in.index = 0;
	for (int i = 0; i < INTERP_NAXES; i++) {
		const int32_t at = b->out.target[i];

		b->in.home |= at <= b->home[i] ? 1u << i : 0;
		b->in.index |= passed(b, i) ? 1u << i : 0;
		b->in.limit |= at < b->limit_min || at > b->limit_max ?
			       1u << i : 0;
		b->in.actual[i] = at;
	}
}

static void period(struct bench *b)
{
	sense(b);
	memcpy(b->before, b->out.target, sizeof(b->before));
	cycle_step(&b->c, &b->in, &b->out);
	for (int i = 0; i < INTERP_NAXES; i++) {
		const int32_t d = abs(b->out.target[i] - b->before[i]);

		b->most = d > b->most ? d : b->most;
	}
	assert_false(b->out.power);
}

static void run_out(struct bench *b, enum cycle_state s)
{
	for (int i = 0; i < 200000 && b->c.state != s; i++)
		period(b);
	assert_string_equal(state_duty[b->c.state].name, state_duty[s].name);
}

static enum cycle_answer ask(struct bench *b, enum cycle_verb v, uint32_t axis,
			     double mm)
{
	const struct cycle_command m = { .verb = v, .arg = axis, .arg_mm = mm };

	return cycle_command(&b->c, &m);
}

static enum cycle_answer jog(struct bench *b, uint32_t axis, double mm)
{
	return ask(b, CYCLE_JOG, axis, mm);
}

/* -- Jogs ------------------------------------------------------------------ */

static void a_jog_goes_as_far_as_told(void **state)
{
	const struct cycle_config k = hand_config();
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
	const struct cycle_config k = hand_config();
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
	struct cycle_config k = hand_config();
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

static void a_hold_brakes_a_jog_and_ends_it(void **state)
{
	const struct cycle_config k = hand_config();
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
	const struct cycle_config k = hand_config();
	struct bench b;

	(void)state;
	bench_init(&b, &k);
	jog(&b, INTERP_Z, -5);
	for (int i = 0; i < 100; i++)
		period(&b);
	b.in.gap_v = SHORTED_V;
	run_out(&b, STATE_FAULT);
	assert_int_equal(b.c.fault, FAULT_CONTACT);
	assert_int_equal(ask(&b, CYCLE_RESET, 0, 0), ANSWER_DONE);
	assert_int_equal(b.c.state, STATE_IDLE);
	assert_int_equal(jog(&b, INTERP_Z, 1), ANSWER_DONE);
	run_out(&b, STATE_IDLE);
}

static void an_e_stop_ends_it_at_once(void **state)
{
	const struct cycle_config k = hand_config();
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

/* -- Limit switches ---------------------------------------------------------- */

static void a_limit_switch_stops_at_once_and_lets_away_alone(void **state)
{
	const struct cycle_config k = hand_config();
	struct bench b;

	(void)state;
	bench_init(&b, &k);
	b.limit_max = 5000;
	jog(&b, INTERP_X, 20);
	run_out(&b, STATE_FAULT);
	assert_int_equal(b.c.fault, FAULT_LIMIT_SWITCH);
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

static void a_limit_switch_stops_a_job_and_its_start(void **state)
{
	const struct cycle_config k = hand_config();
	struct rig r;

	(void)state;
	cut_at(&r, &k, 2);
	r.in.limit = X_BIT;
	step(&r, SPARKING_V);
	assert_int_equal(r.c.state, STATE_FAULT);
	assert_string_equal(cycle_fault_name(r.c.fault), "limit-switch");
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
	const struct cycle_config k = hand_config();
	struct rig r;

	(void)state;
	cut_at(&r, &k, 2);
	r.in.limit = Z_BIT;
	step(&r, SPARKING_V);
	tell(&r, CYCLE_RESET);
	assert_int_equal(tell_mm(&r, CYCLE_RETRACT, 0.5), ANSWER_DONE);
	steps(&r, OPEN_V, 500);
	assert_int_equal(r.c.state, STATE_HOLD);
	assert_false(r.c.moving);
	assert_int_equal(tell_mm(&r, CYCLE_STEP, 1), ANSWER_NOT_PASSED);
	rig_free(&r);
}

/* -- Homing ------------------------------------------------------------------ */

static struct cycle_config home_config(enum home_method method)
{
	struct cycle_config k = hand_config();

	k.axis[INTERP_X].method = method;
	return k;
}

/* Where the switch is, the place is home_at; to a pulse a period's way. */
static void check_homed(const struct bench *b, int axis, int32_t at)
{
	const int32_t off = b->c.out.target[axis] - b->out.target[axis];

	assert_int_equal(b->c.hand.homed >> axis & 1, 1);
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
		assert_int_equal(hand_unhomed(&b.c), X_BIT);
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
	assert_int_equal(ask(&b, CYCLE_HOME, HAND_ALL_AXES, 0), ANSWER_DONE);
	run_out(&b, STATE_IDLE);
	assert_int_equal(b.c.out.target[INTERP_X], 3000 - 10000);
	assert_int_equal(b.out.target[INTERP_X], 3000);
	assert_int_equal(hand_unhomed(&b.c), 0);
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
	ask(&b, CYCLE_HOME, HAND_ALL_AXES, 0);
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
	assert_int_equal(hand_unhomed(&b.c), 0);
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
	assert_string_equal(cycle_fault_name(b.c.fault), "home-not-found");
	assert_in_range(-b.out.target[INTERP_X], 6000, 6020);
	assert_int_equal(hand_unhomed(&b.c), X_BIT);
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
	assert_int_equal(hand_unhomed(&b.c), X_BIT);
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
	r.c.hand.homed = X_BIT;
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	rig_free(&r);
}

static void a_program_from_elsewhere_is_refused(void **state)
{
	const struct cycle_config k = hand_config();
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

/* -- Steps ------------------------------------------------------------------- */

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
	const struct cycle_config k = hand_config();

	begin_nodes(r, &k);
	until(r, STATE_APPROACH, OPEN_V, 1000);
	cut_until(r, 4.2);
	tell(r, CYCLE_HOLD);
	step(r, OPEN_V);
}

static void step_and_rest(struct rig *r, double n, enum cycle_answer a)
{
	assert_int_equal(tell_mm(r, CYCLE_STEP, n), a);
	for (int i = 0; i < 5000 && r->c.moving; i++)
		step(r, OPEN_V);
	assert_false(r->c.moving);
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
	assert_false(r.c.moving);
	assert_true(place(&r) > 1 && place(&r) < 2.9);
	rig_free(&r);
}

static void dry_steps_stand_in_front_of_an_action(void **state)
{
	struct cycle_config k = hand_config();
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
		cmocka_unit_test(a_hold_brakes_a_jog_and_ends_it),
		cmocka_unit_test(a_touch_ends_a_jog_but_lets_it_come_away),
		cmocka_unit_test(an_e_stop_ends_it_at_once),
		cmocka_unit_test(a_limit_switch_stops_at_once_and_lets_away_alone),
		cmocka_unit_test(a_limit_switch_stops_a_job_and_its_start),
		cmocka_unit_test(held_on_a_switch_only_the_way_away_is_gone),
		cmocka_unit_test(a_switch_is_home),
		cmocka_unit_test(an_index_mark_is_home),
		cmocka_unit_test(an_absolute_drive_says_where_it_is),
		cmocka_unit_test(backlash_does_not_move_home),
		cmocka_unit_test(axes_are_homed_in_their_order),
		cmocka_unit_test(no_switch_is_a_fault),
		cmocka_unit_test(a_stop_leaves_it_unhomed),
		cmocka_unit_test(only_axes_with_a_method_are_homed),
		cmocka_unit_test(unhomed_nothing_is_cut_if_so_configured),
		cmocka_unit_test(a_program_from_elsewhere_is_refused),
		cmocka_unit_test(steps_lead_from_node_to_node),
		cmocka_unit_test(a_short_ends_a_step_forward),
		cmocka_unit_test(dry_steps_stand_in_front_of_an_action),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
