/* SPDX-License-Identifier: Apache-2.0 */
/*
 * way.h - a program as a path of interp/contour.h, u in mm along it
 *
 * Threads: one object, one thread.
 */
#ifndef SIM_WAY_H
#define SIM_WAY_H

#include "interp/contour.h"
#include "interp/nurbs.h"
#include "interp/program.h"

/* The curve last looked at: opening its span is most of a look. */
struct way_curve {
	bool open;
	uint32_t curve;
	struct interp_nurbs_eval eval;
};

struct way {
	const struct interp_program *program;	/* without pairs */
	struct way_curve *last;			/* zeroed by the caller */
};

/** way_at() - for interp_contour_path's at; @arg: a struct way. */
void way_at(const void *arg, double u, struct interp_contour_point *ret);

#endif /* SIM_WAY_H */
