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

/* Nor do most have more than one set of columns that make the length: these are
 * constants, too.  @f has them in front of the number of columns. */
#define BY_WAYS(n, along, f, ...) \
	((n) == 3 && (along) == 7 ? f(__VA_ARGS__, 7, 3) : \
	 (n) == 2 && (along) == 3 ? f(__VA_ARGS__, 3, 2) : \
	 (n) == 4 && (along) == 7 ? f(__VA_ARGS__, 7, 4) : \
	 BY_COLUMNS(n, f, __VA_ARGS__, along))

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
	uint32_t round;			/* columns that go round arcs */
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

/* The way from node to node, and what it is in each column. */
COLUMNS_INLINE void heading_straight(const struct ways *w, uint32_t i,
				     struct heading *ret, int64_t *sub,
				     uint32_t n)
{
	const int64_t *from = w->p->nodes + (uint64_t)i * n, *to = from + n;
	const double per_mm = 1 / w->p->segs[i].length_mm;

	for (uint32_t j = 0; j < n; j++) {
		sub[j] = to[j] - from[j];
		ret->rate[j] = (double)sub[j] * per_mm * w->sub_mm[j];
	}
}

/** heading_of() - find the directions of segment @i, which must move. */
void heading_of(const struct ways *w, uint32_t i, struct headings *ret);

/* The square of what those columns go by that make the length is 1 on each mm
 * of a line, of others before them far less. */
#define HEADING_COUNTS	0.25

/** heading_find() - the same, for a constant number of columns.  Mostly it is a
 *  line in X Y Z. */
COLUMNS_INLINE void heading_find(const struct ways *w, uint32_t i,
				 struct headings *ret, uint32_t n)
{
	int64_t sub[INTERP_NAXES];
	double sum = 0;

	if (w->p->segs[i].kind != INTERP_LINE) {
		heading_of(w, i, ret);
		return;
	}
	heading_straight(w, i, &ret->first, sub, n);
	for (uint32_t j = 0; j < n && w->xyz != (1u << n) - 1; j++)
		if (w->xyz >> j & 1)
			sum += ret->first.rate[j] * ret->first.rate[j];
	if (sum < HEADING_COUNTS && w->xyz != (1u << n) - 1) {
		heading_of(w, i, ret);
		return;
	}
	ret->first.along = ret->last.along = w->xyz;
	ret->bend_mm = 0;
	ret->share = 1;
	ret->round = 0;
	for (uint32_t j = 0; j < n; j++)
		ret->last.rate[j] = ret->first.rate[j];
}

/* Where the length passes to other columns. */
struct heading_run {
	uint32_t at;			/* segments before it are in the run */
	uint32_t along;			/* the columns of its lines; 0: there
					 * was none yet */
};

/** heading_run() - a run begins with segment @i. */
struct heading_run heading_run(const struct ways *w, uint32_t i);

/**
 * heading_run_on() - look on, but for segments before @to only.
 *
 * Return: true: the length of segment run->at is in other columns than that of
 * the run; only lines are asked.
 */
bool heading_run_on(const struct ways *w, struct heading_run *run, uint32_t to);

#endif /* SPEED_HEADING_H */
