/* SPDX-License-Identifier: Apache-2.0 */
/*
 * zpetc.h - zero phase error tracking of one axis
 *
 * It finds the speed to demand so that the modelled axis follows the set values
 * without lag: the inverse of the model's transfer function in z.  Zeros of the
 * model outside the circle of INTERP_ZPETC_CANCEL would become poles that are
 * not damped enough.  Each is replaced by its mirror, which leaves the phase
 * right and the size slightly wrong (Tomizuka, 1987).  For the delay, set
 * values are read ahead by whole periods.
 *
 * Units: mm, s.
 * Threads: one object, one thread; _step() is RT-safe.
 */
#ifndef INTERP_ZPETC_H
#define INTERP_ZPETC_H

#include "interp/axis_model.h"

#define INTERP_ZPETC_BEHIND	3
#define INTERP_ZPETC_AHEAD	3	/* plus the delay */
#define INTERP_ZPETC_NTAPS	(INTERP_ZPETC_BEHIND + INTERP_ZPETC_AHEAD + 1)

#define INTERP_ZPETC_CANCEL	0.7

/* Placed by the caller; fields are private. */
struct interp_zpetc {
	double tap[INTERP_ZPETC_NTAPS];	/* of the set values, oldest first */
	double pole[2], past[2];
	int delay;			/* periods */
};

/** interp_zpetc_init() - for a model that was _init()ed. Startup only. */
void interp_zpetc_init(struct interp_zpetc *z,
		       const struct interp_axis_model *m);

/**
 * interp_zpetc_step() - the speed for this period, mm/s.
 *
 * @set_mm: the present set value, in a row that can be read from
 * -INTERP_ZPETC_BEHIND to INTERP_ZPETC_AHEAD + INTERP_AXIS_DELAY_MAX.
 */
double interp_zpetc_step(struct interp_zpetc *z, const double *set_mm);

#endif /* INTERP_ZPETC_H */
