/* SPDX-License-Identifier: Apache-2.0 */
/*
 * depth.h - how deep the cut is: from the place where it began to spark, along
 * the direction in which it went in
 *
 * The direction is that of the first segment that sparks on new ground, without
 * the plane of an arc.  What begins on another line, after a positioning, is
 * another cut and counts from its own first spark; one that comes in again on
 * the same line goes on counting.
 *
 * A jump, and the way back from one, leaves the present depth as it was.  A
 * wire has no depth.
 *
 * Threads: RT-safe.
 */
#ifndef RT_DEPTH_H
#define RT_DEPTH_H

#include "interp/program.h"

struct cycle;

struct depth {
	struct interp_depth cut;	/* where it began, and its deepest */
	double now_mm;
	bool met;			/* the first spark since a positioning
					 * was looked at */
};

/** depth_load() - a program begins; it may be the rest of one. */
void depth_load(struct cycle *c);

/** depth_watch() - once a cycle. */
void depth_watch(struct cycle *c);

#endif /* RT_DEPTH_H */
