/* SPDX-License-Identifier: Apache-2.0 */
/*
 * follow.h - find limits while the program is still put together
 *
 * A thread of its own walks over the segments, as far behind the last one as a
 * limit looks ahead.  So it is the same walk as that of interp_limits_write(),
 * and it writes the same.  What needs the end of the program is left to the
 * caller.
 *
 * Threads: all of this is called by one thread, the owner's.  It may add to the
 * tables meanwhile, but not move or change what it has said is whole.
 */
#ifndef SPEED_FOLLOW_H
#define SPEED_FOLLOW_H

#include "interp/limits.h"

struct follow;

/**
 * follow_begin() - start the thread, with the signals of its owner blocked.
 *
 * @p: head->naxes, head->column and head->pulse_mm, and tables that grow; lent,
 *     as is @segs, its segments
 *
 * Return: NULL if there can be no thread.
 */
struct follow *follow_begin(const struct interp_limits *l,
			    const struct interp_program *p,
			    struct interp_seg *segs);

/** follow_known() - the first @n segments and their nodes are whole. */
void follow_known(struct follow *f, uint32_t n);

/** follow_hold() - let the thread stand, for tables that are to be moved. */
void follow_hold(struct follow *f);

/** follow_go_on() - they have been moved: @p is again as it was lent. */
void follow_go_on(struct follow *f, struct interp_seg *segs);

/** follow_await() - no more will come before follow_write(): the thread does
 *  what it can, and ends.  The tables may be moved from then on. */
void follow_await(struct follow *f);

/** follow_write() - after follow_await() do the rest of interp_limits_write(),
 *  for the whole program @p, and free @f.  Its segments @segs are what the
 *  thread made of them. */
void follow_write(struct follow *f, const struct interp_program *p,
		  struct interp_seg *segs, struct interp_bends *bends);

/** follow_stop() - end the thread, if that is still there: then the segments
 *  become what they were; and free @f.  NULL is fine. */
void follow_stop(struct follow *f);

#endif /* SPEED_FOLLOW_H */
