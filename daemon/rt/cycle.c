/* SPDX-License-Identifier: Apache-2.0 */
/*
 * cycle.c - one period: gap, guard, state, distance, walk, outputs
 */
#include "cycle.h"
#include "feed.h"
#include "laws.h"
#include "step.h"
#include "timed.h"
#include "walk.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

static const char *const faults[CYCLE_NFAULTS] = {
	[FAULT_NONE]			= "none",
	[FAULT_ESTOP]			= "e-stop",
	[FAULT_SHORT_NOT_CLEARED]	= "short-not-cleared",
	[FAULT_GAP_LOST]		= "gap-lost",
	[FAULT_IO_LOST]			= "io-lost",
	[FAULT_CONTACT]			= "contact",
	[FAULT_SOFT_LIMIT]		= "soft-limit",
	[FAULT_PROGRAM]			= "program",
	[FAULT_OVERRUN]			= "overrun",
	[FAULT_RETRACT_AT_START]	= "retract-at-start",
	[FAULT_RETRACT_TIME]		= "retract-time",
	[FAULT_RETRACT_COUNT]		= "retract-count",
	[FAULT_ARCING]			= "arcing",
	[FAULT_WIRE_BROKEN]		= "wire-broken",
	[FAULT_GAP_STUCK]		= "gap-stuck",
	[FAULT_LIMIT_SWITCH]		= "limit-switch",
	[FAULT_DOOR]			= "door",
	[FAULT_DIELECTRIC]		= "dielectric",
	[FAULT_HOME]			= "home-not-found",
	[FAULT_NO_CONTACT]		= "no-contact",
	[FAULT_DRIVE]			= "drive",
	[FAULT_FOLLOWING]		= "following",
	[FAULT_BUS]			= "bus",
	[FAULT_PLC_LOST]		= "plc-lost",
	[FAULT_PERMIT]			= "permit",
	[FAULT_TEMPERATURE]		= "temperature",
	[FAULT_FIRE]			= "fire",
	[FAULT_MCODE]			= "m-code",
};

static const char *const outcomes[] = {
	[OUTCOME_NONE]		= "none",
	[OUTCOME_DONE]		= "done",
	[OUTCOME_FAULT]		= "fault",
	[OUTCOME_STOPPED]	= "stopped",
};

static const char *const answers[CYCLE_NANSWERS] = {
	[ANSWER_DONE]		= "done",
	[ANSWER_NO_PROGRAM]	= "no program is loaded",
	[ANSWER_WRONG_STATE]	= "not possible in this state",
	[ANSWER_BAD_ARGUMENT]	= "argument out of range",
	[ANSWER_NOT_HOMED]	= "an axis is not homed",
	[ANSWER_AT_LIMIT]	= "an axis is on its limit switch",
	[ANSWER_BEYOND]		= "outside the travel",
	[ANSWER_NO_NODE]	= "no such node on the path",
	[ANSWER_NOT_PASSED]	= "the path there was not passed before",
	[ANSWER_ELSEWHERE]	= "the program begins elsewhere",
	[ANSWER_NOT_UP]		= "the drives are not up yet",
	[ANSWER_LOCKED]		= "the PLC does not permit it",
};

const char *cycle_fault_name(enum cycle_fault f)
{
	return f < CYCLE_NFAULTS ? faults[f] : "?";
}

const char *cycle_outcome_name(enum cycle_outcome o)
{
	return o <= OUTCOME_STOPPED ? outcomes[o] : "?";
}

const char *cycle_answer_text(enum cycle_answer a)
{
	return a < CYCLE_NANSWERS ? answers[a] : "?";
}

void cycle_init(struct cycle *c, const struct cycle_config *config)
{
	*c = (struct cycle) {
		.config = *config,
		.gap = config->gap,
		.jump = config->jump,
		.state = STATE_IDLE,
		.after_stand = STATE_HOLD,
		.override = 1,
		.out.pulse = { NAN, NAN, NAN, NAN, false },
	};
	memcpy(c->out.target, config->start, sizeof(c->out.target));
}

