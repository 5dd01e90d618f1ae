/* SPDX-License-Identifier: Apache-2.0 */
/*
 * lp.h - linear programs are solved here, and nowhere else
 *
 * GLPK answers "optimal" also where it lost its way: its presolver takes a
 * rounding of 1e-14 for a term and divides by it.  And without a limit its
 * simplex may turn in a circle for ever.
 *
 * Units: columns and distances are mm, so a term is a share of a mm.
 * Threads: one thread at a time.  Never in the cycle.
 */
#ifndef PLAN_LP_H
#define PLAN_LP_H

#include "interp/axis.h"

#include <glpk.h>
#include <stdbool.h>

#define LP_ROW_MAX	(4 * INTERP_NAXES + 2)

struct lp_row {
	int n;
	int index[LP_ROW_MAX + 1];	/* from 1 on, as GLPK counts */
	double value[LP_ROW_MAX + 1];
};

/** lp_new() - an empty program that looks for a maximum; glp_delete_prob(). */
glp_prob *lp_new(void);

/** lp_bound() - column @col lies between @low and @high; where there is nothing
 *  between them, it is 0. */
void lp_bound(glp_prob *p, int col, double low, double high);

/** lp_put() - put a term into a row. */
void lp_put(struct lp_row *r, int col, double value);

/** lp_at_least() - the sum of the row @r is at least @least. */
void lp_at_least(glp_prob *p, const struct lp_row *r, double least);

/**
 * lp_solve() - find the best of @p.  Terms of no weight are removed from it.
 * @stop: asked again and again; if it returns true, nothing is found.
 * Return: are the columns, as they are then, within all rows and bounds?
 */
bool lp_solve(glp_prob *p, bool (*stop)(void));

#endif /* PLAN_LP_H */
