/* SPDX-License-Identifier: Apache-2.0 */
/*
 * mover.h - go to another place on the path, within speed and acceleration
 *
 * A trapezoidal move along the path, in either direction.  Jumps, retracts by
 * command and positioning use this one.
 *
 * Units: mm along the path, + toward the program's end.
 * Threads: RT-safe.
 */
#ifndef RT_MOVER_H
#define RT_MOVER_H

#include <stdbool.h>

struct mover {
	double v_mm_s;			/* signed */
};

struct mover_limits {
	double v_max_mm_s, a_max_mm_s2;
	double period_s;
};

/**
 * mover_step() - the distance to walk this cycle to come nearer to a place
 * @left_mm away (signed).
 *
 * The place is met exactly and never passed, unless the speed is too high to
 * brake before it: then it is passed, and come back to.  The speed is 0 from
 * the cycle after the one that met it.
 */
double mover_step(struct mover *m, const struct mover_limits *l,
		  double left_mm);

/** mover_stop() - the distance this cycle while braking to a stand. */
double mover_stop(struct mover *m, const struct mover_limits *l);

#endif /* RT_MOVER_H */
