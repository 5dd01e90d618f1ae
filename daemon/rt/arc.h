/* SPDX-License-Identifier: Apache-2.0 */
/*
 * arc.h - arcs, and what is done against them, one rung after another
 *
 * The share of arcs is a mean over arc_cycles cycles with power.  Above
 * arc_share, the next rung is taken; not above it, the jump and the retract
 * have done their work and may be taken again; below half of it, for
 * arc_recover_cycles, one step of the off time is given back:
 *
 *	1 to 4		the off time, in equal steps up to arc_off_max times
 *	5		a jump out of turn
 *	6		a retract of arc_retract_mm at least
 *	7		the fault arcing, when five means in a row after the
 *			retract were above arc_share
 *
 * Rungs that the machine has not are passed over: the off time where nobody
 * knows it, the jump where there are none.
 *
 * Threads: RT-safe.
 */
#ifndef RT_ARC_H
#define RT_ARC_H

#include <stdbool.h>
#include <stdint.h>

enum arc_rung {
	ARC_NONE,
	ARC_OFF_FIRST,
	ARC_OFF_LAST = 4,
	ARC_JUMP,
	ARC_RETRACT,
	ARC_FAULT
};

struct arc {
	double sum;			/* of shares, in the mean under way */
	uint32_t cycles;		/* of it */
	uint64_t calm;			/* cycles without arcs */
	uint32_t lasting;		/* means above, after a retract */
	uint32_t rung;			/* enum arc_rung */
	bool due;			/* the rung's jump or retract */
};

struct cycle;

/** arc_watch() - once a cycle with power. */
void arc_watch(struct cycle *c);

/** arc_jump_due(), arc_retract_due() - is the rung's deed still to do? */
bool arc_jump_due(const struct cycle *c);
bool arc_retract_due(const struct cycle *c);

/** arc_retract_mm() - the least way of the retract that begins. */
double arc_retract_mm(const struct cycle *c);

/** arc_met() - the deed is done: a jump or a retract begins. */
void arc_met(struct cycle *c);

/** arc_off_us() - the off time to ask for; NAN: as it is. */
double arc_off_us(const struct cycle *c);

#endif /* RT_ARC_H */
