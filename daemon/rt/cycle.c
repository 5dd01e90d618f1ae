/* SPDX-License-Identifier: Apache-2.0 */
/* cycle.c - one period: gap, guards, state, distance, walk, outputs */
#include "cycle.h"
#include "enter.h"
#include "feed.h"
#include "guard.h"
#include "path/laws.h"
#include "path/step.h"
#include "path/timed.h"
#include "path/walk.h"
#include "path/place.h"

#include <math.h>
#include <string.h>

void cycle_init(struct cycle *c, const struct cycle_config *config)
{
	*c = (struct cycle) {
		.config = *config,
		.gap = config->gap,
		.jump = config->jump,
		.state = STATE_IDLE,
		.override = 1,
		.plc_override = NAN,
	};
	io_pulse_own(&c->out);
	asking_init(&c->asking);
	memcpy(c->out.target, config->start, sizeof(c->out.target));
}

void cycle_overrun(struct cycle *c, uint32_t missed)
{
	c->totals.overruns += missed;
	c->overruns_in_row += missed;
	c->overran = true;
	if (c->config.overrun_limit && cycle_moves(c) &&
	    c->overruns_in_row >= c->config.overrun_limit)
		fault_latch(&c->fault, FAULT_OVERRUN);
}

/* On ground that was passed before, the cut is reached only when the signal is
 * inside the window. */
static enum cycle_event look_in(const struct cycle *c)
{
	const bool known = place_mm(c) < c->far_mm - MOVER_ONTO_MM;

	if (known && c->sensed.now_v > gap_window_high_v(c))
		return EVENT_NONE;
	return c->sensed.is_open ? EVENT_OPEN : EVENT_SPARK;
}

/* It stands, and axes that lag come to rest, before anything near the work
 * begins. */
static enum cycle_event look_arrive(const struct cycle *c)
{
	if (!contouring_rests(&c->contouring) || !mover_is_standing(&c->mover))
		return EVENT_NONE;
	return walk_ahead(c) == AHEAD_CUT ? EVENT_CUT :
	       walk_ahead(c) == AHEAD_PROBE ? EVENT_PROBE : EVENT_NONE;
}

static bool may_withdraw(struct cycle *c)
{
	/* It comes back over it out of a retract or a jump. */
	if (walk_rejoins(c) || place_mm(c) < c->turned_mm)
		c->ground.answer = GROUND_CUT;
	else
		ground_look(c);
	return c->ground.answer != GROUND_NEW;
}

/*
 * While positioning, the electrode met something over ground that was cut or
 * passed already.  That is a short like any other.  A retract has no lead, so
 * axes that have a lead first brake with it.  It brakes, too, for as long as it
 * is not known whether it is a collision.
 */
static enum cycle_event look_out(struct cycle *c)
{
	if (guard_met(c))
		c->withdraws = may_withdraw(c);
	if (!c->withdraws)
		return look_arrive(c);
	return c->ground.answer != GROUND_ASKED &&
	       contouring_rests(&c->contouring) ? EVENT_SHORT : EVENT_NONE;
}

/* The event that the gap and the place of this cycle mean; at most one. */
static enum cycle_event look(struct cycle *c)
{
	const bool powered = state_duty[c->state].power;

	if (asking_hand(c)) {
		stand_begin(c, STAND_SETTING, c->asking.stands);
		return EVENT_HOLD;
	}
	if (asking_waits(c))
		return !escape_is_out(&c->escape) && walk_positions(c) ?
		       EVENT_FREE : EVENT_NONE;
	if (powered && c->sensed.is_short)
		return EVENT_SHORT;
	if (powered && !escape_is_out(&c->escape) && walk_positions(c))
		return EVENT_FREE;
	if (powered && arcing_retract_due(c))
		return EVENT_ARCING;
	if (powered && timed_is_up(c) && servo_rests(c) &&
	    !escape_is_out(&c->escape))
		return EVENT_TIME_UP;
	switch (c->state) {
	case STATE_APPROACH:
		return walk_positions(c) ? EVENT_NONE : look_in(c);
	case STATE_ERODE:
		return flush_due(c) && servo_rests(c) ? EVENT_JUMP_DUE :
							EVENT_NONE;
	case STATE_TRAVEL:
		return look_out(c);
	case STATE_RETRACT:
		return retract_is_clear(c) ? EVENT_CLEAR : EVENT_NONE;
	case STATE_JUMP:
		return !c->lift.up && c->sensed.contact ? EVENT_SHORT :
							EVENT_NONE;
	default:
		return EVENT_NONE;
	}
}

