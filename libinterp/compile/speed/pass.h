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

/* What segments allow along the path, the least of all and the most. */
struct pass_soft {
	double a_least, a_most, j_least, j_most;
};

struct pass {
	const struct interp_program *p;
	struct interp_seg *segs;	/* of it, writable */
	uint32_t end;			/* the last segment */
	double short_mm;		/* shorter lines stand for a curve */
	double travel_a_mm_s2, travel_j_mm_s3;	/* of a positioning */
	struct pass_soft soft;
	bool parts;			/* the length of the path is not always
					 * in the same columns */
};

static inline float pass_least(float a, float b)
{
	return a < b ? a : b;
}

/** pass_levels() - one behind the other, what is nearly alike becomes alike. */
void pass_levels(struct pass *w);

/** pass_may_stand() - do segments allow so different things that a stand
 *  between them may pay? */
static inline bool pass_may_stand(const struct pass *w)
{
	return w->parts || w->soft.a_most >= 2 * w->soft.a_least ||
	       w->soft.j_most >= 2 * w->soft.j_least;
}

/** pass_stretches() - flag the nodes at which a move stands, because the axes
 *  allow much less on one side. */
void pass_stretches(struct pass *w);

/**
 * pass_moves_s() - the time of segments @from up to, but not with, @to, as
 * moves from stand to stand.
 *
 * @fed: no faster than F.  @v2: room for @to numbers
 */
double pass_moves_s(const struct pass *w, uint32_t from, uint32_t to,
		    bool fed, float *v2);

/* Stands must save so much. */
#define PASS_WORTH	0.97

/* Those that save so much may cost so much at F. */
#define PASS_WORTH_COST	0.95
#define PASS_COST	1.02

/** pass_most_at_feed() - of the time without stands at F, what they may take
 *  there that take @share of it without F. */
static inline double pass_most_at_feed(double share)
{
	return share < PASS_WORTH_COST ? PASS_COST : 1;
}

/**
 * pass_stand_apart() - flag the corners between sides that are softer and
 * harder, where stands save time: each such side may be as soft as the axes
 * that turn on it, and one move over all of them is as soft as the softest.
 *
 * @room: for 5 * @to numbers
 */
void pass_stand_apart(struct pass *w, uint32_t from, uint32_t to, float *room);

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
