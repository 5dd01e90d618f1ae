/* SPDX-License-Identifier: Apache-2.0 */
/* test_retract.c - promises of the way back: its bounds, and that of a wire */
#include "cycle_help.h"
#include "hunting.h"

/* Air, then cuts to 2 and to 5; cut to @mm. */
static void cut_two_motions(struct rig *r, const struct cycle_config *k,
			    double mm)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);

	rapid_to(b, -1);
	cut_to(b, -2);
	cut_to(b, -5);
	rig_load(r, b, k);
	assert_int_equal(tell(r, CYCLE_START), ANSWER_DONE);
	until(r, STATE_APPROACH, OPEN_V, 1000);
	cut_until(r, mm);
}

/* -- How far ------------------------------------------------------------- */

struct bound {
	enum retract_to to;
	double limit_mm, floor_mm;
	enum cycle_fault fault;
};

static void each_bound_of_the_way_has_its_place_and_its_alarm(void **st)
{
	static const struct bound bounds[] = {
		{ RETRACT_LIMIT, 0.5, 2.1, FAULT_SHORT_NOT_CLEARED },
		{ RETRACT_LIMIT, 0.01, 2.59, FAULT_SHORT_NOT_CLEARED },
		{ RETRACT_LIMIT, 50, 0, FAULT_RETRACT_AT_START },
		{ RETRACT_START, 0.5, 0, FAULT_RETRACT_AT_START },
		{ RETRACT_MOTION, 0.5, 2, FAULT_RETRACT_AT_START },
	};

	(void)st;
	for (size_t i = 0; i < sizeof(bounds) / sizeof(bounds[0]); i++) {
		const struct bound *b = &bounds[i];
		struct cycle_config k = usual_config();
		double least = 1e9;
		struct rig r;

		k.gap.retract_to = b->to;
		k.gap.retract_limit_mm = b->limit_mm;
		cut_two_motions(&r, &k, 2.6);
		while (r.c.state != STATE_FAULT) {
			step(&r, SHORTED_V);
			assert_false(r.out.power);
			least = fmin(least, place(&r));
		}
		assert_near(least, b->floor_mm, 0.0021);
		assert_true(least >= b->floor_mm - 2e-9);
		assert_int_equal(r.c.fault.first, b->fault);
		rig_free(&r);
	}
}

static void a_short_that_dissolves_at_the_limit_is_no_fault(void **st)
{
	const struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	cut_at(&r, &k, 3);
	steps(&r, SHORTED_V, 100 + 45);
	assert_int_equal(r.c.state, STATE_RETRACT);
	assert_true(r.c.feed_mm_s == 0);
	until(&r, STATE_ERODE, SPARKING_V, 1000);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	rig_free(&r);
}

/* -- How long, how often ------------------------------------------------- */

static void a_retract_that_lasts_too_long_is_a_fault(void **st)
{
	struct cycle_config k = usual_config();
	struct rig r;
	int n;

	(void)st;
	k.gap.retract_mm_s = 0.1;
	k.gap.retract_max.cycles = 200;
	cut_at(&r, &k, 3);
	step(&r, SHORTED_V);
	for (n = 1; r.c.fault.first == FAULT_NONE; n++)
		step(&r, NARROW_V);
	assert_in_range(n, 199, 202);
	assert_int_equal(r.c.fault.first, FAULT_RETRACT_TIME);
	assert_string_equal(fault_name(r.c.fault.first), "retract-time");
	until(&r, STATE_FAULT, SPARKING_V, 100);
	rig_free(&r);
}

/* One retract, and again to where it was short. */
static void bounce(struct rig *r)
{
	const double from = place(r);

	step(r, SHORTED_V);
	while (r->c.state == STATE_RETRACT)
		step(r, SPARKING_V);
	while (r->c.fault.first == FAULT_NONE && place(r) < from)
		step(r, SPARKING_V);
}

static void retracts_in_a_row_without_erosion_are_a_fault(void **st)
{
	struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	k.gap.abort_count = 5;
	k.gap.progress_mm = 0.02;
	cut_at(&r, &k, 2);
	for (int i = 0; i < 4; i++)
		bounce(&r);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	bounce(&r);
	assert_int_equal(r.c.fault.first, FAULT_RETRACT_COUNT);
	assert_string_equal(fault_name(r.c.fault.first), "retract-count");
	until(&r, STATE_FAULT, SPARKING_V, 100);
	/* The operator looked: it counts anew. */
	tell(&r, CYCLE_RESET);
	tell(&r, CYCLE_START);
	until(&r, STATE_ERODE, SPARKING_V, 1000);
	for (int i = 0; i < 4; i++)
		bounce(&r);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	rig_free(&r);
}

