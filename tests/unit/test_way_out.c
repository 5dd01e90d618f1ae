/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_way_out.c - a way out of every stop: the real cycle with the real
 * backends, axes that an obstacle holds, and every verb
 *
 * A line goes to X 3 Y 1.5.  At X 1 something stops X that does not yield; Y
 * goes on for as long as the machine needs to stop.
 */
#include "way_out_help.h"

#define WALL		1000
#define PATH_PER_X	1.1180339887498949	/* mm of path for a mm of X */

enum stopped { BY_FOLLOWING, BY_LIMIT, BY_STO, BY_ESTOP, BY_KILL, NSTOPS };

static const char *const stop_names[NSTOPS] = {
	"following error", "drive limit", "safe torque off", "e-stop",
	"restart"
};

/* @peak_mm: there the path turns X round; 0: the line. */
static void path_make(struct world *w, double peak_mm)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	const double end[INTERP_NAXES] = { 3, 1.5 };
	const double peak[INTERP_NAXES] = { peak_mm, 0.6 };
	const double behind[INTERP_NAXES] = { 0, 1.2 };

	help_word.feed_mm_s = 8;
	if (peak_mm > 0)
		line(b, peak);
	line(b, peak_mm > 0 ? behind : end);
	w->m = finish(b);
}

static void world_make_path(struct world *w, bool lines, double peak_mm)
{
	world_init(w, lines);
	path_make(w, peak_mm);
	world_start(w);
}

static void world_make(struct world *w, bool lines)
{
	world_make_path(w, lines, 0);
}

static void run_until_x(struct world *w, int32_t x)
{
	for (int i = 0; i < 1000000 && w->axis[INTERP_X].at < x; i++)
		period(w);
	assert_true(w->axis[INTERP_X].at >= x);
}

/* Then it is held, X stands at an obstacle, and no drive has power. */
static void stop(struct world *w, enum stopped by)
{
	struct axis *x = &w->axis[INTERP_X];

	if (by == BY_FOLLOWING || by == BY_LIMIT || by == BY_KILL)
		x->wall = WALL;
	x->clips = by == BY_LIMIT;
	assert_int_equal(ask(w, CYCLE_START, 0), ANSWER_DONE);
	run_until_x(w, WALL);
	if (by == BY_KILL) {
		for (int i = 0; i < 4; i++)
			period(w);
		killed(w);
		return;
	}
	x->sto = by == BY_STO;
	w->estop = by == BY_ESTOP;
	for (int i = 0; i < 100000 && w->cycle.state != STATE_FAULT; i++)
		period(w);
	run_for(w, 0.5);
	x->wall = x->at;
	x->sto = w->estop = false;
	assert_int_equal(w->cycle.state, STATE_FAULT);
	run_for(w, 0.3);
	assert_int_equal(ask(w, CYCLE_RESET, 0), ANSWER_DONE);
	run_for(w, 0.3);
	assert_int_equal(w->cycle.state, STATE_HOLD);
	assert_int_equal(x->at, x->wall);
}

/* -- The table ------------------------------------------------------------- */

static bool is_met(bool lines, enum stopped by)
{
	return !lines || by == BY_FOLLOWING || by == BY_ESTOP || by == BY_KILL;
}

/* Where X is on the path, or stands, whichever is nearer to the start. */
static int32_t begins_at(const struct world *w)
{
	const int32_t path = w->cycle.out.target[INTERP_X];
	const int32_t at = w->axis[INTERP_X].at;

	return at < path ? at : path;
}

static void is_at(const struct world *w, int32_t x)
{
	assert_in_range(w->axis[INTERP_X].at - x + 4, 0, 8);
	assert_in_range(w->axis[INTERP_Y].at - x / 2 + 4, 0, 8);
}

/* X was not sent on toward the obstacle, and leaps nowhere. */
static void was_kind(const struct world *w, int32_t stood)
{
	assert_true(w->most <= stood + 2);
	assert_true(w->leap <= 80e3 * (double)w->k.period_ns * 1e-9 + 2);
}

static void retracts(struct world *w)
{
	const int32_t stood = w->axis[INTERP_X].at, from = begins_at(w);

	assert_int_equal(ask(w, CYCLE_RETRACT, 0.3 * PATH_PER_X), ANSWER_DONE);
	stands(w);
	is_at(w, from - 300);
	was_kind(w, stood);
	/* And again, and it begins there. */
	assert_int_equal(ask(w, CYCLE_RETRACT, 0.3 * PATH_PER_X), ANSWER_DONE);
	stands(w);
	is_at(w, from - 600);
}

