/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fault.c - the latch of faults
 */
#include "fault.h"

/* A fault in which the drives may be wrong is worse than any fault that leaves
 * them on. */
static int rank(enum cycle_fault f)
{
	const struct fault_row *row = &fault_table[f];

	return f == FAULT_NONE ? -1 :
	       2 * row->disables + (row->motion == FAULT_ENDS);
}

void fault_latch(struct fault *s, enum cycle_fault f)
{
	const uint64_t fresh = fault_bit(f) & ~s->latched;

	s->latched |= fresh;
	s->fresh |= fresh;
	s->untold |= fresh;
	if (s->first == FAULT_NONE)
		s->first = f;
	if (rank(f) > rank(s->worst))
		s->worst = f;
}

static void latch_all(struct fault *s, uint64_t found)
{
	for (found &= ~s->latched; found; found &= found - 1)
		fault_latch(s, (enum cycle_fault)__builtin_ctzll(found));
}

/* If several faults come together, those that always count come first. */
void fault_judge(struct fault *s, bool moves, bool sparks)
{
	latch_all(s, s->seen[FAULT_ALWAYS]);
	if (moves)
		latch_all(s, s->seen[FAULT_IN_MOTION]);
	if (sparks)
		latch_all(s, s->seen[FAULT_IN_POWER]);
}

bool fault_row_disables(const struct fault_row *row)
{
	return row->disables;
}

bool fault_row_ends(const struct fault_row *row)
{
	return row->motion == FAULT_ENDS;
}

bool fault_any(uint64_t faults, bool (*holds)(const struct fault_row *))
{
	for (; faults; faults &= faults - 1)
		if (holds(&fault_table[__builtin_ctzll(faults)]))
			return true;
	return false;
}

/* Faults that were not reported yet will still be reported. */
void fault_clear(struct fault *s)
{
	s->first = s->worst = FAULT_NONE;
	s->latched = s->fresh = 0;
	s->resetting = false;
}
