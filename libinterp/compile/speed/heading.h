/* SPDX-License-Identifier: Apache-2.0 */
/*
 * heading.h - which way a segment sets out, and which way it arrives
 *
 * Private to libinterp/compile/speed.
 */
#ifndef SPEED_HEADING_H
#define SPEED_HEADING_H

#include "interp/program.h"

struct heading {
	double rate[INTERP_NAXES];	/* mm of each column per mm of path */
	uint32_t along;			/* columns whose rates make length 1 */
};

struct headings {
	struct heading first, last;
	double bend_mm;			/* smallest radius on the way; 0:
					 * straight */
	double share;			/* of the path's speed, round that
					 * bend */
};

/* A program, and what is the same for all of its segments. */
struct ways {
	const struct interp_program *p;
	uint32_t xyz, uv;		/* columns */
	double sub_mm[INTERP_NAXES];	/* mm per subpulse of each column */
};

void heading_ways_init(struct ways *w, const struct interp_program *p);

/** heading_find() - of segment @i, which is none that stands. */
void heading_find(const struct ways *w, uint32_t i, struct headings *ret);

#endif /* SPEED_HEADING_H */
