/* SPDX-License-Identifier: Apache-2.0 */
/*
 * air.h - how far it is from any place round a part to the open, through air
 *
 * Space is cut into cells; those that a triangle passes are walls.  What the
 * open air does not reach is solid.  A channel may be open at both ends: what
 * counts as the open can be chosen.
 *
 * Units: mm.  Any thread once it is filled.
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
	float *way;			/* of each cell, mm; negative: solid */
};

/** air_cut() - the cells round @part, walls marked. Return: 0 or -ENOMEM. */
int air_cut(struct air *a, const struct mesh *part);

/** air_open() - the cell at the border next to @p is in the open, if @p is
 *  outside of all cells. Return: whether. */
bool air_open(struct air *a, const double p[3]);

/** air_fill() - all ways; to any border, if nothing is open yet. */
void air_fill(struct air *a);
void air_free(struct air *a);

/**
 * air_way() - from @p to the open, mm; 0 in the open; the nearest air counts if
 * @p is in a wall.  @toward: the direction that leads out.
 */
double air_way(const struct air *a, const double p[3], double toward[3]);

#endif /* PLAN_AIR_H */
