/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_contouring.c - the cycle leads lagging axes: they are nearer to the
 * path, an addition is never large, and nothing is added at rest
 */
#include "cycle_help.h"

#include "config.h"
#include "axes/contouring.h"

#include "interp/angle.h"
#include "interp/axis_model.h"
#include "interp/identify.h"

#include <errno.h>

#define RADIUS_MM	5.0

static const struct interp_axis_loop loops[2] = {
	{ .gain_1_s = 30, .velocity_hz = 60, .damping = 0.7 },
	{ .gain_1_s = 21.5, .velocity_hz = 60, .damping = 0.7 },
};

/* A cycle, and a machine whose axes lag. */
struct lagging {
	struct rig r;
	struct interp_axis_model axis[2];
	double worst_mm;		/* off the circle */
	int32_t most;			/* added, pulses */
	int32_t leap;			/* its largest change in a period */
	int32_t was[INTERP_NAXES];	/* added in the period before */
};

static struct cycle_config config_of(uint32_t methods)
{
	struct cycle_config k = usual_config();

	k.dry_run = true;
	k.travel_a_mm_s2 = 500;
	k.contouring = (struct contouring_config) {
		.methods = methods, .axes = 3, .ahead = 2,
		.gains = { .velocity = 1, .acceleration = 1,
			   .lead_periods = 0.5, .cross_1_s = 100 },
	};
	for (int i = 0; i < INTERP_NAXES; i++)
		k.contouring.pulse_mm[i] = PULSE_MM;
	for (int i = 0; i < 2; i++) {
		k.contouring.loop[i] = loops[i];
		k.contouring.most_mm[i] = 80 / loops[i].gain_1_s;
	}
	return k;
}

/* Round the centre at -RADIUS, twice half, from a stand. */
static struct interp_build *circle(void)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);

	help_word.feed_mm_s = 16.7;
	arc(b, (double[INTERP_NAXES]) { -2 * RADIUS_MM }, -RADIUS_MM, 0, false);
	arc(b, (double[INTERP_NAXES]) { 0 }, -RADIUS_MM, 0, false);
	return b;
}

static void begin_circle(struct lagging *l, const struct cycle_config *k)
{
	*l = (struct lagging) { .worst_mm = 0 };
	rig_load(&l->r, circle(), k);
	for (int i = 0; i < 2; i++)
		assert_int_equal(interp_axis_model_init(&l->axis[i], &loops[i],
							PERIOD_S, 0), 0);
	assert_int_equal(tell(&l->r, CYCLE_START), ANSWER_DONE);
}

static int32_t added(const struct lagging *l, int i)
{
	return l->r.out.target[i] - l->r.c.out.target[i];
}

static void look(struct lagging *l)
{
	const double off = hypot(l->axis[0].actual_mm + RADIUS_MM,
				 l->axis[1].actual_mm) - RADIUS_MM;

	l->worst_mm = fmax(l->worst_mm, fabs(off));
	for (int i = 0; i < INTERP_NAXES; i++) {
		l->most = abs(added(l, i)) > l->most ? abs(added(l, i)) :
						      l->most;
		l->leap = abs(added(l, i) - l->was[i]) > l->leap ?
			  abs(added(l, i) - l->was[i]) : l->leap;
		l->was[i] = added(l, i);
	}
}

/* The scales, then the cycle, then the axes go on. */
static void period(struct lagging *l)
{
	for (int i = 0; i < 2; i++)
		l->r.in.actual[i] = (int32_t)lround(l->axis[i].actual_mm /
						    PULSE_MM);
	step_on(&l->r);
	for (int i = 0; i < 2; i++)
		interp_axis_model_follow(&l->axis[i],
			l->r.out.target[i] * PULSE_MM,
			l->r.before.target[i] * PULSE_MM);
	look(l);
}

static void periods(struct lagging *l, int n)
{
	while (n-- > 0)
		period(l);
}

/* To the end of the job, and until the axes stand. */
static void whole(struct lagging *l)
{
	for (int i = 0; i < 20000 && l->r.c.loaded; i++)
		period(l);
	assert_false(l->r.c.loaded);
	periods(l, 500);
}

static double worst_of(const struct cycle_config *k)
{
	struct lagging l;

	begin_circle(&l, k);
	whole(&l);
	rig_free(&l.r);
	return l.worst_mm;
}

/* -- What it is worth ----------------------------------------------------- */

#define FORWARD	INTERP_COMPENSATE_FEEDFORWARD
#define CROSS	INTERP_COMPENSATE_CROSS

