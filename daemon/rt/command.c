/* SPDX-License-Identifier: Apache-2.0 */
/* command.c - carry out commands, and load programs */
#include "cycle.h"
#include "enter.h"
#include "guard.h"
#include "path/step.h"
#include "path/walk.h"
#include "path/place.h"

#include <math.h>
#include <string.h>

/* Do the guards allow that anything begins to move? This is asked before the
 * motion, and not one period later. */
static enum cycle_answer may_begin(const struct cycle *c)
{
	if (c->axes.starting)
		return ANSWER_NOT_UP;
	if (c->axes.powerless)
		return ANSWER_NO_POWER;
	return guard_forbids(c);
}

/* The machine works in order, and is not about to go to a fault or to end the
 * job. */
static bool stands_held(const struct cycle *c)
{
	return c->state == STATE_HOLD && !c->job.stopped &&
	       !c->hold.moving && c->fault.latched == 0;
}

static enum cycle_answer do_start(struct cycle *c, double arg_mm)
{
	enum cycle_answer answer;

	(void)arg_mm;
	if (!c->loaded)
		return ANSWER_NO_PROGRAM;
	if (!stands_held(c))
		return ANSWER_WRONG_STATE;
	if (stand_asks(c))
		return ANSWER_ASKS;
	if (c->limit.on)
		return ANSWER_AT_LIMIT;
	if (c->manual.unplaced ||
	    (c->config.require_home && manual_unhomed(c)))
		return ANSWER_NOT_HOMED;
	answer = may_begin(c);
	if (answer != ANSWER_DONE)
		return answer;
	c->outcome = OUTCOME_NONE;
	c->retract.in_row = 0;
	c->turned_mm = 0;
	c->arcing = (struct arcing) { .rung = ARCING_NONE };
	gap_forget(c);
	axes_want(c, cycle_start, 0);
	return ANSWER_DONE;
}

static enum cycle_answer do_hold(struct cycle *c, double arg_mm)
{
	(void)arg_mm;
	if (cycle_is_manual(c)) {
		c->manual.halt = true;
		return ANSWER_DONE;
	}
	if (!c->loaded)
		return ANSWER_NO_PROGRAM;
	if (c->state == STATE_FAULT)
		return ANSWER_WRONG_STATE;
	c->hold.moving = false;
	axes_forget(c);
	stand_begin(c, STAND_COMMAND, 0);
	cycle_happen(c, EVENT_HOLD);
	return ANSWER_DONE;
}

static enum cycle_answer do_stop(struct cycle *c, double arg_mm)
{
	if (cycle_is_manual(c))
		return do_hold(c, arg_mm);
	if (!c->loaded)
		return ANSWER_NO_PROGRAM;
	c->job.stopped = true;
	if (c->state == STATE_FAULT) {
		cycle_stand_failed(c);
		return ANSWER_DONE;
	}
	cycle_happen(c, EVENT_STOP);
	axes_forget(c);
	c->hold.moving = false;
	return ANSWER_DONE;
}

static void go_back(struct cycle *c, double back_mm)
{
	c->hold.moving = true;
	c->hold.to_mm = fmax(place_outer_mm(c), place_mm(c) - back_mm);
}

static enum cycle_answer do_retract(struct cycle *c, double arg_mm)
{
	enum cycle_answer answer;

	if (!c->loaded)
		return ANSWER_NO_PROGRAM;
	if (c->fault.latched || c->job.stopped)
		return ANSWER_WRONG_STATE;
	if (!(arg_mm > 0 && isfinite(arg_mm)))
		return ANSWER_BAD_ARGUMENT;
	if (c->manual.unplaced)
		return ANSWER_NOT_HOMED;
	answer = may_begin(c);
	if (answer != ANSWER_DONE)
		return answer;
	stand_begin(c, STAND_COMMAND, 0);
	cycle_happen(c, EVENT_HOLD);
	moved_begin(c);
	axes_want(c, go_back, arg_mm);
	return ANSWER_DONE;
}

/* On its way back to the path the machine came to another place: there may be
 * no such node any more, and then it stays. */
static void go_to_node(struct cycle *c, double nodes)
{
	c->hold.moving = step_to(c, nodes, &c->hold.to_mm) == ANSWER_DONE;
}

static enum cycle_answer do_step(struct cycle *c, double arg_mm)
{
	enum cycle_answer answer;
	double to_mm;

	if (!c->loaded)
		return ANSWER_NO_PROGRAM;
	if (!stands_held(c) || escape_is_out(&c->escape))
		return ANSWER_WRONG_STATE;
	if (arg_mm > 0 && stand_asks(c))
		return ANSWER_ASKS;
	answer = (enum cycle_answer)step_to(c, arg_mm, &to_mm);
	if (answer == ANSWER_DONE)
		answer = may_begin(c);
	if (answer != ANSWER_DONE)
		return answer;
	if (c->manual.unplaced)
		return ANSWER_NOT_HOMED;
	moved_begin(c);
	axes_want(c, go_to_node, arg_mm);
	return ANSWER_DONE;
}

static enum cycle_answer do_confirm(struct cycle *c, double of)
{
	if (!c->loaded)
		return ANSWER_NO_PROGRAM;
	return stand_confirm(c, of) ? ANSWER_DONE : ANSWER_NOT_ASKED;
}

static enum cycle_answer do_estop(struct cycle *c, double arg_mm)
{
	(void)arg_mm;
	fault_latch(&c->fault, FAULT_ESTOP);
	return ANSWER_DONE;
}

/* A reset may end what the drives report. The fault is cleared when the drives
 * say that it is gone. */