/* -- States ----------------------------------------------------------------- */

/* Out by the escape, if there is one here, from a stand. */
static void leave_path(struct cycle *c)
{
	if (!escape_is_out(&c->escape) && escape_begin(c))
		mover_set(&c->mover, 0);
}

static void lift(struct cycle *c)
{
	const double height_mm = flush_begin(c);

	c->lifting = true;
	/* Beside the path it is the way out that goes on; the time waits. */
	c->leaving = timed_is_up(c) && !escape_is_out(&c->escape);
	if (c->leaving) {
		/* No further in. */
		mover_set(&c->mover, 0);
		c->jump_to_mm = c->timed_from_mm;
		return;
	}
	c->totals.jumps++;
	leave_path(c);
	c->jump_from_mm = cycle_place_mm(c);
	c->jump_to_mm = fmax(cycle_outer_mm(c), c->jump_from_mm - height_mm);
}

/* Held beside the path: back, as a jump comes back. */
static void come_back(struct cycle *c)
{
	c->lifting = false;
	c->leaving = false;
	c->jump_from_mm = interp_cursor_place_mm(&c->cursor);
	c->jump_to_mm = fmax(c->jump_from_mm - c->jump.short_of_mm,
			     cycle_place_mm(c));
}

/* What is done once, where a state is entered. */
static void enter(struct cycle *c, enum cycle_state s)
{
	const enum cycle_state from = c->state;

	/* The gap is narrower than a brake's way: what can, stops at once. */
	if ((state_duty[from].power || from == STATE_TOUCH) &&
	    (s == STATE_HOLD || s == STATE_JUMP) &&
	    c->mover.v_mm_s <= servo_dv_mm_s(c))
		mover_set(&c->mover, 0);
	c->state = s;
	c->ahead.state = STATE_STAY;
	switch (s) {
	case STATE_TRAVEL:
		servo_reset(c);
		c->free_seen = false;
		break;
	case STATE_TOUCH:
		touch_begin(c);
		break;
	case STATE_RETRACT:
		servo_reset(c);
		if (c->gap.retract_escape)
			leave_path(c);
		retract_begin(c);
		arc_met(c);
		break;
	case STATE_JUMP:
		arc_met(c);
		if (from == STATE_HOLD)
			come_back(c);
		else
			lift(c);
		break;
	case STATE_HOLD:
		axes_forget(c);
		c->moving = false;
		c->braked = false;
		c->after_stand = STATE_HOLD;
		break;
	case STATE_IDLE:
	case STATE_FAULT:
		axes_forget(c);
		mover_set(&c->mover, 0);
		mover_set(&c->hand.mover, 0);
		break;
	default:
		break;
	}
}

static void happen(struct cycle *c, enum cycle_event ev)
{
	const enum cycle_state to = state_next(c->state, ev);

	if (to != c->state)
		enter(c, to);
}

static void end_job(struct cycle *c, enum cycle_outcome o)
{
	c->outcome = o;
	c->loaded = false;
	c->escape = (struct escape) { .nlegs = 0 };
	enter(c, STATE_IDLE);
}

/* Faults in which the axes are good: brake on the path, with the power off. */
static const bool brakes[CYCLE_NFAULTS] = {
	[FAULT_SHORT_NOT_CLEARED]	= true,
	[FAULT_CONTACT]			= true,
	[FAULT_GAP_LOST]		= true,
	[FAULT_RETRACT_AT_START]	= true,
	[FAULT_RETRACT_TIME]		= true,
	[FAULT_RETRACT_COUNT]		= true,
	[FAULT_ARCING]			= true,
	[FAULT_WIRE_BROKEN]		= true,
	[FAULT_GAP_STUCK]		= true,
	[FAULT_DOOR]			= true,
	[FAULT_DIELECTRIC]		= true,
	[FAULT_NO_CONTACT]		= true,
	[FAULT_PLC_LOST]		= true,
	[FAULT_PERMIT]			= true,
	[FAULT_TEMPERATURE]		= true,
	[FAULT_FIRE]			= true,
	[FAULT_MCODE]			= true,
};

