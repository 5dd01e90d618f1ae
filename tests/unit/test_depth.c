/* SPDX-License-Identifier: Apache-2.0 */
/* test_depth.c - promises of the depth of the cut */
#include "cycle_help.h"

static void go(struct interp_build *b, const double at[3], bool rapid)
{
	const struct interp_build_word w = {
		.line = 1, .feed_mm_s = 10, .rapid = rapid,
	};
	double end[INTERP_NAXES] = { at[0], at[1], at[2] };
	struct interp_diag d = { 0 };

	assert_int_equal(interp_build_line(b, end, &w, &d), 0);
}

#define GO(b, rapid, ...) go(b, (const double[3]) { __VA_ARGS__ }, rapid)

static void start(struct rig *r, struct interp_build *b,
		  const struct cycle_config *k)
{
	rig_load(r, b, k);
	assert_int_equal(tell(r, CYCLE_START), ANSWER_DONE);
	until(r, STATE_APPROACH, OPEN_V, 10000);
}

/* In air up to @mm of the path, and then the first spark. */
static void spark_at(struct rig *r, double mm)
{
	for (int i = 0; i < 100000 && place(r) < mm; i++)
		step(r, OPEN_V);
	until(r, STATE_ERODE, SPARKING_V, 100);
	steps(r, SPARKING_V, 2);
}

static double now(const struct rig *r)
{
	return r->c.depth.now_mm;
}

static void it_counts_from_the_first_spark(void **st)
{
	const struct cycle_config k = usual_config();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct rig r;

	(void)st;
	GO(b, true, 0, 0, -1);
	GO(b, false, 0, 0, -5);
	start(&r, b, &k);
	steps(&r, OPEN_V, 50);
	assert_true(now(&r) == 0);
	spark_at(&r, 2);
	assert_near(now(&r), 0, 0.05);
	cut_until(&r, 3);
	assert_near(now(&r), 1, 0.05);
	rig_free(&r);
}

static void it_goes_along_the_direction_of_the_cut(void **st)
{
	const struct cycle_config k = usual_config();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct rig r;

	(void)st;
	GO(b, false, 3, 0, -4);
	start(&r, b, &k);
	spark_at(&r, 1);
	cut_until(&r, 3);
	assert_near(now(&r), 2, 0.05);
	assert_near(r.c.depth.cut.way[0], 0.6, 1e-9);
	assert_near(r.c.depth.cut.way[2], -0.8, 1e-9);
	rig_free(&r);
}

static void a_jump_leaves_it_and_a_retract_does_not(void **st)
{
	struct cycle_config k = usual_config();
	double deep;
	struct rig r;

	(void)st;
	k.jump.height_mm = 0.4;
	cut_at(&r, &k, 2);
	until(&r, STATE_JUMP, SPARKING_V, 1000);
	deep = now(&r);
	until(&r, STATE_ERODE, SPARKING_V, 1000);
	assert_near(now(&r), deep, 0.005);
	until(&r, STATE_RETRACT, SHORTED_V, 10);
	steps(&r, SHORTED_V, 20);
	assert_true(now(&r) < deep - 0.02);
	assert_true(r.c.depth.cut.far_mm >= deep);
	rig_free(&r);
}

static void another_line_is_another_cut(void **st)
{
	const struct cycle_config k = usual_config();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct rig r;

	(void)st;
	GO(b, false, 0, 0, -1);
	GO(b, true, 0, 0, 0);
	GO(b, true, 0, 0, -1);
	GO(b, false, 0, 0, -2);
	GO(b, true, 0, 0, 0);
	GO(b, true, 1, 0, -0.5);
	GO(b, false, 1, 0, -3);
	start(&r, b, &k);
	spark_at(&r, 0.25);
	cut_until(&r, 1);
	until(&r, STATE_APPROACH, OPEN_V, 10000);
	spark_at(&r, 3.25);
	assert_near(now(&r), 1, 0.05);
	cut_until(&r, 4);
	assert_near(r.c.depth.cut.far_mm, 1.75, 0.05);
	until(&r, STATE_APPROACH, OPEN_V, 10000);
	spark_at(&r, place(&r) + 0.25);
	assert_near(now(&r), 0, 0.05);
	assert_near(r.c.depth.cut.far_mm, 0, 0.05);
	rig_free(&r);
}

static void a_wire_has_none(void **st)
{
	struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	k.gap.process = PROCESS_WIRE;
	cut_at(&r, &k, 2);
	assert_true(now(&r) == 0 && r.c.depth.cut.counts == 0);
	rig_free(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(it_counts_from_the_first_spark),
		cmocka_unit_test(it_goes_along_the_direction_of_the_cut),
		cmocka_unit_test(a_jump_leaves_it_and_a_retract_does_not),
		cmocka_unit_test(another_line_is_another_cut),
		cmocka_unit_test(a_wire_has_none),
	};

	return cmocka_run_group_tests_name("rt/depth", tests, NULL, NULL);
}
