/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What rt/interlock.h promises.
 */
#include "plc_help.h"

/* Two millimetres of air, then a cut of three; held, the PLC is there. */
static void load_job(struct rig *r)
{
	struct cycle_config k = usual_config();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);

	rapid_to(b, -2);
	cut_to(b, -5);
	rig_load(r, b, &k);
	r->in.plc = well();
	step(r, OPEN_V);
}

static void begin_job(struct rig *r)
{
	load_job(r);
	assert_int_equal(tell(r, CYCLE_START), ANSWER_DONE);
}

struct loss {
	size_t at;			/* of the bool in struct io_plc */
	enum cycle_fault fault;
	const char *name;
};

static const struct loss losses[] = {
	{ offsetof(struct io_plc, alive), FAULT_PLC_LOST, "plc-lost" },
	{ offsetof(struct io_plc, permit), FAULT_PERMIT, "permit" },
	{ offsetof(struct io_plc, door_closed), FAULT_DOOR, "door" },
	{ offsetof(struct io_plc, level_ok), FAULT_DIELECTRIC, "dielectric" },
	{ offsetof(struct io_plc, temperature_ok), FAULT_TEMPERATURE,
	  "temperature" },
	{ offsetof(struct io_plc, no_fire), FAULT_FIRE, "fire" },
};

#define EACH_LOSS(i) \
	for (size_t i = 0; i < sizeof(losses) / sizeof(losses[0]); i++)

static bool *flag(struct rig *r, const struct loss *l)
{
	return (bool *)((char *)&r->in.plc + l->at);
}

static void a_loss_takes_the_sparks_in_the_same_period(void **st)
{
	(void)st;
	EACH_LOSS(i) {
		struct rig r;

		begin_job(&r);
		cut_until(&r, 3);
		assert_true(r.out.power);
		*flag(&r, &losses[i]) = false;
		step(&r, SPARKING_V);
		assert_false(r.out.power);
		assert_int_equal(r.c.fault.first, losses[i].fault);
		assert_string_equal(fault_name(r.c.fault.first),
				    losses[i].name);
		rig_free(&r);
	}
}

/* On the path: no step larger than the one before it, and then a stand. */
static void the_motion_ends_on_the_path(void **st)
{
	(void)st;
	EACH_LOSS(i) {
		struct cycle_config k = usual_config();
		struct rig r;
		double v, from;

		begin_job(&r);
		steps(&r, OPEN_V, 60);
		v = r.c.mover.v_mm_s;
		from = place(&r);
		assert_true(v > 1);
		*flag(&r, &losses[i]) = false;
		until(&r, STATE_FAULT, OPEN_V, 1000);
		assert_true(place(&r) > from);
		assert_true(place(&r) - from <= braking_mm(&k, v));
		assert_int_equal(r.c.outcome, OUTCOME_FAULT);
		rig_free(&r);
	}
}

static void what_was_lost_goes_on_by_reset_and_start(void **st)
{
	(void)st;
	EACH_LOSS(i) {
		struct rig r;
		double at;

		begin_job(&r);
		cut_until(&r, 3);
		*flag(&r, &losses[i]) = false;
		until(&r, STATE_FAULT, SPARKING_V, 100);
		at = place(&r);

		/* Not by the cause going away, and not before it. */
		assert_int_equal(tell(&r, CYCLE_START), ANSWER_WRONG_STATE);
		if (losses[i].fault != FAULT_FIRE) {
			assert_int_equal(tell(&r, CYCLE_RESET), ANSWER_DONE);
			step(&r, SPARKING_V);
			assert_int_equal(r.c.state, STATE_HOLD);
			assert_int_equal(tell(&r, CYCLE_START),
					 ANSWER_SEEN + losses[i].fault);
			assert_int_equal(tell_mm(&r, CYCLE_RETRACT, 0.1),
					 ANSWER_SEEN + losses[i].fault);
		}
		*flag(&r, &losses[i]) = true;
		steps(&r, SPARKING_V, 10);
		assert_false(r.out.power);
		if (losses[i].fault == FAULT_FIRE)
			assert_int_equal(tell(&r, CYCLE_RESET), ANSWER_DONE);
		assert_true(place(&r) == at);
		assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
		cut_until(&r, 4);
		rig_free(&r);
	}
}

