/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_guards.c - which fault is found in which state, and how each verb is
 * answered
 *
 * This is the whole table: each cause of a fault that comes from outside, in
 * each state, and each verb while the cause is there.
 */
#include "plc_help.h"

#include "fault.h"
#include "path/walk.h"

/* -- The states ----------------------------------------------------------- */

/* In the order of the columns below. */
enum where {
	IN_IDLE, IN_TRAVEL, IN_APPROACH, IN_ERODE, IN_RETRACT, IN_JUMP, IN_HOLD,
	WALKING_BACK, STEPPING, IN_JOG, IN_HOME, IN_PROBE, NWHERE
};

static const char *const where_name[NWHERE] = {
	"idle", "travel", "approach", "erode", "retract", "jump", "hold",
	"walking back", "stepping", "jog", "home", "probe",
};

#define EACH_WHERE(w) \
	for (enum where w = IN_IDLE; w < NWHERE; w++)

static struct cycle_config all_config(void)
{
	struct cycle_config k = usual_config();

	k.jump.height_mm = 0.5;
	k.probe = (struct probe_config) { .feed_mm_s = 1, .fine_mm_s = 0.5,
					  .back_mm = 0.1, .settle.cycles = 5 };
	for (int i = 0; i < 3; i++)
		k.axis[i] = (struct manual_axis) {
			.present = true, .method = HOME_SWITCH,
			.pulse_mm = PULSE_MM, .v_max_mm_s = 50,
			.a_max_mm_s2 = 1000, .j_max_mm_s3 = 20000,
			.jog_mm_s = 20, .home_toward = -1,
			.home_fast_mm_s = 20, .home_slow_mm_s = 1,
			.home_back_mm = 0.5,
		};
	return k;
}

static enum cycle_answer ask(struct rig *r, enum cycle_verb v)
{
	static const double args[CYCLE_NVERBS] = {
		[CYCLE_RETRACT] = 0.5, [CYCLE_OVERRIDE] = 1,
		[CYCLE_STEP] = -1, [CYCLE_JOG] = 5, [CYCLE_JOG_ON] = 5,
	};
	const struct cycle_command m = {
		.verb = v, .arg_mm = args[v],
		.arg = v == CYCLE_SET ? (uint32_t)INTERP_TECH_SERVO_V :
		       v == CYCLE_JOG_ON ? VERB_PRESS_BEGINS | 1u << 8 : 0,
	};

	return cycle_command(&r->c, &m);
}

static void to_probe(struct interp_build *b)
{
	const struct interp_build_word w = {
		.line = 1, .rapid = true, .ends = INTERP_SEG_PROBE,
	};
	double end[INTERP_NAXES] = { [INTERP_X] = -10 };
	struct interp_diag d;

	assert_int_equal(interp_build_line(b, end, &w, &d), 0);
}

static void to_cut(struct interp_build *b)
{
	rapid_to(b, -1);
	rapid_to(b, -2);
	cut_to(b, -5);
}

static bool has_job(enum where w)
{
	return w != IN_IDLE && w != IN_JOG && w != IN_HOME;
}

static void begin_rig(struct rig *r, enum where w)
{
	const struct cycle_config k = all_config();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);

	if (w == IN_PROBE)
		to_probe(b);
	else
		to_cut(b);
	rig_load(r, b, &k);
	r->in.plc = well();
	step(r, OPEN_V);
	if (!has_job(w)) {
		tell(r, CYCLE_STOP);
		until(r, STATE_IDLE, OPEN_V, 10);
	} else {
		assert_int_equal(ask(r, CYCLE_START), ANSWER_DONE);
	}
}

static void hold_there(struct rig *r)
{
	cut_until(r, 3);
	tell(r, CYCLE_HOLD);
	steps(r, OPEN_V, 200);
	assert_true(r->c.state == STATE_HOLD && !cycle_moves(&r->c));
}

static void walk_back(struct rig *r, enum cycle_verb v)
{
	hold_there(r);
	assert_int_equal(ask(r, v), ANSWER_DONE);
	steps(r, OPEN_V, 20);
	assert_true(r->c.hold.moving);
}

static void by_hand(struct rig *r, enum cycle_verb v)
{
	assert_int_equal(ask(r, v), ANSWER_DONE);
	steps(r, OPEN_V, 50);
}

