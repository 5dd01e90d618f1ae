/* SPDX-License-Identifier: Apache-2.0 */
/*
 * bends.h - how much acceleration a slow move may have where axes bend
 *
 * What an axis may do is shared between its bend, beside the path or with it,
 * and speeding up (compile/speed/along.c).  a_mm_s2 and j_mm_s3 of a
 * segment are what is left at the highest speed that can be come to there.  A
 * move that is slower may have more:
 *
 *	a <= bent_a * (1 - by_v2 * v^2)
 *	by_va * v * a <= INTERP_ARC_JERK_BOTH
 *	j <= bent_j * (sqrt(1 - (by_va * v * a)^2) - by_v3 * v^3)
 *
 * Of several runs of segments each number is the worst, so a place may allow
 * more than this.
 *
 * Units: in every name.
 * Threads: RT-safe.
 */
#ifndef INTERP_BENDS_H
#define INTERP_BENDS_H

#include "interp/program.h"

/* Of no segment: anything is allowed. */
#define INTERP_BENDS_NONE ((struct interp_bends) { \
	.a_mm_s2 = INFINITY, .j_mm_s3 = INFINITY, \
	.bent_a_mm_s2 = INFINITY, .bent_j_mm_s3 = INFINITY })

/* Along the path. */
struct interp_along {
	double a_mm_s2, j_mm_s3;
};

/** interp_bends_join() - @b, and all that is in @sum. */
void interp_bends_join(struct interp_bends *sum, const struct interp_bends *b);

/**
 * interp_bends_leave() - what a move may have that stays below @v_mm_s.
 *
 * @most: it has no more than that anyway.  From a stand to v it cannot come to
 *	  more than sqrt(v * j).
 *
 * Return: neither is more than @most; either may be 0 or less.
 */
struct interp_along interp_bends_leave(const struct interp_bends *b,
				       double v_mm_s,
				       const struct interp_along *most);

#endif /* INTERP_BENDS_H */