static void steps_back(struct world *w)
{
	const int32_t stood = w->axis[INTERP_X].at;

	assert_int_equal(ask(w, CYCLE_STEP, -1), ANSWER_DONE);
	stands(w);
	is_at(w, 0);
	was_kind(w, stood);
}

static void jogs_away(struct world *w)
{
	const int32_t stood = w->axis[INTERP_X].at;

	assert_int_equal(ask(w, CYCLE_STOP, 0), ANSWER_DONE);
	run_for(w, 0.1);
	assert_int_equal(ask(w, CYCLE_JOG, -0.05), ANSWER_DONE);
	stands(w);
	assert_int_equal(w->cycle.state, STATE_IDLE);
	assert_in_range(w->axis[INTERP_X].at - stood + 50 + 2, 0, 4);
	was_kind(w, stood);
}

/* The obstacle is gone: the job ends. */
static void goes_on(struct world *w)
{
	const int32_t stood = w->axis[INTERP_X].at;

	w->axis[INTERP_X].wall = NONE;
	assert_int_equal(ask(w, CYCLE_START, 0), ANSWER_DONE);
	while (w->cycle.axes.phase != AXES_FREE)
		period(w);
	was_kind(w, stood);
	stands(w);
	assert_int_equal(w->cycle.outcome, OUTCOME_DONE);
	is_at(w, 3000);
}

/* It is still there: the same stop again, where it was, and the same way out.
 */
static void tries_again(struct world *w)
{
	const int32_t stood = w->axis[INTERP_X].at;

	assert_int_equal(ask(w, CYCLE_START, 0), ANSWER_DONE);
	while (w->cycle.axes.phase != AXES_FREE)
		period(w);
	was_kind(w, stood);
	stands(w);
	assert_int_equal(w->cycle.state, STATE_FAULT);
	run_for(w, 0.3);
	assert_int_equal(ask(w, CYCLE_RESET, 0), ANSWER_DONE);
	run_for(w, 0.3);
	look_anew(w);
	retracts(w);
}

static void (*const verbs[])(struct world *) = {
	retracts, steps_back, jogs_away, goes_on, tries_again
};

static void every_stop_has_a_way_out_by_every_verb(void **st)
{
	(void)st;
	for (int lines = 0; lines < 2; lines++) {
		for (int by = 0; by < NSTOPS; by++) {
			for (size_t v = 0; v < sizeof(verbs) /
			     sizeof(verbs[0]); v++) {
				struct world w;

				if (!is_met(lines, (enum stopped)by))
					continue;
				print_message("%s, %s, verb %zu\n", lines ?
					      "gpio" : "can402",
					      stop_names[by], v);
				world_make(&w, lines);
				stop(&w, (enum stopped)by);
				look_anew(&w);
				verbs[v](&w);
				world_free(&w);
			}
		}
	}
}

/* X was blocked in front of the place where the path turns it round; when the
 * machine stands, the path is behind that place. */
static void stop_behind_the_peak(struct world *w, bool kill)
{
	struct axis *x = &w->axis[INTERP_X];
	int32_t top = WALL;

	x->wall = WALL;
	assert_int_equal(ask(w, CYCLE_START, 0), ANSWER_DONE);
	run_until_x(w, WALL);
	while (w->cycle.out.target[INTERP_X] >= top - 2 &&
	       w->cycle.state != STATE_FAULT) {
		if (w->cycle.out.target[INTERP_X] > top)
			top = w->cycle.out.target[INTERP_X];
		period(w);
	}
	if (kill) {
		for (int i = 0; i < 4; i++)
			period(w);
		killed(w);
		return;
	}
	w->estop = true;
	run_for(w, 0.5);
	w->estop = false;
	run_for(w, 0.3);
	assert_int_equal(ask(w, CYCLE_RESET, 0), ANSWER_DONE);
	run_for(w, 0.3);
	/* A motor that has lost its pulses goes back with the path. */
	assert_in_range(x->at, WALL - (w->lines ? 9 : 0), WALL);
}

/* Killed: drives tell the next edmd where they stand.  An encoder that counts
 * from where it is does not tell what was lost before. */
