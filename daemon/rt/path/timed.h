/* SPDX-License-Identifier: Apache-2.0 */
/*
 * timed.h - a part of the program that ends by time as well as by depth
 *
 * From INTERP_TIMED to its INTERP_TIMED_END every cycle that runs is counted.
 * When the time is up, the electrode goes back along the path to where the part
 * began.  The part ends at the same point, so the cursor is set to its end.
 *
 * What was skipped is not cut, so no way back leads into it.  After a crash
 * nobody knows whether it was skipped; so it is taken as skipped.
 *
 * Threads: RT-safe.
 */
#ifndef RT_TIMED_H
#define RT_TIMED_H

#include "cycle.h"

/** timed_begin() - the part up to segment @end begins here. */
void timed_begin(struct cycle *c, uint32_t end);

/** timed_count() - one more cycle has run. */
void timed_count(struct cycle *c);

static inline bool timed_is_up(const struct cycle *c)
{
	return c->timed.end > 0 && c->timed.left == 0;
}

/** timed_over() - segment @end, where a part ends, is passed or skipped. */
void timed_over(struct cycle *c, uint32_t end);

/** timed_skip() - set the cursor from the beginning of the part to its end. */
void timed_skip(struct cycle *c);

#endif /* RT_TIMED_H */