/* Faults in which an axis may not be where it is thought, or is not told. */
static const bool disables[CYCLE_NFAULTS] = {
	[FAULT_ESTOP]			= true,
	[FAULT_IO_LOST]			= true,
	[FAULT_OVERRUN]			= true,
	[FAULT_DRIVE]			= true,
	[FAULT_FOLLOWING]		= true,
	[FAULT_BUS]			= true,
};

void cycle_fail(struct cycle *c, enum cycle_fault f)
{
	const bool brake = c->loaded && brakes[f];

	/* The first one is reported; a worse one still stops at once. */
	if (c->state == STATE_FAULT || (c->fault != FAULT_NONE && brake))
		return;
	if (c->fault == FAULT_NONE)
		c->fault = f;
	c->out.enable = c->out.enable && !disables[f];
	c->outcome = c->loaded ? OUTCOME_FAULT : c->outcome;
	enter(c, brake ? STATE_HOLD : STATE_FAULT);
	c->after_stand = brake ? STATE_FAULT : STATE_HOLD;
}

/* -- Commands --------------------------------------------------------------- */

static void set_off(struct cycle *c)
{
	happen(c, escape_is_out(&c->escape) ? EVENT_RETURN : EVENT_START);
}

static enum cycle_answer do_start(struct cycle *c, double arg_mm)
{
	(void)arg_mm;
	if (!c->loaded)
		return ANSWER_NO_PROGRAM;
	if (c->state != STATE_HOLD || c->after_stand != STATE_HOLD || c->moving)
		return ANSWER_WRONG_STATE;
	if (c->limit.on)
		return ANSWER_AT_LIMIT;
	if (c->config.require_home && hand_unhomed(c))
		return ANSWER_NOT_HOMED;
	if (c->axes.starting)
		return ANSWER_NOT_UP;
	if (interlock_forbids(c))
		return ANSWER_LOCKED;
	c->outcome = OUTCOME_NONE;
	c->retract.in_row = 0;
	c->arc = (struct arc) { .rung = ARC_NONE };
	gap_forget(c);
	if (axes_want(c, true))
		set_off(c);
	return ANSWER_DONE;
}

static bool by_hand(const struct cycle *c)
{
	return c->state == STATE_JOG || c->state == STATE_HOME;
}

static enum cycle_answer do_hold(struct cycle *c, double arg_mm)
{
	(void)arg_mm;
	if (by_hand(c)) {
		c->hand.halt = true;
		return ANSWER_DONE;
	}
	if (!c->loaded)
		return ANSWER_NO_PROGRAM;
	if (c->state == STATE_FAULT)
		return ANSWER_WRONG_STATE;
	c->moving = false;
	axes_forget(c);
	happen(c, EVENT_HOLD);
	return ANSWER_DONE;
}

static enum cycle_answer do_stop(struct cycle *c, double arg_mm)
{
	if (by_hand(c))
		return do_hold(c, arg_mm);
	if (!c->loaded)
		return ANSWER_NO_PROGRAM;
	if (c->state == STATE_FAULT) {
		end_job(c, OUTCOME_STOPPED);
		c->state = STATE_FAULT;
		return ANSWER_DONE;
	}
	happen(c, EVENT_STOP);
	axes_forget(c);
	c->moving = false;
	if (c->after_stand == STATE_HOLD)
		c->after_stand = STATE_IDLE;
	return ANSWER_DONE;
}

