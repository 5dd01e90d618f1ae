/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_conditions_set.c - the values in force: machine file, condition, `set`
 */
#include "cycle_help.h"
#include "process.h"
#include "restore.h"

#include <errno.h>

/* 0 ... 2 mm without a condition, ... 4 mm C1, ... 6 mm C2, all cut. */
struct conds {
	struct interp_tech c1, c2;
};

static struct conds usual_conds(void)
{
	struct conds t;

	interp_tech_clear(&t.c1);
	interp_tech_clear(&t.c2);
	t.c1.v[INTERP_TECH_SERVO_V] = 30;
	t.c1.v[INTERP_TECH_JUMP_EVERY_S] = 0.25;
	t.c1.v[INTERP_TECH_ON_US] = 100;
	t.c1.v[INTERP_TECH_ISO] = 1;
	t.c1.v[INTERP_TECH_POLARITY] = -1;
	t.c2.v[INTERP_TECH_SERVO_V] = 35;
	t.c2.v[INTERP_TECH_FEED_MAX_MM_S] = 0.5;
	return t;
}

static void cut_in(struct interp_build *b, double z_mm, uint32_t number,
		   const struct interp_tech *tech)
{
	const struct interp_build_word w = {
		.line = 1, .feed_mm_s = 10, .tech = tech,
		.cond_letter = number ? 'C' : 0, .cond_number = number,
	};
	double end[INTERP_NAXES];
	struct interp_diag d;

	memcpy(end, interp_build_here(b), sizeof(end));
	end[INTERP_Z] = z_mm;
	assert_int_equal(interp_build_line(b, end, &w, &d), 0);
}

static void rig_conds(struct rig *r, const struct conds *t)
{
	struct cycle_config k = usual_config();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);

	cut_in(b, -2, 0, NULL);
	cut_in(b, -4, 1, &t->c1);
	cut_in(b, -6, 2, &t->c2);
	rig_load(r, b, &k);
	assert_int_equal(tell(r, CYCLE_START), ANSWER_DONE);
}

static enum cycle_answer set(struct rig *r, enum interp_tech_id id, double v)
{
	const struct cycle_command m = {
		.verb = CYCLE_SET, .arg = id, .arg_mm = v,
	};

	return cycle_command(&r->c, &m);
}

static void check_machine(const struct rig *r)
{
	assert_memory_equal(&r->c.gap, &r->c.config.gap, sizeof(r->c.gap));
	assert_memory_equal(&r->c.jump, &r->c.config.jump, sizeof(r->c.jump));
	assert_true(isnan(r->c.out.pulse[INTERP_TECH_ON_US]));
	assert_true(isnan(r->c.out.pulse[INTERP_TECH_ISO]));
	assert_false(io_is_negative(&r->c.out));
}

static void check_c1(const struct rig *r)
{
	assert_true(r->c.gap.servo_v == 30);
	assert_true(r->c.gap.short_v == r->c.config.gap.short_v);
	assert_true(r->c.gap.feed_max_mm_s == 4);
	assert_int_equal(r->c.jump.every.cycles, 250);
	assert_true(r->c.out.pulse[INTERP_TECH_ON_US] == 100);
	assert_true(isnan(r->c.out.pulse[INTERP_TECH_OFF_US]));
	assert_true(r->c.out.pulse[INTERP_TECH_ISO] > 0);
	assert_true(io_is_negative(&r->out));
}

static void check_c2(const struct rig *r)
{
	assert_true(r->c.gap.servo_v == 35);
	assert_true(r->c.gap.feed_max_mm_s == 0.5);
	assert_int_equal(r->c.jump.every.cycles, 100);
	assert_true(isnan(r->c.out.pulse[INTERP_TECH_ON_US]));
	assert_false(io_is_negative(&r->out));
}

static void the_condition_of_the_place_is_in_force_both_ways(void **state)
{
	const struct conds t = usual_conds();
	struct rig r;

	(void)state;
	rig_conds(&r, &t);
	check_machine(&r);
	cut_until(&r, 1.5);
	check_machine(&r);
	cut_until(&r, 3);
	check_c1(&r);
	assert_int_equal(r.out.cond_number, 1);
	cut_until(&r, 4.2);
	check_c2(&r);
	/* A short drives it back over the node. */
	for (int i = 0; i < 1000 && place(&r) > 3.9; i++)
		step(&r, SHORTED_V);
	assert_int_equal(r.c.state, STATE_RETRACT);
	check_c1(&r);
	cut_until(&r, 4.2);
	check_c2(&r);
	assert_int_equal(tell_mm(&r, CYCLE_RETRACT, 3.5), ANSWER_DONE);
	steps(&r, OPEN_V, 3000);
	assert_near(place(&r), 0.7, 0.01);
	check_machine(&r);
	rig_free(&r);
}

