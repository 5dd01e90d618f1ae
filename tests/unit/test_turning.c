/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_turning.c - a move that is told another goal behind it turns and comes
 * to it, at whatever moment, also if its braking ends exactly with a period
 */
#include "cycle_help.h"

/* Held on Z; behind its end X allows less. */
static void held_at(struct rig *r, double mm, double jerk)
{
	struct cycle_config k = usual_config();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	const double end[INTERP_NAXES] = { [INTERP_X] = 1, [INTERP_Z] = -2 };

	help_machine.axis[INTERP_X].a_max_mm_s2 = 100;
	k.dry_run = true;
	k.period_ns = 50000;
	k.gap.retract_mm_s = 100;
	k.travel_j_mm_s3 = jerk;
	rapid_to(b, -1);
	cut_to(b, -2);
	line(b, end);
	rig_load(r, b, &k);
	tell(r, CYCLE_START);
	for (int i = 0; i < 200000 && place(r) < mm; i++)
		step(r, OPEN_V);
	tell(r, CYCLE_HOLD);
	while (r->c.mover.v_mm_s != 0)
		step(r, OPEN_V);
}

/* After @n periods it is told to go back by @mm. */
static void back_after(struct rig *r, int n, double mm)
{
	double to_mm;

	steps(r, OPEN_V, n);
	assert_int_equal(tell_mm(r, CYCLE_RETRACT, mm), ANSWER_DONE);
	to_mm = r->c.hold.to_mm;
	for (int i = 0; i < 200000 && r->c.hold.moving; i++)
		step(r, OPEN_V);
	assert_int_equal(r->c.fault.first, FAULT_NONE);
	assert_false(r->c.hold.moving);
	assert_near(place(r), to_mm, 4 * MOVER_ONTO_MM);
	rig_free(r);
}

/* Speeding up for n periods, it stands in 3 n, and not a bit more. */
static void onward_and_back_at_any_moment(void **st)
{
	(void)st;
	for (int n = 1; n < 200; n++) {
		struct rig r;

		held_at(&r, 1.2, 1247.99);
		assert_int_equal(tell_mm(&r, CYCLE_STEP, 1), ANSWER_DONE);
		back_after(&r, n, 1.1);
	}
}

static void back_and_not_so_far_at_any_moment(void **st)
{
	(void)st;
	for (int n = 1; n < 200; n++) {
		struct rig r;

		held_at(&r, 1.2, 20000);
		assert_int_equal(tell_mm(&r, CYCLE_RETRACT, 1e9), ANSWER_DONE);
		back_after(&r, n, 1e-4);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(onward_and_back_at_any_moment),
		cmocka_unit_test(back_and_not_so_far_at_any_moment),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
