/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_timed.c - promises of a part of a program that may end by time as well
 * as by depth
 */
#include "cycle_help.h"
#include "path/place.h"

/* From Z0 down to Z-5 and up again in @ms, then down to Z-1 beside it. */
static void load(struct rig *r, const struct cycle_config *k, uint32_t ms)
{
	const double aside[INTERP_NAXES] = { 1 },
		     end[INTERP_NAXES] = { 1, 0, -1 };
	const struct interp_build_word w = { .line = 1, .feed_mm_s = 10 };
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct interp_diag d;

	assert_int_equal(interp_build_timed(b, &w, &d), 0);
	cut_to(b, -5);
	action(b, INTERP_DWELL, 100);
	rapid_to(b, 0);
	assert_int_equal(interp_build_timed_end(b, ms, &w, &d), 0);
	line(b, aside);
	line(b, end);
	rig_load(r, b, k);
	assert_int_equal(tell(r, CYCLE_START), ANSWER_DONE);
}

static struct cycle_config no_jumps(void)
{
	struct cycle_config k = usual_config();

	k.jump.height_mm = 0;
	return k;
}

struct seen {
	int32_t low, last[INTERP_NAXES];
	bool aside;
};

static void on_point(void *arg, const struct cycle *c)
{
	struct seen *s = arg;

	for (int i = 0; i < INTERP_NAXES; i++)
		assert_true(abs(place_pos(c)[i] - s->last[i]) <= 1);
	memcpy(s->last, place_pos(c), sizeof(s->last));
	if (s->last[INTERP_X] == 0 && s->last[INTERP_Z] < s->low)
		s->low = s->last[INTERP_Z];
	/* What was not cut is not gone through. */
	if (s->last[INTERP_X] == 0 && s->aside)
		assert_true(s->last[INTERP_Z] == 0);
	s->aside = s->aside || s->last[INTERP_X] > 0;
}

static int run_all(struct rig *r, struct seen *s)
{
	int n = 0;

	r->c.on_point = on_point;
	r->c.on_point_arg = s;
	for (; n < 100000 && r->c.state != STATE_IDLE; n++)
		step(r, SPARKING_V);
	assert_int_equal(r->c.outcome, OUTCOME_DONE);
	assert_int_equal(r->out.target[INTERP_X], 1000);
	assert_int_equal(r->out.target[INTERP_Z], -1000);
	return n;
}

static void with_time_enough_it_reaches_its_depth(void **st)
{
	const struct cycle_config k = no_jumps();
	struct seen s = { 0 };
	struct rig r;

	(void)st;
	load(&r, &k, 100000);
	run_all(&r, &s);
	assert_int_equal(s.low, -5000);
	rig_free(&r);
}

static void when_the_time_is_up_it_leaves_and_goes_on_behind(void **st)
{
	const struct cycle_config k = no_jumps();
	struct seen s = { 0 };
	struct rig r;

	(void)st;
	load(&r, &k, 2000);
	run_all(&r, &s);
	/* 1 mm/s for two seconds, less the first cycles. */
	assert_true(s.low < -1950 && s.low > -2010);
	assert_int_equal(r.c.totals.jumps, 0);
	rig_free(&r);
}

static void it_leaves_during_a_dwell_too_and_the_next_dwell_is_whole(void **st)
{
	const struct cycle_config k = no_jumps();
	struct seen s = { 0 };
	struct rig r;

	(void)st;
	load(&r, &k, 5050);
	run_all(&r, &s);
	assert_int_equal(s.low, -5000);
	assert_false(r.c.job.dwelling);
	rig_free(&r);
}

static void held_while_it_leaves_it_leaves_again(void **st)
{
	const struct cycle_config k = no_jumps();
	struct seen s = { 0 };
	struct rig r;

	(void)st;
	load(&r, &k, 1000);
	until(&r, STATE_JUMP, SPARKING_V, 5000);
	steps(&r, SPARKING_V, 5);
	assert_int_equal(tell(&r, CYCLE_HOLD), ANSWER_DONE);
	steps(&r, SPARKING_V, 500);
	memcpy(s.last, r.c.cursor.pos, sizeof(s.last));
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	r.c.on_point = on_point;
	r.c.on_point_arg = &s;
	run_all(&r, &s);
	assert_true(s.low > -1010);
	rig_free(&r);
}

static void what_was_skipped_is_no_way_back(void **st)
{
	const struct cycle_config k = no_jumps();
	struct seen s = { 0 };
	double end_mm;
	struct rig r;

	(void)st;
	load(&r, &k, 1000);
	r.c.on_point = on_point;
	r.c.on_point_arg = &s;
	end_mm = r.m.p.segs[5].s_mm;
	for (int i = 0; i < 20000 && place(&r) < end_mm + 0.3; i++)
		step(&r, SPARKING_V);
	steps(&r, SHORTED_V, 80);
	assert_near(place(&r), end_mm, 1e-9);
	assert_int_equal(r.out.target[INTERP_Z], 0);
	steps(&r, OPEN_V, 20);
	assert_int_equal(tell_mm(&r, CYCLE_RETRACT, 1000), ANSWER_DONE);
	steps(&r, OPEN_V, 3000);
	assert_near(place(&r), end_mm, 1e-9);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	run_all(&r, &s);
	rig_free(&r);
}

static void what_ends_elsewhere_has_no_time(void **st)
{
	const struct interp_build_word w = { .line = 1, .feed_mm_s = 10 };
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct interp_diag d = { 0 };

	(void)st;
	assert_int_equal(interp_build_timed(b, &w, &d), 0);
	cut_to(b, -5);
	assert_int_equal(interp_build_timed_end(b, 1000, &w, &d), -22);
	assert_non_null(strstr(d.found, "elsewhere along Z"));
	interp_build_destroy(b);
}

static void a_damaged_end_is_a_fault_not_a_leap(void **st)
{
	const struct cycle_config k = no_jumps();
	struct interp_seg *segs;
	struct rig r;

	(void)st;
	load(&r, &k, 1000);
	segs = (struct interp_seg *)r.m.p.segs;
	segs[1].arg = 7;
	for (int i = 0; i < 5000 && r.c.state != STATE_FAULT; i++)
		step(&r, SPARKING_V);
	assert_int_equal(r.c.fault.first, FAULT_PROGRAM);
	rig_free(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(with_time_enough_it_reaches_its_depth),
		cmocka_unit_test(when_the_time_is_up_it_leaves_and_goes_on_behind),
		cmocka_unit_test(it_leaves_during_a_dwell_too_and_the_next_dwell_is_whole),
		cmocka_unit_test(held_while_it_leaves_it_leaves_again),
		cmocka_unit_test(what_was_skipped_is_no_way_back),
		cmocka_unit_test(what_ends_elsewhere_has_no_time),
		cmocka_unit_test(a_damaged_end_is_a_fault_not_a_leap),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
