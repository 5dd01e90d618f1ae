/* SPDX-License-Identifier: Apache-2.0 */
/*
 * enter.c - what is done where a state is entered; how a job ends or fails
 */
#include "enter.h"
#include "path/timed.h"
#include "path/walk.h"

#include <math.h>

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

void cycle_enter(struct cycle *c, enum cycle_state s)
{
	const enum cycle_state from = c->state;

	/* The gap is narrower than a brake's way: what can, stops at once. */
	if ((state_duty[from].power || from == STATE_PROBE) &&
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
	case STATE_PROBE:
		probe_begin(c);
		break;
	case STATE_RETRACT:
		servo_reset(c);
		if (c->gap.retract_escape)
			leave_path(c);
		retract_begin(c);
		arcing_met(c);
		break;
	case STATE_JUMP:
		arcing_met(c);
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
		mover_set(&c->manual.mover, 0);
		break;
	default:
		break;
	}
}

void cycle_end_job(struct cycle *c, enum cycle_outcome o)
{
	c->outcome = o;
	c->loaded = false;
	c->escape = (struct escape) { .nlegs = 0 };
	cycle_enter(c, STATE_IDLE);
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
	cycle_enter(c, brake ? STATE_HOLD : STATE_FAULT);
	c->after_stand = brake ? STATE_FAULT : STATE_HOLD;
}
