/* SPDX-License-Identifier: Apache-2.0 */
/*
 * identify_fit.h - least squares of a trace over some numbers of the model
 *
 * Threads: any thread, not in the cycle.
 */
#ifndef CONTOUR_IDENTIFY_FIT_H
#define CONTOUR_IDENTIFY_FIT_H

#include "interp/identify.h"

#define IDENTIFY_SETTLES_S	0.2	/* what the start was is forgotten */

/* Beside the model's numbers two that only the estimate needs. */
enum {
	IDENTIFY_START = INTERP_NIDENTIFY,	/* off the first row, mm */
	IDENTIFY_PULL,		/* toward the encoder, of what it misses */
	IDENTIFY_N
};

/* The least squares of one pass: J^T J, J^T e, e^T e. */
struct identify_normal {
	double jj[IDENTIFY_N][IDENTIFY_N], je[IDENTIFY_N], ee;
	size_t rows;
	bool untold[IDENTIFY_N];	/* nothing depends on it */
};

struct identify_fit {
	const struct interp_identify_trace *t;
	double x[IDENTIFY_N];
	int which[IDENTIFY_N], n;	/* the unknowns */
	bool encoder;			/* the drive's loop is closed over it */
};

/** identify_free() - unknowns from now on: @first up to before @end. */
void identify_free(struct identify_fit *f, int first, int end);

/** identify_fix() - no unknown any more: it is @value. */
void identify_fix(struct identify_fit *f, int id, double value);

/** identify_loop() - the model's numbers of @x. */
struct interp_axis_loop identify_loop(const double *x);

/** identify_step() - @f's numbers and @dx, kept in their ranges, to @x. */
void identify_step(const struct identify_fit *f, const double *dx, double *x);

/**
 * identify_solve() - the step @x to the least, and the @inverse of J^T J.
 * @damp: added to its diagonal, as a part of it.
 * Return: false if it is singular.
 */
bool identify_solve(const struct identify_normal *r, int n, double damp,
		    double *x, double inverse[IDENTIFY_N][IDENTIFY_N]);

/**
 * identify_refine() - @f's numbers to the least, its squares in @r.
 * @enough: it ends where a round gains less than this part.
 * Return: 0, or as interp_axis_model_init().
 */
int identify_refine(struct identify_fit *f, struct identify_normal *r,
		    double enough);

#endif /* CONTOUR_IDENTIFY_FIT_H */