static void a_condition_changes_what_the_servo_does(void **state)
{
	struct conds t = usual_conds();
	struct rig r;
	double was;

	(void)state;
	t.c1.v[INTERP_TECH_SERVO_V] = 60;
	rig_conds(&r, &t);
	cut_until(&r, 1);
	was = place(&r);
	steps(&r, SPARKING_V, 50);
	assert_true(place(&r) > was + 0.01);
	/* 50 V are wide for the machine's 40 V, narrow for C1's 60 V. */
	cut_until(&r, 2);
	steps(&r, SPARKING_V, 50);
	was = place(&r);
	steps(&r, SPARKING_V, 50);
	assert_true(place(&r) <= was);
	rig_free(&r);
}

static void window_integral_and_counts_are_the_conditions(void **state)
{
	struct conds t = usual_conds();
	struct rig r;

	(void)state;
	t.c1.v[INTERP_TECH_WINDOW_LOW_V] = 25;
	t.c1.v[INTERP_TECH_WINDOW_HIGH_V] = 35;
	t.c1.v[INTERP_TECH_INTEGRAL_S] = 2;
	t.c1.v[INTERP_TECH_ABORT_COUNT] = 7;
	t.c1.v[INTERP_TECH_JUMP_DEPTH_MM] = 0.5;
	rig_conds(&r, &t);
	check_machine(&r);
	cut_until(&r, 3);
	assert_true(r.c.gap.window_low_v == 25);
	assert_true(r.c.gap.window_high_v == 35);
	assert_true(r.c.gap.integral_s == 2);
	assert_int_equal(r.c.gap.abort_count, 7);
	assert_true(r.c.jump.every_mm == 0.5);
	assert_int_equal(set(&r, INTERP_TECH_ABORT_COUNT, 9), ANSWER_DONE);
	assert_int_equal(r.c.gap.abort_count, 9);
	assert_true(conditions_value(&r.c, INTERP_TECH_ABORT_COUNT) == 9);
	assert_int_equal(set(&r, INTERP_TECH_WINDOW_LOW_V, 31),
			 ANSWER_BAD_ARGUMENT);
	cut_until(&r, 4.2);
	check_c2(&r);
	assert_int_equal(r.c.gap.abort_count, r.c.config.gap.abort_count);
	rig_free(&r);
}

static void a_set_goes_over_and_is_taken_back(void **state)
{
	const struct conds t = usual_conds();
	struct rig r;

	(void)state;
	rig_conds(&r, &t);
	cut_until(&r, 3);
	assert_int_equal(set(&r, INTERP_TECH_SERVO_V, 33), ANSWER_DONE);
	assert_int_equal(set(&r, INTERP_TECH_JUMP_MM, 0.5), ANSWER_DONE);
	assert_true(r.c.gap.servo_v == 33 && r.c.jump.height_mm == 0.5);
	assert_true(conditions_value(&r.c, INTERP_TECH_SERVO_V) == 33);
	assert_int_equal(set(&r, INTERP_TECH_SERVO_V, 34), ANSWER_DONE);
	assert_int_equal(r.c.conditions.nsets, 2);
	assert_int_equal(set(&r, INTERP_TECH_SERVO_V, NAN), ANSWER_DONE);
	assert_true(r.c.gap.servo_v == 30 && r.c.jump.height_mm == 0.5);
	assert_int_equal(set(&r, INTERP_TECH_JUMP_MM, NAN), ANSWER_DONE);
	check_c1(&r);
	assert_int_equal(set(&r, INTERP_TECH_JUMP_MM, NAN), ANSWER_DONE);
	rig_free(&r);
}

