/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What path/mcode.h promises.
 */
#include "plc_help.h"

#define CODE	60
#define NEXT	61

/* A cut of three millimetres, the code, a cut of three more. */
static void begin_job(struct rig *r, enum interp_mcode_sync sync,
		      enum interp_mcode_back back)
{
	struct cycle_config k = usual_config();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	const struct interp_mcode m = { (uint8_t)sync, (uint8_t)back };

	k.gap.retract_limit_mm = 2;
	k.mcode_cycles = 500;
	cut_to(b, -3);
	action(b, INTERP_MCODE, interp_mcode_arg(CODE, m));
	cut_to(b, -6);
	rig_load(r, b, &k);
	r->in.plc = well();
	step(r, OPEN_V);
	assert_int_equal(tell(r, CYCLE_START), ANSWER_DONE);
}

static bool is_told(const struct rig *r, uint8_t number)
{
	return r->c.mcode.number == number;
}

/* The same, and the code is that of a changer. */
static void begin_change(struct rig *r, uint32_t electrode)
{
	struct cycle_config k = usual_config();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	const struct interp_mcode m = { INTERP_MCODE_BEFORE,
					INTERP_MCODE_REDO };

	k.gap.retract_limit_mm = 2;
	action(b, INTERP_ELECTRODE, 2);
	cut_to(b, -3);
	action(b, INTERP_MCODE, interp_mcode_arg(CODE, m));
	action(b, INTERP_ELECTRODE, electrode);
	cut_to(b, -6);
	rig_load(r, b, &k);
	r->in.plc = well();
	step(r, OPEN_V);
	assert_int_equal(tell(r, CYCLE_START), ANSWER_DONE);
}

/* Cut on until the code is told. */
static void meet(struct rig *r)
{
	for (int i = 0; i < 20000 && !is_told(r, CODE); i++)
		step(r, SPARKING_V);
	assert_true(is_told(r, CODE));
}

/* Both halves of the handshake. */
static void do_it(struct rig *r)
{
	r->in.plc.mcode_done = CODE;
	step(r, SPARKING_V);
	assert_true(is_told(r, 0));
	r->in.plc.mcode_done = 0;
	step(r, SPARKING_V);
}

/* On to @to_mm; was the code told on the way? */
static bool told_on_the_way(struct rig *r, double to_mm)
{
	for (int i = 0; i < 20000 && place(r) < to_mm; i++) {
		step(r, SPARKING_V);
		if (is_told(r, CODE))
			return true;
	}
	assert_true(place(r) >= to_mm);
	return false;
}

/* Held, and back by command. */
static void go_back(struct rig *r, double by_mm)
{
	assert_int_equal(tell_mm(r, CYCLE_RETRACT, by_mm), ANSWER_DONE);
	for (int i = 0; i < 5000 && r->c.hold.moving; i++)
		step(r, OPEN_V);
	assert_false(r->c.hold.moving);
}

static void go_on(struct rig *r)
{
	steps(r, OPEN_V, 5);
	assert_int_equal(tell(r, CYCLE_START), ANSWER_DONE);
}

static void the_path_waits_in_front_of_it_without_sparks(void **st)
{
	static const enum interp_mcode_sync syncs[] = {
		INTERP_MCODE_BEFORE, INTERP_MCODE_AFTER
	};

	(void)st;
	for (int i = 0; i < 2; i++) {
		struct rig r;

		begin_job(&r, syncs[i], INTERP_MCODE_SKIP);
		meet(&r);
		for (int k = 0; k < 100; k++) {
			step(&r, SPARKING_V);
			assert_near(place(&r), 3, 1e-9);
			assert_false(r.out.power);
		}
		do_it(&r);
		cut_until(&r, 5);
		rig_free(&r);
	}
}

static void a_free_one_is_not_waited_for(void **st)
{
	struct rig r;

	(void)st;
	begin_job(&r, INTERP_MCODE_FREE, INTERP_MCODE_SKIP);
	meet(&r);
	cut_until(&r, 5);
	assert_true(is_told(&r, CODE));
	do_it(&r);
	assert_true(is_told(&r, 0));
	rig_free(&r);
}

