/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_from.h - begin a program at a place inside it
 *
 * After a power cut the job has to go on where it was; and an operator may name
 * a line or a place from which a program is to be cut.  The electrode is first
 * positioned to the end of the last positioning motion before that place, which
 * is off the work: along one axis out of the work, over, and along the same
 * axis in.  Then it follows the program's own path.  The ground up to the place
 * was cut already, so the gap is open there and the servo comes on at its
 * highest feed, with the gap watched.  The first spark is where the material
 * begins, wherever that is.
 *
 * The way out of the work is straight.  Nothing here knows whether an electrode
 * that still stands in the work can leave it on a straight way.
 *
 * The condition in force and the outputs that the program has switched (power,
 * polarity, pump) are those of the place.  Dwells, stops and M codes that were
 * done before it are not done again, but for an M code that the PLC was told
 * and had not answered: nobody knows whether it was heard.
 *
 * Units: mm, machine coordinates, degrees for rotary axes.
 * Threads: as interp/build.h.
 */
#ifndef INTERP_BUILD_FROM_H
#define INTERP_BUILD_FROM_H

#include "interp/build.h"

#define INTERP_PASSED_MAX	16

struct interp_build_from {
	uint32_t line;			/* the place: where this line of the
					 * text begins, when it is done for the
					 * first time; if nothing is done in
					 * it, the next one; 0: far_mm */
	double far_mm;			/* the place: along the path of the
					 * whole program */
	double now_mm[INTERP_NAXES];	/* where the axes stand */
	struct interp_probed probed;	/* by the program, before the place */
	bool probed_known;		/* false: it is not known what probing
					 * found */
	struct interp_depth depth;	/* of the cut, before the place */
	int up;				/* axis whose + leads out of the work;
					 * -1: a wire, which is cut off: the way
					 * is straight, and at its end the
					 * program stops (M0) for threading */
	uint32_t unanswered;		/* M code that the PLC was told before
					 * the place: it is told again at the
					 * end of the positioning; 0: none */
	uint32_t held;			/* electrode in the holder: if another
					 * one cuts at the place, the program
					 * stops above the work, for a change */
};

/** interp_build_set() - field @field (enum interp_tech_id) of the program's
 *  condition @cond becomes @value.  A condition that the program does not have
 *  is ignored. */
void interp_build_set(struct interp_build *b, uint32_t cond, uint32_t field,
		      double value);

/* Where and how the new program begins. */
struct interp_build_entry {
	uint32_t line;			/* of the place */
	uint32_t next_line;		/* the first line that moves after the
					 * way in */
	double far_mm;			/* the place, along the path of ... */
	double length_mm;		/* ... and the length of the whole
					 * program */
	double entry_mm[INTERP_NAXES];	/* where it comes in: the axes */
	double from_mm;			/* that point, along the path of the
					 * whole program ... */
	double way_mm;			/* ... and of the new one */
	uint32_t passed[INTERP_PASSED_MAX];	/* M codes that are not done
						 * again: as in the segments */
	uint32_t npassed;
	uint32_t again;			/* M code that is told again, in the
					 * same form; 0: none */
	uint32_t electrode;		/* that cuts at the place; 0: none */
	bool dead;			/* the power is off there: no spark */
};

/**
 * interp_build_from() - leave out what was cut before the place @o names.
 *
 * @b: a whole program, read from the same text, with the same start, as the one
 * that was interrupted.
 *
 * What the machine found by probing before the place must be known, and the
 * program must have positioned since.  A probing motion that the place is in
 * the middle of is done again.
 *
 * Return: 0; -EINVAL with @diag filled: the place is not inside, or not behind
 * such a positioning motion; -ENOMEM.  After an error @b
 * can only be destroyed.
 */
int interp_build_from(struct interp_build *b, const struct interp_build_from *o,
		      struct interp_build_entry *ret, struct interp_diag *diag);

#endif /* INTERP_BUILD_FROM_H */
