/* SPDX-License-Identifier: Apache-2.0 */
/*
 * minimise.h - find the gains that make a cost least
 *
 * Two known methods over a box, none of which asks for a derivative:
 * Nelder and Mead's simplex, begun anew around its best when it has shrunk, and
 * a particle swarm (Clerc and Kennedy's constriction).  Both stop after the
 * budget of evaluations they are given.
 *
 * Threads: any thread, not in the cycle.
 */
#ifndef INTERP_MINIMISE_H
#define INTERP_MINIMISE_H

#include <stdint.h>

#define INTERP_MINIMISE_NMAX	8

struct interp_minimise {
	int n;				/* unknowns, 1 ... INTERP_MINIMISE_NMAX */
	double low[INTERP_MINIMISE_NMAX], high[INTERP_MINIMISE_NMAX];
	double (*cost)(void *arg, const double *x);	/* NAN counts as worst */
	void *arg;
	unsigned int budget;		/* evaluations */
	uint64_t seed;			/* of the swarm */
};

/**
 * Both: @x holds the place to begin with, and the best one found; the swarm
 * has one particle there.  Return: the least cost seen.
 */
double interp_minimise_simplex(const struct interp_minimise *m, double *x);
double interp_minimise_swarm(const struct interp_minimise *m, double *x);

#endif /* INTERP_MINIMISE_H */