/* The door is opened between two jobs: no alarm. */
static void a_stand_needs_nothing_but_no_fire(void **st)
{
	(void)st;
	EACH_LOSS(i) {
		struct rig r;

		load_job(&r);
		*flag(&r, &losses[i]) = false;
		steps(&r, OPEN_V, 5);
		assert_int_equal(r.c.fault.first,
				 losses[i].fault == FAULT_FIRE ? FAULT_FIRE :
								 FAULT_NONE);
		rig_free(&r);
	}
}

static void a_fire_is_a_fault_without_a_job_too(void **st)
{
	struct rig r;

	(void)st;
	load_job(&r);
	tell(&r, CYCLE_STOP);
	until(&r, STATE_IDLE, OPEN_V, 10);
	r.in.plc.no_fire = false;
	step(&r, OPEN_V);
	assert_int_equal(r.c.state, STATE_FAULT);
	assert_int_equal(r.c.fault.first, FAULT_FIRE);
	r.in.plc.no_fire = true;
	step(&r, OPEN_V);
	assert_int_equal(tell(&r, CYCLE_RESET), ANSWER_DONE);
	assert_int_equal(r.c.state, STATE_IDLE);
	rig_free(&r);
}

static void a_way_back_by_command_is_watched_too(void **st)
{
	(void)st;
	EACH_LOSS(i) {
		struct rig r;

		begin_job(&r);
		cut_until(&r, 3);
		assert_int_equal(tell_mm(&r, CYCLE_RETRACT, 2), ANSWER_DONE);
		steps(&r, OPEN_V, 20);
		assert_true(r.c.hold.moving);
		*flag(&r, &losses[i]) = false;
		step(&r, OPEN_V);
		assert_int_equal(r.c.fault.first, losses[i].fault);
		until(&r, STATE_FAULT, OPEN_V, 1000);
		rig_free(&r);
	}
}

static void the_worst_is_named_first(void **st)
{
	struct rig r;

	(void)st;
	begin_job(&r);
	r.in.plc.permit = r.in.plc.level_ok = r.in.plc.no_fire = false;
	step(&r, OPEN_V);
	assert_int_equal(r.c.fault.first, FAULT_FIRE);
	rig_free(&r);
}

static void an_edge_of_start_begins_the_job(void **st)
{
	struct rig r;

	(void)st;
	load_job(&r);
	press(&r, &r.in.plc.start, OPEN_V);
	assert_int_equal(r.c.state, STATE_TRAVEL);
	rig_free(&r);
}

static void hold_is_held_as_long_as_it_is_said(void **st)
{
	struct rig r;

	(void)st;
	begin_job(&r);
	cut_until(&r, 3);
	r.in.plc.hold = true;
	step(&r, SPARKING_V);
	assert_int_equal(r.c.state, STATE_HOLD);
	assert_false(r.out.power);
	press(&r, &r.in.plc.start, SPARKING_V);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_PLC_HOLDS);
	steps(&r, SPARKING_V, 10);
	assert_int_equal(r.c.state, STATE_HOLD);
	r.in.plc.hold = false;
	steps(&r, SPARKING_V, 10);
	assert_int_equal(r.c.state, STATE_HOLD);
	press(&r, &r.in.plc.start, SPARKING_V);
	cut_until(&r, 4);
	rig_free(&r);
}

static void an_edge_of_reset_leaves_a_fault(void **st)
{
	struct rig r;

	(void)st;
	begin_job(&r);
	r.in.plc.permit = false;
	until(&r, STATE_FAULT, OPEN_V, 1000);
	r.in.plc.permit = true;
	press(&r, &r.in.plc.reset, OPEN_V);
	assert_int_equal(r.c.state, STATE_HOLD);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	rig_free(&r);
}

static double speed_with(struct rig *r, double override)
{
	r->in.plc.override = override;
	steps(r, OPEN_V, 20);
	return r->c.feed_mm_s;
}

static void its_override_scales_positioning(void **st)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	k.dry_run = true;
	cut_to(b, -50);			/* at 10 mm/s */
	rig_load(&r, b, &k);
	r.in.plc = well();
	step(&r, OPEN_V);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	steps(&r, OPEN_V, 200);
	speed_with(&r, 1);
	assert_near(speed_with(&r, 1), 10, 0.5);
	speed_with(&r, 0.5);
	steps(&r, OPEN_V, 100);
	assert_near(speed_with(&r, 0.5), 5, 0.5);
	speed_with(&r, 0);
	steps(&r, OPEN_V, 100);
	assert_true(speed_with(&r, 0) == 0);
	speed_with(&r, 1);
	steps(&r, OPEN_V, 100);
	assert_near(speed_with(&r, 1), 10, 0.5);
	rig_free(&r);
}

