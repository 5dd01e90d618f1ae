/* SPDX-License-Identifier: Apache-2.0 */
/*
 * cycle.c - one period: guard, gap, state, distance, walk, outputs
 */
#include "cycle.h"
#include "feed.h"
#include "walk.h"

#include <math.h>
#include <stddef.h>

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
		.state = STATE_IDLE,
		.after_stand = STATE_HOLD,
	};
}

/* -- States ----------------------------------------------------------------- */

/* What is done once, where a state is entered. */
static void enter(struct cycle *c, enum cycle_state s)
{
	c->state = s;
	switch (s) {
	case STATE_TRAVEL:
		c->free_seen = false;
		c->ahead = (struct cycle_ahead) { 0 };
		break;
	case STATE_RETRACT:
		c->totals.retracts++;
		c->retract_from_mm = interp_cursor_place_mm(&c->cursor);
		c->retract_waited = 0;
		break;
	case STATE_JUMP:
		c->totals.jumps++;
		c->since_jump = 0;
		c->lifting = true;
		c->jump_from_mm = interp_cursor_place_mm(&c->cursor);
		c->jump_to_mm = fmax(0, c->jump_from_mm -
					c->config.jump.height_mm);
		break;
	case STATE_HOLD:
		c->moving = false;
		c->after_stand = STATE_HOLD;
		break;
	case STATE_IDLE:
	case STATE_FAULT:
		mover_set(&c->mover, 0);
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
	enter(c, STATE_IDLE);
}

/* Faults in which the axes are good: brake on the path, with the power off. */
static const bool brakes[CYCLE_NFAULTS] = {
	[FAULT_SHORT_NOT_CLEARED]	= true,
	[FAULT_CONTACT]			= true,
	[FAULT_GAP_LOST]		= true,
};

void cycle_fail(struct cycle *c, enum cycle_fault f)
{
	/* The first one is reported; a worse one still stops at once. */
	if (c->state == STATE_FAULT || (c->fault != FAULT_NONE && brakes[f]))
		return;
	if (c->fault == FAULT_NONE)
		c->fault = f;
	c->outcome = c->loaded ? OUTCOME_FAULT : c->outcome;
	enter(c, brakes[f] ? STATE_HOLD : STATE_FAULT);
	c->after_stand = brakes[f] ? STATE_FAULT : STATE_HOLD;
}

/* -- Commands --------------------------------------------------------------- */

static enum cycle_answer do_start(struct cycle *c, double arg_mm)
{
	(void)arg_mm;
	if (!c->loaded)
		return ANSWER_NO_PROGRAM;
	if (c->state != STATE_HOLD || c->after_stand != STATE_HOLD || c->moving)
		return ANSWER_WRONG_STATE;
	c->outcome = OUTCOME_NONE;
	happen(c, EVENT_START);
	return ANSWER_DONE;
}

static enum cycle_answer do_hold(struct cycle *c, double arg_mm)
{
	(void)arg_mm;
	if (!c->loaded)
		return ANSWER_NO_PROGRAM;
	if (c->state == STATE_FAULT)
		return ANSWER_WRONG_STATE;
	c->moving = false;
	happen(c, EVENT_HOLD);
	return ANSWER_DONE;
}

static enum cycle_answer do_stop(struct cycle *c, double arg_mm)
{
	(void)arg_mm;
	if (!c->loaded)
		return ANSWER_NO_PROGRAM;
	if (c->state == STATE_FAULT) {
		end_job(c, OUTCOME_STOPPED);
		c->state = STATE_FAULT;
		return ANSWER_DONE;
	}
	happen(c, EVENT_STOP);
	c->moving = false;
	if (c->after_stand == STATE_HOLD)
		c->after_stand = STATE_IDLE;
	return ANSWER_DONE;
}

static enum cycle_answer do_retract(struct cycle *c, double arg_mm)
{
	const double place = interp_cursor_place_mm(&c->cursor);

	if (!c->loaded)
		return ANSWER_NO_PROGRAM;
	if (c->state == STATE_FAULT || c->after_stand != STATE_HOLD)
		return ANSWER_WRONG_STATE;
	if (!(arg_mm > 0 && isfinite(arg_mm)))
		return ANSWER_BAD_ARGUMENT;
	happen(c, EVENT_HOLD);
	c->moving = true;
	c->move_to_mm = arg_mm < place ? place - arg_mm : 0;
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
	c->overruns_in_row = 0;
	happen(c, EVENT_RESET);
	if (!c->loaded)
		enter(c, STATE_IDLE);
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
};

enum cycle_answer cycle_command(struct cycle *c, const struct cycle_command *m)
{
	if (m->verb >= CYCLE_NVERBS)
		return ANSWER_BAD_ARGUMENT;
	return verbs[m->verb](c, m->arg_mm);
}

enum cycle_answer cycle_load_at(struct cycle *c, const struct interp_cursor *at,
				double far_mm)
{
	if (c->state != STATE_IDLE)
		return ANSWER_WRONG_STATE;
	c->cursor = *at;
	c->out.path++;
	c->loaded = true;
	c->outcome = OUTCOME_NONE;
	c->totals = (struct cycle_totals) { 0 };
	c->far_mm = far_mm;
	c->action_done = at->index;
	c->since_jump = 0;
	c->dwelling = false;
	c->power_off = false;
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

static void guard(struct cycle *c, const struct io_inputs *in)
{
	if (in->estop)
		cycle_fail(c, FAULT_ESTOP);
	if (in->lost)
		cycle_fail(c, FAULT_IO_LOST);
	if (!in->gap_valid && state_duty[c->state].power)
		cycle_fail(c, FAULT_GAP_LOST);
}

static void sense_gap(struct cycle *c, const struct io_inputs *in)
{
	const struct cycle_gap_config *g = &c->config.gap;

	c->gap_v = in->gap_valid && isfinite(in->gap_v) ? in->gap_v : 0;
	c->short_before = c->gap_short;
	c->gap_short = in->gap_valid && c->gap_v < g->short_v;
	c->gap_open = in->gap_valid && c->gap_v > g->open_v;
	if (c->gap_short && !c->short_before && state_duty[c->state].power)
		c->totals.shorts++;
}

/* What this cycle's gap and place mean to the state; at most one thing. */
static enum cycle_event look(struct cycle *c)
{
	const bool powered = state_duty[c->state].power;

	if (powered && c->gap_short)
		return EVENT_SHORT;
	if (powered && walk_ahead(c) == AHEAD_FREE)
		return EVENT_FREE;
	switch (c->state) {
	case STATE_APPROACH:
		return c->gap_open ? EVENT_OPEN : EVENT_SPARK;
	case STATE_ERODE:
		return c->config.jump.height_mm > 0 &&
		       c->since_jump >= c->config.jump.every_cycles ?
		       EVENT_JUMP_DUE : EVENT_NONE;
	case STATE_TRAVEL:
		return walk_ahead(c) == AHEAD_CUT ? EVENT_CUT : EVENT_NONE;
	case STATE_RETRACT:
		return c->gap_v >= c->config.gap.servo_v ? EVENT_CLEAR :
							   EVENT_NONE;
	case STATE_JUMP:
		return !c->lifting && c->gap_short ? EVENT_SHORT : EVENT_NONE;
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
	if (c->gap_short && c->free_seen)
		cycle_fail(c, FAULT_CONTACT);
	c->free_seen = c->free_seen || c->gap_open;
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
		return;
	}
	switch (walk_action(c)) {
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

static void go(struct cycle *c)
{
	const double ds = feed_distance(c);
	const enum walk_result r = walk_by(c, ds);

	c->at_start = r == WALK_START;
	if (r == WALK_BROKEN)
		cycle_fail(c, FAULT_PROGRAM);
	else if (r == WALK_BEYOND)
		cycle_fail(c, FAULT_SOFT_LIMIT);
	else if (r == WALK_ACTION)
		meet_action(c);
	if (feed_done(c))
		happen(c, EVENT_MOVE_DONE);
}

/* As far back as it may: stand, and give the short a little time. */
static void watch_retract(struct cycle *c)
{
	const double back = c->retract_from_mm -
			    interp_cursor_place_mm(&c->cursor);

	if (c->state != STATE_RETRACT)
		return;
	if (back > c->totals.retract_mm_max)
		c->totals.retract_mm_max = back;
	if (!c->retract_waited && !c->at_start &&
	    back < c->config.gap.retract_limit_mm)
		return;
	if (c->retract_waited++ >= c->config.gap.retract_wait_cycles)
		cycle_fail(c, FAULT_SHORT_NOT_CLEARED);
}

static void sum_up(struct cycle *c, bool running)
{
	if (running)
		c->totals.cycles++;
	if (c->state == STATE_ERODE) {
		c->totals.erode_cycles++;
		c->since_jump++;
	}
	if (c->state == STATE_JUMP)
		c->totals.jump_cycles++;
}

static void give(struct cycle *c, struct io_outputs *out)
{
	c->out.power = state_duty[c->state].power;
	if (c->loaded) {
		const struct interp_cond *cond =
			&c->cursor.p.conds[c->cursor.seg.cond];

		c->out.place_mm = interp_cursor_place_mm(&c->cursor);
		c->out.rapid = c->state == STATE_TRAVEL;
		c->out.cond_letter = cond->letter;
		c->out.cond_number = cond->number;
	}
	*out = c->out;
}

void cycle_step(struct cycle *c, const struct io_inputs *in,
		struct io_outputs *out)
{
	const bool running = state_duty[c->state].running;

	c->count++;
	guard(c, in);
	sense_gap(c, in);
	if (c->loaded && c->state != STATE_FAULT) {
		happen(c, look(c));
		watch_contact(c);
		go(c);
		watch_retract(c);
		stand(c);
		sum_up(c, running);
	} else {
		c->feed_mm_s = 0;
	}
	if (!c->overran)
		c->overruns_in_row = 0;
	c->overran = false;
	give(c, out);
}
