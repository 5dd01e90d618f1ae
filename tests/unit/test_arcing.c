/* SPDX-License-Identifier: Apache-2.0 */
/* test_arcing.c - promises of the steps that are taken against arcs */
#include "cycle_help.h"

static struct cycle_config arcing(void)
{
	struct cycle_config k = usual_config();

	k.gap.arcing_share = 0.3;
	k.gap.arcing_cycles = 20;
	k.gap.off_us = 10;
	k.gap.arcing_off_max = 5;
	k.gap.arcing_recover.cycles = 100;
	k.gap.arcing_retract_mm = 0.2;
	k.jump.height_mm = 0.5;
	k.jump.every.cycles = 1000000;
	return k;
}

static void cut_arcing(struct rig *r, const struct cycle_config *k)
{
	cut_at(r, k, 2);
	shares(r, 0.2, 0.4, 0.4, 0);
}

/* Cycles until the rung is reached. */
static int climb_to(struct rig *r, uint32_t rung)
{
	int n = 0;

	while (r->c.arcing.rung != rung && n++ < 10000)
		step(r, SPARKING_V);
	assert_int_equal(r->c.arcing.rung, rung);
	return n;
}

static void arcs_first_stretch_the_off_time_step_by_step(void **st)
{
	const struct cycle_config k = arcing();
	struct rig r;

	(void)st;
	cut_arcing(&r, &k);
	assert_true(isnan(r.out.pulse[INTERP_TECH_OFF_US]));
	for (uint32_t i = 1; i <= 4; i++) {
		assert_in_range(climb_to(&r, i), i == 1 ? 1 : 20,
				i == 1 ? 40 : 20);
		assert_near(r.out.pulse[INTERP_TECH_OFF_US], 10.0 + 10 * i,
			    1e-9);
		assert_int_equal(r.c.totals.arcs, i);
		assert_int_equal(r.c.state, STATE_ERODE);
	}
	rig_free(&r);
}

static void a_condition_s_off_time_is_the_one_that_is_stretched(void **st)
{
	const struct cycle_config k = arcing();
	struct rig r;

	(void)st;
	cut_arcing(&r, &k);
	r.c.out.pulse[INTERP_TECH_OFF_US] = 50;
	climb_to(&r, 2);
	assert_near(r.out.pulse[INTERP_TECH_OFF_US], 150, 1e-9);
	steps(&r, SPARKING_V, 10);
	assert_near(r.out.pulse[INTERP_TECH_OFF_US], 150, 1e-9);
	rig_free(&r);
}

static void then_a_jump_then_a_retract_then_a_fault(void **st)
{
	const struct cycle_config k = arcing();
	double from;
	struct rig r;

	(void)st;
	cut_arcing(&r, &k);
	until(&r, STATE_JUMP, SPARKING_V, 200);
	assert_int_equal(r.c.arcing.rung, ARCING_JUMP);
	until(&r, STATE_RETRACT, SPARKING_V, 1000);
	from = r.c.retract.from_mm;
	while (r.c.state == STATE_RETRACT)
		step(&r, SPARKING_V);
	/* To the next cycle at 5 mm/s, and one more of braking. */
	assert_in_range(llround(1e6 * (from - place(&r) -
				       k.gap.arcing_retract_mm)), 0, 9000);
	for (int i = 0; i < 1000 && r.c.fault.first == FAULT_NONE; i++)
		step(&r, SPARKING_V);
	assert_int_equal(r.c.fault.first, FAULT_ARCING);
	assert_string_equal(fault_name(r.c.fault.first), "arcing");
	assert_int_equal(r.c.totals.arcs, 6 + 5);
	assert_false(r.out.power);
	until(&r, STATE_FAULT, SPARKING_V, 100);
	tell(&r, CYCLE_RESET);
	shares(&r, 0.2, 0.8, 0, 0);
	tell(&r, CYCLE_START);
	until(&r, STATE_ERODE, SPARKING_V, 1000);
	assert_true(isnan(r.out.pulse[INTERP_TECH_OFF_US]));
	rig_free(&r);
}

