/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sim_map.h - the ground that an electrode has already been over
 *
 * A grid above the plane X Y keeps, for each cell, how deep the end of the
 * electrode has been there.  The electrode is round, its axis is Z, and it has
 * the frontal area that it was given.  A step of it removes
 *
 *	of a cell it has been over	what lies above its end, often nothing
 *	of any other cell		as much as makes a cut into fresh ground
 *					remove the whole frontal area, whichever
 *					way it leads
 *
 * So the second turn of an orbit at one depth removes nothing.  A wire is an
 * electrode whose end stays at one height.
 *
 * Where the electrode comes, the grid has blocks of cells.  When there are more
 * than SIM_MAP_BLOCKS, new ones displace old ones, whose ground counts as fresh
 * again.  No call allocates or has a loop without a bound.
 *
 * Units: mm.  Threads: one object, one thread; RT-safe.
 */
#ifndef IO_SIM_MAP_H
#define IO_SIM_MAP_H

#include <stdbool.h>
#include <stdint.h>

#define SIM_MAP_BLOCKS	16384		/* 2^n */
#define SIM_MAP_GROUNDS	65536		/* then the blocks are emptied */
#define SIM_MAP_SIDE	8		/* cells to a side of a block; 2^n */

struct sim_map_block {
	uint64_t key;			/* where it lies, on which ground */
	int32_t depth_nm[SIM_MAP_SIDE][SIM_MAP_SIDE];	/* the lowest end that
					 * was here */
};

/* Placed by the caller, zeroed; 4.3 MB.  Fields are private. */
struct sim_map {
	struct sim_map_block block[SIM_MAP_BLOCKS];
	uint32_t ground;		/* its number, from 1 on */
	double radius_mm, cell_mm;
	double at_mm[3];		/* X Y Z of the last step */
	bool placed;			/* at_mm is known */
	bool known;			/* so is the mean */
	double mean;			/* of the shares of late steps */
	double share;			/* of the last step */
};

/**
 * sim_map_init() - everything is fresh.
 *
 * @area_mm2: of the electrode's end; @across: cells in its diameter.
 */
void sim_map_init(struct sim_map *m, double area_mm2, unsigned int across);

/** sim_map_clear() - everything is fresh again. */
void sim_map_clear(struct sim_map *m);

/** sim_map_lift() - the electrode goes elsewhere through free space. */
void sim_map_lift(struct sim_map *m);

/** sim_map_step_mm() - how long a step should be, about. */
double sim_map_step_mm(const struct sim_map *m);

/**
 * sim_map_cut() - the electrode's end has moved here from where it was last.
 *
 * After sim_map_lift() the first call only says where it is.
 * Return: the part of the frontal area that met ground on this step, 0 ... 1;
 * of its way across the grid a mean over about two cells.
 */
double sim_map_cut(struct sim_map *m, const double at_mm[3]);

#endif /* IO_SIM_MAP_H */
