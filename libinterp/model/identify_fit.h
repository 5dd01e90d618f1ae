/* SPDX-License-Identifier: Apache-2.0 */
/*
 * identify_fit.h - least squares of a trace over some numbers of the model
 *
 * Threads: any thread, not in the cycle.
 */
#ifndef CONTOUR_IDENTIFY_FIT_H
#define CONTOUR_IDENTIFY_FIT_H

#include "interp/identify.h"

#define IDENTIFY_SETTLES_S	0.2	/* by then the start does not matter */

/* Besides the model's numbers, two that only the estimate needs. */
enum {
	IDENTIFY_START = INTERP_NIDENTIFY,	/* error of the first row, mm */
	IDENTIFY_PULL,		/* how strongly the model is drawn to the
				 * encoder */
	IDENTIFY_N
};

/* The least squares of one pass: J^T J, J^T e, e^T e. */
struct identify_normal {
	double jj[IDENTIFY_N][IDENTIFY_N], je[IDENTIFY_N], ee;
	size_t rows;
	bool untold[IDENTIFY_N];	/* nothing depends on this unknown */
};

struct identify_fit {
	const struct interp_identify_trace *t;
	double x[IDENTIFY_N];
	int which[IDENTIFY_N], n;	/* the unknowns */
	bool encoder;			/* the drive closes its loop over the
					 * encoder */
};

/**
 * identify_free() - the numbers from @first up to before @end are unknowns from
 * now on.
 */
void identify_free(struct identify_fit *f, int first, int end);

/**
 * identify_fix() - the number @id is no unknown any more; its value is @value.
 */
void identify_fix(struct identify_fit *f, int id, double value);

/** identify_loop() - the model with the numbers @x. */
struct interp_axis_loop identify_loop(const double *x);

/** identify_step() - @x gets @f's numbers plus @dx, kept in their ranges. */
void identify_step(const struct identify_fit *f, const double *dx, double *x);

/**
 * identify_solve() - the step @x to the minimum, and the @inverse of J^T J.
 *
 * @damp: added to the diagonal, as a share of it.
 *
 * Return: false if the matrix is singular.
 */
bool identify_solve(const struct identify_normal *r, int n, double damp,
		    double *x, double inverse[IDENTIFY_N][IDENTIFY_N]);

/**
 * identify_refine() - bring @f's numbers to the minimum; @r gets its squares.
 *
 * @enough: it ends when a round gains less than this share.
 *
 * Return: 0, or as interp_axis_model_init().
 */
int identify_refine(struct identify_fit *f, struct identify_normal *r,
		    double enough);

#endif /* CONTOUR_IDENTIFY_FIT_H */
