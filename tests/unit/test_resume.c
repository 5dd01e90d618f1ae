/* SPDX-License-Identifier: Apache-2.0 */
/* test_resume.c - edmd is killed, and another edmd comes after it */
#include "resume_help.h"

#include "key.h"

#include <stdlib.h>

static void begin_cavity(struct world *w)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);

	cut_to(b, -3);
	load(w, b);
	go_on(w);
}

/* -- The axes ------------------------------------------------------------- */

static void wear_z(struct world *w)
{
	struct comp_config *k = &w->k.comp;
	struct interp_errormap_row *z = &k->maps.row[0];

	for (int i = 0; i < INTERP_NAXES; i++) {
		k->axis[i].pulse_mm = PULSE_MM;
		k->axis[i].take_up = 0.5;
	}
	k->axis[INTERP_Z].backlash = 12;
	*z = (struct interp_errormap_row) {
		.along = INTERP_Z, .across = INTERP_Z, .n = 2,
		.at_mm = { -4, 0 }, .error_mm = { -0.025, 0.005 },
	};
	k->maps.nrows = 1;
	k->mapped = true;
}

static void stands_there(struct world *w, const struct io_outputs *was)
{
	for (int i = 0; i < 300; i++) {
		period(w, OPEN_V);
		for (int a = 0; a < INTERP_NAXES; a++)
			assert_int_equal(w->out.target[a], was->target[a]);
		assert_false(w->out.power);
	}
}

/* Neither backlash nor pitch error is taken up again. */
static void no_drive_moves_after_a_crash_wherever_it_was(void **st)
{
	(void)st;
	for (int at = 10; at < 2500; at += 130) {
		struct world w;
		struct io_outputs was;

		world_init(&w);
		wear_z(&w);
		loop_make(&w);
		begin_cavity(&w);
		periods(&w, SPARKING_V, at);
		/* Back and forth, until what it was taking up is. */
		assert_int_equal(ask(&w, CYCLE_RETRACT, 0, 0.1), ANSWER_DONE);
		periods(&w, OPEN_V, 300);
		was = w.out;
		crash(&w);
		assert_true(w.l.cycle.loaded);
		assert_int_equal(w.l.cycle.state, STATE_HOLD);
		stands_there(&w, &was);
		world_free(&w);
	}
}

static int32_t most_off(const struct world *w, const struct io_outputs *was)
{
	int32_t most = 0;

	for (int a = 0; a < INTERP_NAXES; a++)
		most = abs(w->out.target[a] - was->target[a]) > most ?
		       abs(w->out.target[a] - was->target[a]) : most;
	return most;
}

/* Z grows up to 10 um for each K, from what the machine file says on. */
static void warm_z(struct world *w)
{
	struct comp_config *k = &w->k.comp;

	for (int i = 0; i < INTERP_NAXES; i++) {
		k->axis[i].pulse_mm = PULSE_MM;
		k->axis[i].take_up = 0.5;
	}
	k->mapped = true;
	k->maps_c = 20;
	k->maps.growth[INTERP_Z] = (struct interp_errormap_growth) {
		10e-6, -1000, 0
	};
	w->in.plc = well();
}

static void what_a_plc_told_of_the_axes_is_in_force_again(void **st)
{
	struct world w;
	struct io_outputs was;

	(void)st;
	world_init(&w);
	warm_z(&w);
	loop_make(&w);
	begin_cavity(&w);
	w.in.plc.axes_c = 27.5;
	cut(&w, 1);
	assert_int_equal(ask(&w, CYCLE_HOLD, 0, 0), ANSWER_DONE);
	periods(&w, OPEN_V, 300);
	was = w.out;
	/* Its link comes up, and it says nothing of them yet. */
	w.in.plc.axes_c = 0;
	crash(&w);
	assert_true(w.l.cycle.loaded);
	stands_there(&w, &was);
	/* Nor does the way back after a start take up what never was. */
	assert_int_equal(ask(&w, CYCLE_RETRACT, 0, 0.001), ANSWER_DONE);
	periods(&w, OPEN_V, 300);
	assert_in_range(most_off(&w, &was), 1, 2);
	/* And once more. */
	was = w.out;
	crash(&w);
	stands_there(&w, &was);
	assert_near(w.l.cycle.comp.told_c, 27.5, 0);
	world_free(&w);
}

