/* SPDX-License-Identifier: Apache-2.0 */
/* ridge.c - ridge regression by normal equations, and features of motion */
#include "tried/ridge.h"

#include <errno.h>
#include <math.h>

#define N	INTERP_RIDGE_NFEATURES
#define STANDS_MM_S	0.01		/* slower is no motion */

static const double fade_s[4] = { 0.005, 0.01, 0.02, 0.04 };

void interp_ridge_add(struct interp_ridge_training *t, const double *x,
		      double y)
{
	for (int i = 0; i < N; i++) {
		for (int j = 0; j <= i; j++)
			t->xx[i][j] += x[i] * x[j];
		t->xy[i] += x[i] * y;
	}
	t->n++;
}

/* L of L L^T = @a, lower triangle, in place. */
static void factorise(double a[N][N])
{
	for (int j = 0; j < N; j++) {
		for (int k = 0; k < j; k++)
			a[j][j] -= a[j][k] * a[j][k];
		a[j][j] = sqrt(a[j][j]);
		for (int i = j + 1; i < N; i++) {
			for (int k = 0; k < j; k++)
				a[i][j] -= a[i][k] * a[j][k];
			a[i][j] /= a[j][j];
		}
	}
}

static void substitute(const double (*l)[N], double *x)
{
	for (int i = 0; i < N; i++) {
		for (int k = 0; k < i; k++)
			x[i] -= l[i][k] * x[k];
		x[i] /= l[i][i];
	}
	for (int i = N - 1; i >= 0; i--) {
		for (int k = i + 1; k < N; k++)
			x[i] -= l[k][i] * x[k];
		x[i] /= l[i][i];
	}
}

int interp_ridge_solve(const struct interp_ridge_training *t, double price,
		       struct interp_ridge *ret)
{
	double a[N][N] = { 0 }, scale[N];

	if (t->n == 0)
		return -EDOM;
	/* Scale each feature to mean square 1; one that never was stays out. */
	for (int i = 0; i < N; i++)
		scale[i] = t->xx[i][i] > 0 ?
			   1 / sqrt(t->xx[i][i] / (double)t->n) : 0;
	for (int i = 0; i < N; i++) {
		for (int j = 0; j <= i; j++)
			a[i][j] = t->xx[i][j] * scale[i] * scale[j] /
				  (double)t->n;
		a[i][i] += scale[i] > 0 ? price : 1;
		ret->weight[i] = t->xy[i] * scale[i] / (double)t->n;
	}
	factorise(a);
	substitute((const double (*)[N])a, ret->weight);
	for (int i = 0; i < N; i++)
		ret->weight[i] *= scale[i];
	return 0;
}

double interp_ridge_eval(const struct interp_ridge *r, const double *x)
{
	double sum = 0;

	for (int i = 0; i < N; i++)
		sum += r->weight[i] * x[i];
	return sum;
}

void interp_ridge_motion_init(struct interp_ridge_motion *m, double period_s)
{
	*m = (struct interp_ridge_motion) { .period_s = period_s };
	for (int i = 0; i < 4; i++)
		m->keeps[i] = exp(-period_s / fade_s[i]);
}

void interp_ridge_features(struct interp_ridge_motion *m, const double *set_mm,
			   double x[INTERP_RIDGE_NFEATURES])
{
	const double t = m->period_s;
	const double v = (set_mm[0] - set_mm[-1]) / t;
	const double a = (set_mm[0] - 2 * set_mm[-1] + set_mm[-2]) / (t * t);
	const double j = (set_mm[0] - 3 * set_mm[-1] + 3 * set_mm[-2] -
			  set_mm[-3]) / (t * t * t);
	const int direction = fabs(v) < STANDS_MM_S ? m->direction :
			      v > 0 ? 1 : -1;

	for (int i = 0; i < 4; i++) {
		m->fade[i] *= m->keeps[i];
		if (direction != m->direction && m->direction != 0)
			m->fade[i] = direction;
		x[i] = m->fade[i];
	}
	m->direction = direction;
	x[4] = direction;
	x[5] = v;
	x[6] = a;
	x[7] = j;
}