static void a_set_belongs_to_its_condition(void **state)
{
	const struct conds t = usual_conds();
	struct rig r;

	(void)state;
	rig_conds(&r, &t);
	cut_until(&r, 3.8);
	assert_int_equal(set(&r, INTERP_TECH_SERVO_V, 33), ANSWER_DONE);
	cut_until(&r, 4.2);
	check_c2(&r);
	for (int i = 0; i < 1000 && place(&r) > 3.9; i++)
		step(&r, SHORTED_V);
	assert_true(r.c.gap.servo_v == 33);
	/* Another job knows nothing of it. */
	assert_int_equal(tell(&r, CYCLE_STOP), ANSWER_DONE);
	until(&r, STATE_IDLE, OPEN_V, 5000);
	assert_int_equal(cycle_load(&r.c, &r.m.p), ANSWER_DONE);
	check_machine(&r);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	cut_until(&r, 3);
	check_c1(&r);
	rig_free(&r);
}

/* Who sets a value while it lifts means what is cut, and not where the lift has
 * come to; also where the machine is @held there. */
static void check_set_in_a_retract(bool held)
{
	const struct conds t = usual_conds();
	struct rig r;

	rig_conds(&r, &t);
	cut_until(&r, 4.2);
	check_c2(&r);
	for (int i = 0; i < 1000 && place(&r) > 3.9; i++)
		step(&r, SHORTED_V);
	assert_int_equal(r.c.state, STATE_RETRACT);
	check_c1(&r);
	if (held) {
		assert_int_equal(tell(&r, CYCLE_HOLD), ANSWER_DONE);
		until(&r, STATE_HOLD, OPEN_V, 1000);
		for (int i = 0; i < 100; i++)
			step(&r, OPEN_V);
	}
	assert_int_equal(set(&r, INTERP_TECH_SERVO_V, 33), ANSWER_DONE);
	assert_true(conditions_value(&r.c, INTERP_TECH_SERVO_V) == 33);
	check_c1(&r);
	if (held)
		assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	cut_until(&r, 4.2);
	assert_true(r.c.gap.servo_v == 33);
	rig_free(&r);
}

static void a_set_in_a_retract_is_for_the_cut(void **state)
{
	(void)state;
	check_set_in_a_retract(false);
	check_set_in_a_retract(true);
}

/* Another edmd takes over where the one before had lifted. */
static void killed(struct rig *r)
{
	struct cycle_past past = { .far_mm = r->c.far_mm };
	const struct cycle_config k = r->c.config;
	const struct interp_cursor at = r->c.cursor;
	enum cycle_answer answer;

	memcpy(past.pos, r->c.out.target, sizeof(past.pos));
	cycle_init(&r->c, &k);
	memcpy(r->c.out.target, past.pos, sizeof(past.pos));
	assert_int_equal(cycle_restore(&r->c, &at, &past, &answer), RESTORED);
}

static void a_set_behind_a_restart_is_for_the_cut(void **state)
{
	const struct conds t = usual_conds();
	struct rig r;

	(void)state;
	rig_conds(&r, &t);
	cut_until(&r, 4.2);
	for (int i = 0; i < 1000 && place(&r) > 3.9; i++)
		step(&r, SHORTED_V);
	killed(&r);
	step(&r, OPEN_V);
	check_c1(&r);
	assert_int_equal(set(&r, INTERP_TECH_SERVO_V, 33), ANSWER_DONE);
	check_c1(&r);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	cut_until(&r, 4.2);
	assert_true(r.c.gap.servo_v == 33);
	rig_free(&r);
}

/* A change of it is written down with the value that it replaces. */
static void the_polarity_of_a_retract_over_m4_is_that_of_the_cut(void **state)
{
	const struct conds t = usual_conds();
	struct cycle_config k = usual_config();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct rig r;

	(void)state;
	assert_true(isnan(conditions_value(&(struct cycle) { .loaded = false },
					   INTERP_TECH_POLARITY)));
	cut_in(b, -2, 2, &t.c2);
	action(b, INTERP_AUX, INTERP_AUX_POWER_NEGATIVE);
	cut_in(b, -4, 2, &t.c2);
	rig_load(&r, b, &k);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	cut_until(&r, 1.9);
	assert_true(conditions_value(&r.c, INTERP_TECH_POLARITY) == 1);
	cut_until(&r, 2.1);
	for (int i = 0; i < 1000 && place(&r) > 1.9; i++)
		step(&r, SHORTED_V);
	assert_int_equal(r.c.state, STATE_RETRACT);
	assert_false(io_is_negative(&r.out));
	assert_true(conditions_value(&r.c, INTERP_TECH_POLARITY) == -1);
	assert_int_equal(set(&r, INTERP_TECH_POLARITY, 1), ANSWER_DONE);
	assert_true(conditions_value(&r.c, INTERP_TECH_POLARITY) == 1);
	rig_free(&r);
}

