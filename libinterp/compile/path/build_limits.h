/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_limits.h - the limits of a program; of a long one a thread finds them
 * while it is put together
 *
 * The thread looks at the tables of segments, nodes, arcs and couples.  Only
 * these functions may move them, and nothing may change a segment in them but
 * the arg of an action.  A new column changes all nodes: then the thread is
 * stopped, and another one begins later.
 *
 * Private to libinterp/compile/path.
 */
#ifndef PATH_BUILD_LIMITS_H
#define PATH_BUILD_LIMITS_H

#include "path/builder.h"

/** build_threads() - how many threads pay for so long a program. */
uint32_t build_threads(const struct interp_build *b);

/** build_segs_room() - make room for one more segment.  All others are whole.
 *  Return: 0 or -ENOMEM. */
int build_segs_room(struct interp_build *b);

/** build_seen_room() - build_table_room() of a table that the thread sees. */
int build_seen_room(struct interp_build *b, struct table *t, size_t n);

/** build_seen_add() - the same for one more; NULL: out of memory. */
static inline void *build_seen_add(struct interp_build *b, struct table *t)
{
	if (t->n == t->room && build_seen_room(b, t, 1) < 0)
		return NULL;
	return (char *)t->at + t->size * t->n++;
}

/** build_limits_await() - no more segments will come: wait until the thread
 *  has done what it can. */
void build_limits_await(struct interp_build *b);

/** build_limits_stop() - the segments are what they were, and may be
 *  changed. */
void build_limits_stop(struct interp_build *b);

/**
 * build_limits_write() - of the whole program @p, into its @bends and into
 * @segs: copies of what build_limits_await() has left in the table.
 *
 * @threads: what build_threads() has said of all of it
 */
void build_limits_write(struct interp_build *b, const struct interp_program *p,
			struct interp_seg *segs, struct interp_bends *bends,
			uint32_t threads);

#endif /* PATH_BUILD_LIMITS_H */
