/* SPDX-License-Identifier: Apache-2.0 */
/*
 * wear.h - an estimate of the length that electrodes lose in a program
 *
 *	wear(s) = sum over all cuts up to the place s: ratio x way down
 *
 * ratio is `wear` of the condition in force: the volume that the electrode
 * loses per volume of work removed.  Where an electrode sinks, both have the
 * same area, so it is also the length lost per depth.  Only the way down (-Z)
 * counts: a cut sideways takes no length off the tip.  Positioning, probing,
 * and a motion with the power off (M5) do not count.
 *
 * With a condition that has no such value the wear is unknown.  The depth that
 * is cut with it is summed separately.
 *
 * Units: mm.  Threads: any, each with an object of its own; allocates.
 */
#ifndef INTERP_WEAR_H
#define INTERP_WEAR_H

#include "interp/program.h"

/* Up to place s_mm of the path, and evenly from there to the next one. */
struct interp_wear_part {
	double s_mm;
	double wear_mm;
	double unknown_mm;		/* depth cut without a ratio */
};

/* An electrode that cuts from here on. */
struct interp_wear_change {
	double s_mm;
	uint32_t seg;			/* its segment of the program */
	uint32_t number;
	bool stops;			/* for a person */
};

struct interp_wear {
	struct interp_wear_part *part;	/* private */
	size_t nparts, room;
	struct interp_wear_change change[INTERP_ELECTRODES_MAX];
	uint32_t nchanges;
};

/** interp_wear_measure() - Return: 0 or -ENOMEM.  interp_wear_free() in any
 *  case. */
int interp_wear_measure(struct interp_wear *ret,
			const struct interp_program *p);
void interp_wear_free(struct interp_wear *w);

/** interp_wear_at() - up to place @s_mm.  RT-safe. */
struct interp_wear_part interp_wear_at(const struct interp_wear *w,
				       double s_mm);

#endif /* INTERP_WEAR_H */
