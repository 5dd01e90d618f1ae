/* SPDX-License-Identifier: Apache-2.0 */
/* enter.c - what is done when a state is entered; how a job ends or fails */
#include "enter.h"
#include "path/hole.h"
#include "path/timed.h"
#include "path/walk.h"
#include "path/place.h"

#include <math.h>

void cycle_lift(struct cycle *c)
{
	struct cycle_lift *l = &c->lift;

	l->waits = c->mover.v_mm_s != 0;
	if (!l->waits && !escape_is_out(&c->escape))
		escape_begin(c);
	l->from_mm = place_mm(c);
	l->to_mm = fmax(place_outer_mm(c), l->from_mm - l->height_mm);
}

static void lift(struct cycle *c)
{
	c->lift.height_mm = flush_begin(c);
	c->lift.up = true;
	/* Beside the path the way out goes on; the time waits. */
	c->lift.leaving = timed_is_up(c) && !escape_is_out(&c->escape);
	c->lift.waits = false;
	if (c->lift.leaving) {
		c->lift.to_mm = c->timed.from_mm;
		return;
	}
	c->totals.jumps++;
	cycle_lift(c);
}

/* It is held beside the path: it goes back as a jump does. */
static void come_back(struct cycle *c)
{
	c->lift.up = false;
	c->lift.leaving = c->lift.waits = false;
	c->lift.from_mm = interp_cursor_place_mm(&c->cursor);
	c->lift.to_mm = fmax(c->lift.from_mm - c->jump.short_of_mm,
			     place_mm(c));
}

void cycle_enter(struct cycle *c, enum cycle_state s)
{
	const enum cycle_state from = c->state;

	c->state = s;
	c->ahead.state = STATE_STAY;
	switch (s) {
	case STATE_TRAVEL:
		servo_reset(c);
		c->free_seen = false;
		c->withdraws = false;
		c->ground.answer = GROUND_NONE;
		break;
	case STATE_APPROACH:
		c->job.rejoin_mm = 0;
		break;
	case STATE_PROBE:
		probe_begin(c);
		break;
	case STATE_RETRACT:
		c->turned_mm = fmax(c->turned_mm, place_mm(c));
		servo_reset(c);
		retract_begin(c);
		arcing_met(c);
		break;
	case STATE_JUMP:
		c->turned_mm = fmax(c->turned_mm, place_mm(c));
		arcing_met(c);
		if (from == STATE_HOLD)
			come_back(c);
		else
			lift(c);
		break;
	case STATE_HOLD:
		axes_forget(c);
		c->hold.moving = false;
		c->hold.seek = 0;
		c->hold.braked = false;
		c->hold.fails = false;
		break;
	case STATE_IDLE:
	case STATE_FAULT:
		if (fault_any(c->fault.latched, fault_row_disables))
			c->out.enable = false;
		axes_forget(c);
		c->hold.moving = false;
		mover_set(&c->mover, 0);
		mover_set(&c->manual.mover, 0);
		break;
	default:
		break;
	}
}

void cycle_start(struct cycle *c, double unused)
{
	(void)unused;
	stand_end(c);
	cycle_set_off(c);
}

void cycle_end_job(struct cycle *c, enum cycle_outcome o)
{
	c->outcome = o;
	c->loaded = false;
	stand_end(c);
	resync_settle(c);
	c->escape = (struct escape) { .nlegs = 0 };
	cycle_enter(c, STATE_IDLE);
}

/* -- Faults ---------------------------------------------------------------- */

/* Only out of a cut with a broken wire it goes back a little. */
static bool backs_off(const struct cycle *c)
{
	return c->fault.latched == fault_bit(FAULT_WIRE_BROKEN) &&
	       (state_duty[c->state].power || c->state == STATE_RETRACT);
}

static void retreat(struct cycle *c)
{
	const double back = c->gap.wire_retreat_mm;

	c->job.rejoin_mm = place_mm(c) - back;
	switch (c->gap.wire_retreat_to) {
	case RETREAT_HOLE:
		hole_begin(c);
		break;
	case RETREAT_MOTION:
		c->hold.to_mm = retract_motion_mm(c);
		break;
	default:
		c->hold.to_mm = fmax(place_outer_mm(c), place_mm(c) - back);
	}
}

static void brake(struct cycle *c)
{
	const bool goes_back = backs_off(c);

	if (c->hold.fails && c->state == STATE_HOLD) {
		/* A second fault came while it goes back from the first. */
		c->hold.moving = false;
		return;
	}
	cycle_enter(c, STATE_HOLD);
	if (goes_back)
		retreat(c);
	c->hold.moving = goes_back;
	c->hold.fails = true;
}

/* An axis that is jogged or homed brakes too, but it does not go on against
 * something that it met. */
static bool brakes_by_hand(const struct cycle *c, uint64_t fresh)
{
	return cycle_is_manual(c) && !(fresh & fault_bit(FAULT_CONTACT));
}

/* The reset has reached the drives; what they report now is new. */
void cycle_end_reset(struct cycle *c)
{
	if (c->out.reset)
		return;
	c->fault.resetting = false;
	if (fault_remains(&c->fault) || c->fault.fresh)
		c->fault.untold |= c->fault.latched;
	else
		cycle_reset(c);
}

/* If no axis follows any more, nothing can brake. */
static bool ends_at_once(const struct cycle *c)
{
	return fault_any(c->fault.latched, fault_row_ends) ||
	       (!c->axes.steers &&
		fault_any(c->fault.latched, fault_row_disables));
}

void cycle_stand_failed(struct cycle *c)
{
	cycle_enter(c, STATE_FAULT);
	if (c->loaded && c->job.stopped) {
		cycle_end_job(c, OUTCOME_STOPPED);
		c->state = STATE_FAULT;
	}
}

void cycle_fail(struct cycle *c)
{
	const uint64_t fresh = c->fault.fresh;

	c->fault.fresh = 0;
	if (fresh && c->loaded)
		c->outcome = OUTCOME_FAULT;
	if (c->state == STATE_FAULT || ends_at_once(c))
		cycle_stand_failed(c);
	else if (!fresh)
		return;
	else if (c->loaded)
		brake(c);
	else if (brakes_by_hand(c, fresh))
		c->manual.halt = true;
	else
		cycle_enter(c, STATE_FAULT);
}

void cycle_reset(struct cycle *c)
{
	fault_clear(&c->fault);
	stand_begin(c, STAND_RESET, 0);
	cycle_happen(c, EVENT_RESET);
	if (!c->loaded)
		cycle_enter(c, STATE_IDLE);
}
