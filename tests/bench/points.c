/* SPDX-License-Identifier: Apache-2.0 */
/*
 * points.c - nanoseconds a lattice point, forward and back, beside a straight
 * loop of Bresenham
 */
#include "bench.h"

#include "interp/build.h"
#include "interp/cursor.h"

#include <string.h>

#define RUN		64		/* points at once */

static const struct bench_path paths[] = {
	{ "simultaneous-2",	INTERP_SIMULTANEOUS,	0, 2 },
	{ "simultaneous-3",	INTERP_SIMULTANEOUS,	0, 3 },
	{ "simultaneous-8",	INTERP_SIMULTANEOUS,	0, 8 },
	{ "simultaneous-arc",	INTERP_SIMULTANEOUS,	0, 0 },
	{ "point-by-point-2",	INTERP_POINT_BY_POINT,	0, 2 },
	{ "point-by-point-3-tree", INTERP_POINT_BY_POINT, INTERP_TREE, 3 },
	{ "point-by-point-8-tree", INTERP_POINT_BY_POINT, INTERP_TREE, 8 },
	{ "point-by-point-arc",	INTERP_POINT_BY_POINT,	0, 0 },
	{ "centred-2",		INTERP_CENTRED,		0, 2 },
	{ "centred-3-star",	INTERP_CENTRED,		INTERP_STAR, 3 },
	{ "centred-3-tree",	INTERP_CENTRED,		INTERP_TREE, 3 },
	{ "centred-8-star",	INTERP_CENTRED,		INTERP_STAR, 8 },
	{ "centred-8-tree",	INTERP_CENTRED,		INTERP_TREE, 8 },
	{ "main-direction-2",	INTERP_MAIN_DIRECTION,	0, 2 },
	{ "main-direction-3-star", INTERP_MAIN_DIRECTION, INTERP_STAR, 3 },
	{ "main-direction-3-tree", INTERP_MAIN_DIRECTION, INTERP_TREE, 3 },
	{ "main-direction-8-star", INTERP_MAIN_DIRECTION, INTERP_STAR, 8 },
	{ "main-direction-8-tree", INTERP_MAIN_DIRECTION, INTERP_TREE, 8 },
	{ "min-switch-2",	INTERP_MIN_SWITCH,	0, 2 },
	{ "min-switch-3-star",	INTERP_MIN_SWITCH,	INTERP_STAR, 3 },
	{ "min-switch-3-tree",	INTERP_MIN_SWITCH,	INTERP_TREE, 3 },
	{ "min-switch-8-star",	INTERP_MIN_SWITCH,	INTERP_STAR, 8 },
	{ "min-switch-8-tree",	INTERP_MIN_SWITCH,	INTERP_TREE, 8 },
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

/* To the other end, as a cycle does it; how long a point took. */
static double walk_ns(struct interp_cursor *c, double ds_mm)
{
	const double from_s = bench_now_s();
	uint16_t pulses[RUN];
	uint64_t n = 0;

	interp_cursor_aim(c, ds_mm);
	do
		for (uint32_t some; (some = interp_cursor_run(c, pulses, RUN));)
			n += some;
	while (interp_cursor_step(c) == INTERP_MOVED && ++n);
	return (bench_now_s() - from_s) * 1e9 / (double)n;
}

static void measure(const struct bench_path *p)
{
	const struct interp_program prog = bench_path(&machine, p);
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
	const int32_t dx = (int32_t)(BENCH_REACH_MM * 1000), dy = dx * 73 / 100;
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
		measure(&paths[i]);
	return 0;
}
