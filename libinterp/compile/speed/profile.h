/* SPDX-License-Identifier: Apache-2.0 */
/*
 * profile.h - the quickest speed along a way from stand to stand
 *
 * At each place each axis keeps its own speed, acceleration and jerk
 * (interp/axes.h).  The speeds are the same on the way back.
 *
 * Units: in every name.  Private to libinterp/compile/speed.
 */
#ifndef SPEED_PROFILE_H
#define SPEED_PROFILE_H

#include "interp/axes.h"

#include <stddef.h>

/* A section of a way, on which its derivatives are continuous. */
struct profile_section {
	double from_mm, to_mm;		/* to_mm > from_mm */
	double most_mm_s;		/* F; INFINITY: as fast as it can */
	void (*way)(const void *of, double s_mm, double *ret);
	const void *of;
};

/* Its places in order.  Where two sections meet there are two of one s_mm. */
struct profile {
	uint32_t columns;
	size_t n, room;
	double *s_mm;
	double *v_mm_s;			/* solved */
	double *most_mm_s;		/* ceilings */
	double *way;			/* of each column, as interp/axes.h */
	uint32_t *section;
};

/**
 * profile_solve() - find the speeds along @n sections, one behind the other.
 *
 * @corner_mm_s: how fast the end of each section may be passed; the last one is
 *		 a stand
 * Return: 0, -ENOMEM.
 */
int profile_solve(struct profile *p, const struct interp_axes *x,
		  const struct profile_section *sections, size_t n,
		  const double *corner_mm_s);

/** profile_s() - the time that it takes. */
double profile_s(const struct profile *p);

/* What is asked for at most, as shares of what the axes have; not beside a
 * corner. */
struct profile_asked {
	double v, a, j;
};

/** profile_asked() - of the axes at place @i. */
struct profile_asked profile_asked(const struct profile *p,
				   const struct interp_axes *x, size_t i);

void profile_free(struct profile *p);

#endif /* SPEED_PROFILE_H */
