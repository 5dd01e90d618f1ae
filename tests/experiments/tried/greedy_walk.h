/* SPDX-License-Identifier: Apache-2.0 */
/*
 * greedy_walk.h - walk a list of runs in both directions
 *
 * Programs keep one bit for each pulse instead, see path/build_bits.h.
 *
 * Threads: any.
 */
#ifndef TRIED_GREEDY_WALK_H
#define TRIED_GREEDY_WALK_H

#include "pulse/greedy.h"

/* A place on it. */
struct greedy_walk {
	const struct greedy_runs *r;
	size_t i;			/* run being walked */
	uint32_t sent;			/* of it; 0 only at the start */
};

/** greedy_forward() - true: main.  Not at the end. */
bool greedy_forward(struct greedy_walk *w);
/** greedy_back() - undo the last one.  Not at the start. */
bool greedy_back(struct greedy_walk *w);

#endif /* TRIED_GREEDY_WALK_H */
