/* SPDX-License-Identifier: Apache-2.0 */
/*
 * repair.h - lead a way round the places at which it is too near
 *
 * Units: mm and degrees.  Threads: one.
 */
#ifndef PLAN_REPAIR_H
#define PLAN_REPAIR_H

#include "plan.h"

/**
 * repair_nodes() - move the nodes of a way until all its blocks keep p->c.
 *
 * A stretch that is too near lies between two free nodes.  Linear programs move
 * its nodes.  Where they find no room, OMPL looks for another way in a corridor
 * round the stretch.  The first and the last node of the way stay.  @q: *@n
 * nodes, at most FEWEST_NODES_MAX before and after.  p->repaired gets the
 * number of nodes that were moved or added.
 *
 * Return: 0; 1: for at least one stretch nothing was found; -ENOMEM.
 */
int repair_nodes(struct plan *p, double (*q)[INTERP_NAXES], uint32_t *n);

#endif /* PLAN_REPAIR_H */
