/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_edge.h - arcs at the end of the travel
 *
 * Private to libinterp/compile/path.
 */
#ifndef PATH_BUILD_EDGE_H
#define PATH_BUILD_EDGE_H

#include "interp/build.h"

/* An arc, or two contours, from where the path ends to @end_mm. */
struct build_edge {
	const double *end_mm;
	const struct interp_build_arc *arc;		/* or NULL, and */
	const struct interp_build_contour *contour;	/* [2] */
	const struct interp_build_word *word;
};

/**
 * build_edge_walk() - walk it, and see whether each of its lattice points lies
 * within the travel.  It takes as long as the arc.
 *
 * Return: 0, -ENOMEM, or -EINVAL with @diag's found and wanted.
 */
int build_edge_walk(const struct interp_build *b, const struct build_edge *e,
		    struct interp_diag *diag);

#endif /* PATH_BUILD_EDGE_H */
