/* SPDX-License-Identifier: Apache-2.0 */
/*
 * guard.h - the guards: they look at the inputs in every period, before
 * anything moves
 *
 * Each guard notes what it sees (fault.h); what the machine is doing decides
 * whether that is a fault.
 *
 * Threads: RT-safe.
 */
#ifndef RT_GUARD_H
#define RT_GUARD_H

#include "cycle.h"

/** guard_look() - look at all inputs of this period, once. */
void guard_look(struct cycle *c, const struct io_inputs *in);

/** guard_judge() - latch those of the notes that are faults in this state. */
static inline void guard_judge(struct cycle *c)
{
	if (fault_is_seen(&c->fault))
		fault_judge(&c->fault, cycle_moves(c),
			    state_duty[c->state].power);
}

/** guard_forbids() - may anything begin to move now?  Return: ANSWER_DONE, or
 *  what forbids it. */
enum cycle_answer guard_forbids(const struct cycle *c);

/**
 * guard_met() - while positioning, did the electrode meet something that was
 * not there when the motion began?
 */
bool guard_met(const struct cycle *c);

/**
 * guard_contact() - note a collision; to be called after the state is chosen.
 */
void guard_contact(struct cycle *c);

#endif /* RT_GUARD_H */
