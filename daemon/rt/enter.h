/* SPDX-License-Identifier: Apache-2.0 */
/*
 * enter.h - how the machine goes from one state to another; for the cycle and
 * its commands
 *
 * Private to the files of daemon/rt.
 *
 * Threads: RT-safe.
 */
#ifndef RT_ENTER_H
#define RT_ENTER_H

#include "cycle.h"

/** cycle_enter() - make @s the state, and do what entering it requires. */
void cycle_enter(struct cycle *c, enum cycle_state s);

/**
 * cycle_stand_failed() - make fault the state; a job that was stopped is over.
 */
void cycle_stand_failed(struct cycle *c);

/** cycle_end_job() - unload the program; the state is then idle. */
void cycle_end_job(struct cycle *c, enum cycle_outcome o);

/**
 * cycle_happen() - enter the state that @ev leads to, if that is another one.
 */
static inline void cycle_happen(struct cycle *c, enum cycle_event ev)
{
	enum cycle_state to;

	if (ev == EVENT_NONE)
		return;
	to = state_next(c->state, ev);
	if (to != c->state)
		cycle_enter(c, to);
}

/**
 * cycle_set_off() - leave hold: go on along the path, or first go back to it.
 */
static inline void cycle_set_off(struct cycle *c)
{
	cycle_happen(c, escape_is_out(&c->escape) ? EVENT_RETURN :
						    EVENT_START);
}

/** cycle_start() - the same, for axes_want(). */
void cycle_start(struct cycle *c, double unused);

/**
 * cycle_lift() - a jump begins.  Beside the path the axes may brake less, so
 * what still moves leaves the path in a later cycle, when it stands.
 */
void cycle_lift(struct cycle *c);

/** cycle_reset() - leave a fault: to hold, or to idle if there is no job. */
void cycle_reset(struct cycle *c);

/* For cycle_react(). */
void cycle_end_reset(struct cycle *c);
void cycle_fail(struct cycle *c);

/**
 * cycle_react() - react to the faults that were latched since the last call,
 * and to a reset of the drives.  It is called at two places of a period.
 */
static inline void cycle_react(struct cycle *c)
{
	if (c->fault.resetting)
		cycle_end_reset(c);
	if (c->fault.fresh || (c->fault.latched && c->state != STATE_FAULT))
		cycle_fail(c);
}

#endif /* RT_ENTER_H */
