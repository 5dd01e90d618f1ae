/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_pair.h - from two contours to a pair segment
 */
#ifndef PATH_BUILD_PAIR_H
#define PATH_BUILD_PAIR_H

#include "interp/build.h"

struct build_pair {
	/* In. */
	struct interp_build *walks;	/* that counts what is walked */
	const struct interp_machine *machine;
	const struct interp_build_contour *contour;	/* [2] */
	enum interp_strategy strategy;
	double from_mm[INTERP_NAXES], to_mm[INTERP_NAXES];
	int32_t from[INTERP_NAXES], to[INTERP_NAXES];	/* pulses */
	const double *end_mm;	/* of all axes */
	const int64_t *to_sub;	/* the same in subpulses */
	uint32_t moved;		/* mask of axes */
	uint32_t loose;		/* axes that count from a contact */
	int64_t longest_sub;	/* of all four axes, subpulses */
	/* Out. */
	bool near_edge;		/* of the travel: ask build_edge_look() */
	struct interp_couple couple;
	int64_t start[2][2], end[2][2];	/* of each arc, from its centre,
					 * pulses */
	uint32_t ticks;
	uint64_t *bits;		/* (ticks + 63) / 64 words, or NULL; free() */
	double length_mm, fed_mm, feed_max_mm_s;
};

/** build_pair_plan() - 0, -ENOMEM, or -EINVAL with @diag's found and wanted. */
int build_pair_plan(struct build_pair *p, struct interp_diag *diag);

/** build_pair_add() - add the planned two as a segment.  Return: 0, -ENOMEM or
 *  -EINVAL with @diag's found and wanted. */
int build_pair_add(struct interp_build *b, const struct build_pair *p,
		   const struct interp_build_word *w, struct interp_diag *diag);

#endif /* PATH_BUILD_PAIR_H */