static enum cycle_answer do_retract(struct cycle *c, double arg_mm)
{
	if (!c->loaded)
		return ANSWER_NO_PROGRAM;
	if (c->state == STATE_FAULT || c->after_stand != STATE_HOLD)
		return ANSWER_WRONG_STATE;
	if (!(arg_mm > 0 && isfinite(arg_mm)))
		return ANSWER_BAD_ARGUMENT;
	if (c->axes.starting)
		return ANSWER_NOT_UP;
	if (interlock_forbids(c))
		return ANSWER_LOCKED;
	happen(c, EVENT_HOLD);
	axes_want(c, false);
	c->moving = true;
	c->move_to_mm = fmax(cycle_outer_mm(c), cycle_place_mm(c) - arg_mm);
	return ANSWER_DONE;
}

static enum cycle_answer do_step(struct cycle *c, double arg_mm)
{
	enum cycle_answer answer;
	double to_mm;

	if (!c->loaded)
		return ANSWER_NO_PROGRAM;
	if (c->state != STATE_HOLD || c->after_stand != STATE_HOLD ||
	    c->moving || escape_is_out(&c->escape))
		return ANSWER_WRONG_STATE;
	answer = (enum cycle_answer)step_to(c, arg_mm, &to_mm);
	if (answer != ANSWER_DONE)
		return answer;
	if (c->axes.starting)
		return ANSWER_NOT_UP;
	if (interlock_forbids(c))
		return ANSWER_LOCKED;
	axes_want(c, false);
	c->moving = true;
	c->move_to_mm = to_mm;
	return ANSWER_DONE;
}

static enum cycle_answer do_estop(struct cycle *c, double arg_mm)
{
	(void)arg_mm;
	cycle_fail(c, FAULT_ESTOP);
	return ANSWER_DONE;
}

static enum cycle_answer do_reset(struct cycle *c, double arg_mm)
{
	(void)arg_mm;
	if (c->state != STATE_FAULT)
		return ANSWER_WRONG_STATE;
	c->fault = FAULT_NONE;
	c->out.reset = true;
	c->overruns_in_row = 0;
	happen(c, EVENT_RESET);
	if (!c->loaded)
		enter(c, STATE_IDLE);
	return ANSWER_DONE;
}

#define OVERRIDE_MAX	2.0

static enum cycle_answer do_override(struct cycle *c, double arg_mm)
{
	if (!(arg_mm >= 0 && arg_mm <= OVERRIDE_MAX))
		return ANSWER_BAD_ARGUMENT;
	c->override = arg_mm;
	return ANSWER_DONE;
}

static enum cycle_answer (*const verbs[CYCLE_NVERBS])(struct cycle *, double) = {
	[CYCLE_START]	= do_start,
	[CYCLE_HOLD]	= do_hold,
	[CYCLE_RESUME]	= do_start,
	[CYCLE_STOP]	= do_stop,
	[CYCLE_RETRACT]	= do_retract,
	[CYCLE_ESTOP]	= do_estop,
	[CYCLE_RESET]	= do_reset,
	[CYCLE_OVERRIDE] = do_override,
	[CYCLE_STEP]	= do_step,
};

static enum cycle_answer do_set(struct cycle *c, const struct cycle_command *m)
{
	static const enum cycle_answer answer[] = {
		[PROCESS_DONE]	= ANSWER_DONE,
		[PROCESS_BAD]	= ANSWER_BAD_ARGUMENT,
		[PROCESS_FULL]	= ANSWER_WRONG_STATE,
	};

	if (!c->loaded)
		return ANSWER_NO_PROGRAM;
	return answer[process_set(c, m->arg, m->arg_mm)];
}

static enum cycle_answer do_by_hand(struct cycle *c,
				    const struct cycle_command *m)
{
	const bool jog = m->verb == CYCLE_JOG;
	enum cycle_answer answer;

	if (c->axes.starting)
		return ANSWER_NOT_UP;
	if (interlock_forbids(c))
		return ANSWER_LOCKED;
	answer = (enum cycle_answer)(jog ?
		hand_jog(c, m->arg, m->arg_mm) : hand_home(c, m->arg));
	if (answer != ANSWER_DONE)
		return answer;
	enter(c, jog ? STATE_JOG : STATE_HOME);
	axes_want(c, false);
	return ANSWER_DONE;
}