static void another_number_is_no_answer(void **st)
{
	struct rig r;

	(void)st;
	begin_job(&r, INTERP_MCODE_BEFORE, INTERP_MCODE_SKIP);
	meet(&r);
	r.in.plc.mcode_done = CODE + 1;
	steps(&r, SPARKING_V, 50);
	assert_true(is_told(&r, CODE));
	assert_near(place(&r), 3, 1e-9);
	rig_free(&r);
}

/* The answer to the one before must be gone: the same number may follow. */
static void the_next_is_told_once_the_answer_is_taken_away(void **st)
{
	static const uint8_t numbers[] = { CODE, NEXT };

	(void)st;
	for (int i = 0; i < 2; i++) {
		const struct interp_mcode m = { INTERP_MCODE_BEFORE, 0 };
		struct cycle_config k = usual_config();
		struct interp_build *b = begin(INTERP_SIMULTANEOUS);
		struct rig r;

		action(b, INTERP_MCODE, interp_mcode_arg(CODE, m));
		action(b, INTERP_MCODE, interp_mcode_arg(numbers[i], m));
		cut_to(b, -3);
		rig_load(&r, b, &k);
		r.in.plc = well();
		step(&r, OPEN_V);
		tell(&r, CYCLE_START);
		meet(&r);
		r.in.plc.mcode_done = CODE;
		steps(&r, SPARKING_V, 20);
		assert_true(is_told(&r, 0));
		r.in.plc.mcode_done = 0;
		steps(&r, SPARKING_V, 2);
		assert_true(is_told(&r, numbers[i]));
		assert_near(place(&r), 0, 1e-9);
		r.in.plc.mcode_done = numbers[i];
		step(&r, SPARKING_V);
		cut_until(&r, 1);
		rig_free(&r);
	}
}

static void no_answer_in_time_is_a_fault_and_start_waits_again(void **st)
{
	struct rig r;

	(void)st;
	begin_job(&r, INTERP_MCODE_BEFORE, INTERP_MCODE_SKIP);
	meet(&r);
	steps(&r, SPARKING_V, 490);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	steps(&r, SPARKING_V, 15);
	assert_int_equal(r.c.fault.first, FAULT_MCODE);
	assert_int_equal(r.c.state, STATE_FAULT);
	assert_int_equal(tell(&r, CYCLE_RESET), ANSWER_DONE);
	go_on(&r);
	steps(&r, SPARKING_V, 100);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	do_it(&r);
	cut_until(&r, 5);
	rig_free(&r);
}

static void a_hold_lets_it_wait_as_long_as_need_be(void **st)
{
	struct rig r;

	(void)st;
	begin_job(&r, INTERP_MCODE_BEFORE, INTERP_MCODE_SKIP);
	meet(&r);
	tell(&r, CYCLE_HOLD);
	steps(&r, SPARKING_V, 1000);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	do_it(&r);
	go_on(&r);
	assert_false(told_on_the_way(&r, 5));
	rig_free(&r);
}

static void one_of_skip_is_told_once(void **st)
{
	struct rig r;

	(void)st;
	begin_job(&r, INTERP_MCODE_BEFORE, INTERP_MCODE_SKIP);
	meet(&r);
	do_it(&r);
	cut_until(&r, 4);
	go_back(&r, 2);
	assert_near(place(&r), 2, 0.1);
	go_on(&r);
	assert_false(told_on_the_way(&r, 5));
	rig_free(&r);
}

static void one_of_redo_is_told_on_each_way_forward(void **st)
{
	struct rig r;

	(void)st;
	begin_job(&r, INTERP_MCODE_BEFORE, INTERP_MCODE_REDO);
	meet(&r);
	do_it(&r);
	cut_until(&r, 4);
	for (int i = 0; i < 3; i++) {
		/* Not if the way back did not lead over it. */
		go_back(&r, 0.5);
		go_on(&r);
		assert_false(told_on_the_way(&r, 4));

		go_back(&r, 2);
		assert_true(is_told(&r, 0));
		go_on(&r);
		assert_true(told_on_the_way(&r, 4));
		assert_near(place(&r), 3, 1e-9);
		do_it(&r);
		assert_false(told_on_the_way(&r, 4));
	}
	rig_free(&r);
}

