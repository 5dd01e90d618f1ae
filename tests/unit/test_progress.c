/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_progress.c - promises of path/progress.h: a motion that stands and
 * should move is reported, and a wait that has a name is not
 */
#include "plc_help.h"

#define SECONDS(s)	((int)((s) / PERIOD_S))

static void begin_job(struct rig *r, struct cycle_config *k)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);

	rapid_to(b, -2);
	action(b, INTERP_DWELL, 5000);
	cut_to(b, -5);
	rig_load(r, b, k);
	r->in.plc = well();
	step(r, OPEN_V);
	assert_int_equal(tell(r, CYCLE_START), ANSWER_DONE);
}

/* The walk of a segment that was damaged behind its check: no tick comes. */
static void freeze(struct rig *r)
{
	r->c.config.points_max = 0;
}

static void what_should_move_and_stands_is_stuck(void **st)
{
	(void)st;
	for (int i = 0; i < 3; i++) {
		struct cycle_config k = usual_config();
		struct rig r;
		double at;
		int n;

		k.jump.height_mm = 1;
		begin_job(&r, &k);
		if (i == 0)
			steps(&r, OPEN_V, 20);
		if (i == 1)
			until(&r, STATE_JUMP, SPARKING_V, 20000);
		if (i == 2) {
			steps(&r, OPEN_V, 400);
			tell(&r, CYCLE_HOLD);
			steps(&r, OPEN_V, 100);
			tell_mm(&r, CYCLE_RETRACT, 1);
			steps(&r, OPEN_V, 5);
		}
		freeze(&r);
		at = place(&r);
		n = until(&r, STATE_FAULT, OPEN_V, SECONDS(2));
		assert_in_range(n, SECONDS(0.9), SECONDS(1.1));
		assert_int_equal(r.c.fault.first, FAULT_STUCK);
		assert_near(place(&r), at, 0.01);
		rig_free(&r);
	}
}

/* 0.6 mm/min: a lattice point each 0.1 s; and a hundredth of that. */
static void a_slow_motion_is_not_stuck(void **st)
{
	static const double overrides[] = { 1, 0.1, 0.01 };

	(void)st;
	for (int i = 0; i < 3; i++) {
		struct cycle_config k = usual_config();
		struct interp_build *b = begin(INTERP_SIMULTANEOUS);
		const struct interp_build_word w = {
			.line = 1, .feed_mm_s = 0.01,
		};
		double end[INTERP_NAXES] = { 0 };
		struct interp_diag d;
		struct rig r;

		k.dry_run = true;
		end[INTERP_Z] = -5;
		assert_int_equal(interp_build_line(b, end, &w, &d), 0);
		rig_load(&r, b, &k);
		tell(&r, CYCLE_START);
		tell_mm(&r, CYCLE_OVERRIDE, overrides[i]);
		steps(&r, OPEN_V, SECONDS(30));
		assert_int_equal(r.c.fault.first, FAULT_NONE);
		freeze(&r);
		until(&r, STATE_FAULT, OPEN_V, SECONDS(100));
		assert_int_equal(r.c.fault.first, FAULT_STUCK);
		rig_free(&r);
	}
}

/* A line of less than half a pulse has no point, but it has an end: it takes
 * two seconds here. */
static void a_line_without_a_point_is_not_stuck(void **st)
{
	struct cycle_config k = usual_config();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	const struct interp_build_word w = { .line = 1, .feed_mm_s = 2e-4 };
	double end[INTERP_NAXES] = { 0 };
	struct interp_diag d;
	struct rig r;

	(void)st;
	k.dry_run = true;
	end[INTERP_Z] = -4e-4;
	assert_int_equal(interp_build_line(b, end, &w, &d), 0);
	end[INTERP_Z] = -3e-3;
	assert_int_equal(interp_build_line(b, end, &w, &d), 0);
	rig_load(&r, b, &k);
	tell(&r, CYCLE_START);
	steps(&r, OPEN_V, SECONDS(2.5));
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	assert_int_equal(r.c.cursor.index, 2);
	rig_free(&r);
}

/* Over a line that its axes pass slowly a hold takes seconds, and less than a
 * pulse. */
