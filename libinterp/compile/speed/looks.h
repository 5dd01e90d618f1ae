/* SPDX-License-Identifier: Apache-2.0 */
/*
 * looks.h - what the axes do along each segment of a program, at some places of
 * it
 *
 * Private to libinterp/compile/speed.
 */
#ifndef SPEED_LOOKS_H
#define SPEED_LOOKS_H

#include "speed/along.h"
#include "interp/limits.h"

#include <stdbool.h>
#include <stddef.h>

/* Of a segment. */
struct looks {
	uint32_t at, n;			/* its ways; 0: it does not move */
	float own_mm_s;			/* the fastest that it was made for */
	float node_mm_s;		/* a corner, or a step of an axis, at
					 * its end */
	float a_mm_s2, j_mm_s3;		/* along it, as if nothing bent */
	bool is_run;			/* a line of a run: a look at each
					 * end */
	bool goes_on;			/* its last look is the first of the
					 * next segment */
};

struct look_all {
	const struct interp_program *p;
	struct interp_axes axes;
	struct looks *of;		/* of each segment */
	size_t n, room;
	float *way;			/* of each look, as speed/along.h */
};

/**
 * looks_make() - of all segments of @p.
 *
 * Return: 0, -ENOMEM.
 */
int looks_make(struct look_all *ret, const struct interp_limits *l,
	       const struct interp_program *p);

void looks_free(struct look_all *k);

/** looks_way() - at look @i. */
void looks_way(const struct look_all *k, size_t i,
	       double ret[INTERP_NAXES * INTERP_AXES_WAY]);

#endif /* SPEED_LOOKS_H */
