/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pullout.h - find a way if none is given: pull the electrode out of the cavity
 *
 * The way in is the way out, backward.  Every step is a linear program: move as
 * far outward as possible, while all near pairs of triangles keep their
 * distance. Outward is the direction in which the air of the cavity leads to
 * the open (air.h).
 *
 * Units: mm and degrees.
 */
#ifndef PLAN_PULLOUT_H
#define PLAN_PULLOUT_H

#include "plan.h"

/**
 * pullout_way() - fill p->dense, from the end pose of the options.
 *
 * Return: 0; 1: no way was found, and stderr says how far it came and where the
 * cavity is narrow; else a sysexits code.
 */
int pullout_way(struct plan *p);

#endif /* PLAN_PULLOUT_H */
