/* SPDX-License-Identifier: Apache-2.0 */
/*
 * closed.h - a proof that no way leads out of a cavity
 *
 * For machines on which X, Y and Z alone move the electrode.  Space is divided
 * into cubes of poses.  If the electrode in the middle of a cube is nearer than
 * the clearance less half the cube's diagonal, no pose in the cube keeps the
 * clearance.  If all cubes that are reached from the end pose through the
 * others end at such cubes, or at the travel, there is no way.
 *
 * Units: mm.  Threads: one.
 */
#ifndef PLAN_CLOSED_H
#define PLAN_CLOSED_H

#include "outward.h"
#include "prove.h"

/**
 * closed_prove() - is it proved that no way leads out of @end?
 *
 * @cells: so many cubes are looked at, at most.  Return: 1: it is; 0: it is not
 * decided, or there may be one; -ENOMEM.
 */
int closed_prove(const struct job *j, const struct clearance *c,
		 const double end[INTERP_NAXES], uint32_t cells);

#endif /* PLAN_CLOSED_H */
