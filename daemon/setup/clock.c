/* SPDX-License-Identifier: Apache-2.0 */
/*
 * clock.c - the cycle's clock
 */
#include "clock.h"
#include "clocks.h"

#include <errno.h>
#include <time.h>

#define NS_PER_S	1000000000LL

void setup_clock_start(struct setup_clock *c, int64_t period_ns)
{
	const int64_t from = clock_ns(CLOCK_MONOTONIC) + period_ns;

	c->period_ns = period_ns;
	c->next_ns = from - from % period_ns + period_ns / 2;
}

struct setup_wake setup_clock_woke(struct setup_clock *c, int64_t now_ns)
{
	struct setup_wake w = { .woke_ns = now_ns };

	if (now_ns > c->next_ns)
		w.late_ns = now_ns - c->next_ns;
	w.missed = (uint64_t)(w.late_ns / c->period_ns);
	c->next_ns += (int64_t)(w.missed + 1) * c->period_ns;
	return w;
}

struct setup_wake setup_clock_wait(struct setup_clock *c)
{
	struct timespec due = {
		.tv_sec = (time_t)(c->next_ns / NS_PER_S),
		.tv_nsec = (long)(c->next_ns % NS_PER_S),
	};

	while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due,
			       NULL) == EINTR)
		;
	return setup_clock_woke(c, clock_ns(CLOCK_MONOTONIC));
}

size_t setup_latency_bin(int64_t late_ns, size_t nbins)
{
	uint64_t us = late_ns > 0 ? (uint64_t)late_ns / 1000 : 0;

	return us < nbins ? (size_t)us : nbins - 1;
}
