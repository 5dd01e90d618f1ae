/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_edge.h - arcs at the end of the travel
 *
 * Private to libinterp/compile/path.
 */
#ifndef PATH_BUILD_EDGE_H
#define PATH_BUILD_EDGE_H

#include "path/build_arc.h"
#include "path/build_pair.h"

/* A look takes as long as a walk of so many points. */
#define BUILD_EDGE_POINTS	4096

/* A planned arc, or two planned contours, from where the path ends. */
struct build_edge {
	const struct build_arc *arc;	/* or NULL, and */
	const struct build_pair *pair;
	const struct interp_build_word *word;
};

/**
 * build_edge_look() - does each of its lattice points lie within the travel?
 *
 * Return: 0, -ENOMEM, or -EINVAL with @diag's found and wanted.
 */
int build_edge_look(const struct interp_build *b, const struct build_edge *e,
		    struct interp_diag *diag);

#endif /* PATH_BUILD_EDGE_H */