static void an_axis_blocked_before_its_path_turns_is_met_before_that(void **st)
{
	static const double peaks_mm[] = { 1.02, 1.04, 1.1, 1.2 };
	static const char *const hows[] = { "drives", "drives, killed",
					    "lines" };

	(void)st;
	for (int i = 0; i < 12; i++) {
		struct world w;

		print_message("%s, peak %g\n", hows[i % 3], peaks_mm[i / 3]);
		world_make_path(&w, i % 3 == 2, peaks_mm[i / 3]);
		stop_behind_the_peak(&w, i % 3 == 1);
		look_anew(&w);
		assert_int_equal(ask(&w, CYCLE_RETRACT, 0.3), ANSWER_DONE);
		stands(&w);
		was_kind(&w, WALL);
		assert_true(w.axis[INTERP_X].at < WALL);
		assert_int_equal(w.axis[INTERP_X].at,
				 w.cycle.out.target[INTERP_X]);
		world_free(&w);
	}
}

/* In each period of its way back it is held once, and then retracts. */
static void a_way_back_that_was_held_ends_before_a_retract(void **st)
{
	bool walked = true;

	(void)st;
	for (int periods = 1; walked; periods++) {
		struct world w;

		world_make(&w, false);
		stop(&w, BY_FOLLOWING);
		w.axis[INTERP_X].wall = NONE;
		assert_int_equal(ask(&w, CYCLE_START, 0), ANSWER_DONE);
		for (int i = 0; i < periods ||
		     w.cycle.axes.phase == AXES_POWER; i++)
			period(&w);
		walked = w.cycle.axes.phase != AXES_FREE;
		assert_int_equal(ask(&w, CYCLE_HOLD, 0), ANSWER_DONE);
		stands(&w);
		assert_int_equal(ask(&w, CYCLE_RETRACT, 0.3), ANSWER_DONE);
		stands(&w);
		assert_int_equal(w.axis[INTERP_X].at,
				 w.cycle.out.target[INTERP_X]);
		world_free(&w);
	}
}

/* On a shallow path the place where the path has it is far behind. */
static void an_axis_that_springs_back_is_met_on_a_shallow_path(void **st)
{
	const double end[INTERP_NAXES] = { 8, 0.8 };

	(void)st;
	for (int springs = 0; springs <= 30; springs += 10) {
		struct world w;
		struct axis *y = &w.axis[INTERP_Y];
		struct interp_build *b;

		world_init(&w, false);
		b = begin(INTERP_SIMULTANEOUS);
		line(b, end);
		w.m = finish(b);
		world_start(&w);
		y->wall = 400;
		y->springs = springs;
		assert_int_equal(ask(&w, CYCLE_START, 0), ANSWER_DONE);
		while (w.cycle.state != STATE_FAULT)
			period(&w);
		run_for(&w, 0.5);
		assert_int_equal(y->at, 400 - springs);
		assert_int_equal(ask(&w, CYCLE_RESET, 0), ANSWER_DONE);
		run_for(&w, 0.3);
		look_anew(&w);
		assert_int_equal(ask(&w, CYCLE_RETRACT, 0.05), ANSWER_DONE);
		stands(&w);
		assert_int_equal(y->pressed, 0);
		assert_int_equal(y->at, w.cycle.out.target[INTERP_Y]);
		assert_int_equal(w.cycle.state, STATE_HOLD);
		world_free(&w);
	}
}

/* A brake that closes, or a hand, moves an axis that the path has long left at
 * rest: it was not blocked, and no axis goes back to where it moved last. */
static void an_axis_that_was_not_blocked_takes_nobody_back(void **st)
{
	const double down[INTERP_NAXES] = { 0, -0.5 }, on[INTERP_NAXES] = {
		3, -0.5
	};

	(void)st;
	for (int n = 0; n < 8; n++) {
		const int by = (n & 4 ? 100 : 20) * (n & 2 ? 1 : -1);
		struct interp_build *b;
		struct world w;
		int32_t x;

		world_init(&w, n & 1);
		b = begin(INTERP_SIMULTANEOUS);
		line(b, down);
		line(b, on);
		w.m = finish(b);
		world_start(&w);
		stop(&w, BY_ESTOP);
		x = w.axis[INTERP_X].at;
		w.axis[INTERP_Y].at += by;
		run_for(&w, 0.3);
		assert_int_equal(ask(&w, CYCLE_RETRACT, 0.05), ANSWER_DONE);
		stands(&w);
		assert_in_range(x - w.axis[INTERP_X].at, 0, 60);
		assert_in_range(w.axis[INTERP_Y].at + 500 + 2, 0, 4);
		world_free(&w);
	}
}

