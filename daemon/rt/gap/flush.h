/* SPDX-License-Identifier: Apache-2.0 */
/*
 * flush.h - when to jump, and how high
 *
 * A jump is due after every_s of erosion, after every_mm of depth, or when
 * arcing asks for one.  A wire machine never jumps.
 *
 * With `adaptive`, each jump judges the time since the jump before it.  `bad`
 * is the part of that time that was spent shorted or in a retract, and arcs
 * count by their share.  The rate is the depth gained in all of that time,
 * jumps and approaches included.
 *
 * 	bad > bad_share		period * 0.7, height * 1.25
 * 	else, each four jumps	period * 1.15 or / 1.15; the direction changes
 * 				if the rate has fallen since the last step;
 * 				height * 0.95, while it is above height_mm
 *
 * Period and height stay within every_min_s to every_max_s and height_min_mm to
 * height_max_mm.  They start at every_s and height_mm, and start there again
 * when a condition or `set` changes one of these.
 *
 * Threads: RT-safe.
 */
#ifndef RT_FLUSH_H
#define RT_FLUSH_H

#include <stdbool.h>
#include <stdint.h>

/* A few jumps with the same period. */
struct flush_trial {
	uint32_t jumps;
	double depth_mm, cycles;
	double before;			/* rate of the trial before, mm a
					 * cycle */
	bool seldomer;			/* the period is growing */
};

struct flush {
	/* Of the time since the last jump. */
	uint64_t eroded;		/* cycles of erosion */
	double cycles, bad;		/* bad: arcs by their share */
	double depth_mm;		/* gained while eroding */
	double far_mm;			/* the farthest place, a cycle ago */
	/* Adapted. */
	uint64_t every_cycles;
	double height_mm;
	struct flush_trial trial;
	/* ... from these. */
	uint64_t from_cycles;
	double from_mm;
};

struct cycle;

/** flush_jumps() - does this machine jump at all? */
bool flush_jumps(const struct cycle *c);

/** flush_due() - while eroding. */
bool flush_due(const struct cycle *c);

/** flush_begin() - a jump begins: adapt.  Return: its height, mm. */
double flush_begin(struct cycle *c);

/** flush_watch() - once a cycle of a job. */
void flush_watch(struct cycle *c);

#endif /* RT_FLUSH_H */
