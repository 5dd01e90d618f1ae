/* SPDX-License-Identifier: Apache-2.0 */
/* make_program.h - make a program of one line or circle, walk it, and count */
#ifndef EXPERIMENTS_PROGRAM_H
#define EXPERIMENTS_PROGRAM_H

#include "interp/build.h"
#include "interp/cursor.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(x)	(sizeof(x) / sizeof((x)[0]))

struct how {
	enum interp_strategy strategy;
	uint32_t milli;			/* mu */
	enum interp_coupling coupling;
};

/* A machine of eight axes of 1 um, travel without end. */
static struct interp_machine machine;

static inline void machine_set(void)
{
	for (int i = 0; i < INTERP_NAXES; i++)
		machine.axis[i] = (struct interp_axis_limits) {
			0.001, -1e5, 1e5, 80, 1000, 20000
		};
	machine.present = 0xff;
}

static inline struct interp_build *build_as(struct how h)
{
	const struct interp_build_options o = {
		.machine = &machine, .strategy = h.strategy,
		.tolerance_milli = h.milli, .coupling = h.coupling,
	};

	machine_set();
	return interp_build_create(&o);
}

static inline void must(int r, const struct interp_diag *d)
{
	if (r == 0)
		return;
	fprintf(stderr, "experiment: %s; %s\n", d->found, d->wanted);
	exit(1);
}

static const struct interp_build_word word = { .line = 1, .feed_mm_s = 1 };

/* To @pulses from 0 on every axis. */
static inline void build_line(struct interp_build *b,
			      const int32_t pulses[INTERP_NAXES])
{
	struct interp_diag d = { .found = "" };
	double end[INTERP_NAXES];

	for (int i = 0; i < INTERP_NAXES; i++)
		end[i] = pulses[i] * 0.001;
	must(interp_build_line(b, end, &word, &d), &d);
}

/* Called at every point, the start not among them. */
typedef void (*point_fn)(const struct interp_cursor *c, void *arg);

static inline void program_walk(struct interp_build *b, point_fn point,
				void *arg)
{
	const struct interp_build_about about = { .lines = 1 };
	size_t bytes;
	void *block = interp_build_take(b, &about, &bytes);
	struct interp_program p;
	struct interp_cursor c;

	if (!block)
		abort();
	interp_build_destroy(b);
	if (interp_program_map(&p, block, bytes) < 0 ||
	    interp_cursor_init(&c, &p) < 0)
		abort();
	interp_cursor_aim(&c, 1e9);
	while (interp_cursor_step(&c) == INTERP_MOVED)
		point(&c, arg);
	free(block);
}

/* An axis stops for another: nothing that moved goes on. */
struct changes {
	size_t n, points;
	uint32_t was;
};

static inline void count_change(struct changes *t, uint32_t moved)
{
	t->n += t->was != 0 && (t->was & moved) == 0;
	t->was = moved;
	t->points++;
}

#endif /* EXPERIMENTS_PROGRAM_H */