enum cycle_answer cycle_command(struct cycle *c, const struct cycle_command *m)
{
	if (m->verb >= CYCLE_NVERBS)
		return ANSWER_BAD_ARGUMENT;
	if (m->verb == CYCLE_SET)
		return do_set(c, m);
	if (m->verb == CYCLE_JOG || m->verb == CYCLE_HOME)
		return do_by_hand(c, m);
	return verbs[m->verb](c, m->arg_mm);
}

enum cycle_answer cycle_load_at(struct cycle *c, const struct interp_cursor *at,
				double far_mm)
{
	if (c->state != STATE_IDLE)
		return ANSWER_WRONG_STATE;
	if (c->hand.used && memcmp(at->pos, c->out.target,
				   sizeof(at->pos)) != 0)
		return ANSWER_ELSEWHERE;
	c->cursor = *at;
	c->escape = (struct escape) { .nlegs = 0 };
	if (!process_begin(c))
		return ANSWER_BAD_ARGUMENT;
	c->out.path++;
	c->loaded = true;
	c->outcome = OUTCOME_NONE;
	c->totals = (struct cycle_totals) { 0 };
	c->far_mm = far_mm;
	c->action_done = at->index;
	c->flush = (struct flush) { .far_mm = far_mm };
	c->dwelling = false;
	c->timed_end = 0;
	c->back_mm = 0;
	mcode_begin(c, at->index);
	c->power_off = false;
	c->touch = (struct touch) { .phase = TOUCH_SETTLE };
	for (int i = 0; i < INTERP_NAXES; i++)
		c->out.target[i] = at->pos[i];
	enter(c, STATE_HOLD);
	return ANSWER_DONE;
}

enum cycle_answer cycle_load(struct cycle *c, const struct interp_program *p)
{
	struct interp_cursor at;

	if (c->state != STATE_IDLE)
		return ANSWER_WRONG_STATE;
	if (interp_cursor_init(&at, p) < 0)
		return ANSWER_BAD_ARGUMENT;
	return cycle_load_at(c, &at, 0);
}

void cycle_overrun(struct cycle *c, uint32_t missed)
{
	c->totals.overruns += missed;
	c->overruns_in_row += missed;
	c->overran = true;
	if (c->config.overrun_limit && state_duty[c->state].running &&
	    c->overruns_in_row >= c->config.overrun_limit)
		cycle_fail(c, FAULT_OVERRUN);
}

/* -- One period -------------------------------------------------------------- */

/* Away from the break, and held there.  Nothing is cut with a broken wire. */
static void watch_wire(struct cycle *c)
{
	const double back = c->gap.wire_retreat_mm;

	if (c->gap.process != PROCESS_WIRE)
		return;
	if (c->state == STATE_TRAVEL && walk_ahead(c) == AHEAD_CUT)
		cycle_fail(c, FAULT_WIRE_BROKEN);
	if (!state_duty[c->state].power && c->state != STATE_RETRACT)
		return;
	c->move_to_mm = back > 0 ? fmax(cycle_outer_mm(c),
					law_place(c) - back) :
				   retract_motion_mm(c);
	cycle_fail(c, FAULT_WIRE_BROKEN);
	c->moving = c->state == STATE_HOLD;
}

static void guard_switches(struct cycle *c, const struct io_inputs *in)
{
	limit_guard(c, in);
	if (in->door_open && state_duty[c->state].running)
		cycle_fail(c, FAULT_DOOR);
	if (in->dielectric_low && state_duty[c->state].power)
		cycle_fail(c, FAULT_DIELECTRIC);
}

