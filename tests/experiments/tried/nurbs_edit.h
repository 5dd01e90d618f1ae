/* SPDX-License-Identifier: Apache-2.0 */
/*
 * nurbs_edit.h - the same curve with other knots, in pieces, or of a higher
 * degree
 *
 * Each function makes a new curve in memory of the caller; the old one stays as
 * it is.  Return: 0; -ENOSPC if the memory is too small; -EINVAL if it cannot
 * be done.
 *
 * Units: as in nurbs.h.  Threads: any, with a curve of their own; nothing is
 * allocated; not for the cycle.  Source: W.  Boehm, Inserting new knots into
 * B-spline curves, 1980; L.  Ramshaw, Blossoming, 1987 (degree elevation).
 */
#ifndef INTERP_NURBS_EDIT_H
#define INTERP_NURBS_EDIT_H

#include "interp/nurbs_fit.h"

/** interp_nurbs_copy() */
int interp_nurbs_copy(const struct interp_nurbs *c,
		      struct interp_nurbs_own *ret);

/** interp_nurbs_insert() - knot @u another @times; never more than degree
 *  times inside in all: -EINVAL. */
int interp_nurbs_insert(const struct interp_nurbs *c, double u, uint32_t times,
			struct interp_nurbs_own *ret);

/** interp_nurbs_split() - at @u inside the domain; @left and @right go through
 *  the same point there. */
int interp_nurbs_split(const struct interp_nurbs *c, double u,
		       struct interp_nurbs_own *left,
		       struct interp_nurbs_own *right);

/** interp_nurbs_elevate() - one degree higher; the end knots of @c stand
 *  degree + 1 times.  Every knot then stands once more. */
int interp_nurbs_elevate(const struct interp_nurbs *c,
			 struct interp_nurbs_own *ret);

#endif /* INTERP_NURBS_EDIT_H */
