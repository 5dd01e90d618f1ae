/* SPDX-License-Identifier: Apache-2.0 */
/*
 * hole.h - back from a wire's break to the hole it was threaded in
 *
 * A cut begins where the last positioning in front of it ends, or at the start
 * of the program.  That is where the wire was threaded, and where it can be
 * threaded again.  The way there is the path itself, so it ends up in the hole
 * by way of the kerf.
 *
 * It goes a pulse's way farther than the hole, so that an M code which threads
 * the wire there is in front of it again: `m_redo` tells the PLC once more.
 *
 * Threads: RT-safe; looks at a bounded number of segments in a cycle.
 */
#ifndef RT_HOLE_H
#define RT_HOLE_H

struct cycle;

#define HOLE_SEGMENTS_MAX	512	/* in a cycle */

/** hole_begin() - hold.to_mm and hold.seek for a way back from here. */
void hole_begin(struct cycle *c);

/**
 * hole_follow() - once a cycle, until it is found: while hold.seek is not 0.
 */
void hole_follow(struct cycle *c);

#endif /* RT_HOLE_H */
