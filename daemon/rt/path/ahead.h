/* SPDX-License-Identifier: Apache-2.0 */
/*
 * ahead.h - go along the path, either way, as fast as what comes allows
 *
 * Positioning, jumps and moves by command all use this.  The speed keeps to
 * every limit of the program (interp/limits.h) and of the move, and the motion
 * stops where it has to.  A node limits the speed and never the acceleration,
 * so a node on a straight line costs nothing.  In a cycle only those places are
 * looked at that are slower than the ones already seen, as far as the braking
 * distance.
 *
 * Private to feed.c and ahead.c.  Threads: RT-safe.
 */
#ifndef RT_AHEAD_H
#define RT_AHEAD_H

#include "cycle.h"

/* One move.  Its limits are those of the cycle in which it begins. */
struct ahead_move {
	int toward;			/* +1 or -1 */
	double goal_mm;			/* place to stand at; INFINITY: none */
	bool positions;			/* keeps to F and override; stops in
					 * front of what is to be cut */
	bool stops_at_nodes;
	struct mover_limits l;
};

/** ahead_distance() - signed distance along the path for this cycle, mm. */
double ahead_distance(struct cycle *c, const struct ahead_move *w);

#endif /* RT_AHEAD_H */
