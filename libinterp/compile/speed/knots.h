/* SPDX-License-Identifier: Apache-2.0 */
/*
 * knots.h - the speeds of a way as a table of few knots
 *
 * Private to libinterp/compile/speed.
 */
#ifndef SPEED_KNOTS_H
#define SPEED_KNOTS_H

#include "speed/profile.h"

#include "interp/speeds.h"

/**
 * knots_make() - the table of @p, which is solved.
 *
 * @ret: to be freed; its time begins with 0
 * Return: how many knots, or -ENOMEM.
 */
long knots_make(const struct profile *p, const struct interp_axes *x,
		struct interp_speed_knot **ret);

#endif /* SPEED_KNOTS_H */
