/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pullout.h - a way where none is given: pull the electrode out of the cavity
 *
 * The way in is the way out, backward.  Every step is a linear program: as far
 * out as goes while all near pairs of triangles keep their distance.  Out is
 * where the air of the cavity leads: a flood through small cells of space.
 *
 * Units: mm and degrees.
 */
#ifndef PLAN_PULLOUT_H
#define PLAN_PULLOUT_H

#include "plan.h"

/**
 * pullout_way() - fill p->dense from the end pose of the options.
 *
 * Return: 0; 1 no way, and how far it came and where it is narrow is on stderr;
 * else sysexits.
 */
int pullout_way(struct plan *p);

#endif /* PLAN_PULLOUT_H */
