/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_cycle_pulser.c - the cycle with step and direction lines: busy periods,
 * switches
 */
#include "cycle_help.h"
#include "pulser.h"

#define FEED_MM_S	0.2		/* a pulse in five periods */

static void down(struct rig *r, const struct cycle_config *k)
{
	static const struct interp_build_word w = {
		.line = 1, .feed_mm_s = FEED_MM_S,
	};
	double end[INTERP_NAXES];
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct interp_diag d;

	memcpy(end, interp_build_here(b), sizeof(end));
	end[INTERP_Z] = -1;
	end[INTERP_X] = 0.3;
	assert_int_equal(interp_build_line(b, end, &w, &d), 0);
	rig_load(r, b, k);
}

/* Cycles from start to end, all in dry run; the pulser makes it wait. */
static uint64_t walk(const struct pulser_config *pc, bool waits,
		     int32_t *ret_end)
{
	struct cycle_config k = usual_config();
	struct pulser p;
	struct rig r;
	uint64_t n;

	k.dry_run = true;
	if (waits)
		k.points_max = 1;
	down(&r, &k);
	pulser_init(&p, pc);
	tell(&r, CYCLE_START);
	for (n = 0; r.c.state != STATE_IDLE; n++) {
		assert_true(n < 100000);
		r.in.busy = waits && pulser_busy(&p);
		step(&r, OPEN_V);
		pulser_period(&p, r.out.target);
	}
	memcpy(ret_end, r.out.target, sizeof(r.out.target));
	rig_free(&r);
	return n;
}

static void waiting_for_pulses_costs_no_feed(void **state)
{
	const struct pulser_config c = { 2, 2, 1, 1, false, 0, 0, 0 };
	int32_t free_end[INTERP_NAXES], end[INTERP_NAXES];
	const uint64_t without = walk(&c, false, free_end);
	const uint64_t with = walk(&c, true, end);

	(void)state;
	assert_memory_equal(end, free_end, sizeof(end));
	assert_in_range(with, without, without + without / 50);
}

static void it_takes_no_point_while_the_machine_is_busy(void **state)
{
	struct cycle_config k = usual_config();
	struct rig r;

	(void)state;
	k.dry_run = true;
	k.points_max = 1;
	down(&r, &k);
	tell(&r, CYCLE_START);
	for (int n = 0; n < 3000; n++) {
		r.in.busy = n % 7 != 0;
		step(&r, OPEN_V);
		if (r.in.busy)
			assert_memory_equal(r.out.target, r.before.target,
					    sizeof(r.out.target));
	}
	assert_true(r.out.target[INTERP_Z] < -100);
	rig_free(&r);
}

static void no_faster_than_pulses_can_follow(void **state)
{
	const struct pulser_config c = { 5, 5, 5, 5, false, 0, 0, 0 };
	int32_t free_end[INTERP_NAXES], end[INTERP_NAXES];

	(void)state;
	walk(&c, false, free_end);
	assert_in_range(walk(&c, true, end), 1000 * 10, 1100 * 10);
	assert_memory_equal(end, free_end, sizeof(end));
}

/* What is done already is passed in the same period, on both ways. */
static void an_action_passed_again_gives_no_more_points(void **state)
{
	struct cycle_config k = usual_config();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct rig r;

	(void)state;
	k.dry_run = true;
	k.points_max = 3;
	for (int i = 1; i <= 50; i++) {
		cut_to(b, -0.01 * i);
		action(b, INTERP_AUX, INTERP_AUX_PUMP_ON);
	}
	rig_load(&r, b, &k);
	tell(&r, CYCLE_START);
	while (r.c.out.target[INTERP_Z] > -450)
		step(&r, OPEN_V);
	tell(&r, CYCLE_HOLD);
	steps(&r, OPEN_V, 100);
	assert_int_equal(tell_mm(&r, CYCLE_RETRACT, 0.4), ANSWER_DONE);
	steps(&r, OPEN_V, 1000);	/* none is farther than points_max */
	assert_true(r.c.out.target[INTERP_Z] > -100);
	tell(&r, CYCLE_START);
	until(&r, STATE_IDLE, OPEN_V, 10000);
	rig_free(&r);
}

static void erode_a_while(struct rig *r)
{
	struct cycle_config k = usual_config();

	k.points_max = 1;
	down(r, &k);
	tell(r, CYCLE_START);
	for (int n = 0; n < 200; n++)
		step(r, n < 10 ? OPEN_V : SPARKING_V);
	assert_int_equal(r->c.state, STATE_ERODE);
}

static void a_switch_ends_sparks_at_once_with_its_own_fault(void **state)
{
	(void)state;
	for (int i = 0; i < 3; i++) {
		static const enum cycle_fault faults[] = {
			FAULT_LIMIT_SWITCH, FAULT_DOOR, FAULT_DIELECTRIC
		};
		struct rig r;

		erode_a_while(&r);
		r.in.limit = i == 0 ? 1u << INTERP_Z : 0;
		r.in.door_open = i == 1;
		r.in.dielectric_low = i == 2;
		step(&r, SPARKING_V);
		assert_false(r.out.power);
		assert_int_equal(r.c.fault.first, faults[i]);
		for (int n = 0; n < 500; n++)
			step(&r, SPARKING_V);
		assert_int_equal(r.c.state, STATE_FAULT);
		rig_free(&r);
	}
}

static void it_may_go_back_off_a_limit_switch(void **state)
{
	struct rig r;
	int32_t at;

	(void)state;
	erode_a_while(&r);
	r.in.limit = 1;
	step(&r, SPARKING_V);
	at = r.out.target[INTERP_Z];
	assert_int_equal(tell(&r, CYCLE_RESET), ANSWER_DONE);
	assert_int_equal(tell_mm(&r, CYCLE_RETRACT, 0.01), ANSWER_DONE);
	for (int n = 0; n < 500; n++)
		step(&r, OPEN_V);
	assert_int_equal(r.c.state, STATE_HOLD);
	assert_true(r.out.target[INTERP_Z] > at + 5);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_AT_LIMIT);
	r.in.limit = 0;
	step(&r, OPEN_V);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	rig_free(&r);
}

static void without_sparks_the_level_may_be_low(void **state)
{
	struct cycle_config k = usual_config();
	struct rig r;

	(void)state;
	k.dry_run = true;
	down(&r, &k);
	r.in.dielectric_low = true;
	tell(&r, CYCLE_START);
	for (int n = 0; n < 100; n++)
		step(&r, OPEN_V);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	rig_free(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(waiting_for_pulses_costs_no_feed),
		cmocka_unit_test(it_takes_no_point_while_the_machine_is_busy),
		cmocka_unit_test(no_faster_than_pulses_can_follow),
		cmocka_unit_test(an_action_passed_again_gives_no_more_points),
		cmocka_unit_test(a_switch_ends_sparks_at_once_with_its_own_fault),
		cmocka_unit_test(it_may_go_back_off_a_limit_switch),
		cmocka_unit_test(without_sparks_the_level_may_be_low),
	};

	return cmocka_run_group_tests_name("rt/cycle pulser", tests, NULL,
					   NULL);
}
