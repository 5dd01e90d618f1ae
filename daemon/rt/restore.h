/* SPDX-License-Identifier: Apache-2.0 */
/*
 * restore.h - make a cycle that goes on where another one was killed
 *
 * The axes come first: axes/axis_state.h.  Then comes the job, completely or
 * not at all: a job that went on in another place or with other values would be
 * worse than a lost one.  Last come the faults that were latched; they stay
 * latched until the operator resets.
 *
 * Startup only: these calls look at the whole program.
 */
#ifndef RT_RESTORE_H
#define RT_RESTORE_H

#include "cycle.h"

/* What the killed cycle said last about its job. */
struct cycle_past {
	double far_mm, back_mm;
	double sure_mm, moved_mm[INTERP_NAXES];	/* resync.h */
	int32_t seen[INTERP_NAXES];
	int8_t moved_way[INTERP_NAXES];
	uint32_t moved_beside, adrift;
	int32_t pos[INTERP_NAXES];	/* where the axes were sent, pulses */
	int32_t shift[INTERP_NAXES], found[2][INTERP_NAXES];	/* probe.h */
	uint32_t found_once, found_twice;
	bool pump;
	uint8_t mcode;			/* the PLC was told this code and has
					 * not answered; 0: none */
	uint32_t mcode_at;		/* the segment of that code */
	struct depth depth;
	struct stand stand;		/* NONE: it ran */
	struct cycle_totals totals;
	const struct conditions_set *sets;
	uint32_t nsets;
};

enum cycle_restored {
	RESTORED,
	RESTORE_NOT_LOADED,		/* see @ret_answer */
	RESTORE_ELSEWHERE,		/* the axes are neither on the path nor
					 * on the escape from there */
	RESTORE_OTHER_VALUES,		/* the values that were `set` cannot be
					 * in force now */
};

/**
 * cycle_restore() - give a cycle its job back: it is then held, with the
 * program and at the place of @at.  Its axes must be restored, and it must have
 * no job.
 *
 * If this fails, the cycle cannot be used any more.  So call it with a copy.
 */
enum cycle_restored cycle_restore(struct cycle *c,
				  const struct interp_cursor *at,
				  const struct cycle_past *past,
				  enum cycle_answer *ret_answer);

/**
 * cycle_restore_faults() - keep @first and the set @faults latched.  They were
 * reported before the crash.
 */
void cycle_restore_faults(struct cycle *c, enum cycle_fault first,
			  uint64_t faults);

#endif /* RT_RESTORE_H */
