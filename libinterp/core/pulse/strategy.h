/* SPDX-License-Identifier: Apache-2.0 */
/*
 * strategy.h - the strategies: how a path becomes pulses, one row for each
 *
 * A new strategy needs its walk, or its rule for a pair of axes, in a file of
 * this folder; the declaration of that in pulse.h or pair.h; and a row in
 * interp/strategies.h.
 *
 * Threads: plain data; RT-safe.
 */
#ifndef PULSE_STRATEGY_H
#define PULSE_STRATEGY_H

#include "pulse/pair.h"
#include "pulse/pulse.h"

struct pulse_strategy {
	const char *name;

	/* Lines of one or two axes, and of any number that are coupled as a
	 * tree. */
	const struct interp_walk *line;
	/* Lines of three or more axes that are coupled as a star. */
	const struct interp_walk *flat;
	/* Arcs; NULL: a circle or a helix, one axis at a time. */
	const struct interp_walk *arc;
	/* Two contours together. */
	const struct interp_walk *pair;

	/* Where a pair changes from one input to the other; NULL: toward the
	 * line. */
	void (*set)(struct interp_pair *p, int64_t half, bool at_end);
	uint32_t least_milli;		/* the smallest tolerance, 1/1000
					 * pulse */

	bool at_once;			/* all axes may pulse in one tick */
	bool takes_tolerance;		/* mu says how far it may be off */
	bool couples;			/* the coupling of the axes can be
					 * chosen */
	bool runs;			/* stays with an axis for many pulses,
					 * around a circle, too */
};

/** pulse_strategy() - the row of @s, which is below INTERP_NSTRATEGIES. */
const struct pulse_strategy *pulse_strategy(uint32_t s);

/**
 * pulse_curve_turns() - how many ticks of a curve one point may need: one for
 * each axis, if they pulse one at a time.
 */
static inline uint32_t pulse_curve_turns(uint32_t strategy, uint32_t naxes)
{
	const struct pulse_strategy *s = pulse_strategy(strategy);

	return s->at_once ? 1 : naxes;
}

#endif /* PULSE_STRATEGY_H */
