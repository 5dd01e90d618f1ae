/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sections.h - a program's way in sections on which its derivatives are
 * continuous
 *
 * A long line, an arc, a pair and a piece of a curve are each a section, in
 * closed form.  Short lines behind each other are runs (run.h).
 *
 * Private to libinterp/compile/speed.
 */
#ifndef SPEED_SECTIONS_H
#define SPEED_SECTIONS_H

#include "interp/at.h"
#include "speed/along.h"
#include "interp/limits.h"

#include <stddef.h>

struct interp_program;

/* Lines shorter than so many corners stand for a curve. */
#define SECTIONS_SHORT	100

struct section {
	uint32_t from, to;		/* its segments, up to but not with
					 * @to */
	uint32_t along;			/* columns that make its length */
	double corner_mm_s;		/* how fast its end may be passed */
	struct run_part *part;		/* NULL: it is one segment */
};

struct sections {
	const struct interp_program *p;
	double pulse_mm;		/* the finest */
	size_t n, room;
	struct section *at;
	struct interp_at_curve curve;	/* that was looked at last */
};

/**
 * sections_make() - of the whole of @p.
 *
 * Return: 0, -ENOMEM.
 */
int sections_make(struct sections *ret, const struct interp_limits *l,
		  const struct interp_program *p);

/** sections_way() - r', r'' and r''' of each column at the place @s_mm, as
 *  speed/along.h takes them.  A bend of a curve that is tighter than a pulse is
 *  no bend. */
void sections_way(struct sections *w, const struct section *s, double s_mm,
		  double *ret);

void sections_free(struct sections *s);

/** sections_axes() - what the axis of each column of @p can do. */
struct interp_axes sections_axes(const struct interp_limits *l,
				 const struct interp_program *p);

#endif /* SPEED_SECTIONS_H */
