/* SPDX-License-Identifier: Apache-2.0 */
/*
 * restore.h - a cycle that goes on where another one was killed
 *
 * The axes come first: axes/axis_state.h.  Then the job, whole or not at all:
 * one that went on in another place, or with other values, would be worse than
 * one that is lost.  Then the faults that were latched, until an operator's
 * reset.
 *
 * Startup only: these calls look at the whole program.
 */
#ifndef RT_RESTORE_H
#define RT_RESTORE_H

#include "cycle.h"

/* What the other one said last about its job. */
struct cycle_past {
	double far_mm, back_mm;
	int32_t pos[INTERP_NAXES];	/* where the axes were sent, pulses */
	int32_t shift[INTERP_NAXES], found[2][INTERP_NAXES];	/* probe.h */
	uint32_t found_once, found_twice;
	bool pump;
	uint8_t mcode;			/* told to the PLC, not answered; or 0 */
	uint32_t mcode_at;		/* its segment */
	struct cycle_totals totals;
	const struct conditions_set *sets;
	uint32_t nsets;
};

enum cycle_restored {
	RESTORED,
	RESTORE_NOT_LOADED,		/* see @ret_answer */
	RESTORE_ELSEWHERE,		/* the axes are neither on the path nor
					 * on the way out from there */
	RESTORE_OTHER_VALUES,		/* what was `set` cannot be in force */
};

/**
 * cycle_restore() - a cycle with its axes restored, and without a job, stands
 * held with the program and at the place of @at.
 *
 * If it fails the cycle is of no use: give it a copy.
 */
enum cycle_restored cycle_restore(struct cycle *c,
				  const struct interp_cursor *at,
				  const struct cycle_past *past,
				  enum cycle_answer *ret_answer);

/** cycle_restore_faults() - @first and the set @faults stay latched.  They were
 *  told already. */
void cycle_restore_faults(struct cycle *c, enum cycle_fault first,
			  uint64_t faults);

#endif /* RT_RESTORE_H */