/* Nobody knows what is in the way there; without the job an axis is free. */
static void an_axis_that_was_moved_far_by_hand_is_not_driven_back(void **st)
{
	(void)st;
	for (int n = 0; n < 4; n++) {
		const bool lines = n & 1;
		struct world w;

		world_make(&w, lines);
		stop(&w, BY_ESTOP);
		w.axis[INTERP_Y].at += n & 2 ? -700 : 700;
		run_for(&w, 0.3);
		for (int i = 0; i < 3; i++) {
			const int32_t x = w.axis[INTERP_X].at;
			const int32_t y = w.axis[INTERP_Y].at;

			assert_int_equal(ask(&w, i ? CYCLE_RETRACT :
					     CYCLE_START, 0.1), ANSWER_DONE);
			stands(&w);
			assert_int_equal(w.cycle.fault.first, FAULT_FOLLOWING);
			assert_int_equal(w.axis[INTERP_X].at, x);
			assert_int_equal(w.axis[INTERP_Y].at, y);
			assert_int_equal(ask(&w, CYCLE_RESET, 0), ANSWER_DONE);
			run_for(&w, 0.3);
		}
		look_anew(&w);
		jogs_away(&w);
		world_free(&w);
	}
}

/* A hand on the STO button: nothing is accepted, and its release moves
 * nothing. */
static void without_power_a_verb_is_refused_and_its_return_starts_nothing(
	void **st)
{
	(void)st;
	for (int job = 0; job < 2; job++) {
		struct world w;

		world_make(&w, false);
		if (!job)
			assert_int_equal(ask(&w, CYCLE_STOP, 0), ANSWER_DONE);
		w.axis[INTERP_Y].sto = true;
		run_for(&w, 0.5);
		assert_int_equal(ask(&w, job ? CYCLE_START : CYCLE_JOG, 1),
				 ANSWER_NO_POWER);
		run_for(&w, 3.5);
		w.axis[INTERP_Y].sto = false;
		run_for(&w, 1);
		assert_int_equal(w.axis[INTERP_X].at, 0);
		assert_int_equal(w.axis[INTERP_X].status, 0x31);
		assert_int_equal(w.cycle.fault.latched, 0);
		assert_int_equal(ask(&w, job ? CYCLE_START : CYCLE_JOG, 1),
				 ANSWER_DONE);
		/* Pressed while the axes get power: over, too. */
		w.axis[INTERP_Y].sto = true;
		run_for(&w, 0.3);
		w.axis[INTERP_Y].sto = false;
		run_for(&w, 1);
		assert_int_equal(w.cycle.fault.first, FAULT_DRIVE);
		assert_int_equal(w.axis[INTERP_X].at, 0);
		world_free(&w);
	}
}

/* It stands: what is watched in motion, such as axes without power or the
 * door, is no fault any more. */
static void a_fault_ends_a_way_by_command(void **st)
{
	static const enum cycle_verb ways[] = { CYCLE_RETRACT, CYCLE_STEP };

	(void)st;
	for (int lines = 0; lines < 2; lines++) {
		for (int i = 0; i < 2; i++) {
			struct world w;

			world_make(&w, lines);
			assert_int_equal(ask(&w, CYCLE_START, 0), ANSWER_DONE);
			run_until_x(&w, WALL);
			assert_int_equal(ask(&w, CYCLE_HOLD, 0), ANSWER_DONE);
			stands(&w);
			assert_int_equal(ask(&w, ways[i], i ? -1 : 0.9),
					 ANSWER_DONE);
			run_for(&w, 0.05);
			assert_true(w.cycle.hold.moving);
			assert_int_equal(ask(&w, CYCLE_ESTOP, 0), ANSWER_DONE);
			run_for(&w, 1);
			assert_int_equal(w.cycle.state, STATE_FAULT);
			assert_false(cycle_moves(&w.cycle));
			assert_int_equal(w.cycle.fault.latched,
					 fault_bit(FAULT_ESTOP));
			world_free(&w);
		}
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_fault_ends_a_way_by_command),
		cmocka_unit_test(every_stop_has_a_way_out_by_every_verb),
		cmocka_unit_test(an_axis_blocked_before_its_path_turns_is_met_before_that),
		cmocka_unit_test(a_way_back_that_was_held_ends_before_a_retract),
		cmocka_unit_test(an_axis_that_springs_back_is_met_on_a_shallow_path),
		cmocka_unit_test(an_axis_that_was_not_blocked_takes_nobody_back),
		cmocka_unit_test(an_axis_that_was_moved_far_by_hand_is_not_driven_back),
		cmocka_unit_test(without_power_a_verb_is_refused_and_its_return_starts_nothing),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
