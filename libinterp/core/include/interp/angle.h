/* SPDX-License-Identifier: Apache-2.0 */
/*
 * angle.h - the constants of angles
 *
 * An angle in degrees times ANGLE_DEGREE is in radians; one in radians times
 * ANGLE_RADIAN is in degrees.
 *
 * Threads: any; constants.
 */
#ifndef INTERP_ANGLE_H
#define INTERP_ANGLE_H

#include <math.h>

#define ANGLE_TURN	(2 * M_PI)	/* radians of a whole turn */
#define ANGLE_RIGHT	(M_PI / 2)	/* radians of a right angle */
#define ANGLE_DEGREE	(M_PI / 180)	/* radians of a degree */
#define ANGLE_RADIAN	(180 / M_PI)	/* degrees of a radian */

#endif /* INTERP_ANGLE_H */
