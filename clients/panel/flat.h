/* SPDX-License-Identifier: Apache-2.0 */
/*
 * flat.h - a program's path as points to draw, no finer than asked for
 *
 * Every point of the path lies within the tolerance of the lines that are
 * drawn.  What would need more points than there is room for is drawn coarser.
 *
 * Threads: any; allocates.
 */
#ifndef PANEL_FLAT_H
#define PANEL_FLAT_H

#include "interp/program.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define FLAT_POINTS_MAX	400000

/* How the way to a point is gone. */
enum flat_kind { FLAT_CUT, FLAT_RAPID, FLAT_PROBE };

struct flat {
	size_t n, room;
	float *at_mm;			/* X Y Z of each, less origin_mm */
	float *upper_mm;		/* U V of each, if the program has them */
	double *s_mm;			/* place on the path */
	uint32_t *line;			/* of the source, that leads to it */
	uint8_t *kind;			/* enum flat_kind */
	double origin_mm[3];
	double min_mm[3], max_mm[3];	/* machine coordinates */
	double tolerance_mm;		/* what came of it */
	double cut_mm, rapid_mm;
	bool has_upper;
};

/**
 * flat_make() - @tolerance_mm; 0: a 2000th of the path's extent.
 * Return: 0 and @ret, to be handed to flat_fini() in any case; -ENOMEM.
 */
int flat_make(struct flat *ret, const struct interp_program *p,
	      double tolerance_mm);
void flat_fini(struct flat *f);

#endif /* PANEL_FLAT_H */
