/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_arc.h - from the words of a G2 or G3 to an arc segment
 */
#ifndef PATH_BUILD_ARC_H
#define PATH_BUILD_ARC_H

#include "interp/build.h"

struct build_arc {
	/* In. */
	const struct interp_machine *machine;
	const struct interp_build_arc *word;
	enum interp_strategy strategy;
	double from_mm[INTERP_NAXES], to_mm[INTERP_NAXES];
	int32_t from[INTERP_NAXES], to[INTERP_NAXES];	/* pulses */
	int64_t others_sub;	/* the longest straight axis, subpulses */
	/* Out. */
	bool straight;		/* too short to be an arc: make it a line */
	struct interp_arc arc;
	uint32_t ticks;
	double length_mm, feed_max_mm_s;
};

/** build_arc_plan() - 0, or -EINVAL with @diag's found and wanted. */
int build_arc_plan(struct build_arc *p, struct interp_diag *diag);

/** build_refuse_travel() - say that an axis leaves its travel; -EINVAL. */
int build_refuse_travel(const struct interp_machine *m, int axis,
			double at_mm, struct interp_diag *diag);

#endif /* PATH_BUILD_ARC_H */