/* Wherever in it: half of a turn, half of a warming. */
static void what_was_being_taken_up_waits_for_a_command(void **st)
{
	(void)st;
	for (int at = 1; at < 60; at += 7) {
		struct world w;
		struct io_outputs was;

		world_init(&w);
		wear_z(&w);
		warm_z(&w);
		loop_make(&w);
		begin_cavity(&w);
		cut(&w, 1);
		assert_int_equal(ask(&w, CYCLE_HOLD, 0, 0), ANSWER_DONE);
		w.in.plc.axes_c = 25;
		periods(&w, OPEN_V, at);
		was = w.out;
		crash(&w);
		stands_there(&w, &was);
		/* Another temperature than before moves nothing, too. */
		w.in.plc.axes_c = 30;
		stands_there(&w, &was);
		assert_int_equal(ask(&w, CYCLE_RETRACT, 0, 0.001),
				 ANSWER_DONE);
		periods(&w, OPEN_V, 500);
		assert_true(most_off(&w, &was) > 40);
		world_free(&w);
	}
}

static int32_t z_added(const struct world *w)
{
	return w->out.target[INTERP_Z] - w->l.cycle.out.target[INTERP_Z];
}

/* None, or others: it stands, and goes with the next motion. */
static void another_machine_file_moves_no_axis_by_itself(void **st)
{
	(void)st;
	for (int left = 0; left < 4; left++) {
		struct world w;
		struct io_outputs was;

		world_init(&w);
		wear_z(&w);
		loop_make(&w);
		begin_cavity(&w);
		cut(&w, 1);
		assert_int_equal(ask(&w, CYCLE_HOLD, 0, 0), ANSWER_DONE);
		periods(&w, OPEN_V, 300);
		was = w.out;
		w.k.comp.mapped = left & 1;
		w.k.comp.axis[INTERP_Z].backlash = left & 2 ? 30 : 0;
		crash(&w);
		assert_true(w.l.cycle.loaded);
		stands_there(&w, &was);
		assert_int_equal(ask(&w, CYCLE_RETRACT, 0, 0.1), ANSWER_DONE);
		periods(&w, OPEN_V, 300);
		/* Up again: no backlash; about 7 um of the maps. */
		if (left & 1)
			assert_true(z_added(&w) != 0);
		else
			assert_int_equal(z_added(&w), 0);
		world_free(&w);
	}
}

static void a_fault_and_its_reset_move_no_axis_either(void **st)
{
	struct world w;
	struct io_outputs was;

	(void)st;
	world_init(&w);
	wear_z(&w);
	loop_make(&w);
	begin_cavity(&w);
	cut(&w, 1);
	assert_int_equal(ask(&w, CYCLE_ESTOP, 0, 0), ANSWER_DONE);
	period(&w, OPEN_V);
	was = w.out;
	w.k.comp.axis[INTERP_Z].backlash = 30;
	crash(&w);
	stands_there(&w, &was);
	assert_int_equal(ask(&w, CYCLE_RESET, 0, 0), ANSWER_DONE);
	stands_there(&w, &was);
	assert_int_equal(ask(&w, CYCLE_STOP, 0, 0), ANSWER_DONE);
	stands_there(&w, &was);
	world_free(&w);
}

static void idle_axes_stand_where_they_were_sent(void **st)
{
	struct world w;
	struct io_outputs was;
	struct made other;
	struct interp_build *b;

	(void)st;
	world_init(&w);
	wear_z(&w);
	w.k.axis[INTERP_Z] = (struct manual_axis) {
		.present = true, .pulse_mm = PULSE_MM, .v_max_mm_s = 50,
		.a_max_mm_s2 = 1000, .j_max_mm_s3 = 20000, .jog_mm_s = 20,
	};
	loop_make(&w);
	assert_int_equal(ask(&w, CYCLE_JOG, INTERP_Z, -2.5), ANSWER_DONE);
	periods(&w, OPEN_V, 2000);
	was = w.out;
	crash(&w);
	assert_int_equal(w.l.cycle.state, STATE_IDLE);
	assert_int_equal(w.l.cycle.out.target[INTERP_Z], -2500);
	stands_there(&w, &was);
	/* Compiled for another place, as from before the crash. */
	b = begin(INTERP_SIMULTANEOUS);
	cut_to(b, -3);
	other = finish(b);
	assert_int_equal(cycle_load(&w.l.cycle, &other.p), ANSWER_ELSEWHERE);
	unmake(&other);
	world_free(&w);
}

