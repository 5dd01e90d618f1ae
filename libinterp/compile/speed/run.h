/* SPDX-License-Identifier: Apache-2.0 */
/*
 * run.h - runs of short lines, cut at their corners
 *
 * Between its corners a run is one shape (shape.h).  A corner is a node beside
 * which the path turns by more than a rounding makes it, and hardly a chord
 * away; or, where no shape keeps within its boxes, the node near to it that
 * turns most.
 *
 * Units: mm; rotary axes degrees.  Private to libinterp/compile/speed.
 */
#ifndef SPEED_RUN_H
#define SPEED_RUN_H

#include "speed/shape.h"

#include "interp/axis.h"

struct run {
	size_t n;			/* nodes, 2 or more */
	uint32_t columns;
	uint32_t along;			/* those that make the length */
	const double *s_mm;		/* rising */
	const double *x;
	double tolerance[INTERP_NAXES];
};

/* A part without a corner, from one node to another. */
struct run_part {
	size_t first, last;
	struct shape shape;		/* without intervals it is straight */
	double straight[INTERP_NAXES];	/* r' then */
};

/** sections_part_way() - r', r'' and r''' at @s_mm. */
void sections_part_way(const struct run_part *p, double s_mm, double *ret);

/**
 * sections_parts() - call @found for one part after the other.  The part lasts
 * for the call; who takes its shape leaves an empty one there.
 *
 * Return: 0, -ENOMEM, or what @found returned that is no 0.
 */
int sections_parts(const struct run *r,
	      int (*found)(void *to, struct run_part *p), void *to);

#endif /* SPEED_RUN_H */
