/* SPDX-License-Identifier: Apache-2.0 */
/*
 * arcing.h - arcs, and what is done against them, one rung after another
 *
 * The share of arcs is a mean over arcing_cycles cycles with power.  Above
 * arcing_share, the next rung is taken; not above it, the jump and the retract
 * have done their work and may be taken again; below half of it, for
 * arcing_recover_cycles, one step of the off time is given back:
 *
 *	1 to 4		the off time, in equal steps up to arcing_off_max times
 *	5		a jump out of turn
 *	6		a retract of arcing_retract_mm at least
 *	7		the fault arcing, when five means in a row after the
 *			retract were above arcing_share
 *
 * Rungs that the machine has not are passed over: the off time where nobody
 * knows it, the jump where there are none.
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
	double sum;			/* of shares, in the mean under way */
	uint32_t cycles;		/* of it */
	uint64_t calm;			/* cycles without arcs */
	uint32_t lasting;		/* means above, after a retract */
	uint32_t rung;			/* enum arcing_rung */
	bool due;			/* the rung's jump or retract */
};

struct cycle;

/** arcing_watch() - once a cycle with power. */
void arcing_watch(struct cycle *c);

/** arcing_jump_due(), arcing_retract_due() - is the rung's deed still to do? */
bool arcing_jump_due(const struct cycle *c);
bool arcing_retract_due(const struct cycle *c);

/** arcing_retract_mm() - the least way of the retract that begins. */
double arcing_retract_mm(const struct cycle *c);

/** arcing_met() - the deed is done: a jump or a retract begins. */
void arcing_met(struct cycle *c);

/** arcing_off_us() - the off time to ask for; NAN: as it is. */
double arcing_off_us(const struct cycle *c);

#endif /* RT_ARCING_H */
