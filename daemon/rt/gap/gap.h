/* SPDX-License-Identifier: Apache-2.0 */
/*
 * gap.h - one reading of the gap, whatever the sensor
 *
 * A mean voltage, shares of the last period's pulses, or three comparator
 * lines: the cycle works on one signal in volts, + is wider, with servo_v the
 * value to hold, and on a few flags.
 *
 *	sim, voltage	the mean voltage
 *	shares		servo_v + share_v * (open - share_weight *
 *			(shorted + arc) - share_set); without power, and in
 *			its first cycle, where there are no pulses to count,
 *			the mean voltage if there is one
 *	lines		short 0 V, spark the middle of the window, open twice
 *			open_v; a short before a spark before an open
 *	can		shares where the backend has them, else the voltage
 *
 * A reading counts as valid only if it can be true: finite, not below zero by
 * more than an amplifier's offset, not above 1.5 times the ignition voltage;
 * shares between 0 and 1, together no more than 1; one line at least.
 *
 * Filtered over filter_cycles is `signal_v` alone.  What narrows is seen at
 * once, in `now_v` and `contact`.
 *
 * Threads: RT-safe.
 */
#ifndef RT_GAP_H
#define RT_GAP_H

#include <stdbool.h>
#include <stdint.h>

#define GAP_FILTER_MAX	15		/* cycles of a median */

enum gap_source {
	GAP_SIM,
	GAP_VOLTAGE,
	GAP_SHARES,
	GAP_LINES,
	GAP_CAN,
	GAP_NSOURCES
};

enum gap_filter {
	GAP_MEDIAN,
	GAP_FIRST_ORDER,
	GAP_NFILTERS
};

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
};

struct cycle;
struct io_inputs;

/** gap_sense() - fill c->sensed from this cycle's inputs. */
void gap_sense(struct cycle *c, const struct io_inputs *in);

/** gap_is_unreadable() - an invalid reading: should it be a valid one? */
bool gap_is_unreadable(const struct cycle *c, const struct io_inputs *in);

/** gap_forget() - what was before says nothing, after a fault or a hold. */
void gap_forget(struct cycle *c);

/** The window the servo stands in, from the values in force; low <= high. */
double gap_window_low_v(const struct cycle *c);
double gap_window_high_v(const struct cycle *c);

#endif /* RT_GAP_H */
