/* SPDX-License-Identifier: Apache-2.0 */
/* state.c - the tables of states */
#include "state.h"

#include <stdint.h>

#define DUTY(id, name, power, running) \
	[STATE_##id] = { name, power, running },

const struct state_duty state_duty[CYCLE_NSTATES] = {
	[STATE_STAY] = { "?", false, false },
	STATE_ROWS(DUTY)
};

/*
 * Read a row as "while in this state, this event leads to...". A fault, a stop
 * and a hold lead to the same state from every running state. The function
 * below and enter.c do that, so no row has to say it.
 */
static const uint8_t next[CYCLE_NSTATES][CYCLE_NEVENTS] = {
	[STATE_TRAVEL] = {
		[EVENT_CUT]		= STATE_APPROACH,
		[EVENT_PROBE]		= STATE_PROBE,
		[EVENT_SHORT]		= STATE_RETRACT,
		[EVENT_END]		= STATE_IDLE,
	},
	[STATE_APPROACH] = {
		[EVENT_SPARK]		= STATE_ERODE,
		[EVENT_SHORT]		= STATE_RETRACT,
		[EVENT_ARCING]		= STATE_RETRACT,
		[EVENT_TIME_UP]		= STATE_JUMP,
		[EVENT_FREE]		= STATE_TRAVEL,
		[EVENT_END]		= STATE_IDLE,
	},
	[STATE_ERODE] = {
		[EVENT_SHORT]		= STATE_RETRACT,
		[EVENT_ARCING]		= STATE_RETRACT,
		[EVENT_JUMP_DUE]	= STATE_JUMP,
		[EVENT_TIME_UP]		= STATE_JUMP,
		[EVENT_FREE]		= STATE_TRAVEL,
		[EVENT_END]		= STATE_IDLE,
	},
	[STATE_RETRACT] = {
		[EVENT_CLEAR]		= STATE_APPROACH,
	},
	[STATE_JUMP] = {
		[EVENT_MOVE_DONE]	= STATE_APPROACH,
		[EVENT_SHORT]		= STATE_RETRACT,
	},
	[STATE_HOLD] = {
		[EVENT_START]		= STATE_TRAVEL,
		[EVENT_RETURN]		= STATE_JUMP,
	},
	[STATE_FAULT] = {
		[EVENT_RESET]		= STATE_HOLD,
	},
	[STATE_PROBE] = {
		[EVENT_MOVE_DONE]	= STATE_TRAVEL,
	},
};

enum cycle_state state_next(enum cycle_state s, enum cycle_event ev)
{
	/* A hold and a stop lead from every running state to hold. */
	if (state_duty[s].running && (ev == EVENT_HOLD || ev == EVENT_STOP))
		return STATE_HOLD;

	return next[s][ev] == STATE_STAY ? s : (enum cycle_state)next[s][ev];
}
