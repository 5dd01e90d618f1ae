/* SPDX-License-Identifier: Apache-2.0 */
/*
 * minimise.h - find the gains that make a cost least
 *
 * Two methods of NLopt over a box; neither asks for a derivative, and both do
 * the same again when they are asked again.  The local one is Nelder and Mead's
 * simplex, begun anew around its best when it has shrunk.  The global one
 * spends half of its budget on dividing the box (DIRECT-L, Gablonsky and
 * Kelley), and the rest on the local one from the best place that was found.
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
 * Both: @x holds the place to begin with, and then the best one found, whose
 * cost is @ret_least.  Return: 0, -ENOMEM, or -EINVAL for a box that is none.
 */
int interp_minimise_local(const struct interp_minimise *m, double *x,
			  double *ret_least);
int interp_minimise_global(const struct interp_minimise *m, double *x,
			   double *ret_least);

#endif /* INTERP_MINIMISE_H */
