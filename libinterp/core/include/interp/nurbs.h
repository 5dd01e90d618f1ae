/* SPDX-License-Identifier: Apache-2.0 */
/*
 * nurbs.h - non-uniform rational B-spline curves in up to eight axes
 *
 *	C(u) = sum N_i,p(u) w_i P_i / sum N_i,p(u) w_i
 *
 * of degree p, for p + 1 or more control points P_i of weight w_i > 0 and
 * npoints + p + 1 knots that do not fall.  Its domain is
 * knots[p] <= u <= knots[npoints].
 *
 * The knots and points of a curve belong to the caller.  To evaluate a curve,
 * open it.  The evaluator keeps what one span of knots needs, so that a point
 * costs the Cox-de Boor triangle and a sum.  To enter another span costs a
 * fixed amount of work more.
 *
 * Units: points in mm (rotary axes in degrees), in the columns that the caller
 * chooses.  The parameter u has no unit.
 * Threads: RT-safe unless marked.  No call allocates, blocks or touches a
 * global.  One evaluator belongs to one thread.
 * Source: Cox-de Boor recursion; L. Piegl and W. Tiller, The NURBS Book,
 * eq. 2.5 (basis), 3.4 (control points of a derivative), 4.8 (rational
 * derivatives).
 */
#ifndef INTERP_NURBS_H
#define INTERP_NURBS_H

#include "interp/axis.h"

#include <stddef.h>

#define INTERP_NURBS_DEGREE_MAX	9
#define INTERP_NURBS_ORDER_MAX	(INTERP_NURBS_DEGREE_MAX + 1)
#define INTERP_NURBS_POINTS_MAX	(1u << 24)
#define INTERP_NURBS_DERIVS	3	/* the highest derivative */

struct interp_nurbs {
	uint32_t degree;		/* 1 ... INTERP_NURBS_DEGREE_MAX */
	uint32_t naxes;			/* 1 ... INTERP_NAXES */
	uint32_t npoints;
	uint32_t counted;		/* leading axes that length is counted
					 * in, 1 ... naxes */
	double others;			/* what the other axes weigh in length;
					 * 0: nothing */
	const double *knots;		/* npoints + degree + 1 */
	const double *points;		/* npoints rows of naxes + 1 numbers:
					 * each place times the weight, then the
					 * weight */
};

/* What is wrong with a curve. */
enum interp_nurbs_flaw {
	INTERP_NURBS_SOUND,
	INTERP_NURBS_BAD_DEGREE,
	INTERP_NURBS_BAD_AXES,
	INTERP_NURBS_FEW_POINTS,	/* fewer than degree + 1 */
	INTERP_NURBS_MANY_POINTS,
	INTERP_NURBS_NOT_FINITE,	/* a point; @at is its number */
	INTERP_NURBS_BAD_WEIGHT,	/* not > 0; @at */
	INTERP_NURBS_KNOT_FALLS,	/* below the one before, or no number */
	INTERP_NURBS_KNOT_REPEATS,	/* more than degree + 1 times at an end,
					 * or degree times inside */
	INTERP_NURBS_WEIGHTS_PART,	/* two weights differ by more than a
					 * factor of 10000: such a curve may
					 * bend where nobody looks at it */
	INTERP_NURBS_KNOTS_NEAR,	/* 1e-9 of the domain or less apart, and
					 * not equal */
	INTERP_NURBS_NO_DOMAIN,		/* its first and last u are the same */
	INTERP_NURBS_NFLAWS
};

/**
 * interp_nurbs_check() - is @c a valid curve?
 *
 * @ret_at: the number, from 0, of the point or knot that is wrong.  The work
 * grows with the curve: not for the cycle.
 */
enum interp_nurbs_flaw interp_nurbs_check(const struct interp_nurbs *c,
					  uint32_t *ret_at);

/**
 * interp_nurbs_flaw_text() - what was found, as half a sentence. Any thread.
 */
const char *interp_nurbs_flaw_text(enum interp_nurbs_flaw f);

/** interp_nurbs_flaw_wanted() - what would be accepted instead. Any thread. */
const char *interp_nurbs_flaw_wanted(enum interp_nurbs_flaw f);

/** interp_nurbs_first(), interp_nurbs_last() - ends of the domain. */
static inline double interp_nurbs_first(const struct interp_nurbs *c)
{
	return c->knots[c->degree];
}

static inline double interp_nurbs_last(const struct interp_nurbs *c)
{
	return c->knots[c->npoints];
}

/* A curve opened; placed by the caller, read and do not write. */
struct interp_nurbs_eval {
	struct interp_nurbs c;
	uint32_t span;			/* knots[span] <= u < knots[span + 1] */
	double from, to;		/* those two knots */
	/* Of the span: reciprocals of knot distances, row by row of the
	 * triangle; control points of the derivatives and their weights. */
	double gap[INTERP_NURBS_ORDER_MAX * INTERP_NURBS_DEGREE_MAX / 2];
	double point[INTERP_NURBS_DERIVS + 1][INTERP_NURBS_ORDER_MAX]
		    [INTERP_NAXES];
	double weight[INTERP_NURBS_DERIVS + 1][INTERP_NURBS_ORDER_MAX];
};

/* A point of a curve, with derivatives by u: [k] is the k-th. */
struct interp_nurbs_point {
	double d[INTERP_NURBS_DERIVS + 1][INTERP_NAXES];
};

/** interp_nurbs_open() - open @c, which has passed its check.  Its knots and
 *  points must stay. */
void interp_nurbs_open(struct interp_nurbs_eval *e,
		       const struct interp_nurbs *c);

/**
 * interp_nurbs_at() - the point at @u and its first @derivs derivatives.
 *
 * If @u is outside the domain, the nearer end of the domain is taken.  At a
 * knot the span that begins there is taken; at the end of the domain, the last
 * span.
 */
void interp_nurbs_at(struct interp_nurbs_eval *e, double u, int derivs,
		     struct interp_nurbs_point *ret);

/**
 * interp_nurbs_span() - the span that @u is in: the largest i of degree ...
 * npoints - 1 with knots[i] <= u and knots[i] < knots[i + 1].
 */
uint32_t interp_nurbs_span(const struct interp_nurbs *c, double u);

/** interp_nurbs_dot() - dot product of two places or derivatives, with the
 *  weights that the axes have in the length. */
static inline double interp_nurbs_dot(const struct interp_nurbs *c,
				      const double *a, const double *b)
{
	double sum = 0, beside = 0;

	for (uint32_t j = 0; j < c->counted; j++)
		sum += a[j] * b[j];
	for (uint32_t j = c->counted; j < c->naxes; j++)
		beside += a[j] * b[j];
	return sum + c->others * c->others * beside;
}

#endif /* INTERP_NURBS_H */
