/* SPDX-License-Identifier: Apache-2.0 */
/*
 * wear.h - what a program takes off its electrodes, by estimate
 *
 *	wear(s) = sum over what is cut up to s: ratio x way down
 *
 * ratio is `wear` of the condition in force: the volume that the electrode
 * loses per volume of work removed.  Where an electrode sinks, both have the
 * same area, so it is also the length lost per depth.  Only the way down (-Z)
 * counts: what is cut sideways takes no length off the tip.  What is positioned
 * or probed, and what is cut with the power off (M5), counts nothing.
 *
 * A condition without the value makes the wear unknown: the depth that is cut
 * with it is told apart.
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
