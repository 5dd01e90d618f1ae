/* SPDX-License-Identifier: Apache-2.0 */
/*
 * clock.h - when to wake next, how late a wake was, how many periods went by
 *
 * The next wake is the last one plus one period, never "now" plus one period,
 * so that lateness does not add up. A thread that wakes a whole period or more
 * too late has missed periods. They are counted and skipped; nobody makes up
 * for them.
 *
 * Units: ns of CLOCK_MONOTONIC.
 *
 * Threads: RT-safe; one object belongs to one thread.
 */
#ifndef SETUP_CLOCK_H
#define SETUP_CLOCK_H

#include <stddef.h>
#include <stdint.h>

struct setup_clock {
	int64_t period_ns;
	int64_t next_ns;		/* the wake to come, or just come */
};

struct setup_wake {
	int64_t woke_ns;
	int64_t late_ns;		/* after the time it was due, >= 0 */
	uint64_t missed;		/* whole periods that went by */
};

/**
 * setup_clock_start() - the first wake is half a period to one and a half from
 * now.
 *
 * It is in the middle between two multiples of the period.  The kernel's tick
 * comes at multiples of 1, 4 or 10 ms, so with the usual periods no wake has to
 * wait for a tick.
 */
void setup_clock_start(struct setup_clock *c, int64_t period_ns);

/** setup_clock_wait() - sleep until the next wake is due. */
struct setup_wake setup_clock_wait(struct setup_clock *c);

/**
 * setup_clock_woke() - the calculation of setup_clock_wait(), without the
 * clock.
 *
 * For a wake that was due at c->next_ns and came at @now_ns: sets c->next_ns to
 * the next one, which is more than 0 and at most one period after @now_ns.
 */
struct setup_wake setup_clock_woke(struct setup_clock *c, int64_t now_ns);

/**
 * setup_latency_bin() - bin of 1 us for @late_ns; the last bin holds everything
 * above.
 */
size_t setup_latency_bin(int64_t late_ns, size_t nbins);

#endif /* SETUP_CLOCK_H */