/* X leads; what is added is part of no place, and gone at rest. */
static void lead_x(struct world *w)
{
	struct contouring_config *k = &w->k.contouring;

	wear_z(w);
	w->k.comp.axis[INTERP_X].backlash = 20;
	w->k.dry_run = true;
	w->k.travel_a_mm_s2 = 500;
	*k = (struct contouring_config) {
		.methods = INTERP_COMPENSATE_FEEDFORWARD |
			   INTERP_COMPENSATE_CROSS,
		.axes = 1u << INTERP_X, .ahead = 2,
		.gains = { .velocity = 1, .acceleration = 1,
			   .lead_periods = 0.5, .cross_1_s = 100 },
	};
	for (int i = 0; i < INTERP_NAXES; i++)
		k->pulse_mm[i] = PULSE_MM;
	k->loop[INTERP_X] = (struct interp_axis_loop) {
		.gain_1_s = 30, .velocity_hz = 60, .damping = 0.7,
	};
	k->most_mm[INTERP_X] = 2;
}

static void a_lead_is_gone_after_a_crash_in_motion(void **st)
{
	(void)st;
	for (int at = 30; at < 900; at += 29) {
		struct world w;
		struct interp_build *b = begin(INTERP_SIMULTANEOUS);
		struct io_outputs was;

		world_init(&w);
		lead_x(&w);
		loop_make(&w);
		help_word.feed_mm_s = 15;
		line(b, (double[INTERP_NAXES]) { -5 });
		load(&w, b);
		go_on(&w);
		for (int i = 0; i < at; i++) {
			memcpy(w.in.actual, w.out.target, sizeof(w.in.actual));
			period(&w, OPEN_V);
		}
		was = w.out;
		was.target[INTERP_X] -= w.l.cycle.contouring.on ?
			w.l.cycle.contouring.added[INTERP_X] : 0;
		crash(&w);
		stands_there(&w, &was);
		world_free(&w);
	}
}

static void begin_idle_x(struct world *w)
{
	world_init(w);
	w->k.axis[INTERP_X] = (struct manual_axis) {
		.present = true, .pulse_mm = PULSE_MM, .v_max_mm_s = 50,
		.a_max_mm_s2 = 1000, .j_max_mm_s3 = 20000, .jog_mm_s = 20,
		.home_slow_mm_s = 5,
	};
	loop_make(w);
}

/* Run onto it toward +, and come back a bit, not off it. */
static void a_limit_switch_is_on_the_side_it_was(void **st)
{
	struct world w;

	(void)st;
	begin_idle_x(&w);
	assert_int_equal(ask(&w, CYCLE_JOG, INTERP_X, 5), ANSWER_DONE);
	periods(&w, OPEN_V, 100);
	w.in.limit = 1u << INTERP_X;
	periods(&w, OPEN_V, 2);
	assert_int_equal(w.l.cycle.fault.first, FAULT_LIMIT_SWITCH);
	assert_int_equal(ask(&w, CYCLE_RESET, 0, 0), ANSWER_DONE);
	assert_int_equal(ask(&w, CYCLE_JOG, INTERP_X, -0.1), ANSWER_DONE);
	periods(&w, OPEN_V, 300);
	assert_int_equal(w.l.cycle.state, STATE_IDLE);
	for (int times = 0; times < 2; times++) {
		crash(&w);
		period(&w, OPEN_V);
		assert_int_equal(ask(&w, CYCLE_JOG, INTERP_X, 0.1),
				 ANSWER_AT_LIMIT);
	}
	assert_int_equal(ask(&w, CYCLE_JOG, INTERP_X, -0.1), ANSWER_DONE);
	world_free(&w);
}

