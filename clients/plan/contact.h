/* SPDX-License-Identifier: Apache-2.0 */
/*
 * contact.h - how an electrode may move where walls are near
 *
 * Each near pair of triangles is a half space of the axes: a motion s may come
 * nearer along the pair's normal only by what is left.  All of them are the
 * polytope of the motions that are free, to the first order.  What comes out of
 * it must be proved.
 *
 * Motions are in mm: a rotary axis counts by the farthest way of any point
 * (job_axes.reach_mm).
 *
 * Threads: one.
 */
#ifndef PLAN_CONTACT_H
#define PLAN_CONTACT_H

#include "job.h"
#include "near_set.h"

struct contact {
	const struct job *j;		/* lent */
	struct job_axes axes;
	double keep_mm;			/* clearance, and what pulses stray */
	double q[INTERP_NAXES];		/* where */
	double least_mm;		/* the distance there */
	struct near_pair nearest;	/* its pair; zeros at first */
	uint32_t n;			/* half spaces: a . s >= least - mm */
	double a[NEAR_SET_MAX][INTERP_NAXES];	/* by number in axes */
	double mm[NEAR_SET_MAX];
};

/** contact_init() - for ways that end at @end; @mm: the clearance. */
void contact_init(struct contact *c, const struct job *j,
		  const double end[INTERP_NAXES], double mm);

/** contact_look() - the half spaces at @q that matter for steps of @room_mm. */
void contact_look(struct contact *c, const double q[INTERP_NAXES],
		  double room_mm);

/** contact_step() - a step of at most @room_mm, as far as possible along
 *  @toward, and toward the middle. @s: the step. Return: is there one? */
bool contact_step(const struct contact *c, const double toward[INTERP_NAXES],
		  double room_mm, double s[INTERP_NAXES]);

/** contact_centre() - the step square to @along, of at most @room_mm, to where
 *  the least distance is largest. */
bool contact_centre(const struct contact *c, const double along[INTERP_NAXES],
		    double room_mm, double s[INTERP_NAXES]);

/** contact_directions() - @ret[0] is the direction in which the walls hinder
 *  least, and so on: the direction of a slot, the pitch of a thread. */
void contact_directions(const struct contact *c,
			double ret[INTERP_NAXES][INTERP_NAXES]);

/** contact_to() - the axes after the step @s, in whole pulses. */
void contact_to(const struct contact *c, const double s[INTERP_NAXES],
		double ret[INTERP_NAXES]);

/** contact_apart_mm() - how far the axes @a and @b are apart. */
double contact_apart_mm(const struct contact *c, const double a[INTERP_NAXES],
			const double b[INTERP_NAXES]);

#endif /* PLAN_CONTACT_H */
