/* SPDX-License-Identifier: Apache-2.0 */
/*
 * ground.h - does the electrode stand on ground that was cut already?
 *
 * Where a program positions out of what it cut, a short is debris and no
 * collision.  Which ground that is, the program says: the cut that it stands
 * on, the segments behind, and the cut that comes next, as far as it was cut
 * before.
 *
 * Threads: RT-safe; in a call a bounded number of segments and of looks.
 */
#ifndef RT_GROUND_H
#define RT_GROUND_H

#include "interp/axis.h"

#include <stdbool.h>
#include <stdint.h>

struct cycle;

#define GROUND_SEGMENTS_MAX	512
#define GROUND_LOOKS_MAX	32	/* in a cycle */

enum ground_answer {
	GROUND_NONE,			/* nobody asked */
	GROUND_ASKED,			/* the next cycle looks on */
	GROUND_CUT,
	GROUND_NEW,
};

/* The last question, and how far it is answered. */
struct ground {
	enum ground_answer answer;
	int32_t pos[INTERP_NAXES];	/* the place in question */
	uint32_t at;			/* the segment that is looked along */
	double mm, most_mm;		/* where on it, and how far it counts */
	int looks;			/* at it, so far */
	uint32_t behind;		/* all from here on are looked at */
	int left;			/* segments that may still count */
	bool left_out;			/* by its time */
};

/**
 * ground_look() - is it, on every axis, as near to a cut behind as the
 * strategy keeps, or on the way out of an orbit?
 *
 * Of GROUND_SEGMENTS_MAX behind, up to a probing motion or another electrode.
 * What a time leaves out of a cycle counts as new.
 *
 * Return: GROUND_ASKED if it is to be called in the next cycle again.  It then
 * goes on with the place of the first call, wherever the machine is by now.
 */
enum ground_answer ground_look(struct cycle *c);

/** ground_is_open() - did it ask, and was not told that the ground is cut? */
static inline bool ground_is_open(const struct ground *g)
{
	return g->answer == GROUND_ASKED || g->answer == GROUND_NEW;
}

#endif /* RT_GROUND_H */
