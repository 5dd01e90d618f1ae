/* SPDX-License-Identifier: Apache-2.0 */
/*
 * to_build.h - a work system that is turned: what stands between the contours
 * and the builder
 *
 * A reader and the contours work in places that are turned back: the q of
 * interp/turn.h.
 *
 * An arc or a curve that does not lie in X Y (or U V) is refused while there is
 * a turn: it would be none of the builder's.  The functions are otherwise as
 * the builder's of the same names.
 *
 * Threads: any; allocates.  Never in the cycle.
 */
#ifndef WIRE_TO_BUILD_H
#define WIRE_TO_BUILD_H

#include "wire/guide.h"

/** guides_here() - the q of interp_build_here(). */
void guides_here(const struct guides *g, double ret_q_mm[INTERP_NAXES]);

int guides_line(const struct guides *g, const double end_mm[INTERP_NAXES],
	      const struct interp_build_word *w, struct interp_diag *diag);
int guides_arc(const struct guides *g, const double end_mm[INTERP_NAXES],
	     const struct interp_build_arc *arc,
	     const struct interp_build_word *w, struct interp_diag *diag);
int guides_pair(const struct guides *g, const double end_mm[INTERP_NAXES],
	      const struct interp_build_contour contour[2],
	      const struct interp_build_word *w, struct interp_diag *diag);
int guides_curve(const struct guides *g, const struct interp_build_curve *c,
	       const struct interp_build_word *w, struct interp_diag *diag);

/** guides_escape() - a way out along a turned axis alone is none of the
 *  builder's: then it is along the path. */
int guides_escape(const struct guides *g, const struct interp_escape *e);

#endif /* WIRE_TO_BUILD_H */