static enum cycle_answer do_reset(struct cycle *c, double arg_mm)
{
	const uint64_t remains = fault_remains(&c->fault);

	(void)arg_mm;
	if (c->state != STATE_FAULT || c->fault.fresh)
		return ANSWER_WRONG_STATE;
	if (remains & ~axes_faults())
		return ANSWER_STILL_THERE;
	c->out.reset = true;
	c->overruns_in_row = 0;
	c->fault.resetting = remains != 0;
	if (remains == 0)
		cycle_reset(c);
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

static enum cycle_answer (*const verbs[CYCLE_NVERBS])(struct cycle *,
						       double) = {
	[CYCLE_START]	= do_start,
	[CYCLE_HOLD]	= do_hold,
	[CYCLE_RESUME]	= do_start,
	[CYCLE_STOP]	= do_stop,
	[CYCLE_RETRACT]	= do_retract,
	[CYCLE_ESTOP]	= do_estop,
	[CYCLE_RESET]	= do_reset,
	[CYCLE_OVERRIDE] = do_override,
	[CYCLE_STEP]	= do_step,
	[CYCLE_CONFIRM]	= do_confirm,
};

static enum cycle_answer do_set(struct cycle *c, const struct cycle_command *m)
{
	static const enum cycle_answer answer[] = {
		[CONDITIONS_DONE]	= ANSWER_DONE,
		[CONDITIONS_BAD]	= ANSWER_BAD_ARGUMENT,
		[CONDITIONS_FULL]	= ANSWER_WRONG_STATE,
	};

	if (!c->loaded)
		return ANSWER_NO_PROGRAM;
	return answer[conditions_set(c, m->arg, m->arg_mm)];
}

/* There are no sparks, and none can begin while it is tried. */
static enum cycle_answer do_try(struct cycle *c, const struct cycle_command *m)
{
	if (c->loaded || c->state != STATE_IDLE)
		return ANSWER_WRONG_STATE;
	return asking_try(c, VERB_TRY_FIELD(m->arg), m->arg_mm,
			  m->arg & VERB_TRY_LEASED) ?
	       ANSWER_DONE : ANSWER_BAD_ARGUMENT;
}

static enum cycle_answer do_manual(struct cycle *c,
				    const struct cycle_command *m)
{
	const bool jog = m->verb == CYCLE_JOG;
	enum cycle_answer answer;

	if (c->fault.latched)
		return ANSWER_WRONG_STATE;
	answer = may_begin(c);
	if (answer != ANSWER_DONE)
		return answer;
	answer = (enum cycle_answer)(jog ?
		manual_jog(c, m->arg, m->arg_mm) : manual_home(c, m->arg));
	if (answer != ANSWER_DONE)
		return answer;
	cycle_enter(c, jog ? STATE_JOG : STATE_HOME);
	moved_begin(c);
	axes_want(c, NULL, 0);
	return ANSWER_DONE;
}

static enum cycle_answer do_press(struct cycle *c,
				  const struct cycle_command *m)
{
	const enum cycle_answer may = c->fault.latched ? ANSWER_WRONG_STATE :
				      may_begin(c);
	bool begun;
	const int answer = manual_press(c, m->arg, m->arg_mm, (int)may, &begun);

	if (begun) {
		cycle_enter(c, STATE_JOG);
		moved_begin(c);
		axes_want(c, NULL, 0);
	}
	return (enum cycle_answer)answer;
}

enum cycle_answer cycle_command(struct cycle *c, const struct cycle_command *m)
{
	if (m->verb >= CYCLE_NVERBS)
		return ANSWER_BAD_ARGUMENT;
	if (m->verb == CYCLE_JOG_ON)
		return do_press(c, m);
	if (m->verb == CYCLE_SET)
		return do_set(c, m);
	if (m->verb == CYCLE_TRY)
		return do_try(c, m);
	if (m->verb == CYCLE_PLACE)
		return (enum cycle_answer)manual_place(c, m->arg, m->arg_mm);
	if (m->verb == CYCLE_JOG || m->verb == CYCLE_HOME)
		return do_manual(c, m);
	if ((m->verb == CYCLE_START || m->verb == CYCLE_CONFIRM) &&
	    !stand_is(c, m->arg))
		return ANSWER_OVER;
	return verbs[m->verb](c, m->arg_mm);
}

enum cycle_answer cycle_load_at(struct cycle *c, const struct interp_cursor *at,
				double far_mm)
{
	if (c->state != STATE_IDLE)
		return ANSWER_WRONG_STATE;
	if (c->manual.used && !probe_is_start(c, at))
		return ANSWER_ELSEWHERE;
	c->cursor = *at;
	c->escape = (struct escape) { .nlegs = 0 };
	if (!conditions_begin(c))
		return ANSWER_BAD_ARGUMENT;
	asking_begin(c);
	c->out.path++;
	c->loaded = true;
	stand_end(c);
	stand_begin(c, STAND_READY, 0);
	c->outcome = OUTCOME_NONE;
	c->totals = (struct cycle_totals) { 0 };
	c->far_mm = far_mm;
	resync_begin(&c->resync, interp_cursor_place_mm(at));
	c->job.action_done = at->index;
	c->flush = (struct flush) { .far_mm = far_mm };
	c->job.dwelling = false;
	c->timed.end = 0;
	c->back_mm = 0;
	mcode_begin(c, at->index);
	c->job.power_off = false;
	c->job.stopped = false;
	c->job.rejoin_mm = 0;
	probe_load(c);
	depth_load(c);
	cycle_enter(c, STATE_HOLD);
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
