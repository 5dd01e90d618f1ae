/* SPDX-License-Identifier: Apache-2.0 */
/*
 * wayout.h - a way out of a cavity, from the end pose alone
 *
 * A tree of slides grows from the end pose.  A slide goes on in one direction
 * as long as the walls let it, and gives way to them.  Directions are that in
 * which the air leads, those in which the walls hinder least (along a slot, the
 * pitch of a thread), and the axes.  Where a slide ends, and every few mm on
 * it, others may begin.  Each step is proved.
 *
 * Source: the slides are those of disassembly by translation (Tian et al.,
 * Assemble Them All, 2022); the directions from contacts, and the proofs, are
 * this project's (docs/plan.md).
 *
 * Units: mm and degrees.  Threads: one.
 */
#ifndef PLAN_WAYOUT_H
#define PLAN_WAYOUT_H

#include "outward.h"
#include "prove.h"

struct wayout_asked {
	const struct job *j;
	const struct outward *outward;
	const struct clearance *c;
	const struct clearance *in;	/* of the positioning to the mouth */
	const double *end;		/* axes at the end pose */
	double seconds;			/* of the processor, about */
};

/* What was tried. */
struct wayout_tried {
	uint32_t states, slides;
	uint32_t unreached;		/* ways out to which the machine does
					 * not come from start_mm */
	double left_mm;			/* of the way through the cavity, from
					 * the state that came farthest */
	double q[INTERP_NAXES];		/* that state */
	struct near_pair nearest;	/* the nearest pair there */
};

/**
 * wayout_find() - find a way out.
 *
 * @out: gets the nodes, from the end pose outward, if there is a way; on it
 * blocks are proved inward, as the machine goes.  Return: 0; 1: none was
 * found, in the time or at all; -ENOMEM.
 */
int wayout_find(const struct wayout_asked *asked, struct route *out,
		struct wayout_tried *tried);

#endif /* PLAN_WAYOUT_H */
