/* SPDX-License-Identifier: Apache-2.0 */
/*
 * bench.h - a clock, a median, a program in memory, and the form of a result
 * line that the script tests/bench/run reads
 */
#ifndef BENCH_H
#define BENCH_H

#include "interp/build.h"

#include <math.h>
#include <stdbool.h>
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

static inline void bench_must(bool good)
{
	if (!good)
		exit(70);
}

/** bench_program() - what was built, laid out; @b is no more. */
static inline struct interp_program bench_program(struct interp_build *b)
{
	const struct interp_build_about about = { .lines = 1 };
	size_t bytes;
	void *block = interp_build_take(b, &about, &bytes);
	struct interp_program p;

	bench_must(block != NULL);
	interp_build_destroy(b);
	bench_must(interp_program_map(&p, block, bytes) == 0);
	return p;
}

/* One segment, walked by one strategy. */
struct bench_path {
	const char *name;
	enum interp_strategy strategy;
	enum interp_coupling coupling;
	int axes;			/* 0: a circle in X and Y; BENCH_PAIR:
					 * and a smaller one in U and V */
};

#define BENCH_PAIR	(-1)
#define BENCH_REACH_MM	100.0

/** bench_circle() - of @r_mm in X and Y, and, for a pair, the half in U V. */
static inline int bench_circle(struct interp_build *b, double r_mm, bool pair)
{
	const double to[INTERP_NAXES] = { 0 };
	const struct interp_build_word w = { .line = 1, .feed_mm_s = 1 };
	const struct interp_build_arc arc = {
		.axis_a = INTERP_X, .axis_b = INTERP_Y, .centre_a_mm = r_mm,
		.sweep = 2 * M_PI,
	};
	const struct interp_build_contour both[2] = {
		{ .arc = true, .centre_mm = { r_mm }, .sweep = 2 * M_PI },
		{ .arc = true, .centre_mm = { r_mm / 2 }, .sweep = 2 * M_PI },
	};
	struct interp_diag d;

	return pair ? interp_build_pair(b, to, both, &w, &d) :
		      interp_build_arc(b, to, &arc, &w, &d);
}

/** bench_path() - it alone as a program, of about 100 mm. */
static inline struct interp_program
bench_path(const struct interp_machine *machine, const struct bench_path *p)
{
	const struct interp_build_options o = {
		.machine = machine, .strategy = p->strategy,
		.tolerance_milli = 2000, .coupling = p->coupling,
	};
	const struct interp_build_word w = { .line = 1, .feed_mm_s = 1 };
	struct interp_build *b = interp_build_create(&o);
	double to[INTERP_NAXES] = { 0 };
	struct interp_diag d;

	for (int i = 0; i < p->axes; i++)
		to[i] = BENCH_REACH_MM / (1 + 0.37 * i);
	bench_must(b && !(p->axes > 0 ? interp_build_line(b, to, &w, &d) :
			  bench_circle(b, BENCH_REACH_MM / 4, p->axes != 0)));
	return bench_program(b);
}

/** bench_say() - one result; @name is one word. */
static inline void bench_say(const char *name, double value)
{
	printf("%s %.6g\n", name, value);
}

#endif /* BENCH_H */
