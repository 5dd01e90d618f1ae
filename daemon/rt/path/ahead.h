/* SPDX-License-Identifier: Apache-2.0 */
/*
 * ahead.h - go along the path, either way, at a speed all that comes allows
 *
 * One look ahead for positioning, jumps and moves by command.  The speed keeps
 * to every ceiling of the program (interp/limits.h) and to those of the move,
 * and stops where it must; a node limits the speed and never the acceleration,
 * so one on a line costs nothing.  In a cycle the look follows only what is
 * slower than what it has seen, as far as the braking distance.
 *
 * Private to feed.c and ahead.c.  Threads: RT-safe.
 */
#ifndef RT_AHEAD_H
#define RT_AHEAD_H

#include "cycle.h"

/* One move; what leads to its end is latched when it begins. */
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
