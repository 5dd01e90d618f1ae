/* SPDX-License-Identifier: Apache-2.0 */
/*
 * at.h - the programmed point at a place on a program's path
 *
 * The point is exact: it does not depend on lattice points or on a strategy.
 * It is for those who need the speeds and accelerations of the axes, because
 * steps of whole pulses do not show them.
 *
 * Units: mm along the path and of the axes; rotary axes degrees.  Node column j
 * of the program is axis head->column[j].
 * Threads: RT-safe; a damaged block gives a false or odd numbers, no more.
 */
#ifndef INTERP_AT_H
#define INTERP_AT_H

#include "interp/foot.h"
#include "interp/nurbs.h"

struct interp_program;

/* The curve that was looked at last.  To open a span of a curve costs most of a
 * look, so it is kept.  It belongs to one program.  The caller fills it with
 * zeros at first. */
struct interp_at_curve {
	bool open;
	uint32_t curve;
	struct interp_nurbs_eval eval;
};

/**
 * interp_program_at() - the point that is @s_mm after the start of segment @i,
 * and how far each axis goes there per mm of path.
 *
 * @ret: by column of the nodes.  Outside the segment it is the point at the
 * nearer end.
 * Return: false for an action, two contours at once, or a segment that is not
 * sound.
 */
bool interp_program_at(const struct interp_program *p, uint32_t i, double s_mm,
		       struct interp_at_curve *last,
		       struct interp_contour_point *ret);

/**
 * interp_program_any_at() - the same, and for two contours at once: both at the
 * same share of their length.
 */
bool interp_program_any_at(const struct interp_program *p, uint32_t i,
			   double s_mm, struct interp_at_curve *last,
			   struct interp_contour_point *ret);

/* Both belong to the caller. */
struct interp_at_path {
	const struct interp_program *program;
	struct interp_at_curve *last;
};

/**
 * interp_program_path() - the whole program as a path; u is the place in mm.
 *
 * @w belongs to the caller, and must stay as long as the path is used.  Startup
 * only.  Each look at the path is a binary search.
 * Return: false if the program does not move, or has two contours at once.
 */
bool interp_program_path(const struct interp_at_path *w,
			 struct interp_contour_path *ret);

#endif /* INTERP_AT_H */
