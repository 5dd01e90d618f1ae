/* SPDX-License-Identifier: Apache-2.0 */
/*
 * enter.h - from one state to another, for the cycle and its commands
 *
 * Private to the files of daemon/rt.
 *
 * Threads: RT-safe.
 */
#ifndef RT_ENTER_H
#define RT_ENTER_H

#include "cycle.h"

/** cycle_enter() - make @s the state, and do what is done on entering it. */
void cycle_enter(struct cycle *c, enum cycle_state s);

/** cycle_end_job() - the program is out, the state idle. */
void cycle_end_job(struct cycle *c, enum cycle_outcome o);

/** cycle_happen() - enter the state that @ev leads to, if it is another. */
static inline void cycle_happen(struct cycle *c, enum cycle_event ev)
{
	const enum cycle_state to = state_next(c->state, ev);

	if (to != c->state)
		cycle_enter(c, to);
}

/** cycle_set_off() - from hold: on along the path, or first back to it. */
static inline void cycle_set_off(struct cycle *c)
{
	cycle_happen(c, escape_is_out(&c->escape) ? EVENT_RETURN :
						    EVENT_START);
}

/** cycle_reset() - out of a fault: held, or idle without a job. */
void cycle_reset(struct cycle *c);

/* For cycle_react(). */
void cycle_end_reset(struct cycle *c);
void cycle_fail(struct cycle *c);

/** cycle_react() - to the faults latched since it was called last, and to a
 *  reset of the drives; at its two places in a period. */
static inline void cycle_react(struct cycle *c)
{
	if (c->fault.resetting)
		cycle_end_reset(c);
	if (c->fault.fresh || (c->fault.latched && c->state != STATE_FAULT))
		cycle_fail(c);
}

#endif /* RT_ENTER_H */