static void stand(struct cycle *c)
{
	if (c->state != STATE_HOLD || c->hold.moving || c->mover.v_mm_s != 0)
		return;
	if (c->hold.fails)
		cycle_stand_failed(c);
	else if (c->job.stopped && contouring_rests(&c->contouring))
		cycle_end_job(c, OUTCOME_STOPPED);
}

static void stand_held(struct cycle *c, enum stand_reason why, uint32_t of)
{
	stand_begin(c, why, of);
	cycle_happen(c, EVENT_HOLD);
	mover_set(&c->mover, 0);
}

/* The last bit of a way to a stand is cut.  What is left of its speed must not
 * carry the limits of that move over the action. */
static void stand_before(struct cycle *c)
{
	const struct interp_scurve_limits l = mover_curve(&c->mover.l);
	struct mover *m = &c->mover;

	if (m->kind != MOVER_NO_PLAN &&
	    fabs(interp_scurve_way_mm(&l, m->v_mm_s, m->a_mm_s2, 0)) <=
		    2 * MOVER_ONTO_MM)
		mover_set(m, 0);
}

/* A held job does no action; it stands before the action.  A way back that was
 * told while it came here begins here. */
static void meet_action(struct cycle *c)
{
	if (c->state == STATE_HOLD) {
		mover_set(&c->mover, 0);
		c->hold.moving = c->hold.moving && c->hold.to_mm < place_mm(c);
		return;
	}
	stand_before(c);
	switch (walk_action(c)) {
	case ACTION_WAIT:
		cycle_happen(c, EVENT_FREE);
		mover_set(&c->mover, 0);
		break;
	case ACTION_HOLD:
		stand_held(c, STAND_STOP, 0);
		break;
	case ACTION_OPTIONAL:
		stand_held(c, STAND_OPTIONAL, 0);
		break;
	case ACTION_ELECTRODE:
		stand_held(c, STAND_ELECTRODE, c->job.electrode);
		break;
	case ACTION_END:
		if (c->config.hold_at_end)
			stand_held(c, STAND_END, 0);
		else if (contouring_rests(&c->contouring))
			cycle_end_job(c, OUTCOME_DONE);
		else
			mover_set(&c->mover, 0);
		break;
	default:
		break;
	}
}

/* Beside the path no segment ends, and there is no action. */
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
		fault_latch(&c->fault, FAULT_PROGRAM);
	else if (r == WALK_BEYOND)
		fault_latch(&c->fault, c->state == STATE_PROBE ?
				       FAULT_NO_CONTACT : FAULT_SOFT_LIMIT);
	else if (r == WALK_ACTION)
		meet_action(c);
	mcode_follow(c);
	if (c->loaded && !conditions_follow(c))
		fault_latch(&c->fault, FAULT_PROGRAM);
	if (feed_done(c)) {
		if (c->lift.leaving)
			timed_skip(c);
		cycle_happen(c, EVENT_MOVE_DONE);
	}
}

/* Through air, and where no sparks are, the process has no say. */
static bool is_cut(const struct cycle *c)
{
	return !c->job.dwelling && c->state != STATE_TRAVEL &&
	       c->state != STATE_PROBE &&
	       walk_is_cut(c, &c->cursor.seg) &&
	       !(c->state == STATE_APPROACH && place_mm(c) >= c->far_mm);
}

static void sum_period(struct cycle *c)
{
	struct cycle_totals *t = &c->totals;

	t->cycles++;
	timed_count(c);
	if (stand_now(c).why != STAND_NONE)
		return;
	if (is_cut(c))
		t->cut_cycles++;
	else if (c->state == STATE_TRAVEL && !c->job.dwelling &&
		 !walk_rejoins(c))
		t->moved_cycles++;
	else
		t->other_cycles++;
}

