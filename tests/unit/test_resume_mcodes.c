/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_resume_mcodes.c - M codes of a PLC, if edmd is killed while they are
 * under way
 */
#include "resume_help.h"

#define CODE	60

static void begin_code(struct world *w, enum interp_mcode_sync sync,
		       enum interp_mcode_back back)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	const struct interp_mcode m = { (uint8_t)sync, (uint8_t)back };

	world_init(w);
	w->in.plc = well();
	w->k.gap.retract_limit_mm = 2;
	loop_make(w);
	cut_to(b, -1);
	action(b, INTERP_MCODE, interp_mcode_arg(CODE, m));
	action(b, INTERP_ELECTRODE, 3);
	cut_to(b, -2);
	load(w, b);
	go_on(w);
}

static void meet(struct world *w)
{
	for (int i = 0; i < 20000 && !w->l.cycle.mcode.number; i++)
		period(w, SPARKING_V);
	assert_int_equal(w->l.cycle.mcode.number, CODE);
}

static void do_it(struct world *w)
{
	w->in.plc.mcode_done = CODE;
	period(w, SPARKING_V);
	assert_int_equal(w->l.cycle.mcode.number, 0);
	w->in.plc.mcode_done = 0;
	period(w, SPARKING_V);
}

static bool told_on_the_way(struct world *w, double to_mm)
{
	for (int i = 0; i < 20000 && at_mm(w) < to_mm; i++) {
		period(w, SPARKING_V);
		if (w->l.cycle.mcode.number)
			return true;
	}
	assert_true(at_mm(w) >= to_mm);
	return false;
}

/* From the first period after it on. */
static void an_m_code_that_was_done_is_not_told_again(void **st)
{
	(void)st;
	for (int after = 0; after < 40; after += 3) {
		struct world w;

		begin_code(&w, INTERP_MCODE_BEFORE, INTERP_MCODE_SKIP);
		meet(&w);
		do_it(&w);
		periods(&w, SPARKING_V, after);
		crash(&w);
		go_on(&w);
		assert_false(told_on_the_way(&w, 1.9));
		world_free(&w);
	}
}

static void an_m_code_that_waits_is_told_still_and_done_once(void **st)
{
	struct world w;

	(void)st;
	begin_code(&w, INTERP_MCODE_BEFORE, INTERP_MCODE_SKIP);
	meet(&w);
	assert_int_equal(w.l.cycle.job.electrode, 3);
	crash(&w);
	periods(&w, OPEN_V, 5);
	assert_int_equal(w.l.cycle.mcode.number, CODE);
	assert_int_equal(w.l.cycle.job.electrode, 3);
	/* The PLC had done it, and its answer came to nobody. */
	w.in.plc.mcode_done = CODE;
	period(&w, OPEN_V);
	w.in.plc.mcode_done = 0;
	go_on(&w);
	assert_false(told_on_the_way(&w, 1.9));
	world_free(&w);
}

/* The job was held, or in a fault, when the answer came. */
static void one_answered_while_held_is_not_waited_for_again(void **st)
{
	struct world w;

	(void)st;
	begin_code(&w, INTERP_MCODE_BEFORE, INTERP_MCODE_SKIP);
	meet(&w);
	assert_int_equal(ask(&w, CYCLE_HOLD, 0, 0), ANSWER_DONE);
	do_it(&w);
	periods(&w, OPEN_V, 5);
	crash(&w);
	periods(&w, OPEN_V, 5);
	go_on(&w);
	assert_false(told_on_the_way(&w, 1.9));
	world_free(&w);
}

static void one_not_waited_for_is_told_until_it_is_done(void **st)
{
	struct world w;

	(void)st;
	begin_code(&w, INTERP_MCODE_FREE, INTERP_MCODE_SKIP);
	meet(&w);
	cut(&w, 1.5);
	crash(&w);
	period(&w, OPEN_V);
	assert_int_equal(w.l.cycle.mcode.number, CODE);
	do_it(&w);
	world_free(&w);
}

static void no_way_leads_back_over_a_stop_after_a_crash(void **st)
{
	struct world w;

	(void)st;
	begin_code(&w, INTERP_MCODE_BEFORE, INTERP_MCODE_STOP);
	meet(&w);
	do_it(&w);
	cut(&w, 1.4);
	crash(&w);
	period(&w, OPEN_V);
	assert_int_equal(ask(&w, CYCLE_RETRACT, 0, 1), ANSWER_DONE);
	periods(&w, OPEN_V, 3000);
	assert_near(at_mm(&w), 1, 2e-3);
	world_free(&w);
}

static void one_to_be_redone_is_told_after_a_crash_behind_it(void **st)
{
	struct world w;

	(void)st;
	begin_code(&w, INTERP_MCODE_BEFORE, INTERP_MCODE_REDO);
	meet(&w);
	do_it(&w);
	cut(&w, 1.4);
	assert_int_equal(ask(&w, CYCLE_RETRACT, 0, 0.8), ANSWER_DONE);
	periods(&w, OPEN_V, 3000);
	assert_true(at_mm(&w) < 0.9);
	crash(&w);
	go_on(&w);
	assert_true(told_on_the_way(&w, 1.9));
	world_free(&w);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(an_m_code_that_was_done_is_not_told_again),
		cmocka_unit_test(an_m_code_that_waits_is_told_still_and_done_once),
		cmocka_unit_test(one_answered_while_held_is_not_waited_for_again),
		cmocka_unit_test(one_not_waited_for_is_told_until_it_is_done),
		cmocka_unit_test(no_way_leads_back_over_a_stop_after_a_crash),
		cmocka_unit_test(one_to_be_redone_is_told_after_a_crash_behind_it),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