static void a_short_that_leads_back_over_it_redoes_it(void **st)
{
	struct rig r;

	(void)st;
	begin_job(&r, INTERP_MCODE_BEFORE, INTERP_MCODE_REDO);
	meet(&r);
	do_it(&r);
	cut_until(&r, 3.2);
	for (int i = 0; i < 1000 && place(&r) > 2.8; i++)
		step(&r, SHORTED_V);
	assert_true(place(&r) <= 2.8);
	assert_true(told_on_the_way(&r, 4));
	rig_free(&r);
}

/* The wire breaks, the way leads back to the hole it was threaded in, and the
 * PLC threads it there before the cut goes on. */
static void a_broken_wire_is_threaded_again_in_its_hole(void **st)
{
	const struct interp_mcode m = { INTERP_MCODE_BEFORE,
					INTERP_MCODE_REDO };
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	k.gap.process = PROCESS_WIRE;
	k.gap.wire_retreat_to = RETREAT_HOLE;
	k.mcode_cycles = 500;
	rapid_to(b, -1);
	action(b, INTERP_MCODE, interp_mcode_arg(CODE, m));
	for (int i = 1; i <= 800; i++)
		cut_to(b, -1 - 0.005 * i);
	rig_load(&r, b, &k);
	r.in.plc = well();
	step(&r, OPEN_V);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	meet(&r);
	do_it(&r);
	cut_until(&r, 4.5);
	r.in.wire_broken = true;
	until(&r, STATE_FAULT, OPEN_V, 10000);
	assert_int_equal(r.c.fault.first, FAULT_WIRE_BROKEN);
	assert_near(place(&r), 1, 0.0021);
	for (int i = 0; i < 2; i++) {
		/* The first time the PLC does not get it done. */
		if (i == 1)
			until(&r, STATE_FAULT, OPEN_V, 1000);
		assert_int_equal(r.c.fault.first, i ? FAULT_MCODE :
						  FAULT_WIRE_BROKEN);
		assert_int_equal(tell(&r, CYCLE_RESET), ANSWER_DONE);
		assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
		meet(&r);
		assert_false(r.out.power);
	}
	r.in.wire_broken = false;
	do_it(&r);
	until(&r, STATE_APPROACH, OPEN_V, 10000);
	for (int i = 0; i < 20000 && place(&r) < 4.5; i++)
		step(&r, OPEN_V);
	cut_until(&r, 4.9);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	rig_free(&r);
}

/* The lift comes back to where it left: nothing was undone. */
static void a_lift_over_it_redoes_nothing(void **st)
{
	struct rig r;

	(void)st;
	begin_job(&r, INTERP_MCODE_BEFORE, INTERP_MCODE_REDO);
	meet(&r);
	do_it(&r);
	cut_until(&r, 3.1);
	r.c.config.jump.height_mm = r.c.jump.height_mm = 2;
	until(&r, STATE_JUMP, SPARKING_V, 2000);
	for (int i = 0; i < 1000 && place(&r) > 2; i++)
		step(&r, OPEN_V);
	assert_true(place(&r) <= 2);
	r.c.config.jump.height_mm = r.c.jump.height_mm = 0;
	assert_false(told_on_the_way(&r, 5));
	assert_true(r.c.totals.jumps > 0);
	rig_free(&r);
}

