/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_curve.h - a NURBS among those of the program
 *
 * Private to libinterp/path.
 */
#ifndef PATH_BUILD_CURVE_H
#define PATH_BUILD_CURVE_H

#include "interp/build.h"

/**
 * build_curve_store() - add the axes of a sound curve that move, and its knots.
 *
 * @ret gets it as stored, of no axes if none moves; @ret_moved a bit for each
 * axis.  Return: 0 or -ENOMEM.
 */
int build_curve_store(struct interp_build *b, const struct interp_build_curve *c,
		      struct interp_curve *ret, uint32_t *ret_moved);

#endif /* PATH_BUILD_CURVE_H */
