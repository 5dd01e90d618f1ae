/* SPDX-License-Identifier: Apache-2.0 */
/*
 * flat.h - the path of a program as points to draw, with a given tolerance
 *
 * Every point of the path lies within the tolerance of the lines that are
 * drawn. A path that would need too many points is drawn with a larger
 * tolerance.
 *
 * Threads: any; allocates.
 */
#ifndef PANEL_FLAT_H
#define PANEL_FLAT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct interp_program;

#define FLAT_POINTS_MAX	400000

/* How the machine goes to a point. */
enum flat_kind { FLAT_CUT, FLAT_RAPID, FLAT_PROBE };

struct flat {
	size_t n, room;
	float *at_mm;			/* X Y Z of each point, minus
					 * origin_mm */
	float *upper_mm;		/* the upper guide at each point, if the
					 * program moves U or V */
	double *s_mm;			/* place on the path */
	uint32_t *line;			/* the line of the text that leads to
					 * it */
	uint8_t *kind;			/* enum flat_kind */
	double origin_mm[3];
	double min_mm[3], max_mm[3];	/* machine coordinates */
	double tolerance_mm;		/* the one that was used */
	double cut_mm, rapid_mm;
	bool has_upper;
	bool rides;			/* the upper guide rides on the lower */
};

/**
 * flat_make() - make the points. @tolerance_mm 0 means a 2000th of the path's
 * extent.  @guides is enum interp_guides of the machine.
 *
 * Return: 0 or -ENOMEM. In both cases call flat_fini() for @ret.
 */
int flat_make(struct flat *ret, const struct interp_program *p, int guides,
	      double tolerance_mm);
void flat_fini(struct flat *f);

#endif /* PANEL_FLAT_H */
