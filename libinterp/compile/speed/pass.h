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
	double short_mm;		/* shorter lines stand for a curve */
	double travel_a_mm_s2, travel_j_mm_s3;	/* of a positioning */
};

static inline float pass_least(float a, float b)
{
	return a < b ? a : b;
}

/** pass_levels() - one behind the other, what is nearly alike becomes alike. */
void pass_levels(struct pass *w);

/* A side of a program ends where the acceleration or the jerk that is allowed
 * becomes so many times as much, or so small a part. */
#define PASS_SIDE	2

/* A node is slow if it is passed no faster than this share of what its sides
 * come to. */
#define PASS_SLOW	0.5

/**
 * pass_stands() - flag the nodes at which a move stands, because the axes allow
 * much less on one side.
 *
 * Return: 0, -ENOMEM.
 */
int pass_stands(struct pass *w);

/**
 * pass_moves_s() - the time of segments @from up to, but not with, @to, as
 * moves from stand to stand.
 *
 * @fed: no faster than F.  @v2: room for @to numbers
 */
double pass_moves_s(const struct pass *w, uint32_t from, uint32_t to,
		    bool fed, float *v2);

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
