/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sections.h - a program's way from stand to stand, in sections on which its
 * derivatives are continuous
 *
 * A long line, an arc, a pair and a piece of a curve are each a section, in
 * closed form.  Short lines behind each other are runs (run.h).
 *
 * Private to libinterp/compile/speed.
 */
#ifndef SPEED_SECTIONS_H
#define SPEED_SECTIONS_H

#include "speed/profile.h"

#include "interp/limits.h"
#include "interp/program.h"

/* Opaque but for what profile_solve() takes. */
struct sections {
	size_t n, room;
	struct profile_section *at;
	double *corner_mm_s;
};

/**
 * sections_make() - of segments @from up to, but not with, @to, none of them an
 * action.
 *
 * Return: 0, -ENOMEM.
 */
int sections_make(struct sections *ret, const struct interp_limits *l,
		  const struct interp_program *p, uint32_t from, uint32_t to);

void sections_free(struct sections *s);

/** sections_axes() - what the axis of each column of @p can do. */
struct interp_axes sections_axes(const struct interp_limits *l,
				 const struct interp_program *p);

#endif /* SPEED_SECTIONS_H */