static void axes_that_lag_keep_to_the_path(void **state)
{
	const struct cycle_config none = config_of(0), cross = config_of(CROSS);
	const struct cycle_config forward = config_of(FORWARD);
	const struct cycle_config both = config_of(FORWARD | CROSS);
	const double alone = worst_of(&none);

	(void)state;
	assert_true(alone > 0.05);
	assert_true(worst_of(&cross) < alone / 2);
	assert_true(worst_of(&forward) < 0.004);
	assert_true(worst_of(&both) < 0.003);
}

static void a_delay_that_is_known_is_led_too(void **state)
{
	struct cycle_config k = config_of(FORWARD);
	struct lagging l;

	(void)state;
	for (int i = 0; i < 2; i++)
		k.contouring.loop[i].delay_s = 0.0025;
	k.contouring.ahead = 5;
	begin_circle(&l, &k);
	for (int i = 0; i < 2; i++)
		interp_axis_model_init(&l.axis[i], &k.contouring.loop[i],
				       PERIOD_S, 0);
	whole(&l);
	assert_true(l.worst_mm < 0.005);
	rig_free(&l.r);
}

static void what_the_drive_leads_itself_is_counted(void **state)
{
	struct cycle_config k = config_of(FORWARD);
	struct lagging l;

	(void)state;
	k.contouring.gains.velocity = 0.4;
	k.contouring.gains.acceleration = 2.5;
	begin_circle(&l, &k);
	for (int i = 0; i < 2; i++) {
		struct interp_axis_loop own = loops[i];

		own.feedforward = 0.6;
		l.r.c.config.contouring.loop[i] = own;
		interp_axis_model_init(&l.axis[i], &own, PERIOD_S, 0);
	}
	whole(&l);
	assert_true(l.worst_mm < 0.02);
	rig_free(&l.r);
}

static void the_path_is_the_same_one(void **state)
{
	const struct cycle_config none = config_of(0);
	const struct cycle_config both = config_of(FORWARD | CROSS);
	struct lagging l, m;

	(void)state;
	begin_circle(&l, &none);
	begin_circle(&m, &both);
	while (l.r.c.loaded) {
		period(&l);
		period(&m);
		assert_memory_equal(l.r.c.out.target, m.r.c.out.target,
				    sizeof(l.r.c.out.target));
		assert_true(l.r.c.state == m.r.c.state || !l.r.c.loaded);
	}
	/* It ends on its pulses. */
	periods(&m, 30);
	assert_memory_equal(l.r.c.out.target, m.r.c.out.target,
			    sizeof(l.r.c.out.target));
	assert_false(m.r.c.loaded);
	rig_free(&l.r);
	rig_free(&m.r);
}

/* -- As late as on a bus -------------------------------------------------- */

#define LATE_PERIODS	8000

/* What edmctl record would have. */
struct record {
	double target[2][LATE_PERIODS], actual[2][LATE_PERIODS];
};

/* With can402 a target is reached two SYNCs later, and a place is one old. */
static void late_job(struct lagging *l, const struct cycle_config *k,
		     struct record *ret)
{
	int32_t sent[2][2] = { { 0 } };
	double was[2] = { 0 };

	begin_circle(l, k);
	for (int n = 0; n < LATE_PERIODS; n++) {
		for (int i = 0; i < 2; i++) {
			l->r.in.actual[i] = (int32_t)lround(was[i] / PULSE_MM);
			was[i] = l->axis[i].actual_mm;
		}
		step_on(&l->r);
		for (int i = 0; i < 2; i++) {
			ret->target[i][n] = l->r.c.out.target[i] * PULSE_MM;
			ret->actual[i][n] = l->r.in.actual[i] * PULSE_MM;
			interp_axis_model_follow(&l->axis[i],
						 sent[n % 2][i] * PULSE_MM, 0);
			sent[n % 2][i] = l->r.out.target[i];
		}
		look(l);
	}
	assert_false(l->r.c.loaded);
	rig_free(&l->r);
}

/* Loops as they are seen from the cycle, all the bus in them. */
static void take_loops(struct cycle_config *k, const struct record *seen)
{
	for (int i = 0; i < 2; i++) {
		const struct interp_identify_trace t = {
			seen->target[i], seen->actual[i], LATE_PERIODS,
			PERIOD_S, NULL, NULL
		};
		struct interp_identified d;

		assert_int_equal(interp_identify(&t, &d), 0);
		k->contouring.loop[i] = d.loop;
		k->contouring.loop[i].kick_mm_s = 0;
		k->contouring.loop[i].backlash_mm = 0;
	}
	k->contouring.ahead = CONTOURING_AHEAD;
}