static void guard(struct cycle *c, const struct io_inputs *in)
{
	const bool power = state_duty[c->state].power;

	if (in->estop)
		cycle_fail(c, FAULT_ESTOP);
	if (in->lost)
		cycle_fail(c, FAULT_IO_LOST);
	axes_guard(c, in);
	interlock_guard(c, in);
	mcode_hear(c);
	if (in->wire_broken || (in->plc.alive && !in->plc.wire_whole))
		watch_wire(c);
	if ((!c->sensed.valid && power) || touch_is_blind(c, in))
		cycle_fail(c, FAULT_GAP_LOST);
	if (c->sensed.suspect && power)
		cycle_fail(c, FAULT_GAP_STUCK);
	if (state_duty[c->state].power)
		arc_watch(c);
	guard_switches(c, in);
	c->busy = in->busy;
}

/* Over ground it has passed before, only the gap's own window is the cut. */
static enum cycle_event look_in(const struct cycle *c)
{
	const bool known = law_place(c) < c->far_mm - LAW_ONTO_MM;

	if (known && c->sensed.now_v > gap_window_high_v(c))
		return EVENT_NONE;
	return c->sensed.is_open ? EVENT_OPEN : EVENT_SPARK;
}

/* What this cycle's gap and place mean to the state; at most one thing. */
static enum cycle_event look(struct cycle *c)
{
	const bool powered = state_duty[c->state].power;

	if (powered && c->sensed.is_short)
		return EVENT_SHORT;
	if (powered && !escape_is_out(&c->escape) &&
	    (walk_ahead(c) == AHEAD_FREE || walk_ahead(c) == AHEAD_TOUCH))
		return EVENT_FREE;
	if (powered && arc_retract_due(c))
		return EVENT_ARC;
	if (powered && !escape_is_out(&c->escape) && timed_is_up(c))
		return EVENT_TIME_UP;
	switch (c->state) {
	case STATE_APPROACH:
		return look_in(c);
	case STATE_ERODE:
		return flush_due(c) ? EVENT_JUMP_DUE : EVENT_NONE;
	case STATE_TRAVEL:
		return walk_ahead(c) == AHEAD_CUT ? EVENT_CUT :
		       walk_ahead(c) == AHEAD_TOUCH ? EVENT_TOUCH : EVENT_NONE;
	case STATE_RETRACT:
		return retract_is_clear(c) ? EVENT_CLEAR : EVENT_NONE;
	case STATE_JUMP:
		return !c->lifting && c->sensed.touch ? EVENT_SHORT :
							EVENT_NONE;
	default:
		return EVENT_NONE;
	}
}

/*
 * A short while positioning is a collision, once the gap has been open: on the
 * way out of a cut, debris may still bridge it.
 */
static void watch_contact(struct cycle *c)
{
	if (c->state != STATE_TRAVEL || c->config.dry_run)
		return;
	if (c->sensed.touch && c->free_seen)
		cycle_fail(c, FAULT_CONTACT);
	c->free_seen = c->free_seen || c->sensed.is_open;
}

static void stand(struct cycle *c)
{
	if (c->state != STATE_HOLD || c->moving || c->mover.v_mm_s != 0)
		return;
	if (c->after_stand == STATE_FAULT)
		enter(c, STATE_FAULT);
	else if (c->after_stand == STATE_IDLE)
		end_job(c, OUTCOME_STOPPED);
}

static void stand_held(struct cycle *c)
{
	happen(c, EVENT_HOLD);
	mover_set(&c->mover, 0);
}

/* What is held does nothing more: it stands in front of the action. */
static void meet_action(struct cycle *c)
{
	if (c->state == STATE_HOLD) {
		mover_set(&c->mover, 0);
		c->moving = false;
		return;
	}
	switch (walk_action(c)) {
	case ACTION_WAIT:
		happen(c, EVENT_FREE);
		mover_set(&c->mover, 0);
		break;
	case ACTION_HOLD:
		stand_held(c);
		break;
	case ACTION_END:
		if (c->config.hold_at_end)
			stand_held(c);
		else
			end_job(c, OUTCOME_DONE);
		break;
	default:
		break;
	}
}

