/* SPDX-License-Identifier: Apache-2.0 */
/*
 * turn.h - a work system, or a figure of a program, that is turned about Z or
 * mirrored
 *
 *	machine place = R(angle) * D * q	X Y, and U V alike
 *
 * + is from X toward Y, about machine zero.  D is 1, or it changes the sign of
 * Y (V): with an angle of 180 degrees that is the mirror image of X, with 90
 * degrees X and Y are exchanged.  Z and the rotary axes stay as they are.
 * Without a turn and by whole quarters q is the machine place, or its mirror
 * image, to the last bit.
 *
 * Threads: any; nothing here has state.
 */
#ifndef INTERP_TURN_H
#define INTERP_TURN_H

#include "interp/axis.h"

#include <stdbool.h>

/* All 0: no turn. */
struct interp_turn {
	double deg;			/* 0: none */
	bool mirrored;
	double cos, sin;
};

struct interp_turn interp_turn_of(double deg, bool mirrored);

/** interp_turn_image() - a turn by @deg of the image that changes the sign of
 *  X, of Y, or exchanges both. */
struct interp_turn interp_turn_image(double deg, bool x, bool y,
				     bool exchanged);

static inline bool interp_turn_is_on(const struct interp_turn *t)
{
	return t->deg != 0 || t->mirrored;
}

/** interp_turn_plane() - two places only, X Y or U V; @to may be @from. */
void interp_turn_plane(const struct interp_turn *t, const double from[2],
		       double to[2]);

/** interp_turn_plane_back() - the q of them. */
void interp_turn_plane_back(const struct interp_turn *t, const double from[2],
			    double to[2]);

/** interp_turn_to() - the machine place of @q_mm; @ret_mm may be @q_mm. */
void interp_turn_to(const struct interp_turn *t,
		    const double q_mm[INTERP_NAXES],
		    double ret_mm[INTERP_NAXES]);

/** interp_turn_back() - the q of a machine place; @ret_q_mm may be @mm. */
void interp_turn_back(const struct interp_turn *t,
		      const double mm[INTERP_NAXES],
		      double ret_q_mm[INTERP_NAXES]);

#endif /* INTERP_TURN_H */
