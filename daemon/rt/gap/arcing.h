/* SPDX-License-Identifier: Apache-2.0 */
/*
 * arcing.h - what is done against arcs, one step after another
 *
 * The share of arcs among the pulses is averaged over arcing_cycles cycles with
 * power.  An average above arcing_share takes the next step; one that is not
 * above it means that the jump and the retract have done their work, and they
 * may be taken again later.  While the average is below half of arcing_share,
 * one step of the off time is given back every arcing_recover:
 *
 * 	1 to 4		the off time grows, in equal steps, to arcing_off_max
 * 			times its own length
 * 	5		a jump at once
 * 	6		a retract of arcing_retract_mm at least
 * 	7		the fault `arcing`, when five averages in a row after
 * 			the retract were above arcing_share
 *
 * A step that the machine cannot take is left out: the off time where it is not
 * known, the jump on a machine without jumps.
 *
 * Threads: RT-safe.
 */
#ifndef RT_ARCING_H
#define RT_ARCING_H

#include <stdbool.h>
#include <stdint.h>

enum arcing_rung {
	ARCING_NONE,
	ARCING_OFF_FIRST,
	ARCING_OFF_LAST = 4,
	ARCING_JUMP,
	ARCING_RETRACT,
	ARCING_FAULT
};

struct arcing {
	double sum;			/* of the shares in this average ... */
	uint32_t cycles;		/* ... and how many there are */
	uint64_t calm;			/* cycles since the last step, without
					 * arcs */
	uint32_t lasting;		/* averages above arcing_share, after a
					 * retract */
	uint32_t rung;			/* enum arcing_rung */
	bool due;			/* the jump or retract of this rung is
					 * still to be done */
};

struct cycle;

/** arcing_watch() - once a cycle with power. */
void arcing_watch(struct cycle *c);

/** arcing_jump_due(), arcing_retract_due() - is one asked for, and not done? */
bool arcing_jump_due(const struct cycle *c);
bool arcing_retract_due(const struct cycle *c);

/** arcing_retract_mm() - how far the retract that begins goes at least. */
double arcing_retract_mm(const struct cycle *c);

/** arcing_met() - what was asked for is done: a jump or a retract begins. */
void arcing_met(struct cycle *c);

/** arcing_off_us() - the off time to ask for; NAN: as it is. */
double arcing_off_us(const struct cycle *c);

#endif /* RT_ARCING_H */
