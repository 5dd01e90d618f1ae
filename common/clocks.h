/* SPDX-License-Identifier: Apache-2.0 */
/*
 * clocks.h - the time of a clock, as one number
 *
 * CLOCK_MONOTONIC is for waiting and measuring, CLOCK_REALTIME for what a
 * person reads.
 *
 * Threads: any; RT-safe.
 */
#ifndef COMMON_CLOCKS_H
#define COMMON_CLOCKS_H

#include <stdint.h>
#include <time.h>

static inline int64_t clock_ns(clockid_t clock)
{
	struct timespec t;

	clock_gettime(clock, &t);
	return t.tv_sec * INT64_C(1000000000) + t.tv_nsec;
}

static inline int64_t clock_us(clockid_t clock)
{
	return clock_ns(clock) / 1000;
}

static inline int64_t clock_ms(clockid_t clock)
{
	return clock_ns(clock) / 1000000;
}

static inline double clock_s(clockid_t clock)
{
	return (double)clock_ns(clock) * 1e-9;
}

#endif /* COMMON_CLOCKS_H */
