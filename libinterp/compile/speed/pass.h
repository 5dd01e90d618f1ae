/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pass.h - the limits of a program while they are found
 *
 * Private to compile/speed.
 */
#ifndef SPEED_PASS_H
#define SPEED_PASS_H

#include "interp/limits.h"
#include "interp/smaller.h"

#include <stdbool.h>

struct pass {
	const struct interp_program *p;
	struct interp_seg *segs;	/* of it, writable */
	uint32_t end;			/* the last segment */
	double travel_a_mm_s2, travel_j_mm_s3;	/* of a positioning */
};

static inline float pass_least(float a, float b)
{
	return a < b ? a : b;
}

/** pass_levels() - one behind the other, what is nearly alike becomes alike. */
void pass_levels(struct pass *w);

/**
 * pass_sides() - flag a stand between any two sides of a program, of which one
 * allows much less than the other.
 *
 * Return: how many sides it has.
 */
uint32_t pass_sides(struct pass *w);

/**
 * pass_join() - take the stands away that save no time.
 *
 * @sides: what pass_sides() returned.  @v2: room for a number of each segment.
 * Return: 0, -ENOMEM.
 */
int pass_join(struct pass *w, uint32_t sides, float *v2);

/**
 * pass_moves_s() - the time of segments @from up to, but not with, @to, as
 * moves from stand to stand: once as fast as can be, and once at F.
 *
 * @v2: room for @to numbers.  @one: as one move, whatever stands are in it.
 */
double pass_moves_s(const struct pass *w, uint32_t from, uint32_t to,
		    float *v2, bool one);

/** pass_set_stand() - at the end of segment @i; false: take it away. */
static inline void pass_set_stand(struct pass *w, uint32_t i, bool stands)
{
	uint8_t *flags = &w->segs[i].flags;

	*flags = (uint8_t)(stands ? *flags | INTERP_SEG_STAND :
				    *flags & ~INTERP_SEG_STAND);
}

/** pass_hops() - write slower_* and softer_* of all segments, when all else is
 *  known. */
void pass_hops(struct pass *w);

#endif /* SPEED_PASS_H */