static void a_limit_switch_met_meanwhile_has_no_known_side(void **st)
{
	struct world w;

	(void)st;
	begin_idle_x(&w);
	assert_int_equal(ask(&w, CYCLE_JOG, INTERP_X, 1), ANSWER_DONE);
	periods(&w, OPEN_V, 500);
	crash(&w);
	w.in.limit = 1u << INTERP_X;
	period(&w, OPEN_V);
	assert_int_equal(ask(&w, CYCLE_JOG, INTERP_X, 0.1), ANSWER_DONE);
	assert_int_equal(ask(&w, CYCLE_STOP, 0, 0), ANSWER_DONE);
	periods(&w, OPEN_V, 100);
	world_free(&w);
}

static void homed_axes(struct world *w, bool stays)
{
	world_init(w);
	w->k.require_home = true;
	w->k.axis[INTERP_X] = (struct manual_axis) {
		.present = true, .pulse_mm = PULSE_MM, .v_max_mm_s = 50,
		.a_max_mm_s2 = 1000, .j_max_mm_s3 = 20000, .jog_mm_s = 20,
		.method = HOME_ABSOLUTE, .home_at_mm = 10,
	};
	loop_make(w);
	w->in.own[INTERP_X] = w->in.actual[INTERP_X] = 1234;
	assert_int_equal(ask(w, CYCLE_HOME, INTERP_X, 0), ANSWER_DONE);
	periods(w, OPEN_V, 10);
	assert_int_equal(manual_unhomed(&w->l.cycle), 0);
	w->l.io.stays = stays;
}

static void crash_as(struct world *w, bool stays)
{
	struct shm_snapshot before;

	assert_true(shm_snapshot(w->l.status, &before));
	loop_make(w);
	w->l.io.stays = stays;
	resume(&w->l, &w->config, &before);
}

static void axes_that_cannot_have_moved_stay_homed(void **st)
{
	struct world w;

	(void)st;
	homed_axes(&w, true);
	crash_as(&w, true);
	assert_int_equal(manual_unhomed(&w.l.cycle), 0);
	assert_int_equal(w.l.cycle.out.target[INTERP_X], 11234);
	period(&w, OPEN_V);
	assert_int_equal(w.out.target[INTERP_X], 1234);
	world_free(&w);
}

static void axes_that_nothing_measures_are_to_be_homed_again(void **st)
{
	struct world w;

	(void)st;
	homed_axes(&w, false);
	crash_as(&w, false);
	assert_int_equal(manual_unhomed(&w.l.cycle), 1u << INTERP_X);
	assert_int_equal(w.l.cycle.out.target[INTERP_X], 11234);
	world_free(&w);
}

static void axes_that_are_homed_otherwise_now_are_to_be_homed_again(void **st)
{
	struct world w;
	struct shm_snapshot before;

	(void)st;
	homed_axes(&w, true);
	assert_true(shm_snapshot(w.l.status, &before));
	loop_make(&w);
	w.config.manual[INTERP_X].home_at_mm += 1;
	w.l.home_key = key_home(&w.config);
	resume(&w.l, &w.config, &before);
	assert_int_equal(manual_unhomed(&w.l.cycle), 1u << INTERP_X);
	assert_int_equal(w.l.cycle.out.target[INTERP_X], 11234);
	period(&w, OPEN_V);
	assert_int_equal(w.out.target[INTERP_X], 1234);
	world_free(&w);
}

static int32_t originated[IO_NAXES];

static bool origin(void *self, int32_t ret[IO_NAXES])
{
	(void)self;
	for (int i = 0; i < IO_NAXES; i++)
		ret[i] = 1000 * i - 7;
	return true;
}

static void originate(void *self, const int32_t zero[IO_NAXES])
{
	(void)self;
	memcpy(originated, zero, sizeof(originated));
}

static void drives_that_count_are_told_where_their_zero_was(void **st)
{
	struct world w;
	struct shm_snapshot before;

	(void)st;
	homed_axes(&w, false);
	w.l.io.origin = origin;
	period(&w, OPEN_V);
	assert_true(shm_snapshot(w.l.status, &before));
	loop_make(&w);
	w.l.io.stays = false;
	w.l.io.originate = originate;
	resume(&w.l, &w.config, &before);
	for (int i = 0; i < IO_NAXES; i++)
		assert_int_equal(originated[i], 1000 * i - 7);
	assert_int_equal(manual_unhomed(&w.l.cycle), 0);
	world_free(&w);
}