/* A jump that ends them may be taken again, and is no way to a fault. */
static void arcs_that_a_jump_ends_are_ended_by_the_next_one_too(void **st)
{
	const struct cycle_config k = arcing();
	struct rig r;

	(void)st;
	cut_arcing(&r, &k);
	for (uint32_t i = 1; i <= 10; i++) {
		shares(&r, 0.2, 0.4, 0.4, 0);
		until(&r, STATE_JUMP, SPARKING_V, 500);
		shares(&r, 0.2, 0.6, 0.2, 0);
		until(&r, STATE_ERODE, SPARKING_V, 2000);
		steps(&r, SPARKING_V, 40);
		assert_int_equal(r.c.arcing.rung, ARCING_OFF_LAST);
		assert_int_equal(r.c.totals.jumps, i);
	}
	assert_int_equal(r.c.totals.retracts, 0);
	rig_free(&r);
}

static void rungs_that_are_not_there_are_passed_over(void **st)
{
	struct cycle_config k = arcing();
	struct rig r;

	(void)st;
	k.gap.off_us = 0;
	k.jump.height_mm = 0;
	cut_arcing(&r, &k);
	assert_in_range(until(&r, STATE_RETRACT, SPARKING_V, 100), 1, 22);
	assert_true(isnan(r.out.pulse[INTERP_TECH_OFF_US]));
	assert_int_equal(r.c.totals.jumps, 0);
	rig_free(&r);
}

static void without_arcs_a_rung_is_given_back_slowly(void **st)
{
	const struct cycle_config k = arcing();
	struct rig r;

	(void)st;
	cut_arcing(&r, &k);
	climb_to(&r, 3);
	shares(&r, 0.2, 0.7, 0.1, 0);
	steps(&r, SPARKING_V, 95);
	assert_int_equal(r.c.arcing.rung, 3);
	for (uint32_t i = 2; i > 0; i--)
		assert_in_range(climb_to(&r, i), 1, 100);
	climb_to(&r, ARCING_NONE);
	assert_true(isnan(r.out.pulse[INTERP_TECH_OFF_US]));
	/* Between the two shares it stays where it is. */
	shares(&r, 0.2, 0.4, 0.4, 0);
	climb_to(&r, 1);
	shares(&r, 0.2, 0.6, 0.2, 0);
	steps(&r, SPARKING_V, 1000);
	assert_int_equal(r.c.arcing.rung, 1);
	rig_free(&r);
}

static void arcs_are_not_looked_for_without_power(void **st)
{
	const struct cycle_config k = arcing();
	struct rig r;

	(void)st;
	cut_arcing(&r, &k);
	tell(&r, CYCLE_HOLD);
	steps(&r, SPARKING_V, 1000);
	assert_int_equal(r.c.totals.arcs, 0);
	rig_free(&r);
}

/* A mean voltage that scatters by @sigma, for whoever counts no pulses. */
static uint32_t arcs_of(double v, double sigma)
{
	struct cycle_config k = arcing();
	uint64_t s = 1;
	uint32_t arcs;
	struct rig r;

	k.gap.arcing_sigma_v = 1;
	cut_at(&r, &k, 2);
	for (int i = 0; i < 200 && r.c.fault.first == FAULT_NONE; i++)
		step(&r, v + uniform(&s, -1.7, 1.7) * sigma);
	arcs = r.c.totals.arcs;
	rig_free(&r);
	return arcs;
}

static void a_voltage_that_stands_in_the_plateau_is_an_arc(void **st)
{
	(void)st;
	assert_true(arcs_of(30, 0.3) > 2);
	assert_int_equal(arcs_of(30, 3), 0);
	assert_int_equal(arcs_of(60, 0.3), 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(arcs_first_stretch_the_off_time_step_by_step),
		cmocka_unit_test(a_condition_s_off_time_is_the_one_that_is_stretched),
		cmocka_unit_test(then_a_jump_then_a_retract_then_a_fault),
		cmocka_unit_test(arcs_that_a_jump_ends_are_ended_by_the_next_one_too),
		cmocka_unit_test(rungs_that_are_not_there_are_passed_over),
		cmocka_unit_test(without_arcs_a_rung_is_given_back_slowly),
		cmocka_unit_test(arcs_are_not_looked_for_without_power),
		cmocka_unit_test(a_voltage_that_stands_in_the_plateau_is_an_arc),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
