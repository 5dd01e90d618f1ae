/* SPDX-License-Identifier: Apache-2.0 */
/*
 * grid.h - which curves of many are near a place
 *
 * The plane is divided into square cells, and each curve is entered in the
 * cells that it may pass.  If cells are about as large as the curves are long,
 * the time grows in proportion to the number of curves.
 *
 * Threads: allocates.  Never in the cycle.
 */
#ifndef WIRE_GRID_H
#define WIRE_GRID_H

#include "wire/curve.h"

#include <stddef.h>
#include <stdint.h>

struct grid_entry {
	uint64_t cell;
	uint32_t id;
};

struct grid {
	double cell_mm;
	struct vec origin;
	struct grid_entry *entry;	/* by rising cell once it is sorted */
	size_t n, room;
};

void grid_init(struct grid *g, double cell_mm, struct vec origin);

/** grid_free() - it may be all zero. */
void grid_free(struct grid *g);

/** grid_add() - enter @c under @id. Return: 0 or -ENOMEM. */
int grid_add(struct grid *g, const struct curve *c, uint32_t id);

/** grid_sort() - after the last grid_add(), before the first question. */
void grid_sort(struct grid *g);

/**
 * grid_near() - call @visit for each curve that may be within @reach of @c;
 * for some of them more than once.  @visit returns false to end the search.
 */
void grid_near(const struct grid *g, const struct curve *c, double reach,
	       bool (*visit)(void *arg, uint32_t id), void *arg);

/** grid_pairs() - call @visit for each two curves of a cell, a < b; for some
 *  of them more than once. Return: what @visit returns, if that is not 0. */
int grid_pairs(const struct grid *g,
	       int (*visit)(void *arg, uint32_t a, uint32_t b), void *arg);

#endif /* WIRE_GRID_H */
