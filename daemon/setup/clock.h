/* SPDX-License-Identifier: Apache-2.0 */
/*
 * clock.h - when to wake next, how late it was, how many periods went by
 *
 * The next wake is the last plus one period, never "now" plus one: lateness
 * does not add up.  Whoever wakes a whole period or more too late has missed
 * periods; they are counted and skipped, not made up for.
 *
 * Units: ns of CLOCK_MONOTONIC.
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

/** setup_now_ns() - CLOCK_MONOTONIC. */
int64_t setup_now_ns(void);

/** setup_clock_start() - the first wake is one period from now. */
void setup_clock_start(struct setup_clock *c, int64_t period_ns);

/** setup_clock_wait() - sleep until the next wake is due. */
struct setup_wake setup_clock_wait(struct setup_clock *c);

/**
 * setup_clock_woke() - the reckoning of setup_clock_wait(), pure.
 *
 * For a wake due at c->next_ns that came at @now_ns: sets c->next_ns to the
 * one after, more than 0 and at most one period from @now_ns.
 */
struct setup_wake setup_clock_woke(struct setup_clock *c, int64_t now_ns);

/** setup_latency_bin() - bin of 1 us for @late_ns; the last holds all above. */
size_t setup_latency_bin(int64_t late_ns, size_t nbins);

#endif /* SETUP_CLOCK_H */
