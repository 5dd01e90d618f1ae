/* SPDX-License-Identifier: Apache-2.0 */
/*
 * ways.h - the columns of a program, and which of them make its length
 *
 * Private to libinterp/compile/speed.
 */
#ifndef SPEED_WAYS_H
#define SPEED_WAYS_H

#include "interp/limits.h"

struct interp_program;

/* Beside the path, a rounding of it counts so often. */
#define WAYS_RATE_MOST	20

/* A program, and what is the same for all of its segments. */
struct ways {
	const struct interp_program *p;
	uint32_t xyz, uv;		/* columns */
	double sub_mm[INTERP_NAXES];	/* mm per subpulse of each column */
	double tol[INTERP_NAXES];	/* of each column: what is less is a
					 * rounding.  A pulse at least */
};

void ways_init(struct ways *w, const struct interp_limits *l,
	       const struct interp_program *p);

/** ways_column() - the column of @axis, which the program moves. */
uint32_t ways_column(const struct interp_program *p, uint32_t axis);

/** ways_rate() - mm of column @k in a mm of segment @i, from node to node. */
static inline double ways_rate(const struct ways *w, uint32_t i, uint32_t k)
{
	const uint32_t n = w->p->head->naxes;
	const int64_t *a = w->p->nodes + (uint64_t)i * n + k;

	return (double)(a[n] - a[0]) * w->sub_mm[k] /
	       w->p->segs[i].length_mm;
}

/** ways_rate_off() - how far a rounding of its ends may have that rate off. */
double ways_rate_off(const struct ways *w, uint32_t i, uint32_t k);

/** ways_along() - the columns that make the length of segment @i, which must
 *  move. */
uint32_t ways_along(const struct ways *w, uint32_t i);

#endif /* SPEED_WAYS_H */
