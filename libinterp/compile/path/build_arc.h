/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_arc.h - from the words of a G2 or G3 to an arc segment
 */
#ifndef PATH_BUILD_ARC_H
#define PATH_BUILD_ARC_H

#include "interp/build.h"
#include "path/build_rule.h"
#include "pulse/pulse.h"

struct build_arc {
	/* In. */
	const struct interp_build_options *o;
	struct interp_build *walks;	/* that counts what is walked */
	const struct interp_build_arc *word;
	double from_mm[INTERP_NAXES], to_mm[INTERP_NAXES];
	const double *end_mm;	/* of all axes */
	const int64_t *to_sub;	/* the same in subpulses */
	uint32_t moved;		/* mask of axes */
	struct build_way way;	/* all axes except those of the plane */
	uint32_t loose;		/* axes that count from a contact */
	/* Out. */
	bool straight;		/* too short to be an arc: make it a line */
	bool near_edge;		/* of the travel: ask build_edge_look() */
	struct interp_arc arc;
	double mid_mm[2];	/* between its halves */
	uint32_t ticks;
	double length_mm, feed_max_mm_s;
	struct circle_plan runs;	/* if arc.nruns > 0 */
};

/**
 * build_arc_shape() - fill the arc with centre, radii and angles, from @p's
 * word and ends.
 *
 * Of o only the machine is used.
 */
void build_arc_shape(struct build_arc *p);

enum build_arc_ends {
	BUILD_ARC_AS_IT_IS,		/* on one already, or a line */
	BUILD_ARC_MOVED,		/* round another centre */
	BUILD_ARC_HALVES,
};

/**
 * build_arc_even() - the ends of the shape @p are rounded, and lie on two
 * circles round a centre that is rounded, too.  How do they come onto one?
 *
 * The centre moves along the chord, into @word.  On an arc that nearly comes
 * back to its start it would move by far more than a rounding: such an arc
 * becomes two, with the place p->mid_mm between them, whose chords are long.
 */
enum build_arc_ends build_arc_even(struct build_arc *p,
				   struct interp_build_arc *word);

/** build_arc_plan() - of a shape.  0, or -EINVAL with @diag's found and
 *  wanted. */
int build_arc_plan(struct build_arc *p, struct interp_diag *diag);

/** build_arc_kept() - numbers that the program keeps of a planned arc: its runs
 *  and what a seek begins at. */
uint64_t build_arc_kept(const struct build_arc *p);

/** build_arc_runs() - write them. */
void build_arc_runs(const struct build_arc *p, struct interp_arc *arc,
		    int32_t *runs);

/** build_arc_add() - add a planned arc as a segment.  Return: 0, -ENOMEM or
 *  -EINVAL with @diag's found and wanted. */
int build_arc_add(struct interp_build *b, const struct build_arc *p,
		  const struct interp_build_word *w, struct interp_diag *diag);

/** build_refuse_travel() - say that an axis leaves its travel, as the program
 *  counts; -EINVAL. */
int build_refuse_travel(const struct interp_build *b, int axis, double at_mm,
			struct interp_diag *diag);

#endif /* PATH_BUILD_ARC_H */