/* The row at work, for who has to mend one. */
static enum where where_now;
static const char *cause_now = "";
static int verb_now = -1;

static int tell_row(void **st)
{
	(void)st;
	print_message("    last: %s, %s, verb %d\n", where_name[where_now],
		      cause_now, verb_now);
	return 0;
}

static void drive_to(struct rig *r, enum where w)
{
	static const enum cycle_state states[NWHERE] = {
		STATE_IDLE, STATE_TRAVEL, STATE_APPROACH, STATE_ERODE,
		STATE_RETRACT, STATE_JUMP, STATE_HOLD, STATE_HOLD, STATE_HOLD,
		STATE_JOG, STATE_HOME, STATE_PROBE,
	};
	const double volt = w == IN_RETRACT ? SHORTED_V :
			    w == IN_APPROACH || w == IN_PROBE ? OPEN_V :
			    SPARKING_V;

	where_now = w;
	begin_rig(r, w);
	if (w == IN_TRAVEL)
		steps(r, OPEN_V, 20);
	else if (w == IN_RETRACT)
		cut_until(r, 3);
	else if (w == IN_HOLD)
		hold_there(r);
	else if (w == WALKING_BACK || w == STEPPING)
		walk_back(r, w == STEPPING ? CYCLE_STEP : CYCLE_RETRACT);
	else if (w == IN_JOG || w == IN_HOME)
		by_hand(r, w == IN_JOG ? CYCLE_JOG : CYCLE_HOME);
	else if (w == IN_PROBE)
		steps(r, OPEN_V, 200);
	until(r, states[w], volt, 2000);
	r->c.out.enable = true;
	assert_int_equal(r->c.fault.first, FAULT_NONE);
}

/* -- The causes ----------------------------------------------------------- */

enum kind {
	STAYS,			/* not reset while it is there */
	AT_DRIVES,		/* reset by the drives, then here */
	FORBIDS_MOTION,		/* reset, but nothing moves */
	FORBIDS_POWER,		/* reset, and moves, but does not spark */
	IS_PAST,		/* it happened; reset ends it */
};

struct cause {
	const char *name;
	enum cycle_fault fault;
	enum kind kind;
	const char *at;		/* a column: E ends at once, B brakes, . none */
	void (*put)(struct rig *r);
};

#define PUT(name, what) \
	static void name(struct rig *r) { what; }

PUT(estop, r->in.estop = true)
PUT(estop_told, tell(r, CYCLE_ESTOP))
PUT(lost, r->in.lost = true)
PUT(drive, r->in.trouble = IO_DRIVE)
PUT(following, r->in.trouble = IO_FOLLOWING)
PUT(bus, r->in.trouble = IO_BUS)
PUT(fire, r->in.plc.no_fire = false)
PUT(door, r->in.door_open = true)
PUT(gap, r->in.gap_valid = false)
PUT(level, r->in.dielectric_low = true)
PUT(plc_lost, r->in.plc.alive = false)
PUT(plc_permit, r->in.plc.permit = false)
PUT(plc_door, r->in.plc.door_closed = false)
PUT(plc_level, r->in.plc.level_ok = false)
PUT(plc_temperature, r->in.plc.temperature_ok = false)
PUT(overrun, cycle_overrun(&r->c, 10))
PUT(limit, r->in.limit = 1u << INTERP_Z)

