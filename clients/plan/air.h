/* SPDX-License-Identifier: Apache-2.0 */
/*
 * air.h - how far it is from a place round a part into the open, through air
 *
 * Space is divided into cells.  A cell that a triangle passes through is a
 * wall. A cell that air from the open does not reach is solid.  A channel may
 * be open at both ends; air_open() chooses which end counts as the open.
 *
 * Units: mm.  Any thread may ask once it is filled.
 */
#ifndef PLAN_AIR_H
#define PLAN_AIR_H

#include "mesh.h"

#include <stddef.h>

struct air {
	double from[3], cell_mm;
	int n[3];
	size_t cells;
	bool opened;			/* by air_open() */
	float *way;			/* from each cell to the open, mm;
					 * negative: the cell is solid */
};

/** air_cut() - make the cells round @part and mark the walls. Return: 0 or
 *  -ENOMEM. */
int air_cut(struct air *a, const struct mesh *part);

/** air_open() - if @p is outside of all cells, the border cell next to it
 *  counts as the open. Return: is @p outside? */
bool air_open(struct air *a, const double p[3]);

/** air_fill() - find the ways of all cells.  If nothing counts as the open yet,
 *  every border does. */
void air_fill(struct air *a);
void air_free(struct air *a);

/**
 * air_way() - the way from @p to the open, mm; 0 in the open.  If @p is in a
 * wall, the nearest air counts.  @toward: the direction that leads out.
 */
double air_way(const struct air *a, const double p[3], double toward[3]);

#endif /* PLAN_AIR_H */