static double late_worst(const struct record *seen, uint32_t methods)
{
	static struct record unused;
	struct cycle_config k = config_of(methods);
	struct lagging l;

	k.contouring.gains.cross_1_s = 50;
	take_loops(&k, seen);
	late_job(&l, &k, &unused);
	for (int i = 0; i < 2; i++)
		assert_near(l.axis[i].actual_mm, 0, PULSE_MM / 2);
	return l.worst_mm;
}

static void axes_behind_a_bus_are_led_by_what_was_identified(void **state)
{
	const struct cycle_config none = config_of(0);
	static struct record seen;
	struct lagging l;

	(void)state;
	late_job(&l, &none, &seen);
	assert_true(late_worst(&seen, CROSS) < l.worst_mm / 1.5);
	assert_true(late_worst(&seen, FORWARD) < l.worst_mm / 10);
	assert_true(late_worst(&seen, FORWARD | CROSS) < l.worst_mm / 10);
}

/* -- What it never does --------------------------------------------------- */

static void at_rest_it_adds_nothing(void **state)
{
	const struct cycle_config k = config_of(FORWARD | CROSS);
	struct lagging l;

	(void)state;
	begin_circle(&l, &k);
	for (int n = 0; n < 4; n++) {
		periods(&l, 300);
		assert_true(l.most > 300);
		assert_int_equal(tell(&l.r, CYCLE_HOLD), ANSWER_DONE);
		periods(&l, 400);
		for (int i = 0; i < INTERP_NAXES; i++)
			assert_int_equal(added(&l, i), 0);
		for (int i = 0; i < 2; i++)
			assert_near(l.axis[i].actual_mm / PULSE_MM,
				    l.r.c.out.target[i], 0.02);
		assert_int_equal(tell(&l.r, CYCLE_START), ANSWER_DONE);
	}
	whole(&l);
	for (int i = 0; i < INTERP_NAXES; i++)
		assert_int_equal(added(&l, i), 0);
	rig_free(&l.r);
}

static void it_comes_and_goes_without_a_leap(void **state)
{
	const struct cycle_config k = config_of(FORWARD | CROSS);
	const double lags_s = 2 * 0.7 / (6.283185307179586 * 60);
	/* The speed's change in a period, the acceleration's, and what jerk
	 * makes of the lead. */
	const double most = (k.travel_a_mm_s2 + k.travel_j_mm_s3 *
			     (lags_s + 4 * PERIOD_S)) * PERIOD_S /
			    loops[1].gain_1_s;
	struct lagging l;

	(void)state;
	begin_circle(&l, &k);
	for (int n = 0; n < 3; n++) {
		periods(&l, 200 + 37 * n);
		tell(&l.r, CYCLE_HOLD);
		periods(&l, 300);
		if (n == 1) {
			tell_mm(&l.r, CYCLE_RETRACT, 1.5);
			periods(&l, 800);
		}
		tell(&l.r, CYCLE_START);
	}
	whole(&l);
	assert_true(l.leap * PULSE_MM < most + 2 * PULSE_MM);
	rig_free(&l.r);
}

static void it_never_adds_more_than_the_lag_at_full_speed(void **state)
{
	struct cycle_config k = config_of(FORWARD | CROSS);
	struct lagging l;

	(void)state;
	k.contouring.most_mm[0] = 0.1;
	k.contouring.most_mm[1] = 0.05;
	begin_circle(&l, &k);
	for (int n = 0; n < 2000 && l.r.c.loaded; n++) {
		period(&l);
		assert_true(abs(added(&l, 0)) <= 100);
		assert_true(abs(added(&l, 1)) <= 50);
	}
	rig_free(&l.r);
}

static void it_never_sends_an_axis_out_of_its_travel(void **state)
{
	struct cycle_config k = config_of(FORWARD | CROSS);
	struct lagging l;

	(void)state;
	k.travel_min[0] = -10001;
	k.travel_max[0] = 1;
	k.travel_min[1] = -5001;
	k.travel_max[1] = 5001;
	begin_circle(&l, &k);
	whole(&l);
	assert_true(l.most > 300);
	rig_free(&l.r);
}

/* Along X at speed, onto two contours at once, and on along X. */
static struct interp_build *onto_a_pair(void)
{
	const struct interp_build_contour c[2] = {
		{ .arc = false },
		{ .arc = true, .sweep = ANGLE_TURN, .centre_mm = { 0.05, 0 } },
	};
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct interp_diag d;

