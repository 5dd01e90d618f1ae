/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fault.h - the latch of faults: what was found, and nothing else
 *
 * The code that finds a fault latches it here and goes on as if nothing had
 * happened.  The state changes only at two fixed places of a period (cycle.c):
 * after the guards and after the walk.  So a fault that a guard finds stops the
 * sparks and the motion of this period, and a fault that the walk finds lets
 * the period end in order.
 *
 * A guard does not ask what the machine is doing.  It notes what it sees.  The
 * table says in which scope that is a fault; a guard may name a wider one.
 * fault_judge() then latches the faults that count in the present state, and is
 * called once more when the state has changed.  So whatever forbids sparks is
 * known before the first spark.
 *
 * Several faults can be latched at a time.  The first one tells why the machine
 * stopped, the worst one decides how the motion ends.  A reset clears all of
 * them, but not while a guard still sees one of scope FAULT_ALWAYS.
 *
 * Threads: RT-safe; the object belongs to the cycle's thread.
 */
#ifndef RT_FAULT_H
#define RT_FAULT_H

#include "faults.h"

struct fault {
	enum cycle_fault first, worst;	/* FAULT_NONE: none is latched */
	/* Sets with one bit for each fault: */
	uint64_t latched;		/* all that are latched */
	uint64_t fresh;			/* the cycle has not reacted to it
					 * yet */
	uint64_t untold;		/* not reported yet; whoever reports
					 * clears it */
	uint64_t seen[FAULT_ALWAYS + 1];	/* noted in this period, by
						 * scope */
	bool resetting;			/* a reset was sent to the drives; do
					 * they still report their faults? */
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

/** fault_latch() - the fault @f was found. */
void fault_latch(struct fault *s, enum cycle_fault f);

/** fault_look_anew() - a period begins: forget the notes of the last one. */
static inline void fault_look_anew(struct fault *s)
{
	s->seen[FAULT_IN_POWER] = s->seen[FAULT_IN_MOTION] =
		s->seen[FAULT_ALWAYS] = 0;
}

/** fault_note_in() - a guard sees @f, and here it is a fault in @scope. */
static inline void fault_note_in(struct fault *s, enum cycle_fault f,
				 enum fault_scope scope)
{
	s->seen[scope] |= fault_bit(f);
}

/** fault_note() - a guard sees @f, which is a fault in the table's scope. */
static inline void fault_note(struct fault *s, enum cycle_fault f)
{
	fault_note_in(s, f, fault_table[f].scope);
}

/** fault_is_seen() - is anything noted in this period? */
static inline bool fault_is_seen(const struct fault *s)
{
	return s->seen[FAULT_IN_POWER] | s->seen[FAULT_IN_MOTION] |
	       s->seen[FAULT_ALWAYS];
}

/** fault_judge() - latch those of the noted faults that count now. */
void fault_judge(struct fault *s, bool moves, bool sparks);

/**
 * fault_remains() - the faults that a reset cannot clear: they are still seen.
 */
static inline uint64_t fault_remains(const struct fault *s)
{
	return s->seen[FAULT_ALWAYS];
}

/** fault_any() - is @holds true for one of the set @faults? */
bool fault_any(uint64_t faults, bool (*holds)(const struct fault_row *));

/* For fault_any(). */
bool fault_row_disables(const struct fault_row *row);
bool fault_row_ends(const struct fault_row *row);

/** fault_clear() - the operator resets. */
void fault_clear(struct fault *s);

#endif /* RT_FAULT_H */
