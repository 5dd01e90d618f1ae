/* SPDX-License-Identifier: Apache-2.0 */
/*
 * zpetc.h - zero phase error tracking of one axis
 *
 * The speed to demand so that the modelled axis follows the set values without
 * lag: the model's quotient in z turned over.  Its zeros outside the circle of
 * INTERP_ZPETC_CANCEL cannot be turned into poles; they are answered by their
 * mirror, which leaves the size slightly wrong and the phase right (Tomizuka,
 * 1987).  The delay is answered by looking ahead, in whole periods.
 *
 * Units: mm, s.
 * Threads: one object, one thread; _step() is RT-safe.
 */
#ifndef INTERP_ZPETC_H
#define INTERP_ZPETC_H

#include "interp/axis_model.h"

#define INTERP_ZPETC_BEHIND	3
#define INTERP_ZPETC_AHEAD	3	/* and the delay */
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