	help_word.feed_mm_s = 50;
	line(b, (double[INTERP_NAXES]) { 20 });
	assert_int_equal(interp_build_pair(b, (double[INTERP_NAXES]) {
		[INTERP_X] = 40 }, c, &help_word, &d), 0);
	line(b, (double[INTERP_NAXES]) { 60 });
	return b;
}

static void where_no_path_is_known_it_comes_off_by_and_by(void **state)
{
	const struct cycle_config k = config_of(FORWARD | CROSS);
	bool passed = false;
	struct lagging l = { .worst_mm = 0 };

	(void)state;
	rig_load(&l.r, onto_a_pair(), &k);
	for (int i = 0; i < 2; i++)
		assert_int_equal(interp_axis_model_init(&l.axis[i], &loops[i],
							PERIOD_S, 0), 0);
	tell(&l.r, CYCLE_START);
	for (int n = 0; n < 20000 && l.r.c.loaded; n++) {
		period(&l);
		passed = passed || (l.r.c.cursor.seg.kind == INTERP_PAIR &&
				    l.r.c.feed_mm_s > 20 && added(&l, 0) == 0);
	}
	assert_true(passed);
	assert_true(l.most > 500);
	assert_true(l.leap * PULSE_MM <= 80 * PERIOD_S + 2 * PULSE_MM);
	rig_free(&l.r);
}

/* Scales that say anything at all. */
static void scales_that_lie_are_bounded(void **state)
{
	const struct cycle_config k = config_of(FORWARD | CROSS);
	uint64_t seed = 3;
	struct lagging l;

	(void)state;
	begin_circle(&l, &k);
	for (int n = 0; n < 3000 && l.r.c.loaded; n++) {
		for (int i = 0; i < 2; i++) {
			seed = seed * 6364136223846793005u +
			       1442695040888963407u;
			l.r.in.actual[i] = (int32_t)(seed >> 32);
		}
		step_on(&l.r);
		for (int i = 0; i < 2; i++)
			assert_true(abs(added(&l, i)) * PULSE_MM <=
				    k.contouring.most_mm[i] + PULSE_MM);
		assert_true(l.leap * PULSE_MM <= 80 * PERIOD_S + PULSE_MM);
		look(&l);
	}
	rig_free(&l.r);
}

static void a_fault_takes_it_off_at_once(void **state)
{
	const struct cycle_config k = config_of(FORWARD | CROSS);
	struct lagging l;

	(void)state;
	begin_circle(&l, &k);
	periods(&l, 300);
	assert_true(abs(added(&l, 0)) + abs(added(&l, 1)) > 300);
	l.r.in.estop = true;
	period(&l);
	assert_int_equal(l.r.c.state, STATE_FAULT);
	for (int i = 0; i < INTERP_NAXES; i++)
		assert_int_equal(added(&l, i), 0);
	rig_free(&l.r);
}

static void axes_without_power_get_nothing(void **state)
{
	const struct cycle_config k = config_of(FORWARD);
	struct lagging l;

	(void)state;
	begin_circle(&l, &k);
	periods(&l, 300);
	l.r.in.axes_off = true;
	period(&l);
	for (int i = 0; i < INTERP_NAXES; i++)
		assert_int_equal(added(&l, i), 0);
	rig_free(&l.r);
}

static void a_jog_and_a_cut_get_nothing(void **state)
{
	struct cycle_config k = config_of(FORWARD | CROSS);
	const struct cycle_command jog = {
		.verb = CYCLE_JOG, .arg = INTERP_X, .arg_mm = 3
	};
	struct rig r;

	(void)state;
	k.axis[INTERP_X] = (struct manual_axis) {
		.present = true, .pulse_mm = PULSE_MM, .v_max_mm_s = 50,
		.a_max_mm_s2 = 500, .j_max_mm_s3 = 20000, .jog_mm_s = 20,
	};
	k.contouring.axes = 7;
	k.contouring.loop[INTERP_Z] = loops[0];
	k.contouring.most_mm[INTERP_Z] = 2;
	k.dry_run = false;
	begin_cut(&r, &k);
	until(&r, STATE_APPROACH, OPEN_V, 1000);
	for (int n = 0; n < 800; n++) {
		step(&r, n % 100 < 90 ? SPARKING_V : SHORTED_V);
		if (r.c.state != STATE_HOLD && r.c.state != STATE_TRAVEL)
			assert_memory_equal(r.out.target, r.c.out.target,
					    sizeof(r.out.target));
	}
	tell(&r, CYCLE_STOP);
	steps(&r, OPEN_V, 300);
	assert_int_equal(r.c.state, STATE_IDLE);
	assert_int_equal(cycle_command(&r.c, &jog), ANSWER_DONE);
	for (int n = 0; n < 400; n++) {
		step(&r, OPEN_V);
		assert_memory_equal(r.out.target, r.c.out.target,
				    sizeof(r.out.target));
	}
	rig_free(&r);
}