/* clang-format off */
static const struct cause causes[] = {
	/*					 idle travel approach erode
	 *					 retract jump hold back
	 *					 step jog home probe */
	{ "e-stop", FAULT_ESTOP, STAYS,		"EEEEEEEEEEEE", estop },
	{ "estop told", FAULT_ESTOP, IS_PAST,	"EEEEEEEEEEEE", estop_told },
	{ "io-lost", FAULT_IO_LOST, STAYS,	"EEEEEEEEEEEE", lost },
	{ "drive", FAULT_DRIVE, AT_DRIVES,	"EEEEEEEEEEEE", drive },
	{ "following", FAULT_FOLLOWING, AT_DRIVES, "EEEEEEEEEEEE", following },
	{ "bus", FAULT_BUS, AT_DRIVES,		"EEEEEEEEEEEE", bus },
	{ "fire", FAULT_FIRE, STAYS,		"BBBBBBBBBBBB", fire },
	{ "door", FAULT_DOOR, FORBIDS_MOTION,	".BBBBB.BBBBB", door },
	{ "gap", FAULT_GAP_LOST, FORBIDS_MOTION, ".BBBBB.BBBBB", gap },
	{ "plc", FAULT_PLC_LOST, FORBIDS_MOTION, ".BBBBB.BBBBB", plc_lost },
	{ "permit", FAULT_PERMIT, FORBIDS_MOTION, ".BBBBB.BBBBB", plc_permit },
	{ "plc door", FAULT_DOOR, FORBIDS_MOTION, ".BBBBB.BBBBB", plc_door },
	{ "plc level", FAULT_DIELECTRIC, FORBIDS_MOTION,
						".BBBBB.BBBBB", plc_level },
	{ "warm", FAULT_TEMPERATURE, FORBIDS_MOTION,
						".BBBBB.BBBBB",
						plc_temperature },
	{ "level", FAULT_DIELECTRIC, FORBIDS_POWER, "..BB........", level },
	{ "overrun", FAULT_OVERRUN, IS_PAST,	".EEEEE.EEEEE", overrun },
	{ "limit", FAULT_LIMIT_SWITCH, IS_PAST,	".EEEEE.EEEEE", limit },
};

/* While the cause is there: with a job and without one, in state fault; and
 * after a reset, where nothing may move: SEEN is its fault. */
static const struct verb_row {
	enum cycle_verb verb;
	enum cycle_answer job, none;
	enum cycle_answer held, idle;
} verb_rows[] = {
	{ CYCLE_START,	ANSWER_WRONG_STATE,	ANSWER_NO_PROGRAM,
			ANSWER_SEEN,		ANSWER_NO_PROGRAM },
	{ CYCLE_RESUME,	ANSWER_WRONG_STATE,	ANSWER_NO_PROGRAM,
			ANSWER_SEEN,		ANSWER_NO_PROGRAM },
	{ CYCLE_HOLD,	ANSWER_WRONG_STATE,	ANSWER_NO_PROGRAM,
			ANSWER_DONE,		ANSWER_NO_PROGRAM },
	{ CYCLE_STOP,	ANSWER_DONE,		ANSWER_NO_PROGRAM,
			ANSWER_DONE,		ANSWER_NO_PROGRAM },
	{ CYCLE_RETRACT, ANSWER_WRONG_STATE,	ANSWER_NO_PROGRAM,
			ANSWER_SEEN,		ANSWER_NO_PROGRAM },
	{ CYCLE_STEP,	ANSWER_WRONG_STATE,	ANSWER_NO_PROGRAM,
			ANSWER_SEEN,		ANSWER_NO_PROGRAM },
	{ CYCLE_JOG,	ANSWER_WRONG_STATE,	ANSWER_WRONG_STATE,
			ANSWER_SEEN,		ANSWER_SEEN },
	{ CYCLE_HOME,	ANSWER_WRONG_STATE,	ANSWER_WRONG_STATE,
			ANSWER_SEEN,		ANSWER_SEEN },
	{ CYCLE_JOG_ON,	ANSWER_WRONG_STATE,	ANSWER_WRONG_STATE,
			ANSWER_SEEN,		ANSWER_SEEN },
	{ CYCLE_ESTOP,	ANSWER_DONE,		ANSWER_DONE,
			ANSWER_DONE,		ANSWER_DONE },
	{ CYCLE_OVERRIDE, ANSWER_DONE,		ANSWER_DONE,
			ANSWER_DONE,		ANSWER_DONE },
};
/* clang-format on */

#define NCAUSES		(sizeof(causes) / sizeof(causes[0]))
#define EACH_CAUSE(k)	for (const struct cause *k = causes; \
			     k < causes + NCAUSES; k++)
#define EACH_VERB(v)	for (const struct verb_row *v = verb_rows; \
			     v < verb_rows + sizeof(verb_rows) / \
					     sizeof(verb_rows[0]); v++)

static void put(struct rig *r, const struct cause *k)
{
	cause_now = k->name;
	k->put(r);
}

/* -- What must hold whatever is asked for --------------------------------- */

static bool drives_may_have_power(const struct cause *k)
{
	return !fault_table[k->fault].disables || k->kind == IS_PAST;
}

