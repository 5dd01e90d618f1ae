/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What rt/stand.h promises.
 */
#include "plc_help.h"

#define WANTED	3

/* A cut of 1 mm, another electrode, a cut of 2 mm. */
static void at_the_change(struct rig *r)
{
	const struct cycle_config k = usual_config();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);

	cut_to(b, -1);
	action(b, INTERP_ELECTRODE, INTERP_ELECTRODE_STOP | WANTED);
	cut_to(b, -3);
	rig_load(r, b, &k);
	r->in.plc = well();
	step(r, OPEN_V);
	assert_int_equal(stand_now(&r->c).why, STAND_READY);
	assert_int_equal(tell(r, CYCLE_START), ANSWER_DONE);
	steps(r, SPARKING_V, 2);
	until(r, STATE_HOLD, SPARKING_V, 10000);
	steps(r, SPARKING_V, 100);
}

static void assert_asks(struct rig *r)
{
	const struct stand_now s = stand_now(&r->c);

	assert_int_equal(s.why, STAND_ELECTRODE);
	assert_int_equal(s.of, WANTED);
	assert_int_equal(tell(r, CYCLE_START), ANSWER_ASKS);
	steps(r, SPARKING_V, 20);
	assert_int_equal(r->c.state, STATE_HOLD);
	assert_near(place(r), 1, 1e-9);
}

static void only_its_own_number_answers_for_it(void **st)
{
	static const double wrong[] = { 0, 2, 4, 3.5, -3, NAN, INFINITY };
	struct rig r;

	(void)st;
	at_the_change(&r);
	assert_asks(&r);
	for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++)
		assert_int_equal(tell_mm(&r, CYCLE_CONFIRM, wrong[i]),
				 ANSWER_NOT_ASKED);
	assert_asks(&r);
	assert_int_equal(tell_mm(&r, CYCLE_CONFIRM, WANTED), ANSWER_DONE);
	steps(&r, SPARKING_V, 20);
	assert_int_equal(r.c.state, STATE_HOLD);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	steps(&r, SPARKING_V, 50);
	assert_int_equal(stand_now(&r.c).why, STAND_NONE);
	assert_true(place(&r) > 1);
	assert_int_equal(tell_mm(&r, CYCLE_CONFIRM, WANTED), ANSWER_NOT_ASKED);
	rig_free(&r);
}

static enum cycle_answer tell_of(struct rig *r, uint32_t verb, uint32_t stand)
{
	return cycle_command(&r->c, &(struct cycle_command) {
		.verb = verb, .arg = stand, .arg_mm = WANTED,
	});
}

/* Two people see the same stand, and both answer it. */
static void an_answer_is_for_the_stand_that_was_seen(void **st)
{
	uint32_t seen, ready;
	struct rig r;

	(void)st;
	at_the_change(&r);
	seen = r.c.stand.n;
	ready = seen - 1;
	assert_int_equal(tell_of(&r, CYCLE_CONFIRM, ready), ANSWER_OVER);
	assert_true(stand_asks(&r.c));
	assert_int_equal(tell_of(&r, CYCLE_CONFIRM, seen), ANSWER_DONE);
	assert_int_equal(tell_of(&r, CYCLE_START, ready), ANSWER_OVER);
	assert_int_equal(r.c.state, STATE_HOLD);
	assert_int_equal(tell_of(&r, CYCLE_START, seen), ANSWER_DONE);
	steps(&r, SPARKING_V, 50);
	assert_int_equal(tell_of(&r, CYCLE_START, seen), ANSWER_OVER);
	assert_int_equal(tell(&r, CYCLE_HOLD), ANSWER_DONE);
	steps(&r, SPARKING_V, 200);
	assert_int_equal(r.c.state, STATE_HOLD);
	assert_int_equal(tell_of(&r, CYCLE_START, seen), ANSWER_OVER);
	steps(&r, SPARKING_V, 20);
	assert_int_equal(r.c.state, STATE_HOLD);
	assert_int_equal(tell_of(&r, CYCLE_START, seen + 1), ANSWER_DONE);
	rig_free(&r);
}

static void nothing_that_comes_between_answers_for_it(void **st)
{
	struct rig r;

	(void)st;
	at_the_change(&r);
	assert_int_equal(tell(&r, CYCLE_HOLD), ANSWER_DONE);
	assert_asks(&r);
	assert_int_equal(tell(&r, CYCLE_ESTOP), ANSWER_DONE);
	step(&r, OPEN_V);
	assert_int_equal(r.c.state, STATE_FAULT);
	assert_int_equal(stand_now(&r.c).why, STAND_NONE);
	assert_int_equal(tell(&r, CYCLE_RESET), ANSWER_DONE);
	step(&r, OPEN_V);
	assert_asks(&r);
	r.in.plc.hold = true;
	step(&r, OPEN_V);
	r.in.plc.hold = false;
	step(&r, OPEN_V);
	assert_asks(&r);
	assert_int_equal(tell_mm(&r, CYCLE_RETRACT, 0.2), ANSWER_DONE);
	steps(&r, OPEN_V, 3000);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_ASKS);
	rig_free(&r);
}

static void a_plc_confirms_what_it_was_told(void **st)
{
	struct rig r;

	(void)st;
	at_the_change(&r);
	r.in.plc.start = true;
	step(&r, OPEN_V);
	r.in.plc.start = false;
	assert_asks(&r);
	r.in.plc.confirm = true;
	step(&r, OPEN_V);
	r.in.plc.confirm = false;
	steps(&r, OPEN_V, 20);
	assert_int_equal(r.c.state, STATE_HOLD);
	r.in.plc.start = true;
	step(&r, OPEN_V);
	r.in.plc.start = false;
	steps(&r, SPARKING_V, 50);
	assert_true(place(&r) > 1);
	rig_free(&r);
}

static void each_way_to_stand_has_its_reason(void **st)
{
	struct rig r;

	(void)st;
	at_the_change(&r);
	tell_mm(&r, CYCLE_CONFIRM, WANTED);
	tell(&r, CYCLE_START);
	cut_until(&r, 1.5);
	tell(&r, CYCLE_HOLD);
	steps(&r, SPARKING_V, 100);
	assert_int_equal(stand_now(&r.c).why, STAND_COMMAND);
	tell(&r, CYCLE_START);
	steps(&r, SPARKING_V, 20);
	r.in.plc.hold = true;
	steps(&r, SPARKING_V, 20);
	assert_int_equal(stand_now(&r.c).why, STAND_PLC);
	r.in.plc.hold = false;
	step(&r, SPARKING_V);
	assert_int_equal(stand_now(&r.c).why, STAND_PLC);
	tell(&r, CYCLE_START);
	steps(&r, SPARKING_V, 20);
	tell(&r, CYCLE_ESTOP);
	step(&r, OPEN_V);
	tell(&r, CYCLE_RESET);
	steps(&r, OPEN_V, 5);
	assert_int_equal(stand_now(&r.c).why, STAND_RESET);
	rig_free(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(only_its_own_number_answers_for_it),
		cmocka_unit_test(an_answer_is_for_the_stand_that_was_seen),
		cmocka_unit_test(nothing_that_comes_between_answers_for_it),
		cmocka_unit_test(a_plc_confirms_what_it_was_told),
		cmocka_unit_test(each_way_to_stand_has_its_reason),
	};

	return cmocka_run_group_tests_name("rt/stand", tests, NULL, NULL);
}
