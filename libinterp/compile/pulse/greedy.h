/* SPDX-License-Identifier: Apache-2.0 */
/*
 * greedy.h - the fewest changes of axis a line in a tube can have
 *
 * Keep the axis while its next pulse stays in |e| <= M and below its total,
 * else change.  Of two paths in the tube that began on the same axis and have
 * made as many runs, the greedy one is never behind: how far a run reaches
 * rises with where it begins, and wherever 2*floor(M/g) + 1 >= (a + b)/g some
 * pulse is legal at every place.  So the better of the two first axes is the
 * optimum; the other one costs a run more at the most.
 *
 * It cannot be walked back from its place alone, for two places may lead to
 * one.  So the builder plans it, and the program keeps which input gives each
 * pulse: path/build_bits.h.
 *
 * Threads: any; planning takes as long as the line has runs.
 */
#ifndef PULSE_GREEDY_H
#define PULSE_GREEDY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct greedy_line {
	int64_t a, b;			/* pulses, a >= b >= 0, a > 0 */
	int64_t half_width;		/* M; if it is too narrow, the step that
					 * goes least astray is taken */
};

/* Runs alternate between the main and the secondary axis. */
struct greedy_runs {
	uint32_t *run;			/* memory of the caller; NULL: only
					 * count */
	size_t room;
	size_t n;			/* how many runs there are, with or
					 * without room */
	bool main_first;
};

/** greedy_plan() - the better of the two. */
void greedy_plan(const struct greedy_line *l, struct greedy_runs *r);

#endif /* PULSE_GREEDY_H */