/* The cause is there all the time: nothing sparks, nothing moves. */
static void nothing_comes(struct rig *r, const struct cause *k, int n)
{
	int32_t at[INTERP_NAXES];

	memcpy(at, r->c.out.target, sizeof(at));
	while (n-- > 0) {
		step(r, OPEN_V);
		assert_false(r->out.power);
		assert_memory_equal(at, r->c.out.target, sizeof(at));
		if (!drives_may_have_power(k))
			assert_false(r->out.enable);
	}
}

static void stands_in_fault(struct rig *r, const struct cause *k)
{
	for (int i = 0; r->c.state != STATE_FAULT && i < 2000; i++) {
		step(r, OPEN_V);
		assert_false(r->out.power);
	}
	assert_int_equal(r->c.state, STATE_FAULT);
	assert_true(fault_is_latched(&r->c.fault, k->fault));
}

/* -- States and causes ---------------------------------------------------- */

static void check_reaction(struct rig *r, const struct cause *k, char want)
{
	if (want == '.') {
		assert_true(r->c.fault.latched == 0);
		assert_true(r->out.enable);
		return;
	}
	assert_true(r->c.fault.latched == fault_bit(k->fault));
	assert_true(r->c.fault.untold == fault_bit(k->fault));
	assert_false(r->out.power);
	assert_int_equal(r->out.enable, !fault_table[k->fault].disables);
	if (want == 'E') {
		assert_int_equal(r->c.state, STATE_FAULT);
		assert_memory_equal(r->c.out.target, r->path_before,
				    sizeof(r->path_before));
	}
	stands_in_fault(r, k);
}

static void each_cause_is_a_fault_where_the_table_says_so(void **st)
{
	(void)st;
	EACH_CAUSE(k) {
		assert_int_equal(strlen(k->at), NWHERE);
		EACH_WHERE(w) {
			struct rig r;

			drive_to(&r, w);
			put(&r, k);
			step(&r, w == IN_RETRACT ? SHORTED_V : SPARKING_V);
			check_reaction(&r, k, k->at[w]);
			rig_free(&r);
		}
	}
}

/* -- Verbs ---------------------------------------------------------------- */

static void into_fault(struct rig *r, enum where w, const struct cause *k)
{
	drive_to(r, w);
	put(r, k);
	step(r, OPEN_V);
	stands_in_fault(r, k);
}

static void ask_in_fault(enum where w, const struct cause *k,
			 const struct verb_row *v)
{
	const bool is_loaded = has_job(w);
	struct rig r;

	into_fault(&r, w, k);
	verb_now = (int)v->verb;
	assert_int_equal(ask(&r, v->verb), is_loaded ? v->job : v->none);
	nothing_comes(&r, k, 20);
	assert_int_equal(r.c.state, STATE_FAULT);
	assert_true(fault_is_latched(&r.c.fault, k->fault));
	rig_free(&r);
}

static void no_verb_moves_a_machine_in_fault(void **st)
{
	(void)st;
	EACH_CAUSE(k)
		EACH_WHERE(w) {
			if (k->at[w] == '.')
				continue;
			EACH_VERB(v)
				ask_in_fault(w, k, v);
		}
}

static bool is_cleared(const struct rig *r, enum where w)
{
	return r->c.fault.latched == 0 &&
	       r->c.state == (has_job(w) ? STATE_HOLD : STATE_IDLE);
}

static void a_reset_clears_nothing_that_is_still_there(void **st)
{
	(void)st;
	EACH_CAUSE(k)
		EACH_WHERE(w) {
			const bool remains = k->kind == STAYS ||
					     k->kind == AT_DRIVES;
			struct rig r;

			if (k->at[w] == '.')
				continue;
			into_fault(&r, w, k);
			assert_int_equal(ask(&r, CYCLE_RESET),
					 k->kind == STAYS ?
					 ANSWER_STILL_THERE : ANSWER_DONE);
			nothing_comes(&r, k, 10);
			assert_int_equal(is_cleared(&r, w), !remains);
			/* Gone, it waits for a reset, but for the drives'. */
			r.in = (struct io_inputs) { .gap_valid = true };
			r.in.plc = well();
			nothing_comes(&r, k, 10);
			assert_int_equal(is_cleared(&r, w), !remains);
			if (remains)
				assert_int_equal(ask(&r, CYCLE_RESET),
						 ANSWER_DONE);
			nothing_comes(&r, k, 3);
			assert_true(is_cleared(&r, w));
			rig_free(&r);
		}
}