/* -- What a machine file may ask the cycle for ---------------------------- */

static void a_machine(struct machine_config *c, const char *method)
{
	config_defaults(c);
	c->backend = BACKEND_CAN402;
	c->axes.present = 3;
	c->loop[0].gain_1_s = c->loop[1].gain_1_s = 30;
	c->contour.cross_1_s = 20;
	snprintf(c->contour.method, sizeof(c->contour.method), "%s", method);
}

static void what_the_cycle_has_is_taken(void **state)
{
	static const char *const good[] = {
		"none", "feedforward", "cross-coupled",
		"cross-coupled+feedforward",
	};
	struct machine_config c;
	struct cycle_config k;
	struct interp_diag d;

	(void)state;
	for (int i = 0; i < 4; i++) {
		a_machine(&c, good[i]);
		assert_int_equal(config_check_contouring(&c, &d), 0);
		config_cycle(&c, &k);
		assert_int_equal(k.contouring.methods,
				 interp_compensate_parse(good[i]));
	}
	assert_near(k.contouring.most_mm[0], c.axes.axis[0].v_max_mm_s / 30,
		    1e-9);
}

static void refused(struct machine_config *c, const char *found,
		    const char *wanted)
{
	struct cycle_config k;
	struct interp_diag d;

	assert_int_equal(config_check_contouring(c, &d), -EINVAL);
	if (!strstr(d.found, found) || !strstr(d.wanted, wanted))
		fail_msg("%s; %s", d.found, d.wanted);
	config_cycle(c, &k);
	assert_int_equal(k.contouring.methods, 0);
}

static void what_the_cycle_has_not_is_refused_with_what_it_has(void **state)
{
	struct machine_config c;
	struct interp_diag d;

	(void)state;
	for (int i = 2; interp_compensate_name(i); i++) {
		a_machine(&c, interp_compensate_name(i));
		refused(&c, interp_compensate_name(i),
			"feedforward+cross-coupled");
	}
	a_machine(&c, "feedforward");
	c.backend = BACKEND_GPIO;
	refused(&c, "axes that do not lag", "can402");
	a_machine(&c, "feedforward");
	c.backend = BACKEND_SIM;
	refused(&c, "axes that do not lag", "loops = yes");
	a_machine(&c, "feedforward");
	c.axes.present = 7;
	refused(&c, "axis.Z has no loop_gain_1_s", "edmctl identify");
	a_machine(&c, "feedforward");
	c.loop[1].delay_s = 0.0131;
	refused(&c, "axis.Y.loop_delay_s", "below 7 periods");
	a_machine(&c, "cross-coupled");
	c.contour.cross_1_s = 200;
	refused(&c, "less than 6 dB", "cross_1_s ");
	assert_int_equal(config_check_contouring(&c, &d), -EINVAL);
	c.contour.cross_1_s = atof(strstr(d.wanted, "cross_1_s ") + 10);
	assert_true(c.contour.cross_1_s > 10);
	assert_int_equal(config_check_contouring(&c, &d), 0);
	c.contour.cross_1_s += 0.2;
	refused(&c, "less than 6 dB", "cross_1_s ");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(axes_that_lag_keep_to_the_path),
		cmocka_unit_test(a_delay_that_is_known_is_led_too),
		cmocka_unit_test(what_the_drive_leads_itself_is_counted),
		cmocka_unit_test(axes_behind_a_bus_are_led_by_what_was_identified),
		cmocka_unit_test(the_path_is_the_same_one),
		cmocka_unit_test(at_rest_it_adds_nothing),
		cmocka_unit_test(it_comes_and_goes_without_a_leap),
		cmocka_unit_test(it_never_adds_more_than_the_lag_at_full_speed),
		cmocka_unit_test(it_never_sends_an_axis_out_of_its_travel),
		cmocka_unit_test(where_no_path_is_known_it_comes_off_by_and_by),
		cmocka_unit_test(scales_that_lie_are_bounded),
		cmocka_unit_test(a_fault_takes_it_off_at_once),
		cmocka_unit_test(axes_without_power_get_nothing),
		cmocka_unit_test(a_jog_and_a_cut_get_nothing),
		cmocka_unit_test(what_the_cycle_has_is_taken),
		cmocka_unit_test(what_the_cycle_has_not_is_refused_with_what_it_has),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