static void places_in_other_pulses_are_not_believed(void **st)
{
	struct world w;
	struct shm_snapshot before;

	(void)st;
	world_init(&w);
	begin_cavity(&w);
	cut(&w, 1);
	assert_true(shm_snapshot(w.l.status, &before));
	program_close(w.l.program);
	loop_make(&w);
	w.l.pulse_mm[INTERP_Z] = 0.0005;
	resume(&w.l, &w.config, &before);
	assert_false(w.l.cycle.loaded);
	assert_int_equal(w.l.cycle.out.target[INTERP_Z], 0);
	world_free(&w);
}

/* As if a gear or a node were mended in the machine file. */
static void places_of_other_drives_are_not_believed(void **st)
{
	struct machine_config other[4];

	(void)st;
	for (int i = 0; i < 4; i++) {
		struct world w;
		struct shm_snapshot before;

		world_init(&w);
		w.config.backend = BACKEND_CAN402;
		loop_make(&w);
		w.l.axes_key = key_axes(&w.config);
		begin_cavity(&w);
		cut(&w, 1);
		assert_true(shm_snapshot(w.l.status, &before));
		program_close(w.l.program);
		loop_make(&w);
		other[i] = w.config;
		if (i == 1)
			other[i].drive[INTERP_Z].increments *= -1;
		if (i == 2)
			other[i].can402.node[INTERP_Z] += 1;
		if (i == 3)
			other[i].backend = BACKEND_SIM;
		w.l.axes_key = key_axes(&other[i]);
		resume(&w.l, &w.config, &before);
		assert_int_equal(w.l.cycle.loaded, i == 0);
		if (i > 0)
			assert_int_equal(w.l.cycle.out.target[INTERP_Z], 0);
		world_free(&w);
	}
}

/* -- The job -------------------------------------------------------------- */

static void what_was_set_is_in_force_again(void **st)
{
	struct world w;
	double deep;

	(void)st;
	world_init(&w);
	begin_cavity(&w);
	cut(&w, 1);
	assert_int_equal(ask(&w, CYCLE_SET, INTERP_TECH_SERVO_V, 47),
			 ANSWER_DONE);
	assert_int_equal(ask(&w, CYCLE_SET, INTERP_TECH_JUMP_MM, 0.25),
			 ANSWER_DONE);
	assert_int_equal(ask(&w, CYCLE_SET, INTERP_TECH_POLARITY, -1),
			 ANSWER_DONE);
	assert_int_equal(ask(&w, CYCLE_OVERRIDE, 0, 0.25), ANSWER_DONE);
	period(&w, SPARKING_V);
	deep = w.l.cycle.depth.cut.far_mm;
	assert_true(deep > 0.5);
	crash(&w);
	assert_true(w.l.cycle.loaded);
	assert_near(w.l.cycle.gap.servo_v, 47, 0);
	assert_near(w.l.cycle.jump.height_mm, 0.25, 0);
	assert_near(w.l.cycle.override, 0.25, 0);
	assert_true(io_is_negative(&w.l.cycle.out));
	assert_int_equal(w.l.cycle.conditions.nsets, 3);
	assert_near(w.l.cycle.depth.cut.far_mm, deep, 0);
	assert_int_equal(w.l.cycle.depth.cut.counts, 1);
	/* And a second time, with nothing set in between. */
	period(&w, OPEN_V);
	crash(&w);
	assert_near(w.l.cycle.gap.servo_v, 47, 0);
	world_free(&w);
}

/* Whoever changed it last has it; a PLC that says the same has not. */
static void an_override_of_a_client_stays_beside_a_plc(void **st)
{
	struct world w;

	(void)st;
	world_init(&w);
	w.in.plc = well();
	loop_make(&w);
	begin_cavity(&w);
	assert_near(w.l.cycle.override, 1, 0);
	assert_int_equal(ask(&w, CYCLE_OVERRIDE, 0, 0.25), ANSWER_DONE);
	period(&w, SPARKING_V);
	crash(&w);
	/* Its link comes up. */
	w.in.plc = (struct io_plc) { .present = true };
	periods(&w, OPEN_V, 3);
	w.in.plc = well();
	periods(&w, OPEN_V, 3);
	assert_near(w.l.cycle.override, 0.25, 0);
	w.in.plc.override = 0.5;
	period(&w, OPEN_V);
	assert_near(w.l.cycle.override, 0.5, 0);
	world_free(&w);
}

