/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pulser.h - from targets in pulses to levels on step and direction lines
 *
 * One call is one period, and changes each line at most once. All axes make a
 * lattice point in the same round: first their directions change, then, after
 * the set-up time, all step lines change together. So axes that move in the
 * same point pulse in the same write.
 *
 * 	dir	____/------------------------
 * 		    | setup | high | low  |
 * 	step	____________/------\______/---
 *
 * In quadrature the two lines of an axis are A and B. A quarter turn is one
 * pulse, and A leads B in the positive direction.
 *
 * A period may be shorter than it should be, because the one before was late.
 * So whoever calls this asks pulser_level_ns() first, and waits.
 *
 * Units: times in periods, ns. Threads: RT-safe.
 */
#ifndef IO_PULSER_H
#define IO_PULSER_H

#include "io.h"

struct pulser_config {
	uint32_t high, low;		/* of a step; in quadrature, high is */
	uint32_t dir_setup, dir_hold;	/* the least between two edges */
	bool quadrature;
	int64_t high_ns, low_ns, setup_ns;	/* at least, whatever a period
					 * takes */
};

enum pulser_phase {
	PULSER_READY,
	PULSER_SETUP,			/* directions stand, steps to come */
	PULSER_HIGH,
	PULSER_LOW,			/* or, in quadrature, between edges */
};

struct pulser {
	struct pulser_config c;
	int32_t put[IO_NAXES];		/* pulses, as put out */
	uint32_t step, dir;		/* levels, a bit per axis; in */
					/* quadrature A and B */

	/* Private. */
	enum pulser_phase phase;
	uint32_t left;			/* periods of the phase */
	uint32_t hold;			/* periods before dir may change */
	uint8_t turn[IO_NAXES];		/* quarter turns, 0 ... 3 */
	bool behind;			/* put is not yet at the target */
};

/** pulser_init() - all lines low, at 0 pulses.  Startup only. */
void pulser_init(struct pulser *p, const struct pulser_config *c);

/** pulser_stand_at() - the machine is at @at by word; no line changes. */
void pulser_stand_at(struct pulser *p, const int32_t *at);

/** pulser_period() - one period on the way to @target. */
void pulser_period(struct pulser *p, const int32_t *target);

/**
 * pulser_busy() - a lattice point of the next period could not begin then.
 *
 * Whoever gives none while it is true is never more than one point ahead.
 */
bool pulser_busy(const struct pulser *p);

/** pulser_level_ns() - the present levels must last at least this long. */
int64_t pulser_level_ns(const struct pulser *p);

/** pulser_wait() - one period in which the levels stay as they are. */
void pulser_wait(struct pulser *p, const int32_t *target);

/** pulser_periods() - between two pulses of one direction, at the least. */
uint32_t pulser_periods(const struct pulser_config *c);

#endif /* IO_PULSER_H */