static void sum_up(struct cycle *c, bool running)
{
	if (running)
		sum_period(c);
	if (c->state == STATE_ERODE)
		c->totals.erode_cycles++;
	if (c->state == STATE_JUMP)
		c->totals.jump_cycles++;
	flush_watch(c);
	depth_watch(c);
}

/* Where it is on its way back to a cut there is none, nor in the cycle that
 * ends the way, nor beside what is positioned. */
static bool may_spark(const struct cycle *c)
{
	return state_duty[c->state].power && !c->job.power_off &&
	       c->fault.latched == 0 && !walk_positions(c) &&
	       c->asking.in_force;
}

/* Does a command move the axes?  Then their compensation may move them too. */
static bool moves_by_will(const struct cycle *c)
{
	return !axes_awaits(&c->axes) &&
	       (state_duty[c->state].running || c->hold.moving ||
		c->axes.phase == AXES_BACK || cycle_is_manual(c));
}

static void give(struct cycle *c, struct io_outputs *out)
{
	/* M5 takes effect in its own cycle, also when a way back meets it. */
	c->out.power = may_spark(c);
	c->out.sense = c->state == STATE_PROBE;
	c->out.home = manual_in_phase(c, HOME_BY_DRIVE);
	c->out.latch = manual_in_phase(c, HOME_INDEX);
	if (c->loaded) {
		c->out.place_mm = interp_cursor_place_mm(&c->cursor);
		c->out.off_path_mm = c->escape.way_mm;
		c->out.rapid = c->state == STATE_TRAVEL ||
			       c->state == STATE_PROBE;
	}
	if (moves_by_will(c))
		c->comp.resting = false;
	*out = c->out;
	comp_apply(&c->comp, &c->config.comp, &(struct comp_period) {
		.place = c->out.target,
		.frozen = c->state == STATE_FAULT || c->busy,
		.edges = c->config.points_max,
	}, out->target);
	for (int i = 0; i < INTERP_NAXES && c->contouring.on; i++)
		out->target[i] += c->contouring.added[i];
	resync_apply(c, out->target);
	memcpy(out->pulse, c->asking.now, sizeof(out->pulse));
	out->asked = c->asking.version;
	c->out.reset = false;
}

/* Motion without a program. */
static void go_manually(struct cycle *c, const struct io_inputs *in)
{
	c->feed_mm_s = 0;
	if (!cycle_is_manual(c) || !manual_go(c, in))
		return;
	c->moved.there = !c->manual.halt;
	cycle_enter(c, c->fault.latched ? STATE_FAULT : STATE_IDLE);
}

/* The machine is held until the axes have power and stand on their places. */
static bool may_move(struct cycle *c)
{
	/* A jog or homing that ends before the axes have power needs none. */
	if (axes_awaits(&c->axes) && cycle_is_manual(c) && manual_ends(c))
		axes_forget(c);
	if (c->axes.then == cycle_start)
		c->totals.cycles++;
	return axes_await(c);
}

/* Choose the state by the gap and the place, unless a guard has found a
 * fault. */
static void choose_state(struct cycle *c)
{
	if (c->fault.fresh)
		return;
	cycle_happen(c, look(c));
	guard_contact(c);
	guard_judge(c);
}

void cycle_step(struct cycle *c, const struct io_inputs *in,
		struct io_outputs *out)
{
	const bool running = state_duty[c->state].running;
	bool moves, walks;

	c->count++;
	gap_sense(c, in);
	probe_sense(c, in);
	guard_look(c, in);
	interlock_obey(c);
	moves = c->state != STATE_FAULT && may_move(c);
	if (c->loaded && moves)
		choose_state(c);
	cycle_react(c);
	moves = moves && c->state != STATE_FAULT;
	walks = moves && c->loaded;
	if (walks) {
		step_watch(c);
		go(c);
		retract_watch(c);
		if (c->count % PROGRESS_EVERY == 0)
			progress_look(c);
	} else if (moves) {
		go_manually(c, in);
	} else {
		c->feed_mm_s = 0;
	}
	limit_watch(c);
	guard_judge(c);
	cycle_react(c);
	if (walks) {
		stand(c);
		sum_up(c, running);
	}
	contouring_step(c, in);
	if (!c->overran)
		c->overruns_in_row = 0;
	c->overran = false;
	asking_step(c, in);
	moved_watch(c);
	give(c, out);
}