static void a_set_that_cannot_be_leaves_all_as_it_was(void **state)
{
	static const struct {
		uint32_t id;
		double v;
	} bad[] = {
		{ INTERP_TECH_SERVO_V, 1001 }, { INTERP_TECH_SERVO_V, -1 },
		{ INTERP_TECH_SERVO_V, INFINITY },
		{ INTERP_TECH_SERVO_V, 70 },	/* open_v is 70 */
		{ INTERP_TECH_SHORT_V, 30 },	/* servo_v is 30 */
		{ INTERP_TECH_POLARITY, 0 }, { INTERP_TECH_ISO, 0.5 },
		{ INTERP_TECH_GAP_MM, 0.1 }, { INTERP_NTECH, 1 },
		{ UINT32_MAX, 1 }, { UINT32_MAX, NAN },
	};
	const struct conds t = usual_conds();
	struct rig r;

	(void)state;
	rig_conds(&r, &t);
	cut_until(&r, 3);
	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
		assert_int_equal(set(&r, bad[i].id, bad[i].v),
				 ANSWER_BAD_ARGUMENT);
		check_c1(&r);
	}
	assert_int_equal(r.c.conditions.nsets, 0);
	/* short 45 < servo 50 needs the servo first, and it stays first. */
	assert_int_equal(set(&r, INTERP_TECH_SERVO_V, 50), ANSWER_DONE);
	assert_int_equal(set(&r, INTERP_TECH_SHORT_V, 45), ANSWER_DONE);
	assert_int_equal(set(&r, INTERP_TECH_SERVO_V, NAN),
			 ANSWER_BAD_ARGUMENT);
	assert_true(r.c.gap.servo_v == 50 && r.c.gap.short_v == 45);
	rig_free(&r);
}

static void the_list_of_sets_is_bounded(void **state)
{
	const struct conds t = usual_conds();
	struct rig r;

	(void)state;
	rig_conds(&r, &t);
	cut_until(&r, 3);
	r.c.conditions.nsets = CONDITIONS_SETS_MAX;
	for (uint32_t i = 0; i < CONDITIONS_SETS_MAX; i++)
		r.c.conditions.set[i] = (struct conditions_set) {
			1, 99, INTERP_TECH_ON_US
		};
	assert_int_equal(set(&r, INTERP_TECH_SERVO_V, 33), ANSWER_WRONG_STATE);
	assert_int_equal(set(&r, INTERP_TECH_SERVO_V, NAN), ANSWER_DONE);
	r.c.conditions.set[5].cond = r.c.conditions.cond;
	assert_int_equal(set(&r, INTERP_TECH_ON_US, NAN), ANSWER_DONE);
	assert_int_equal(set(&r, INTERP_TECH_SERVO_V, 33), ANSWER_DONE);
	rig_free(&r);
}

/* M3 M4 are stronger than a condition, a set is stronger than both. */
static void polarity_is_the_sets_then_the_programs_then_the_conditions(void **s)
{
	const struct conds t = usual_conds();
	struct cycle_config k = usual_config();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct rig r;

	(void)s;
	cut_in(b, -1, 1, &t.c1);
	action(b, INTERP_AUX, INTERP_AUX_POWER_POSITIVE);
	cut_in(b, -2, 1, &t.c1);
	action(b, INTERP_AUX, INTERP_AUX_POWER_NEGATIVE);
	cut_in(b, -4, 2, &t.c2);
	rig_load(&r, b, &k);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	cut_until(&r, 0.5);
	assert_true(io_is_negative(&r.out));
	cut_until(&r, 1.5);
	assert_false(io_is_negative(&r.out));
	assert_int_equal(set(&r, INTERP_TECH_POLARITY, -1), ANSWER_DONE);
	step(&r, SPARKING_V);
	assert_true(io_is_negative(&r.out));
	assert_int_equal(set(&r, INTERP_TECH_POLARITY, NAN), ANSWER_DONE);
	step(&r, SPARKING_V);
	assert_false(io_is_negative(&r.out));
	cut_until(&r, 3);
	assert_true(io_is_negative(&r.out));
	rig_free(&r);
}