static void a_slow_brake_is_not_stuck(void **st)
{
	struct cycle_config k = usual_config();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	const struct interp_build_word w = { .line = 1, .feed_mm_s = 2e-4 };
	double end[INTERP_NAXES] = { 0 };
	struct interp_diag d;
	struct rig r;

	(void)st;
	k.dry_run = true;
	k.travel_a_mm_s2 = 1e-4;
	k.travel_j_mm_s3 = 1e-2;
	end[INTERP_Z] = -5;
	assert_int_equal(interp_build_line(b, end, &w, &d), 0);
	rig_load(&r, b, &k);
	tell(&r, CYCLE_START);
	steps(&r, OPEN_V, SECONDS(20));
	tell(&r, CYCLE_HOLD);
	steps(&r, OPEN_V, SECONDS(1.5));
	assert_true(r.c.mover.v_mm_s > 0);
	steps(&r, OPEN_V, SECONDS(5));
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	assert_int_equal(r.c.state, STATE_HOLD);
	assert_true(r.c.mover.v_mm_s == 0);
	rig_free(&r);
}

/* The first half pulse takes 1.4 s at this jerk. */
static void a_soft_start_is_not_stuck(void **st)
{
	struct cycle_config k = usual_config();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct rig r;

	(void)st;
	k.dry_run = true;
	k.travel_j_mm_s3 = 1e-3;
	rapid_to(b, -2);
	rig_load(&r, b, &k);
	tell(&r, CYCLE_START);
	steps(&r, OPEN_V, SECONDS(4));
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	assert_true(r.c.cursor.tick > 0);
	freeze(&r);
	until(&r, STATE_FAULT, OPEN_V, SECONDS(4));
	assert_int_equal(r.c.fault.first, FAULT_STUCK);
	rig_free(&r);
}

/* What was waited for a point of a slow feed does not count against the way
 * back. */
static void a_fast_move_after_a_slow_one_is_not_stuck(void **st)
{
	struct cycle_config k = usual_config();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	const struct interp_build_word w = { .line = 1, .feed_mm_s = 2e-4 };
	double end[INTERP_NAXES] = { 0 };
	struct interp_diag d;
	struct rig r;

	(void)st;
	k.dry_run = true;
	k.travel_a_mm_s2 = 0.1;
	end[INTERP_Z] = -5;
	assert_int_equal(interp_build_line(b, end, &w, &d), 0);
	rig_load(&r, b, &k);
	tell(&r, CYCLE_START);
	steps(&r, OPEN_V, SECONDS(19));
	tell(&r, CYCLE_HOLD);
	tell_mm(&r, CYCLE_RETRACT, 1);
	steps(&r, OPEN_V, SECONDS(2));
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	rig_free(&r);
}

static void hold_it(struct rig *r)
{
	tell(r, CYCLE_HOLD);
}

static void override_zero(struct rig *r)
{
	r->in.plc.override = 0;
}

static void busy(struct rig *r)
{
	r->in.busy = true;
}

static void dwell(struct rig *r)
{
	while (!r->c.job.dwelling)
		step(r, OPEN_V);
}

static void gap_in_the_window(struct rig *r)
{
	until(r, STATE_ERODE, SPARKING_V, 20000);
	/* Neither wide nor narrow: the servo stands. */
	r->c.gap.window_low_v = 20;
	r->c.gap.window_high_v = SPARKING_V + 1;
}

static void a_wait_that_has_a_name_may_last(void **st)
{
	static void (*const waits[])(struct rig *) = {
		hold_it, override_zero, busy, dwell, gap_in_the_window,
	};

	(void)st;
	for (size_t i = 0; i < sizeof(waits) / sizeof(waits[0]); i++) {
		struct cycle_config k = usual_config();
		struct rig r;

		begin_job(&r, &k);
		steps(&r, OPEN_V, 20);
		waits[i](&r);
		steps(&r, SPARKING_V, SECONDS(4));
		assert_int_equal(r.c.fault.first, FAULT_NONE);
		rig_free(&r);
	}
}

/* The servo backs off the cut and comes on again, some periods each: at each
 * look the machine may be found at one place, in travel. */
