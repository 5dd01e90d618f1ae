/* SPDX-License-Identifier: Apache-2.0 */
/*
 * lp.h - linear programs are solved here, and nowhere else
 *
 * GLPK answers "optimal" also where it lost its way: its presolver takes a
 * rounding of 1e-14 for a term and divides by it.  And without a limit its
 * simplex may turn in a circle for ever.
 *
 * Threads: one thread at a time.  Never in the cycle.
 */
#ifndef PLAN_LP_H
#define PLAN_LP_H

#include <glpk.h>
#include <stdbool.h>

/**
 * lp_solve() - find the best of @p.  Terms of no weight are removed from it.
 * @stop: asked again and again; if it returns true, nothing is found.
 * Return: are the columns, as they are then, within all rows and bounds?
 */
bool lp_solve(glp_prob *p, bool (*stop)(void));

#endif /* PLAN_LP_H */
