/* SPDX-License-Identifier: Apache-2.0 */
/*
 * minimise.h - find the gains that make a cost least
 *
 * Two methods of NLopt search a box.  Neither needs a derivative, and both find
 * the same again if they are called again.  The local one is Nelder and Mead's
 * simplex; when it has shrunk it begins anew around its best place.  The global
 * one uses half of its budget to divide the box (DIRECT-L, Gablonsky and
 * Kelley), and the rest for the local one, from the best place that was found.
 *
 * Threads: any thread, not in the cycle.
 */
#ifndef INTERP_MINIMISE_H
#define INTERP_MINIMISE_H

#define INTERP_MINIMISE_NMAX	8

struct interp_minimise {
	int n;				/* unknowns, 1 ...
					 * INTERP_MINIMISE_NMAX */
	double low[INTERP_MINIMISE_NMAX], high[INTERP_MINIMISE_NMAX];
	double (*cost)(void *arg, const double *x);	/* NAN counts as
							 * worst */
	void *arg;
	unsigned int budget;		/* evaluations, at the most */
};

/**
 * Both: @x is the place to begin at, and gets the best place that was found.
 * Its cost is @ret_least.  Return: 0; -ENOMEM; -EINVAL: the box is empty.
 */
int interp_minimise_local(const struct interp_minimise *m, double *x,
			  double *ret_least);
int interp_minimise_global(const struct interp_minimise *m, double *x,
			   double *ret_least);

#endif /* INTERP_MINIMISE_H */