/* Beside the path no segment ends and nothing is to be done. */
static enum walk_result walk_on(struct cycle *c, double ds_mm)
{
	const double behind = c->back_mm - interp_cursor_place_mm(&c->cursor);
	enum walk_result r;

	if (escape_is_out(&c->escape))
		return escape_by(c, ds_mm) ? WALK_ON : WALK_START;
	if (ds_mm >= 0 || ds_mm > behind || c->back_mm <= 0)
		return walk_by(c, ds_mm);
	r = walk_by(c, fmin(behind, 0));
	return r == WALK_ON ? WALK_START : r;
}

static void go(struct cycle *c)
{
	const enum walk_result r = walk_on(c, feed_distance(c));

	c->at_start = r == WALK_START;
	if (r == WALK_BROKEN)
		cycle_fail(c, FAULT_PROGRAM);
	else if (r == WALK_BEYOND)
		cycle_fail(c, c->state == STATE_TOUCH ? FAULT_NO_CONTACT :
							FAULT_SOFT_LIMIT);
	else if (r == WALK_ACTION)
		meet_action(c);
	mcode_follow(c);
	if (c->loaded && !process_follow(c))
		cycle_fail(c, FAULT_PROGRAM);
	if (feed_done(c)) {
		if (c->leaving)
			timed_skip(c);
		happen(c, EVENT_MOVE_DONE);
	}
}

static void sum_up(struct cycle *c, bool running)
{
	if (running) {
		c->totals.cycles++;
		timed_count(c);
	}
	if (c->state == STATE_ERODE)
		c->totals.erode_cycles++;
	if (c->state == STATE_JUMP)
		c->totals.jump_cycles++;
	flush_watch(c);
}

static void give(struct cycle *c, struct io_outputs *out)
{
	/* M5 is heeded in its own cycle, and in a way back that it met. */
	c->out.power = state_duty[c->state].power && !c->power_off;
	c->out.sense = c->state == STATE_TOUCH;
	if (c->loaded) {
		const struct interp_cond *cond =
			&c->cursor.p.conds[c->cursor.seg.cond];

		c->out.place_mm = interp_cursor_place_mm(&c->cursor);
		c->out.off_path_mm = c->escape.way_mm;
		c->out.rapid = c->state == STATE_TRAVEL ||
			       c->state == STATE_TOUCH;
		c->out.cond_letter = cond->letter;
		c->out.cond_number = cond->number;
	}
	c->given = c->out;
	comp_apply(&c->comp, c->config.comp, c->out.target,
		   c->state == STATE_FAULT || c->busy, c->config.points_max,
		   c->given.target);
	c->given.pulse.off_us = arc_off_us(c);
	*out = c->given;
	c->out.reset = false;
}

/* Without a program. */
static void go_by_hand(struct cycle *c, const struct io_inputs *in)
{
	c->feed_mm_s = 0;
	if (by_hand(c) && hand_go(c, in))
		enter(c, STATE_IDLE);
}

/* Held until the axes are under power and on their places. */
static bool may_move(struct cycle *c)
{
	const enum axes_await a = axes_await(c);

	if (a == AXES_START)
		set_off(c);
	if (c->axes.start)
		c->totals.cycles++;
	return a != AXES_AWAITED;
}

void cycle_step(struct cycle *c, const struct io_inputs *in,
		struct io_outputs *out)
{
	const bool running = state_duty[c->state].running;
	bool moves;

	c->count++;
	gap_sense(c, in);
	touch_sense(c, in);
	guard(c, in);
	moves = c->state != STATE_FAULT && may_move(c);
	if (c->loaded && moves) {
		happen(c, look(c));
		watch_contact(c);
		step_watch(c);
		go(c);
		retract_watch(c);
		stand(c);
		sum_up(c, running);
	} else if (moves) {
		go_by_hand(c, in);
	} else {
		c->feed_mm_s = 0;
	}
	limit_watch(c);
	if (!c->overran)
		c->overruns_in_row = 0;
	c->overran = false;
	give(c, out);
}