static void erosion_between_retracts_counts_them_anew(void **st)
{
	struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	k.gap.abort_count = 3;
	k.gap.progress_mm = 0.02;
	cut_at(&r, &k, 2);
	for (int i = 0; i < 20; i++) {
		bounce(&r);
		cut_until(&r, r.c.far_mm + 0.03);
	}
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	assert_int_equal(r.c.totals.retracts, 20);
	rig_free(&r);
}

/* -- A wire -------------------------------------------------------------- */

static struct cycle_config wired(void)
{
	struct cycle_config k = usual_config();

	k.gap.process = PROCESS_WIRE;
	k.gap.wire_retract_mm = 0.02;
	k.gap.wire_retreat_mm = 0.3;
	k.jump.height_mm = 1;
	k.jump.every_mm = 0.1;
	return k;
}

static void a_wire_retracts_by_micrometres_and_never_jumps(void **st)
{
	const struct cycle_config k = wired();
	double from;
	struct rig r;

	(void)st;
	cut_two_motions(&r, &k, 3);
	for (int n = 0; n < 1000; n++) {
		step(&r, n % 5 ? SPARKING_V : k.gap.servo_v);
		assert_int_not_equal(r.c.state, STATE_JUMP);
	}
	from = place(&r);
	until(&r, STATE_FAULT, SHORTED_V, 1000);
	assert_int_equal(r.c.fault.first, FAULT_SHORT_NOT_CLEARED);
	assert_near(from - place(&r), k.gap.wire_retract_mm, 2e-9);
	rig_free(&r);
}

static void
a_broken_wire_is_held_back_from_the_break_and_cut_on_there(void **st)
{
	static const struct {
		enum retreat_to to;
		double mm, end_mm;
	} ways[] = {
		{ RETREAT_DISTANCE, 0.3, 2.7 },
		{ RETREAT_DISTANCE, 0.01, 2.99 },
		{ RETREAT_DISTANCE, 50, 0 },
		{ RETREAT_MOTION, 50, 2 },
		{ RETREAT_HOLE, 50, 1 },
	};

	(void)st;
	for (int i = 0; i < 5; i++) {
		struct cycle_config k = wired();
		double at;
		struct rig r;

		k.gap.wire_retreat_to = ways[i].to;
		k.gap.wire_retreat_mm = ways[i].mm;
		cut_two_motions(&r, &k, 3);
		at = place(&r);
		r.in.wire_broken = true;
		step(&r, SPARKING_V);
		assert_false(r.out.power);
		assert_int_equal(r.c.fault.first, FAULT_WIRE_BROKEN);
		until(&r, STATE_FAULT, SPARKING_V, 20000);
		assert_near(place(&r), ways[i].end_mm, 0.006);
		/* Still broken: it does not begin. */
		tell(&r, CYCLE_RESET);
		tell(&r, CYCLE_START);
		for (int n = 0; n < 1000 && r.c.state != STATE_FAULT; n++) {
			step(&r, OPEN_V);
			assert_false(r.out.power);
		}
		assert_int_equal(r.c.fault.first, FAULT_WIRE_BROKEN);
		r.in.wire_broken = false;
		tell(&r, CYCLE_RESET);
		assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
		until(&r, STATE_APPROACH, OPEN_V, 10000);
		/* Positioned so far: nothing sparks where it is cut. */
		assert_near(place(&r), fmax(fmax(at - ways[i].mm, 1),
					    ways[i].end_mm), 0.003);
		until(&r, STATE_ERODE, SPARKING_V, 20000);
		assert_near(place(&r), at, 0.003);
		rig_free(&r);
	}
}

/* Broken at 3, led back to the motion's start at 2 and threaded there. */
static void begin_again(struct rig *r)
{
	struct cycle_config k = wired();

	k.gap.wire_retreat_to = RETREAT_MOTION;
	cut_two_motions(r, &k, 3);
	r->in.wire_broken = true;
	until(r, STATE_FAULT, SPARKING_V, 20000);
	r->in.wire_broken = false;
	tell(r, CYCLE_RESET);
	assert_int_equal(tell(r, CYCLE_START), ANSWER_DONE);
}

static void the_way_forward_from_a_break_is_positioned_and_then_cut(void **st)
{
	struct rig r;

	(void)st;
	begin_again(&r);
	for (int n = 0; n < 20000 && r.c.state != STATE_APPROACH; n++) {
		step(&r, OPEN_V);
		assert_false(r.out.power && place(&r) < 2.69);
	}
	assert_near(place(&r), 2.7, 0.003);
	/* A retract from there on does not begin it anew. */
	until(&r, STATE_ERODE, SPARKING_V, 20000);
	until(&r, STATE_RETRACT, SHORTED_V, 10);
	until(&r, STATE_APPROACH, OPEN_V, 1000);
	step(&r, OPEN_V);
	assert_true(r.out.power);
	rig_free(&r);
}

