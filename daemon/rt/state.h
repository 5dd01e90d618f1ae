/* SPDX-License-Identifier: Apache-2.0 */
/*
 * state.h - the states of a machine on its path, and which event leads to which
 * state
 *
 * The transitions and the duties are tables in state.c.
 * Threads: RT-safe.
 */
#ifndef RT_STATE_H
#define RT_STATE_H

#include "states.h"

#include <stdbool.h>

enum cycle_event {
	EVENT_NONE,
	EVENT_START,		/* start or resume */
	EVENT_RETURN,		/* the same, while held beside the path */
	EVENT_HOLD,
	EVENT_STOP,
	EVENT_RESET,
	EVENT_FREE,		/* the segment ahead is positioned, not cut */
	EVENT_CUT,		/* the segment ahead is cut */
	EVENT_PROBE,		/* the segment ahead ends at contact */
	EVENT_SPARK,		/* gap voltage in the sparking range */
	EVENT_OPEN,		/* gap voltage above open_v */
	EVENT_SHORT,		/* below short_v */
	EVENT_ARCING,		/* arcs that a jump did not end */
	EVENT_CLEAR,		/* the short is gone, in a retract */
	EVENT_JUMP_DUE,
	EVENT_TIME_UP,		/* the time of a timed part is over */
	EVENT_MOVE_DONE,	/* the mover is where it was sent */
	EVENT_END,		/* end of the program */
	CYCLE_NEVENTS
};

/* What a state does. */
struct state_duty {
	const char *name;
	bool power;		/* sparks allowed */
	bool running;		/* a job is under way */
};

extern const struct state_duty state_duty[CYCLE_NSTATES];

/** state_next() - the state that @ev leads to from @s; @s if nowhere. */
enum cycle_state state_next(enum cycle_state s, enum cycle_event ev);

#endif /* RT_STATE_H */