static void a_narrow_gap_at_the_begin_of_a_cut_is_not_stuck(void **st)
{
	(void)st;
	for (int i = 0; i < 40; i++) {
		struct interp_build *b = begin(INTERP_SIMULTANEOUS);
		struct cycle_config k = usual_config();
		struct rig r;

		k.gap.gain_mm_s_v = 0.005 + 0.0005 * i;
		rapid_to(b, -2);
		cut_to(b, -5);
		rig_load(&r, b, &k);
		r.in.plc = well();
		step(&r, OPEN_V);
		tell(&r, CYCLE_START);
		until(&r, STATE_APPROACH, OPEN_V, SECONDS(2));
		steps(&r, 20, SECONDS(3));
		assert_int_equal(r.c.fault.first, FAULT_NONE);
		rig_free(&r);
	}
}

#define FAR_TURN	3

/* Its third line has a pulse of X, on which C turns far. */
static struct made far_turn(void)
{
	static const double axis[4][3] = { { 2.159, 78.53, 40245 },
		{ 71.61, 86.29, 33080 }, { 24.34, 38.4, 9.8527e5 },
		{ 0.2862, 1.957, 13214 } };
	static const double by[][4] = { { 0.001, 0, 0, 0 },
		{ -0.002, 0.001, 0, -0.002 }, { 0.001, 0, 0, 4.407 },
		{ 0.001, -0.001, -0.001, 0 }, { 0.001, 0, 0, 0 },
		{ 0, 0, -0.001, 0.001 }, { 0.002, 0, 0, 0.002 } };
	const struct interp_build_options o = {
		.machine = &help_machine, .strategy = INTERP_CENTRED,
		.corner_mm = 0.02,
	};
	double end[INTERP_NAXES] = { 0 };
	struct interp_build *b;

	help_machine.present = 0xff;
	for (int k = 0; k < 4; k++)
		help_machine.axis[k < 3 ? k : INTERP_C] =
			(struct interp_axis_limits) {
				0.001, -200, 200, axis[k][0], axis[k][1],
				axis[k][2]
			};
	b = interp_build_create(&o);
	for (size_t i = 0; i < sizeof(by) / sizeof(by[0]); i++) {
		for (int k = 0; k < 4; k++)
			end[k < 3 ? k : INTERP_C] += by[i][k];
		line(b, end);
	}
	return finish(b);
}

/* From a speed of a thousandth of what the segment allows, to a lower one. */
static void slowing_down_for_a_slow_place_is_not_stuck(void **st)
{
	struct cycle_config k = usual_config();
	struct interp_cursor at;
	struct rig r;

	(void)st;
	k.period_ns = 50000;
	k.dry_run = true;
	r.m = far_turn();
	rig_take(&r, r.m, &k);
	at = r.c.cursor;
	tell(&r, CYCLE_STOP);
	step(&r, OPEN_V);
	assert_int_equal(interp_cursor_seek_end(&at, at.p.head->nsegs - 2), 0);
	assert_int_equal(cycle_load_at(&r.c, &at, at.p.head->length_mm),
			 ANSWER_DONE);
	memcpy(r.path_before, r.c.out.target, sizeof(r.path_before));
	assert_int_equal(tell_mm(&r, CYCLE_RETRACT, 1e9), ANSWER_DONE);
	for (int n = 0; n < 400000 && r.c.cursor.index > FAR_TURN; n++)
		step(&r, OPEN_V);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	assert_int_equal(r.c.cursor.index, FAR_TURN);
	rig_free(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_should_move_and_stands_is_stuck),
		cmocka_unit_test(a_slow_motion_is_not_stuck),
		cmocka_unit_test(a_line_without_a_point_is_not_stuck),
		cmocka_unit_test(a_slow_brake_is_not_stuck),
		cmocka_unit_test(a_soft_start_is_not_stuck),
		cmocka_unit_test(a_fast_move_after_a_slow_one_is_not_stuck),
		cmocka_unit_test(slowing_down_for_a_slow_place_is_not_stuck),
		cmocka_unit_test(a_narrow_gap_at_the_begin_of_a_cut_is_not_stuck),
		cmocka_unit_test(a_wait_that_has_a_name_may_last),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
