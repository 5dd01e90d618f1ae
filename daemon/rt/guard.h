/* SPDX-License-Identifier: Apache-2.0 */
/*
 * guard.h - what is looked at in every period, before anything moves
 *
 * Each guard notes what it sees (fault.h); what the machine is doing decides
 * whether that is a fault.
 *
 * Threads: RT-safe.
 */
#ifndef RT_GUARD_H
#define RT_GUARD_H

#include "cycle.h"

/** guard_look() - at all inputs of this period, once. */
void guard_look(struct cycle *c, const struct io_inputs *in);

/** guard_judge() - latch what of it counts in the present state. */
static inline void guard_judge(struct cycle *c)
{
	if (fault_is_seen(&c->fault))
		fault_judge(&c->fault, cycle_moves(c),
			    state_duty[c->state].power);
}

/** guard_forbids() - would the guards not let anything move now? */
bool guard_forbids(const struct cycle *c);

/** guard_met() - positioning, it met something that was not there before. */
bool guard_met(const struct cycle *c);

/** guard_contact() - a collision on the way?  After the state is chosen. */
void guard_contact(struct cycle *c);

#endif /* RT_GUARD_H */
