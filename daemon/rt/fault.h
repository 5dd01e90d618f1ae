/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fault.h - the latch of faults: what was found, and nothing else
 *
 * Whoever finds a fault latches it here and goes on as if nothing had happened.
 * The state changes at two fixed places of a period (cycle.c): after the guards
 * and after the walk.  So no sparks and no motion of this period follow from
 * what a guard found, and a fault that the walk found ends the period in order.
 *
 * A guard does not ask what the machine is doing: it notes what it sees, with
 * the scope in which that is a fault.  fault_judge() then latches what counts
 * in the present state, and again once the state is another one: what forbids
 * sparks is known before the first spark.
 *
 * Several faults can be latched at a time.  The first one is the answer to
 * "why", the worst one decides how the motion ends.  A reset clears all of
 * them, but not while one of scope FAULT_ALWAYS is still seen.
 *
 * Threads: RT-safe; the object belongs to the cycle's thread.
 */
#ifndef RT_FAULT_H
#define RT_FAULT_H

#include "faults.h"

struct fault {
	enum cycle_fault first, worst;	/* FAULT_NONE: none is latched */
	uint64_t latched;		/* bit per fault; all of them, ... */
	uint64_t fresh;			/* ... not reacted to yet, and ... */
	uint64_t untold;		/* ... not told outside; the teller
					 * clears it */
	uint64_t seen[FAULT_ALWAYS + 1];	/* this period's notes */
	bool resetting;			/* a reset went out to the drives: is
					 * what they reported still there? */
};

_Static_assert(CYCLE_NFAULTS <= 64, "a bit for each fault");

static inline uint64_t fault_bit(enum cycle_fault f)
{
	return UINT64_C(1) << f;
}

static inline bool fault_is_latched(const struct fault *s, enum cycle_fault f)
{
	return s->latched & fault_bit(f);
}

/** fault_latch() - @f was found. */
void fault_latch(struct fault *s, enum cycle_fault f);

/** fault_look_anew() - a period begins: nothing is noted yet. */
static inline void fault_look_anew(struct fault *s)
{
	s->seen[FAULT_IN_POWER] = s->seen[FAULT_IN_MOTION] =
		s->seen[FAULT_ALWAYS] = 0;
}

/** fault_note() - a guard sees what is a fault in @scope. */
static inline void fault_note(struct fault *s, enum cycle_fault f,
			      enum fault_scope scope)
{
	s->seen[scope] |= fault_bit(f);
}

/** fault_is_seen() - is anything noted in this period? */
static inline bool fault_is_seen(const struct fault *s)
{
	return s->seen[FAULT_IN_POWER] | s->seen[FAULT_IN_MOTION] |
	       s->seen[FAULT_ALWAYS];
}

/** fault_judge() - latch what was noted and counts now. */
void fault_judge(struct fault *s, bool moves, bool sparks);

/** fault_remains() - a reset would not clear these: they are still seen. */
static inline uint64_t fault_remains(const struct fault *s)
{
	return s->seen[FAULT_ALWAYS];
}

/** fault_any() - one of the set @faults for which @holds is true? */
bool fault_any(uint64_t faults, bool (*holds)(const struct fault_row *));

/* For fault_any(). */
bool fault_row_disables(const struct fault_row *row);
bool fault_row_ends(const struct fault_row *row);

/** fault_clear() - an operator's reset. */
void fault_clear(struct fault *s);

#endif /* RT_FAULT_H */
