/* SPDX-License-Identifier: Apache-2.0 */
/*
 * points.c - nanoseconds a lattice point, forward and back, beside a straight
 * loop of Bresenham
 */
#include "bench.h"

#include "interp/build.h"
#include "interp/cursor.h"

#include <string.h>

#define REACH_MM	100.0
#define TOLERANCE_MILLI	2000
#define RUN		64		/* points at once */

struct path {
	const char *name;
	enum interp_strategy strategy;
	int axes;			/* 0: a circle in X and Y */
	enum interp_coupling coupling;
};

static const struct path paths[] = {
	{ "simultaneous-2",	INTERP_SIMULTANEOUS,	2, 0 },
	{ "simultaneous-3",	INTERP_SIMULTANEOUS,	3, 0 },
	{ "simultaneous-8",	INTERP_SIMULTANEOUS,	8, 0 },
	{ "simultaneous-arc",	INTERP_SIMULTANEOUS,	0, 0 },
	{ "dda-2",		INTERP_DDA,		2, 0 },
	{ "dda-3",		INTERP_DDA,		3, 0 },
	{ "dda-8",		INTERP_DDA,		8, 0 },
	{ "dda-arc",		INTERP_DDA,		0, 0 },
	{ "point-by-point-2",	INTERP_POINT_BY_POINT,	2, 0 },
	{ "point-by-point-3-tree", INTERP_POINT_BY_POINT, 3, INTERP_TREE },
	{ "point-by-point-8-tree", INTERP_POINT_BY_POINT, 8, INTERP_TREE },
	{ "point-by-point-arc",	INTERP_POINT_BY_POINT,	0, 0 },
	{ "centred-2",		INTERP_CENTRED,		2, 0 },
	{ "centred-3-star",	INTERP_CENTRED,		3, INTERP_STAR },
	{ "centred-3-tree",	INTERP_CENTRED,		3, INTERP_TREE },
	{ "centred-8-star",	INTERP_CENTRED,		8, INTERP_STAR },
	{ "centred-8-tree",	INTERP_CENTRED,		8, INTERP_TREE },
	{ "main-direction-2",	INTERP_MAIN_DIRECTION,	2, 0 },
	{ "main-direction-3-star", INTERP_MAIN_DIRECTION, 3, INTERP_STAR },
	{ "main-direction-3-tree", INTERP_MAIN_DIRECTION, 3, INTERP_TREE },
	{ "main-direction-8-star", INTERP_MAIN_DIRECTION, 8, INTERP_STAR },
	{ "main-direction-8-tree", INTERP_MAIN_DIRECTION, 8, INTERP_TREE },
	{ "min-switch-2",	INTERP_MIN_SWITCH,	2, 0 },
	{ "min-switch-3-star",	INTERP_MIN_SWITCH,	3, INTERP_STAR },
	{ "min-switch-3-tree",	INTERP_MIN_SWITCH,	3, INTERP_TREE },
	{ "min-switch-3-tube",	INTERP_MIN_SWITCH,	3, INTERP_TUBE },
	{ "min-switch-8-star",	INTERP_MIN_SWITCH,	8, INTERP_STAR },
	{ "min-switch-8-tree",	INTERP_MIN_SWITCH,	8, INTERP_TREE },
	{ "min-switch-8-tube",	INTERP_MIN_SWITCH,	8, INTERP_TUBE },
	{ "min-switch-arc",	INTERP_MIN_SWITCH,	0, 0 },
};

#define NPATHS	(sizeof(paths) / sizeof(paths[0]))

static struct interp_machine machine;

static void machine_set(void)
{
	machine.present = 0xff;
	for (int i = 0; i < INTERP_NAXES; i++)
		machine.axis[i] = (struct interp_axis_limits) {
			0.001, -200, 200, 80, 1000, 20000
		};
}

static void add_segment(struct interp_build *b, const struct path *p)
{
	const struct interp_build_word w = { .line = 1, .feed_mm_s = 1 };
	const struct interp_build_arc arc = {
		.axis_a = INTERP_X, .axis_b = INTERP_Y,
		.centre_a_mm = REACH_MM / 4,
	};
	double end[INTERP_NAXES] = { 0 };
	struct interp_diag d;

	for (int i = 0; i < p->axes; i++)
		end[i] = REACH_MM / (1 + 0.37 * i);
	if (p->axes ? interp_build_line(b, end, &w, &d) :
		      interp_build_arc(b, end, &arc, &w, &d))
		exit(70);
}

static struct interp_program program_of(const struct path *p)
{
	const struct interp_build_options o = {
		.machine = &machine, .strategy = p->strategy,
		.tolerance_milli = TOLERANCE_MILLI, .coupling = p->coupling,
	};
	const struct interp_build_about about = { .lines = 1 };
	struct interp_build *b = interp_build_create(&o);
	struct interp_program ret;
	size_t n;
	void *block;

	add_segment(b, p);
	n = interp_build_bytes(b);
	block = malloc(n);
	interp_build_write(b, &about, block);
	interp_build_destroy(b);
	if (interp_program_map(&ret, block, n))
		exit(70);
	return ret;
}

/* To the other end, as a cycle does it; how long a point took. */
static double walk_ns(struct interp_cursor *c, double ds_mm)
{
	const double from_s = bench_now_s();
	uint16_t pulses[RUN];
	uint64_t n = 0;

	interp_cursor_aim(c, ds_mm);
	do
		for (uint32_t some; (some = interp_cursor_run(c, pulses, RUN)); )
			n += some;
	while (interp_cursor_step(c) == INTERP_MOVED && ++n);
	return (bench_now_s() - from_s) * 1e9 / (double)n;
}

static void bench_path(const struct path *p)
{
	const struct interp_program prog = program_of(p);
	double out[BENCH_RUNS], back[BENCH_RUNS];
	char name[64];

	for (int i = 0; i < BENCH_RUNS; i++) {
		struct interp_cursor c;

		interp_cursor_init(&c, &prog);
		out[i] = walk_ns(&c, 1e9);
		back[i] = walk_ns(&c, -1e9);
	}
	snprintf(name, sizeof(name), "forward-%s", p->name);
	bench_say(name, bench_median(out, BENCH_RUNS));
	snprintf(name, sizeof(name), "back-%s", p->name);
	bench_say(name, bench_median(back, BENCH_RUNS));
}

/* -- The measure --------------------------------------------------------- */

/* Forward only, two axes, everything in registers: as fast as it can be. */
static double bresenham_ns(void)
{
	const int32_t dx = (int32_t)(REACH_MM * 1000), dy = dx * 73 / 100;
	const double from_s = bench_now_s();
	int32_t y = 0, err = 0;

	for (int32_t x = 0; x < dx; ) {
		x++;
		err += dy;
		if (2 * err >= dx) {
			err -= dx;
			y++;
		}
		/* The point is wanted; nothing else is done with it. */
		__asm__ volatile("" : : "r"(x), "r"(y));
	}
	return (bench_now_s() - from_s) * 1e9 / dx;
}

int main(void)
{
	double ns[BENCH_RUNS];

	machine_set();
	for (int i = 0; i < BENCH_RUNS; i++)
		ns[i] = bresenham_ns();
	bench_say("bresenham", bench_median(ns, BENCH_RUNS));
	for (size_t i = 0; i < NPATHS; i++)
		bench_path(&paths[i]);
	return 0;
}
