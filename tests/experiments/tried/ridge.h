/* SPDX-License-Identifier: Apache-2.0 */
/*
 * ridge.h - a model that is learned from history: what the axis model still
 * misses
 *
 * It is a weighted sum of features of the set motion.  The weights come from
 * ridge regression: least squares with a price on large weights.  It is trained
 * beforehand, row by row, in memory of a fixed size; its use in the cycle is
 * one product.  It is kept only if it predicts runs that it was not trained on
 * better than the model alone.
 *
 * Units: those of the features and of the target.  Threads: _add() and _solve()
 * any thread; _eval() and the features RT-safe.
 */
#ifndef INTERP_RIDGE_H
#define INTERP_RIDGE_H

#include <stdint.h>

#define INTERP_RIDGE_NFEATURES	8

/* Sums of a training; zero it to begin. */
struct interp_ridge_training {
	double xx[INTERP_RIDGE_NFEATURES][INTERP_RIDGE_NFEATURES];
	double xy[INTERP_RIDGE_NFEATURES];
	uint64_t n;
};

struct interp_ridge {
	double weight[INTERP_RIDGE_NFEATURES];	/* all 0: corrects nothing */
};

/** interp_ridge_add() - one row of history. */
void interp_ridge_add(struct interp_ridge_training *t, const double *x,
		      double y);

/**
 * interp_ridge_solve() - the weights.
 *
 * @price: relative to each feature's own mean square, > 0.
 * Return: 0, or -EDOM without rows.
 */
int interp_ridge_solve(const struct interp_ridge_training *t, double price,
		       struct interp_ridge *ret);

/** interp_ridge_eval() - what it says to @x. */
double interp_ridge_eval(const struct interp_ridge *r, const double *x);

/*
 * The features of an axis that moves along set values: what is left of the
 * last reversal after several time constants, the direction, speed,
 * acceleration and jerk.
 */
struct interp_ridge_motion {
	double period_s;
	double keeps[4];		/* of a fade over a period */
	double fade[4];			/* +-1 at a reversal, then fading */
	int direction;
};

/** interp_ridge_motion_init() - at rest. Startup only. */
void interp_ridge_motion_init(struct interp_ridge_motion *m, double period_s);

/** interp_ridge_features() - @set_mm[-3 ... 0] of one axis, each period. */
void interp_ridge_features(struct interp_ridge_motion *m, const double *set_mm,
			   double x[INTERP_RIDGE_NFEATURES]);

#endif /* INTERP_RIDGE_H */
