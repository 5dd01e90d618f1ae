/* SPDX-License-Identifier: Apache-2.0 */
/*
 * seek.c - how long it takes to stand in the middle of one segment of some
 * 5 * 10^6 points, by each strategy
 */
#include "bench.h"

#include "interp/cursor.h"

#define PULSE_MM	2e-5
#define PLACES		9

static const struct bench_path paths[] = {
	{ "simultaneous-2",	INTERP_SIMULTANEOUS,	0, 2 },
	{ "simultaneous-8",	INTERP_SIMULTANEOUS,	0, 8 },
	{ "simultaneous-arc",	INTERP_SIMULTANEOUS,	0, 0 },
	{ "point-by-point-2",	INTERP_POINT_BY_POINT,	0, 2 },
	{ "point-by-point-arc",	INTERP_POINT_BY_POINT,	0, 0 },
	{ "centred-2",		INTERP_CENTRED,		0, 2 },
	{ "main-direction-2",	INTERP_MAIN_DIRECTION,	0, 2 },
	{ "min-switch-2",	INTERP_MIN_SWITCH,	0, 2 },
};

/* The longest of some places, first the way behind the others. */
static double seek_us(const struct interp_program *p)
{
	const uint32_t ticks = p->segs[1].ticks;
	struct interp_cursor c;
	double most = 0;

	interp_cursor_init(&c, p);
	for (uint32_t i = PLACES; i > 0; i--) {
		const double from_s = bench_now_s();
		double us;

		bench_must(interp_cursor_seek(&c, 1,
					      ticks / (PLACES + 1) * i) == 0);
		us = (bench_now_s() - from_s) * 1e6;
		most = us > most ? us : most;
	}
	return most;
}

int main(void)
{
	struct interp_machine m = { .present = 0xff };

	for (int i = 0; i < INTERP_NAXES; i++)
		m.axis[i] = (struct interp_axis_limits) {
			PULSE_MM, -200, 200, 80, 1000, 20000
		};
	for (size_t i = 0; i < sizeof(paths) / sizeof(*paths); i++) {
		const struct interp_program p = bench_path(&m, &paths[i]);

		bench_say(paths[i].name, seek_us(&p));
	}
	return 0;
}
