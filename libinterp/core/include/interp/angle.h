/* SPDX-License-Identifier: Apache-2.0 */
/*
 * angle.h - the constants of angles, and whole turns
 *
 * An angle in degrees times ANGLE_DEGREE is in radians; one in radians times
 * ANGLE_RADIAN is in degrees.
 *
 * Threads: any; nothing here has state.
 */
#ifndef INTERP_ANGLE_H
#define INTERP_ANGLE_H

#include <math.h>

#define ANGLE_TURN	(2 * M_PI)	/* radians of a whole turn */
#define ANGLE_RIGHT	(M_PI / 2)	/* radians of a right angle */
#define ANGLE_DEGREE	(M_PI / 180)	/* radians of a degree */
#define ANGLE_RADIAN	(180 / M_PI)	/* degrees of a radian */

/** angle_nearest() - @angle and so many whole turns that it is nearest to
 *  @wanted; radians. */
static inline double angle_nearest(double angle, double wanted)
{
	return angle + ANGLE_TURN * floor((wanted - angle) / ANGLE_TURN + 0.5);
}

/** angle_ahead() - @angle and so many whole turns that it is in [0, one turn);
 *  radians. */
static inline double angle_ahead(double angle)
{
	return angle - ANGLE_TURN * floor(angle / ANGLE_TURN);
}

#endif /* INTERP_ANGLE_H */
