/* SPDX-License-Identifier: Apache-2.0 */
/*
 * turn.h - a work system that is turned about Z
 *
 *	machine place = R(angle) * q		X Y, and U V alike
 *
 * + is from X toward Y, about machine zero.  Z and the rotary axes stay as they
 * are.  Without a turn q is the machine place, to the last bit.
 *
 * Threads: any; nothing here has state.
 */
#ifndef INTERP_TURN_H
#define INTERP_TURN_H

#include "interp/axis.h"

/* All 0: no turn. */
struct interp_turn {
	double deg;			/* 0: none */
	double cos, sin;
};

struct interp_turn interp_turn_of(double deg);

/** interp_turn_to() - the machine place of @q_mm; @ret_mm may be @q_mm. */
void interp_turn_to(const struct interp_turn *t,
		    const double q_mm[INTERP_NAXES],
		    double ret_mm[INTERP_NAXES]);

/** interp_turn_back() - the q of a machine place; @ret_q_mm may be @mm. */
void interp_turn_back(const struct interp_turn *t,
		      const double mm[INTERP_NAXES],
		      double ret_q_mm[INTERP_NAXES]);

#endif /* INTERP_TURN_H */
