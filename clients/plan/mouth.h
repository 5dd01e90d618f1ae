/* SPDX-License-Identifier: Apache-2.0 */
/*
 * mouth.h - from where the machine stands to the mouth of a way in
 *
 * Units: mm and degrees.  Threads: one.
 */
#ifndef PLAN_MOUTH_H
#define PLAN_MOUTH_H

#include "job.h"

#define MOUTH_NODES	3

/* start_mm of the machine file, a corner, the mouth; the corner is the mouth
 * where one straight block leads there. */
struct mouth_lead {
	double q[MOUTH_NODES][INTERP_NAXES];
};

/** mouth_find() - straight, or X Y and the rotaries first and Z then, as it
 *  is proved. Return: is there one? */
bool mouth_find(const struct job *j, const struct clearance *c,
		  const double mouth[INTERP_NAXES], struct mouth_lead *ret);

/** mouth_put() - let @w begin with it: as its first nodes if it has any, or
 *  else as new ones. Return: 0 or -ENOMEM. */
int mouth_put(const struct mouth_lead *in, struct route *w);

#endif /* PLAN_MOUTH_H */
