/* SPDX-License-Identifier: Apache-2.0 */
/*
 * row.h - the last set values in a row, as a path to measure a contour error by
 *
 * Where the set values turn back, the row turns back too.  Its chords are at
 * least INTERP_ROW_SPACING_MM long, so that a step of one pulse does not make a
 * corner.
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

/** interp_row_begin() - begin a new row, with @mm as its only point. */
void interp_row_begin(struct interp_row *r, int naxes, const double *mm);

/** interp_row_foot() - put a foot at the end of the row. */
void interp_row_foot(const struct interp_row *r, struct interp_contour *foot);

/** interp_row_take() - add the next set value to the row. */
void interp_row_take(struct interp_row *r, const double *mm);

/**
 * interp_row_error() - how far @mm is from the row, by a @foot on it.
 *
 * The row has no length before its first point.  A foot whose place has been
 * dropped from the row begins again at the end of the row.
 */
void interp_row_error(const struct interp_row *r, struct interp_contour *foot,
		      const double *mm, struct interp_contour_error *ret);

#endif /* INTERP_ROW_H */
