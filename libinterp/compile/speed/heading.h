/* SPDX-License-Identifier: Apache-2.0 */
/*
 * heading.h - the direction in which a segment begins, and in which it ends
 *
 * Private to libinterp/compile/speed.
 */
#ifndef SPEED_HEADING_H
#define SPEED_HEADING_H

#include "interp/program.h"

/* Most programs move two to four axes: for these @f is compiled with a constant
 * number of columns, its last parameter. */
#define BY_COLUMNS(n, f, ...) \
	((n) == 3 ? f(__VA_ARGS__, 3) : (n) == 2 ? f(__VA_ARGS__, 2) : \
	 (n) == 4 ? f(__VA_ARGS__, 4) : f(__VA_ARGS__, n))

/* So that the constant gets there. */
#define COLUMNS_INLINE static inline __attribute__((always_inline))

struct heading {
	double rate[INTERP_NAXES];	/* mm of each column for a mm of path */
	uint32_t along;			/* the columns that make the length */
};

struct headings {
	struct heading first, last;
	double bend_mm;			/* smallest radius on the way; 0: it is
					 * straight */
	double share;			/* share of the path's speed in that
					 * bend */
};

/* A program, and what is the same for all of its segments. */
struct ways {
	const struct interp_program *p;
	uint32_t xyz, uv;		/* columns */
	double sub_mm[INTERP_NAXES];	/* mm per subpulse of each column */
};

void heading_ways_init(struct ways *w, const struct interp_program *p);

/** heading_column() - the column of @axis, which the program moves. */
uint32_t heading_column(const struct interp_program *p, uint32_t axis);

/** heading_find() - find the directions of segment @i, which must move. */
void heading_find(const struct ways *w, uint32_t i, struct headings *ret);

/**
 * heading_run_end() - the first segment from @i on whose length is in other
 * columns than that of @i; only lines are asked.
 */
uint32_t heading_run_end(const struct ways *w, uint32_t i);

#endif /* SPEED_HEADING_H */
