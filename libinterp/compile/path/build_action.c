/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_action.c - actions at the place where the path stands, and parts with a
 * time
 */
#include "path/builder.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

int interp_build_action(struct interp_build *b, enum interp_kind kind,
			uint32_t arg, const struct interp_build_word *w,
			struct interp_diag *diag)
{
	struct interp_seg seg = { .kind = (uint8_t)kind, .arg = arg };
	const int err = interp_build_flush(b, diag);

	if (kind == INTERP_AUX && arg <= INTERP_AUX_POWER_NEGATIVE) {
		b->off = arg == INTERP_AUX_POWER_OFF;
		seg.arg |= b->said << 8;
		b->said = b->off ? b->said : arg;
	}
	/* Millions of them would take as much memory as the program. */
	if (err || b->again.counts)
		return err;
	return build_seg_finish(b, &seg, w, diag);
}

int interp_build_timed(struct interp_build *b,
		       const struct interp_build_word *w,
		       struct interp_diag *diag)
{
	const int err = interp_build_action(b, INTERP_TIMED, 0, w, diag);

	if (err < 0)
		return err;
	/* Where it is now: segments before it may have been left out. */
	b->timed = b->segs.n - 1;
	memcpy(b->timed_at, b->here, sizeof(b->timed_at));
	return 0;
}

int interp_build_timed_end(struct interp_build *b, uint32_t ms,
			   const struct interp_build_word *w,
			   struct interp_diag *diag)
{
	const int err = interp_build_flush(b, diag);
	struct interp_seg *begin = b->segs.at;

	if (err < 0)
		return err;
	for (int i = 0; i < INTERP_NAXES; i++) {
		if (interp_round_sub(b->here[i]) ==
		    interp_round_sub(b->timed_at[i]))
			continue;
		return interp_diag_say(diag, "a time for motions that end "
				       "elsewhere along %c; motions that end "
				       "where they begin",
				       INTERP_AXIS_LETTERS[i]);
	}
	begin[b->timed].arg = (uint32_t)b->segs.n;
	return interp_build_action(b, INTERP_TIMED_END, ms, w, diag);
}