/* What was cut negative is not cut positive after a retract over M3. */
static void the_electrode_turns_round_on_the_way_back_too(void **state)
{
	const struct conds t = usual_conds();
	struct cycle_config k = usual_config();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct rig r;

	(void)state;
	cut_in(b, -1, 2, &t.c2);
	action(b, INTERP_AUX, INTERP_AUX_POWER_NEGATIVE);
	action(b, INTERP_AUX, INTERP_AUX_POWER_NEGATIVE);
	cut_in(b, -2, 2, &t.c2);
	action(b, INTERP_AUX, INTERP_AUX_POWER_OFF);
	action(b, INTERP_AUX, INTERP_AUX_POWER_POSITIVE);
	cut_in(b, -4, 2, &t.c2);
	rig_load(&r, b, &k);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	cut_until(&r, 2.5);
	for (int i = 0; i < 5; i++) {
		static const double to_mm[] = { 1.5, 0.5, 1.5, 0.2, 2.5 };
		const double back_mm = place(&r) - to_mm[i];

		if (back_mm > 0) {
			assert_int_equal(tell(&r, CYCLE_HOLD), ANSWER_DONE);
			while (r.c.mover.v_mm_s != 0 || r.c.hold.moving)
				step(&r, SPARKING_V);
			assert_int_equal(tell_mm(&r, CYCLE_RETRACT, back_mm),
					 ANSWER_DONE);
			for (int n = 0; n < 20000; n++) {
				if (place(&r) <= to_mm[i] + 0.01)
					break;
				step(&r, OPEN_V);
			}
			steps(&r, OPEN_V, 500);
			assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
		}
		cut_until(&r, to_mm[i] + 0.1);
		assert_int_equal(io_is_negative(&r.out),
				 to_mm[i] > 1 && to_mm[i] < 2);
	}
	rig_free(&r);
}

static void a_damaged_condition_is_a_fault_and_no_value(void **state)
{
	const struct conds t = usual_conds();
	struct interp_cond *c;
	struct rig r;

	(void)state;
	rig_conds(&r, &t);
	c = (struct interp_cond *)(uintptr_t)r.m.p.conds;
	c[2].tech.v[INTERP_TECH_SERVO_V] = 500;
	cut_until(&r, 3.9);
	for (int i = 0; i < 1000 && r.c.state != STATE_FAULT; i++)
		step(&r, SPARKING_V);
	assert_int_equal(r.c.fault.first, FAULT_PROGRAM);
	assert_true(r.c.gap.servo_v == 30);
	c[2].tech.v[INTERP_TECH_SERVO_V] = -1;
	assert_int_equal(interp_program_map(&r.m.p, r.m.block, r.m.bytes),
			 -EBADMSG);
	rig_free(&r);
}

/* A field that the cycle goes by is a setting, or asked of the generator; the
 * servo's voltage may be both. */
static void each_live_field_has_its_place(void **state)
{
	struct cycle_config k = usual_config();
	struct interp_tech base;

	(void)state;
	process_base(&base, &k.gap, &k.jump);
	for (int i = 0; i < INTERP_NTECH; i++) {
		const enum interp_tech_id id = (enum interp_tech_id)i;
		const double *at = process_setting(id, &k.gap, &k.jump);

		assert_int_equal(at != NULL, interp_tech_is_live(id) &&
				 (i >= INTERP_NGENERATOR ||
				  process_is_setting(i)));
		assert_int_equal(process_is_setting(i),
				 i == INTERP_TECH_SERVO_V);
		assert_true(at ? base.v[i] == *at : isnan(base.v[i]));
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_condition_of_the_place_is_in_force_both_ways),
		cmocka_unit_test(a_condition_changes_what_the_servo_does),
		cmocka_unit_test(window_integral_and_counts_are_the_conditions),
		cmocka_unit_test(a_set_goes_over_and_is_taken_back),
		cmocka_unit_test(a_set_belongs_to_its_condition),
		cmocka_unit_test(a_set_in_a_retract_is_for_the_cut),
		cmocka_unit_test(a_set_behind_a_restart_is_for_the_cut),
		cmocka_unit_test(the_polarity_of_a_retract_over_m4_is_that_of_the_cut),
		cmocka_unit_test(a_set_that_cannot_be_leaves_all_as_it_was),
		cmocka_unit_test(the_list_of_sets_is_bounded),
		cmocka_unit_test(polarity_is_the_sets_then_the_programs_then_the_conditions),
		cmocka_unit_test(the_electrode_turns_round_on_the_way_back_too),
		cmocka_unit_test(a_damaged_condition_is_a_fault_and_no_value),
		cmocka_unit_test(each_live_field_has_its_place),
	};

	return cmocka_run_group_tests_name("rt/process", tests, NULL, NULL);
}