/* Every retract comes a little farther, up to the break and beyond. */
static void retracts_in_a_kerf_that_is_cut_again_are_no_hunting(void **st)
{
	struct rig r;

	(void)st;
	begin_again(&r);
	for (int n = 0; n < 20000 && place(&r) < 2.4; n++)
		step(&r, OPEN_V);
	until(&r, STATE_RETRACT, SHORTED_V, 10);
	until(&r, STATE_ERODE, r.c.gap.servo_v, 1000);
	r.c.gap.abort_count = HUNTING_ROW;
	r.c.gap.progress_mm = 0.001;
	for (int i = 0; i < HUNTING_ROW + 5; i++) {
		bounce(&r);
		cut_until(&r, place(&r) + 0.003);
	}
	assert_true(place(&r) < 3);
	assert_int_equal(r.c.totals.hunts, 0);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	/* On the spot they are. */
	r.c.gap.progress_mm = 0.1;
	for (int i = 0; i < HUNTING_ROW; i++)
		bounce(&r);
	assert_int_equal(r.c.totals.hunts, 1);
	assert_int_equal(r.c.fault.first, FAULT_RETRACT_COUNT);
	rig_free(&r);
}

/* Stress closes a kerf: where the wire touches, it has to be cut again. */
static void a_kerf_that_has_closed_is_cut_again_from_there(void **st)
{
	struct rig r;
	double met;

	(void)st;
	begin_again(&r);
	for (int n = 0; n < 20000 && place(&r) < 2.4; n++)
		step(&r, OPEN_V);
	assert_int_equal(r.c.state, STATE_TRAVEL);
	met = place(&r);
	until(&r, STATE_RETRACT, SHORTED_V, 10);
	until(&r, STATE_APPROACH, OPEN_V, 1000);
	/* It brakes first, and comes back to where it met it. */
	assert_true(r.c.retract.from_mm < met + 0.081 &&
		    place(&r) <= r.c.retract.from_mm);
	until(&r, STATE_ERODE, r.c.gap.servo_v, 1000);
	assert_true(r.out.power && place(&r) < 2.69);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	rig_free(&r);
}

static void a_wire_lost_on_the_way_forward_is_met_at_once(void **st)
{
	struct rig r;

	(void)st;
	begin_again(&r);
	for (int n = 0; n < 20000 && place(&r) < 2.4; n++)
		step(&r, OPEN_V);
	r.in.wire_broken = true;
	until(&r, STATE_FAULT, OPEN_V, 1000);
	assert_int_equal(r.c.fault.first, FAULT_WIRE_BROKEN);
	assert_true(place(&r) < 2.69);
	rig_free(&r);
}

static void a_sinker_has_no_wire_to_break(void **st)
{
	const struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	cut_at(&r, &k, 2);
	r.in.wire_broken = true;
	steps(&r, SPARKING_V, 100);
	assert_int_equal(r.c.state, STATE_ERODE);
	rig_free(&r);
}

static void an_e_stop_ends_a_retreat_at_once(void **st)
{
	const struct cycle_config k = wired();
	struct rig r;

	(void)st;
	cut_two_motions(&r, &k, 3);
	r.in.wire_broken = true;
	steps(&r, SPARKING_V, 20);
	assert_true(r.c.feed_mm_s < 0);
	r.in.estop = true;
	step(&r, SPARKING_V);
	assert_int_equal(r.c.state, STATE_FAULT);
	assert_int_equal(r.c.fault.first, FAULT_WIRE_BROKEN);
	assert_memory_equal(r.out.target, r.before.target,
			    sizeof(r.out.target));
	rig_free(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(each_bound_of_the_way_has_its_place_and_its_alarm),
		cmocka_unit_test(a_short_that_dissolves_at_the_limit_is_no_fault),
		cmocka_unit_test(a_retract_that_lasts_too_long_is_a_fault),
		cmocka_unit_test(retracts_in_a_row_without_erosion_are_a_fault),
		cmocka_unit_test(erosion_between_retracts_counts_them_anew),
		cmocka_unit_test(a_wire_retracts_by_micrometres_and_never_jumps),
		cmocka_unit_test(a_broken_wire_is_held_back_from_the_break_and_cut_on_there),
		cmocka_unit_test(the_way_forward_from_a_break_is_positioned_and_then_cut),
		cmocka_unit_test(a_kerf_that_has_closed_is_cut_again_from_there),
		cmocka_unit_test(
			retracts_in_a_kerf_that_is_cut_again_are_no_hunting),
		cmocka_unit_test(a_wire_lost_on_the_way_forward_is_met_at_once),
		cmocka_unit_test(a_sinker_has_no_wire_to_break),
		cmocka_unit_test(an_e_stop_ends_a_retreat_at_once),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
