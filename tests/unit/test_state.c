/* SPDX-License-Identifier: Apache-2.0 */
/* test_state.c - promises of the two tables of states */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "state.h"

#include <string.h>

#define EACH_STATE(s)	for (int s = STATE_IDLE; s < CYCLE_NSTATES; s++)
#define EACH_EVENT(e)	for (int e = EVENT_NONE; e < CYCLE_NEVENTS; e++)

static enum cycle_state next_of(int s, int e)
{
	return state_next((enum cycle_state)s, (enum cycle_event)e);
}

static void every_running_state_gives_way_to_hold_and_stop(void **st)
{
	int running = 0;

	(void)st;
	EACH_STATE(s) {
		if (!state_duty[s].running)
			continue;
		running++;
		assert_int_equal(next_of(s, EVENT_HOLD), STATE_HOLD);
		assert_int_equal(next_of(s, EVENT_STOP), STATE_HOLD);
	}
	assert_int_equal(running, 6);
}

static void a_fault_is_left_by_reset_alone_and_then_it_is_held(void **st)
{
	(void)st;
	EACH_EVENT(e)
		assert_int_equal(next_of(STATE_FAULT, e), e == EVENT_RESET ?
				 STATE_HOLD : STATE_FAULT);
}

static void power_is_on_in_approach_and_erode_only(void **st)
{
	(void)st;
	for (int s = 0; s < CYCLE_NSTATES; s++)
		assert_int_equal(state_duty[s].power,
				 s == STATE_APPROACH || s == STATE_ERODE);
}

static void idle_hold_fault_and_hands_do_not_run(void **st)
{
	(void)st;
	EACH_STATE(s)
		assert_int_equal(state_duty[s].running, s != STATE_IDLE &&
				 s != STATE_HOLD && s != STATE_FAULT &&
				 s != STATE_JOG && s != STATE_HOME);
}

static void a_hold_is_left_by_start_alone(void **st)
{
	(void)st;
	EACH_EVENT(e)
		assert_int_equal(next_of(STATE_HOLD, e),
				 e == EVENT_START ? STATE_TRAVEL :
				 e == EVENT_RETURN ? STATE_JUMP : STATE_HOLD);
}

static void nothing_that_happens_starts_an_idle_machine(void **st)
{
	(void)st;
	EACH_EVENT(e)
		assert_int_equal(next_of(STATE_IDLE, e), STATE_IDLE);
}

static void shorts_and_arcs_under_power_lead_back_along_the_path(void **st)
{
	(void)st;
	EACH_STATE(s) {
		if (!state_duty[s].power)
			continue;
		assert_int_equal(next_of(s, EVENT_SHORT), STATE_RETRACT);
		assert_int_equal(next_of(s, EVENT_ARCING), STATE_RETRACT);
	}
	assert_int_equal(next_of(STATE_JUMP, EVENT_SHORT), STATE_RETRACT);
}

static void no_event_turns_the_power_on_but_from_a_running_state(void **st)
{
	(void)st;
	EACH_STATE(s) {
		EACH_EVENT(e) {
			if (state_duty[next_of(s, e)].power)
				assert_true(state_duty[s].running);
		}
	}
}

static void every_entry_is_a_state_and_the_nothing_event_stays(void **st)
{
	(void)st;
	EACH_STATE(s) {
		assert_int_equal(next_of(s, EVENT_NONE), s);
		EACH_EVENT(e) {
			assert_true(next_of(s, e) > STATE_STAY);
			assert_true(next_of(s, e) < CYCLE_NSTATES);
		}
	}
}

static void every_state_has_a_name_of_its_own(void **st)
{
	(void)st;
	EACH_STATE(s) {
		assert_non_null(state_duty[s].name);
		for (int o = STATE_IDLE; o < s; o++)
			assert_string_not_equal(state_duty[s].name,
						state_duty[o].name);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_running_state_gives_way_to_hold_and_stop),
		cmocka_unit_test(a_fault_is_left_by_reset_alone_and_then_it_is_held),
		cmocka_unit_test(power_is_on_in_approach_and_erode_only),
		cmocka_unit_test(idle_hold_fault_and_hands_do_not_run),
		cmocka_unit_test(a_hold_is_left_by_start_alone),
		cmocka_unit_test(nothing_that_happens_starts_an_idle_machine),
		cmocka_unit_test(shorts_and_arcs_under_power_lead_back_along_the_path),
		cmocka_unit_test(no_event_turns_the_power_on_but_from_a_running_state),
		cmocka_unit_test(every_entry_is_a_state_and_the_nothing_event_stays),
		cmocka_unit_test(every_state_has_a_name_of_its_own),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
