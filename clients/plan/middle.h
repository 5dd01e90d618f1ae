/* SPDX-License-Identifier: Apache-2.0 */
/*
 * middle.h - a way out led through the middle of the air, and straight at last
 *
 * Units: mm and degrees.  Threads: one.
 */
#ifndef PLAN_MIDDLE_H
#define PLAN_MIDDLE_H

#include "wayout.h"

/**
 * middle_lead() - move each node but the first to where the walls are farthest,
 * square to the way.  A node stays where its blocks would not be proved.
 *
 * @out: nodes from the end pose outward.  Return: 0 or -ENOMEM.
 */
int middle_lead(const struct wayout_asked *asked, struct route *out);

/** middle_straighten() - replace the last part of @out by one straight block,
 *  the longest that leads out and is proved. Return: is it one block now? */
bool middle_straighten(const struct wayout_asked *asked, struct route *out);

#endif /* PLAN_MIDDLE_H */
