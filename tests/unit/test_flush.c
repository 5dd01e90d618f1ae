/* SPDX-License-Identifier: Apache-2.0 */
/* test_flush.c - promises of jumps: when one is due, and how high it goes */
#include "cycle_help.h"

static struct cycle_config jumping(void)
{
	struct cycle_config k = usual_config();

	k.jump.height_mm = 0.4;
	k.jump.every.cycles = 200;
	k.jump.every_min.cycles = 50;
	k.jump.every_max.cycles = 1000;
	k.jump.height_min_mm = 0.2;
	k.jump.height_max_mm = 0.9;
	k.jump.bad_share = 0.02;
	return k;
}

/* Erode by turns at @v and above it until a jump; cycles of erosion. */
static uint64_t to_jump(struct rig *r, double v)
{
	const uint64_t from = r->c.totals.erode_cycles;

	while (r->c.state == STATE_JUMP)
		step(r, SPARKING_V);
	for (int i = 0; i < 20000 && r->c.state != STATE_JUMP; i++)
		step(r, v);
	assert_int_equal(r->c.state, STATE_JUMP);
	return r->c.totals.erode_cycles - from;
}

static double height(const struct rig *r)
{
	return r->c.lift.from_mm - r->c.lift.to_mm;
}

static void a_jump_is_due_by_depth(void **st)
{
	struct cycle_config k = jumping();
	double far;
	struct rig r;

	(void)st;
	k.jump.every.cycles = 1000000;
	k.jump.every_mm = 0.05;
	cut_at(&r, &k, 1.5);
	to_jump(&r, SPARKING_V);
	for (int i = 0; i < 5; i++) {
		far = r.c.far_mm;
		to_jump(&r, i % 2 ? 42 : SPARKING_V);
		assert_near(r.c.far_mm - far, 0.05, 0.004);
	}
	rig_free(&r);
}

static void a_jump_is_due_by_whichever_comes_first(void **st)
{
	struct cycle_config k = jumping();
	struct rig r;

	(void)st;
	k.jump.every_mm = 0.05;
	cut_at(&r, &k, 1.5);
	to_jump(&r, SPARKING_V);
	assert_int_equal(to_jump(&r, k.gap.servo_v), 200);
	assert_true(to_jump(&r, SPARKING_V) < 100);
	rig_free(&r);
}

static void new_values_count_at_once(void **st)
{
	const struct cycle_config k = jumping();
	struct rig r;

	(void)st;
	cut_at(&r, &k, 1.5);
	to_jump(&r, 41);
	r.c.jump.every.cycles = 70;
	r.c.jump.height_mm = 0.1;
	assert_int_equal(to_jump(&r, 41), 70);
	assert_near(height(&r), 0.1, 1e-9);
	r.c.jump.height_mm = 0;
	while (r.c.state == STATE_JUMP)
		step(&r, 41);
	steps(&r, 41, 1000);
	assert_int_not_equal(r.c.state, STATE_JUMP);
	rig_free(&r);
}

/* -- Adaptive ------------------------------------------------------------ */

/* Where a jump does nothing but take time. */
static void a_calm_gap_is_jumped_out_of_as_seldom_as_may_be(void **st)
{
	struct cycle_config k = jumping();
	struct rig r;

	(void)st;
	k.jump.adaptive = true;
	cut_at(&r, &k, 1.5);
	for (int i = 0; i < 100; i++)
		to_jump(&r, 40.2);
	assert_true(r.c.flush.every_cycles > 700);
	assert_near(height(&r), k.jump.height_mm, 1e-9);
	rig_free(&r);
}

/* Debris that chokes the gap: 150 cycles after a jump nothing is eroded. */
static void the_period_goes_where_most_depth_is_gained(void **st)
{
	static const uint64_t starts[] = { 60, 600 };

	(void)st;
	for (int i = 0; i < 2; i++) {
		struct cycle_config k = jumping();
		struct rig r;

		k.jump.adaptive = true;
		k.jump.every.cycles = starts[i];
		cut_at(&r, &k, 1.5);
		for (int n = 0; n < 120;) {
			const bool jumped = r.c.state == STATE_JUMP;

			step(&r, r.c.flush.eroded < 150 ? 42 : 40);
			n += !jumped && r.c.state == STATE_JUMP;
		}
		assert_in_range(r.c.flush.every_cycles, 100, 260);
		rig_free(&r);
	}
}

static void shorts_and_arcs_bring_jumps_sooner_and_higher(void **st)
{
	for (int arcs = 0; arcs < 2; arcs++) {
		struct cycle_config k = jumping();
		struct rig r;

		(void)st;
		k.jump.adaptive = true;
		k.jump.bad_share = 0.01;
		cut_at(&r, &k, 2);
		if (arcs)
			shares(&r, 0.1, 0.6, 0.3, 0);
		for (int i = 0; i < 15; i++) {
			while (r.c.state == STATE_JUMP)
				step(&r, SPARKING_V);
			if (!arcs)
				steps(&r, SHORTED_V, 60);
			to_jump(&r, 41);
		}
		assert_int_equal(r.c.flush.every_cycles,
				 k.jump.every_min.cycles);
		assert_near(height(&r), k.jump.height_max_mm, 1e-9);
		/* When it is calm again, the height is given back. */
		shares(&r, 0.1, 0.9, 0, 0);
		for (int i = 0; i < 100; i++)
			to_jump(&r, 40.2);
		assert_near(height(&r), k.jump.height_mm, 0.025);
		rig_free(&r);
	}
}

static void a_new_condition_begins_with_its_own_values(void **st)
{
	struct cycle_config k = jumping();
	struct rig r;

	(void)st;
	k.jump.adaptive = true;
	cut_at(&r, &k, 1.5);
	for (int i = 0; i < 45; i++)
		to_jump(&r, 40.5);
	assert_true(r.c.flush.every_cycles > 300);
	r.c.jump.every.cycles = 100;
	assert_int_equal(to_jump(&r, 40.5), 100);
	rig_free(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_jump_is_due_by_depth),
		cmocka_unit_test(a_jump_is_due_by_whichever_comes_first),
		cmocka_unit_test(new_values_count_at_once),
		cmocka_unit_test(a_calm_gap_is_jumped_out_of_as_seldom_as_may_be),
		cmocka_unit_test(the_period_goes_where_most_depth_is_gained),
		cmocka_unit_test(shorts_and_arcs_bring_jumps_sooner_and_higher),
		cmocka_unit_test(a_new_condition_begins_with_its_own_values),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