static void the_way_back_ends_at_one_of_stop(void **st)
{
	struct rig r;

	(void)st;
	begin_job(&r, INTERP_MCODE_BEFORE, INTERP_MCODE_STOP);
	cut_until(&r, 2);
	go_back(&r, 1);			/* it is not done yet */
	assert_near(place(&r), 1, 0.1);
	go_on(&r);
	meet(&r);
	do_it(&r);
	cut_until(&r, 4);
	go_back(&r, 2);
	assert_near(place(&r), 3, 1e-6);
	go_on(&r);
	assert_false(told_on_the_way(&r, 4));
	for (int i = 0; i < 2000 && r.c.state != STATE_FAULT; i++) {
		step(&r, SHORTED_V);
		assert_true(place(&r) > 3 - 1e-6);
	}
	assert_int_equal(r.c.fault.first, FAULT_RETRACT_AT_START);
	rig_free(&r);
}

static void a_lost_plc_is_a_fault_while_it_is_waited_for(void **st)
{
	struct rig r;

	(void)st;
	begin_job(&r, INTERP_MCODE_BEFORE, INTERP_MCODE_SKIP);
	meet(&r);
	r.in.plc = (struct io_plc) { .present = true, .mcode_done = CODE };
	step(&r, SPARKING_V);
	assert_int_equal(r.c.fault.first, FAULT_PLC_LOST);
	assert_true(is_told(&r, CODE));
	rig_free(&r);
}

static void without_a_plc_it_is_passed(void **st)
{
	struct rig r;

	(void)st;
	begin_job(&r, INTERP_MCODE_BEFORE, INTERP_MCODE_STOP);
	r.in.plc = (struct io_plc) { .present = false };
	assert_false(told_on_the_way(&r, 5));
	go_back(&r, 4);
	assert_near(place(&r), 1, 0.1);
	rig_free(&r);
}

static void a_new_job_owes_nothing_of_the_last(void **st)
{
	struct rig r;

	(void)st;
	begin_job(&r, INTERP_MCODE_BEFORE, INTERP_MCODE_SKIP);
	meet(&r);
	tell(&r, CYCLE_STOP);
	until(&r, STATE_IDLE, SPARKING_V, 10);
	assert_int_equal(cycle_load(&r.c, &r.m.p), ANSWER_DONE);
	assert_true(is_told(&r, 0));
	tell(&r, CYCLE_START);
	meet(&r);
	assert_near(place(&r), 3, 1e-9);
	rig_free(&r);
}

/* The code and the electrode that it is about are told in one period, and not
 * before. */
static void a_changer_is_told_the_electrode_with_its_code(void **state)
{
	struct rig r;

	(void)state;
	begin_change(&r, 3);
	for (int i = 0; i < 20000 && !is_told(&r, CODE); i++) {
		assert_in_range(r.c.job.electrode, 0, 2);
		step(&r, SPARKING_V);
	}
	assert_true(is_told(&r, CODE));
	assert_int_equal(r.c.job.electrode, 3);
	do_it(&r);
	assert_int_equal(r.c.job.electrode, 3);
	rig_free(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_path_waits_in_front_of_it_without_sparks),
		cmocka_unit_test(a_free_one_is_not_waited_for),
		cmocka_unit_test(another_number_is_no_answer),
		cmocka_unit_test(the_next_is_told_once_the_answer_is_taken_away),
		cmocka_unit_test(no_answer_in_time_is_a_fault_and_start_waits_again),
		cmocka_unit_test(a_hold_lets_it_wait_as_long_as_need_be),
		cmocka_unit_test(one_of_skip_is_told_once),
		cmocka_unit_test(one_of_redo_is_told_on_each_way_forward),
		cmocka_unit_test(a_short_that_leads_back_over_it_redoes_it),
		cmocka_unit_test(a_broken_wire_is_threaded_again_in_its_hole),
		cmocka_unit_test(a_lift_over_it_redoes_nothing),
		cmocka_unit_test(the_way_back_ends_at_one_of_stop),
		cmocka_unit_test(a_lost_plc_is_a_fault_while_it_is_waited_for),
		cmocka_unit_test(without_a_plc_it_is_passed),
		cmocka_unit_test(a_new_job_owes_nothing_of_the_last),
		cmocka_unit_test(a_changer_is_told_the_electrode_with_its_code),
	};

	return cmocka_run_group_tests_name("rt/mcode", tests, NULL, NULL);
}
