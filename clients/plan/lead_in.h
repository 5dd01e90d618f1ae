/* SPDX-License-Identifier: Apache-2.0 */
/*
 * lead_in.h - from where the machine stands to the mouth of a way in
 *
 * Units: mm and degrees.  Threads: one.
 */
#ifndef PLAN_LEAD_IN_H
#define PLAN_LEAD_IN_H

#include "job.h"

#define LEAD_IN_NODES	3

/* start_mm of the machine file, a corner, the mouth; the corner is the mouth
 * where one straight block leads there. */
struct lead_in {
	double q[LEAD_IN_NODES][INTERP_NAXES];
};

/** lead_in_find() - straight, or X Y and the rotaries first and Z then, as it
 *  is proved. Return: is there one? */
bool lead_in_find(const struct job *j, const struct clearance *c,
		  const double mouth[INTERP_NAXES], struct lead_in *ret);

/** lead_in_put() - let @w begin with it: as its first nodes if it has any, or
 *  else as new ones. Return: 0 or -ENOMEM. */
int lead_in_put(const struct lead_in *in, struct route *w);

#endif /* PLAN_LEAD_IN_H */
