/* SPDX-License-Identifier: Apache-2.0 */
/*
 * bench.h - a clock, a median, and a line the script tests/bench/run reads
 */
#ifndef BENCH_H
#define BENCH_H

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define BENCH_RUNS	7

static inline double bench_now_s(void)
{
	struct timespec t;

	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

static inline int bench_order(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

static inline double bench_median(double *v, int n)
{
	qsort(v, (size_t)n, sizeof(*v), bench_order);
	return v[n / 2];
}

/** bench_say() - one result; @name is one word. */
static inline void bench_say(const char *name, double value)
{
	printf("%s %.6g\n", name, value);
}

#endif /* BENCH_H */
