/* SPDX-License-Identifier: Apache-2.0 */
/*
 * at.h - the programmed point at a place on a program's path
 *
 * Exact: no lattice, no strategy.  What lies between two lattice points is
 * seen by whoever needs speeds and accelerations of the axes, which steps of
 * whole pulses do not tell.
 *
 * Units: mm along the path and of the axes; rotary axes degrees.  Node column j
 * of the program is axis head->column[j].
 * Threads: RT-safe; a damaged block gives a false or odd numbers, no more.
 */
#ifndef INTERP_AT_H
#define INTERP_AT_H

#include "interp/foot.h"
#include "interp/nurbs.h"
#include "interp/program.h"

/* The curve last looked at: opening its span is most of a look.  Of one program;
 * zeroed by the caller. */
struct interp_at_curve {
	bool open;
	uint32_t curve;
	struct interp_nurbs_eval eval;
};

/**
 * interp_program_at() - the point @s_mm behind the start of segment @i, and the
 * way of each axis per mm of path there.
 *
 * @ret: by node column.  Beyond the segment's ends it is the end's.
 * Return: false for an action, two contours at once, or a segment that is not
 * sound.
 */
bool interp_program_at(const struct interp_program *p, uint32_t i, double s_mm,
		       struct interp_at_curve *last,
		       struct interp_contour_point *ret);

/* Both stay the caller's. */
struct interp_at_path {
	const struct interp_program *program;
	struct interp_at_curve *last;
};

/**
 * interp_program_path() - the whole of it as a path; u is the place in mm.
 *
 * @w stays the caller's, too.  Startup only; then a binary search for each look.
 * Return: false if the program does not move, or has two contours at once.
 */
bool interp_program_path(const struct interp_at_path *w,
			 struct interp_contour_path *ret);

#endif /* INTERP_AT_H */
