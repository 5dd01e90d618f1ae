/* SPDX-License-Identifier: Apache-2.0 */
/* arc_turn.h - an arc from where a builder stands, told by its sense */
#ifndef TESTS_ARC_TURN_H
#define TESTS_ARC_TURN_H

#include "interp/build.h"

/* Equal ends make a full circle. */
static inline void arc_turn(struct interp_build_arc *a,
			    const struct interp_build *b,
			    const double end_mm[INTERP_NAXES], bool clockwise)
{
	const double *here = interp_build_here(b);

	a->sweep = interp_build_sweep(
		(double[]) { here[a->axis_a], here[a->axis_b] },
		(double[]) { end_mm[a->axis_a], end_mm[a->axis_b] },
		(double[]) { a->centre_a_mm, a->centre_b_mm }, clockwise);
}

#endif /* TESTS_ARC_TURN_H */