/* Of two that change it, the last one has it. */
static void an_override_of_a_client_stays_until_the_plc_changes_its_own(
	void **st)
{
	struct rig r;

	(void)st;
	load_job(&r);
	assert_int_equal(tell_mm(&r, CYCLE_OVERRIDE, 0.25), ANSWER_DONE);
	steps(&r, OPEN_V, 5);
	assert_true(r.c.override == 0.25);
	r.in.plc.override = 0.75;
	step(&r, OPEN_V);
	assert_true(r.c.override == 0.75);
	rig_free(&r);
}

/* What Z is sent more than its place, in pulses. */
static int32_t grown(const struct rig *r)
{
	return r->out.target[INTERP_Z] - r->c.out.target[INTERP_Z];
}

static void its_temperature_is_that_of_the_axes(void **st)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	for (int i = 0; i < INTERP_NAXES; i++) {
		k.comp.axis[i].pulse_mm = PULSE_MM;
		k.comp.axis[i].take_up = 1;
	}
	k.comp.mapped = true;
	k.comp.maps_c = 20;
	k.comp.maps.growth[INTERP_Z] = (struct interp_errormap_growth) {
		10e-6, -100, 0
	};
	cut_to(b, -50);
	rig_load(&r, b, &k);
	r.in.plc = well();
	steps(&r, OPEN_V, 50);
	assert_int_equal(grown(&r), 0);
	r.in.plc.axes_c = 30;
	step(&r, OPEN_V);
	assert_int_equal(grown(&r), -1);
	steps(&r, OPEN_V, 50);
	assert_int_equal(grown(&r), -10);
	r.in.plc.axes_c = 0;		/* not told any more */
	steps(&r, OPEN_V, 50);
	assert_int_equal(grown(&r), -10);
	r.in.plc.axes_c = 15;
	steps(&r, OPEN_V, 50);
	assert_int_equal(grown(&r), 5);
	rig_free(&r);
}

static void what_a_dead_plc_says_last_is_void(void **st)
{
	struct rig r;

	(void)st;
	load_job(&r);
	r.in.plc = (struct io_plc) { .present = true, .start = true,
				     .hold = true, .reset = true };
	steps(&r, OPEN_V, 3);
	assert_int_equal(r.c.state, STATE_HOLD);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	assert_true(r.c.override == 1);
	rig_free(&r);
}

static void a_machine_without_a_plc_needs_none(void **st)
{
	struct rig r;

	(void)st;
	load_job(&r);
	r.in.plc = (struct io_plc) { .present = false };
	step(&r, OPEN_V);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	cut_until(&r, 4);
	rig_free(&r);
}

static void a_broken_wire_is_the_wire_machines_fault(void **st)
{
	(void)st;
	for (int wire = 0; wire < 2; wire++) {
		struct rig r;

		begin_job(&r);
		r.c.gap.process = wire ? PROCESS_WIRE : PROCESS_SINK;
		r.c.config.gap.process = r.c.gap.process;
		cut_until(&r, 3);
		r.in.plc.wire_whole = false;
		step(&r, SPARKING_V);
		assert_int_equal(r.c.fault.first, wire ? FAULT_WIRE_BROKEN :
						   FAULT_NONE);
		assert_int_equal(r.out.power, !wire);
		rig_free(&r);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_loss_takes_the_sparks_in_the_same_period),
		cmocka_unit_test(the_motion_ends_on_the_path),
		cmocka_unit_test(what_was_lost_goes_on_by_reset_and_start),
		cmocka_unit_test(a_stand_needs_nothing_but_no_fire),
		cmocka_unit_test(a_fire_is_a_fault_without_a_job_too),
		cmocka_unit_test(a_way_back_by_command_is_watched_too),
		cmocka_unit_test(the_worst_is_named_first),
		cmocka_unit_test(an_edge_of_start_begins_the_job),
		cmocka_unit_test(hold_is_held_as_long_as_it_is_said),
		cmocka_unit_test(an_edge_of_reset_leaves_a_fault),
		cmocka_unit_test(its_override_scales_positioning),
		cmocka_unit_test(its_temperature_is_that_of_the_axes),
		cmocka_unit_test(an_override_of_a_client_stays_until_the_plc_changes_its_own),
		cmocka_unit_test(what_a_dead_plc_says_last_is_void),
		cmocka_unit_test(a_machine_without_a_plc_needs_none),
		cmocka_unit_test(a_broken_wire_is_the_wire_machines_fault),
	};

	return cmocka_run_group_tests_name("rt/interlock", tests, NULL, NULL);
}
