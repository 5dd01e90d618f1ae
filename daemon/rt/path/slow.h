/* SPDX-License-Identifier: Apache-2.0 */
/*
 * slow.h - a lower ceiling of speed, and more acceleration under it
 *
 * Where axes bend, more acceleration is left at a lower speed
 * (interp/bends.h).  A move that is too short for its speed gains by that.
 *
 * Private to ahead.c and slow.c.  Threads: RT-safe.
 */
#ifndef RT_SLOW_H
#define RT_SLOW_H

#include "path/ahead.h"

/**
 * slow_limits() - for a move that begins here and stands at @end_mm.
 *
 * @l: what holds for all of its way at any speed; changed, if it comes there
 *     earlier so.  Its v_max_mm_s is then the ceiling.
 */
void slow_limits(const struct cycle *c, const struct ahead_move *w,
		 double end_mm, struct mover_limits *l);

#endif /* RT_SLOW_H */
