/* SPDX-License-Identifier: Apache-2.0 */
/*
 * repair.h - a way that is too near in places, led round them
 *
 * Units: mm and degrees.  Threads: one.
 */
#ifndef PLAN_REPAIR_H
#define PLAN_REPAIR_H

#include "plan.h"

/**
 * repair_nodes() - move the nodes of a way until all its blocks keep p->c.
 *
 * Linear programs move the nodes of each stretch that is too near, from a free
 * node before it to one behind it; where they find no room, OMPL looks for
 * another way in a corridor round the stretch.  The first and the last node
 * stay.  @q: *@n nodes, FEWEST_NODES_MAX at most before and after.
 * p->repaired tells how many of them are others.
 *
 * Return: 0; 1, and a stretch is left for which nothing was found; -ENOMEM.
 */
int repair_nodes(struct plan *p, double (*q)[INTERP_NAXES], uint32_t *n);

#endif /* PLAN_REPAIR_H */