/* As after a change of the machine file: below its short_v now. */
static void a_job_whose_sets_do_not_fit_is_not_taken_up(void **st)
{
	struct world w;

	(void)st;
	world_init(&w);
	begin_cavity(&w);
	cut(&w, 1);
	assert_int_equal(ask(&w, CYCLE_SET, INTERP_TECH_SERVO_V, 20),
			 ANSWER_DONE);
	period(&w, SPARKING_V);
	w.k.gap.short_v = 30;
	crash(&w);
	assert_false(w.l.cycle.loaded);
	assert_int_equal(w.l.cycle.state, STATE_IDLE);
	world_free(&w);
}

/* The same way, so that each place is one of both. */
static void another_program_under_its_number_is_not_taken_up(void **st)
{
	struct world w;
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct made other;

	(void)st;
	world_init(&w);
	begin_cavity(&w);
	cut(&w, 1);
	cut_to(b, -4);
	other = finish(b);
	program_put(&w, &other);
	crash(&w);
	assert_false(w.l.cycle.loaded);
	assert_null(w.l.program);
	assert_int_equal(w.l.cycle.state, STATE_IDLE);
	assert_in_range(-w.l.cycle.out.target[INTERP_Z], 1000, 1010);
	unmake(&other);
	world_free(&w);
}

static void a_latched_fault_stays_until_the_reset(void **st)
{
	struct world w;

	(void)st;
	world_init(&w);
	begin_cavity(&w);
	cut(&w, 1);
	assert_int_equal(ask(&w, CYCLE_ESTOP, 0, 0), ANSWER_DONE);
	periods(&w, OPEN_V, 3);
	crash(&w);
	assert_true(w.l.cycle.loaded);
	periods(&w, OPEN_V, 3);
	assert_int_equal(w.l.cycle.state, STATE_FAULT);
	assert_int_equal(w.l.cycle.fault.first, FAULT_ESTOP);
	assert_int_equal(ask(&w, CYCLE_START, 0, 0), ANSWER_WRONG_STATE);
	assert_int_equal(ask(&w, CYCLE_RESET, 0, 0), ANSWER_DONE);
	go_on(&w);
	cut(&w, 2);
	world_free(&w);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(no_drive_moves_after_a_crash_wherever_it_was),
		cmocka_unit_test(what_a_plc_told_of_the_axes_is_in_force_again),
		cmocka_unit_test(what_was_being_taken_up_waits_for_a_command),
		cmocka_unit_test(another_machine_file_moves_no_axis_by_itself),
		cmocka_unit_test(a_fault_and_its_reset_move_no_axis_either),
		cmocka_unit_test(idle_axes_stand_where_they_were_sent),
		cmocka_unit_test(a_lead_is_gone_after_a_crash_in_motion),
		cmocka_unit_test(a_limit_switch_is_on_the_side_it_was),
		cmocka_unit_test(a_limit_switch_met_meanwhile_has_no_known_side),
		cmocka_unit_test(axes_that_cannot_have_moved_stay_homed),
		cmocka_unit_test(axes_that_nothing_measures_are_to_be_homed_again),
		cmocka_unit_test(axes_that_are_homed_otherwise_now_are_to_be_homed_again),
		cmocka_unit_test(places_of_other_drives_are_not_believed),
		cmocka_unit_test(drives_that_count_are_told_where_their_zero_was),
		cmocka_unit_test(places_in_other_pulses_are_not_believed),
		cmocka_unit_test(what_was_set_is_in_force_again),
		cmocka_unit_test(an_override_of_a_client_stays_beside_a_plc),
		cmocka_unit_test(a_job_whose_sets_do_not_fit_is_not_taken_up),
		cmocka_unit_test(another_program_under_its_number_is_not_taken_up),
		cmocka_unit_test(a_latched_fault_stays_until_the_reset),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
