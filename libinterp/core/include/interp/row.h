/* SPDX-License-Identifier: Apache-2.0 */
/*
 * row.h - the row of the last set values as a path to stand square to
 *
 * Where the set values turn back, so does the row.  Its chords are at least
 * INTERP_ROW_SPACING_MM long, so that steps of a pulse are not its corners.
 *
 * Units: mm; u counts the points.
 * Threads: one object, one thread; RT-safe.
 */
#ifndef INTERP_ROW_H
#define INTERP_ROW_H

#include "interp/foot.h"

#include <stdint.h>

#define INTERP_ROW_POINTS	512	/* a power of two */
#define INTERP_ROW_SPACING_MM	0.005

/* Placed by the caller; fields are private. */
struct interp_row {
	double mm[INTERP_ROW_POINTS][INTERP_NAXES];
	uint64_t n;			/* points so far */
	struct interp_contour_path path;
};

/** interp_row_begin() - anew, with @mm. */
void interp_row_begin(struct interp_row *r, int naxes, const double *mm);

/** interp_row_foot() - a foot at its end. */
void interp_row_foot(const struct interp_row *r, struct interp_contour *foot);

/** interp_row_take() - the next set value. */
void interp_row_take(struct interp_row *r, const double *mm);

/**
 * interp_row_error() - how far @mm is from the row, by a @foot on it.
 *
 * Nothing before the row has a length.  A foot that fell out of the row is
 * taken up at its end.
 */
void interp_row_error(const struct interp_row *r, struct interp_contour *foot,
		      const double *mm, struct interp_contour_error *ret);

#endif /* INTERP_ROW_H */
