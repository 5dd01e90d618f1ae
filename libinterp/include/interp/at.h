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

#include "interp/contour.h"
#include "interp/program.h"

/**
 * interp_program_at() - the point @s_mm behind the start of segment @i, and the
 * way of each axis per mm of path there.
 *
 * @ret: by node column.  Beyond the segment's ends it is the end's.
 * Return: false for an action, two contours at once, or a segment that is not
 * sound.
 */
bool interp_program_at(const struct interp_program *p, uint32_t i, double s_mm,
		       struct interp_contour_point *ret);

/**
 * interp_program_path() - the whole of it as a path; u is the place in mm.
 *
 * @p stays the caller's.  Startup only; then a binary search for each look.
 * Return: false if the program does not move, or has two contours at once.
 */
bool interp_program_path(const struct interp_program *p,
			 struct interp_contour_path *ret);

#endif /* INTERP_AT_H */
