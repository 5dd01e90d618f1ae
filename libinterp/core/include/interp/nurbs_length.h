/* SPDX-License-Identifier: Apache-2.0 */
/*
 * nurbs_length.h - a curve by its length instead of its parameter
 *
 * A table of stops gives the parameter u for a place s on a curve.  Between two
 * stops u is a cubic of s (Hermite) that never falls, because its slopes are
 * within the bounds of Fritsch and Carlson.  So a walk by length never goes
 * back and never skips a part, whatever the shape of the curve; not even over a
 * cusp, where du/ds has no bound.
 *
 * Units: mm, in the axes the curve counts.
 * Threads: the time to make a table grows with its length: startup only.  To
 * read it is RT-safe.
 * Source: F. N. Fritsch and R. E. Carlson, Monotone Piecewise Cubic
 * Interpolation, 1980.
 */
#ifndef INTERP_NURBS_LENGTH_H
#define INTERP_NURBS_LENGTH_H

#include "interp/nurbs.h"

/** interp_nurbs_length() - from @from to @to, @from <= @to, within about
 *  @error_mm. */
double interp_nurbs_length(struct interp_nurbs_eval *e, double from, double to,
			   double error_mm);

struct interp_nurbs_stop {
	double s_mm;			/* from the table's start */
	double u;
	double slope;			/* du/ds there, per mm */
};

/* What a table is made for. */
struct interp_nurbs_range {
	double from, to;		/* of the parameter, from < to */
	double error_mm;		/* how far off its place a u may be */
};

/**
 * interp_nurbs_stops() - make a table for a part of a curve.
 *
 * Return: how many stops it has, two or more.  Stops for which @room is too
 * small are counted, but not written.
 */
size_t interp_nurbs_stops(struct interp_nurbs_eval *e,
			  const struct interp_nurbs_range *r,
			  struct interp_nurbs_stop *ret, size_t room);

/* The cubic between two stops; placed by the caller. */
struct interp_nurbs_between {
	double from_mm, to_mm;
	double a[4];			/* u = a0 + a1 t + a2 t^2 + a3 t^3,
					 * t = s - from_mm */
};

/** interp_nurbs_between() - between @stop[0] and @stop[1]. RT-safe. */
void interp_nurbs_between(const struct interp_nurbs_stop *stop,
			  struct interp_nurbs_between *ret);

/**
 * interp_nurbs_stop_of() - the number of the stop before @s_mm.  It is never
 * the last of the @n stops, so that one follows it.  RT-safe.
 */
size_t interp_nurbs_stop_of(const struct interp_nurbs_stop *stop, size_t n,
			    double s_mm);

/** interp_nurbs_between_at() - u at the place @s_mm. RT-safe. */
static inline double
interp_nurbs_between_at(const struct interp_nurbs_between *b, double s_mm)
{
	const double t = s_mm - b->from_mm;

	return b->a[0] + t * (b->a[1] + t * (b->a[2] + t * b->a[3]));
}

#endif /* INTERP_NURBS_LENGTH_H */