static void nothing_begins_where_motion_is_forbidden(void **st)
{
	(void)st;
	EACH_CAUSE(k)
		EACH_WHERE(w)
			EACH_VERB(v) {
				enum cycle_answer want = has_job(w) ?
							 v->held : v->idle;
				struct rig r;

				if (want == ANSWER_SEEN)
					want += k->fault;
				if (k->kind != FORBIDS_MOTION ||
				    k->at[w] == '.')
					continue;
				into_fault(&r, w, k);
				assert_int_equal(ask(&r, CYCLE_RESET),
						 ANSWER_DONE);
				step(&r, OPEN_V);
				assert_int_equal(ask(&r, v->verb), want);
				nothing_comes(&r, k, 20);
				rig_free(&r);
			}
}

/* -- Two at a time -------------------------------------------------------- */

/* Whatever is latched already, and wherever it stands for that. */
static void what_counts_always_is_heard_in_a_fault_too(void **st)
{
	(void)st;
	EACH_CAUSE(k)
		EACH_CAUSE(l) {
			const uint64_t both = fault_bit(k->fault) |
					      fault_bit(l->fault);
			struct rig r;

			/* One input says one thing at a time, and a PLC that
			 * is gone nothing. */
			if (l->at[IN_HOLD] == '.' || l->fault == k->fault ||
			    (k->fault == FAULT_PLC_LOST &&
			     l->fault == FAULT_FIRE) ||
			    (k->kind == AT_DRIVES && l->kind == AT_DRIVES))
				continue;
			into_fault(&r, IN_ERODE, k);
			r.c.fault.untold = 0;
			put(&r, l);
			step(&r, OPEN_V);
			assert_true(r.c.fault.latched == both);
			assert_true(r.c.fault.untold == fault_bit(l->fault));
			assert_int_equal(r.c.fault.first, k->fault);
			if (fault_table[l->fault].disables)
				assert_false(r.out.enable);
			if (l->kind == STAYS)
				assert_int_equal(ask(&r, CYCLE_RESET),
						 ANSWER_STILL_THERE);
			nothing_comes(&r, l, 5);
			if (l->kind != IS_PAST)
				assert_true(r.c.fault.latched == both);
			rig_free(&r);
		}
}

static void one_that_ends_the_motion_ends_braking_too(void **st)
{
	(void)st;
	EACH_CAUSE(k)
		EACH_CAUSE(l) {
			struct rig r;

			if (k->at[IN_TRAVEL] != 'B' || l->at[IN_TRAVEL] != 'E')
				continue;
			drive_to(&r, IN_TRAVEL);
			put(&r, k);
			steps(&r, OPEN_V, 3);
			assert_int_equal(r.c.state, STATE_HOLD);
			assert_true(r.c.feed_mm_s > 0);
			put(&r, l);
			step(&r, OPEN_V);
			assert_int_equal(r.c.state, STATE_FAULT);
			assert_memory_equal(r.c.out.target, r.path_before,
					    sizeof(r.path_before));
			rig_free(&r);
		}
}

/* -- Before the first spark ----------------------------------------------- */

static void no_spark_is_made_where_it_is_forbidden(void **st)
{
	(void)st;
	EACH_CAUSE(k) {
		struct rig r;

		if (k->at[IN_APPROACH] == '.' || k->kind == IS_PAST)
			continue;
		drive_to(&r, IN_TRAVEL);
		while (walk_ahead(&r.c) != AHEAD_CUT)
			step(&r, OPEN_V);
		put(&r, k);
		stands_in_fault(&r, k);
		rig_free(&r);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_teardown(
			each_cause_is_a_fault_where_the_table_says_so,
			tell_row),
		cmocka_unit_test_teardown(
			no_verb_moves_a_machine_in_fault, tell_row),
		cmocka_unit_test_teardown(
			a_reset_clears_nothing_that_is_still_there, tell_row),
		cmocka_unit_test_teardown(
			nothing_begins_where_motion_is_forbidden, tell_row),
		cmocka_unit_test_teardown(
			what_counts_always_is_heard_in_a_fault_too, tell_row),
		cmocka_unit_test_teardown(
			one_that_ends_the_motion_ends_braking_too, tell_row),
		cmocka_unit_test_teardown(
			no_spark_is_made_where_it_is_forbidden, tell_row),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
