/* SPDX-License-Identifier: Apache-2.0 */
/*
 * gap.h - one reading of the gap, whatever the sensor
 *
 * A sensor may give a mean voltage, shares of the last period's pulses, or
 * three comparator lines.  The cycle works with one signal in volts and a few
 * flags.  A higher signal is a wider gap, and servo_v is the value to hold.
 *
 * 	sim, voltage	the mean voltage
 * 	shares		servo_v + share_v * (open - share_weight *
 * 			(shorted + arc) - share_set).  Without power, and in
 * 			its first cycle, no pulses were counted: then the mean
 * 			voltage, if there is one
 * 	lines		a short is 0 V, a spark the middle of the window, an
 * 			open gap twice open_v.  If several lines are on, a
 * 			short counts before a spark and a spark before an open
 * 	can		shares if the backend has them, else the voltage
 * 	counts		shares of what the generator has counted.  Their
 * 			readings are old, and come seldom: one is good for
 * 			share_mm of feed.  Before the first one, and beyond
 * 			that, it is blind: it stands
 *
 * A reading is valid only if it can be true: finite, below zero by no more than
 * the offset of an amplifier, not above 1.5 times the ignition voltage; shares
 * between 0 and 1, with a sum of 1 at most; at least one line on.
 *
 * Only `signal_v` is filtered, over filter_cycles.  A gap that narrows is seen
 * at once, in `now_v` and `contact`.
 *
 * Threads: RT-safe.
 */
#ifndef RT_GAP_H
#define RT_GAP_H

#include "settings.h"

#include <stdbool.h>
#include <stdint.h>

#define GAP_FILTER_MAX	15		/* cycles of a median */

/* This cycle's gap, as the rest of the cycle sees it. */
struct gap_reading {
	double v;			/* as read, for status and trace */
	double now_v;			/* the signal, of this cycle alone */
	double signal_v;		/* the signal, filtered */
	double arc;			/* share of arcs, 0 ... 1 */
	bool valid;
	bool contact;			/* shorted in this cycle */
	bool is_short;			/* for short_cycles in a row */
	bool is_open;			/* nothing to cut yet */
	bool suspect;			/* stuck, or noisy beyond belief */
	bool blind;			/* no reading for this place: it
					 * neither feeds nor creeps */
};

/* What sensing keeps from cycle to cycle. */
struct gap_memory {
	double past_v[GAP_FILTER_MAX];	/* the median's */
	uint32_t npast, next;
	double low_v;			/* the first order's */
	double arcing_mean_v, arcing_var_v2;
	uint64_t arcing_cycles;		/* since power came on, for the two */
	uint64_t contacts;		/* cycles in a row */
	double before_v;		/* as read, the cycle before */
	uint64_t same_cycles;		/* it did not change */
	double same_mm;			/* place since when */
	double change_v;		/* mean change from cycle to cycle */
	uint64_t powered;		/* cycles with power, in a row */
	double read_mm;			/* place of the last new shares */
	bool awaits;			/* no counts yet since power came on */
};

struct cycle;
struct io_inputs;

/** gap_sense() - fill c->sensed from this cycle's inputs. */
void gap_sense(struct cycle *c, const struct io_inputs *in);

/** gap_is_unreadable() - an invalid reading: should it be a valid one? */
bool gap_is_unreadable(const struct cycle *c, const struct io_inputs *in);

/** gap_forget() - forget all readings so far; after a fault or a hold. */
void gap_forget(struct cycle *c);

/** The window the servo stands in, from the values in force; low <= high. */
double gap_window_low_v(const struct cycle *c);
double gap_window_high_v(const struct cycle *c);

#endif /* RT_GAP_H */
