/* SPDX-License-Identifier: Apache-2.0 */
/*
 * zpetc.c - the inverse of the axis model
 *
 * Let the model be B(z) / A(z), with B = B+ B-, where B- has the zeros that are
 * not cancelled.  The speed is
 *
 *	u = A(z) B-(1/z) / (B+(z) B-(1)^2) set
 *
 * so that place = B-(z) B-(1/z) / B-(1)^2 set, which has no phase.
 */
#include "interp/zpetc.h"

#include <math.h>

/* A polynomial, lowest power first; low is that power. */
struct poly {
	double c[8];
	int n, low;
};

static struct poly product(const struct poly *a, const struct poly *b)
{
	struct poly r = { .n = a->n + b->n - 1, .low = a->low + b->low };

	for (int i = 0; i < a->n; i++)
		for (int j = 0; j < b->n; j++)
			r.c[i + j] += a->c[i] * b->c[j];
	return r;
}

/* 1/z - @zero, divided by its value at 1. */
static struct poly mirrored(double zero)
{
	const double at_one = 1 - zero;

	return (struct poly) { { 1 / at_one, -zero / at_one }, 2, -1 };
}

/* b[0] z^2 + b[1] z + b[2] without real zeros, mirrored as a whole. */
static struct poly mirrored_whole(const double *b)
{
	const double one = b[0] + b[1] + b[2];

	return (struct poly) {
		{ b[0] / one, b[1] / one, b[2] / one }, 3, -2
	};
}

void interp_zpetc_init(struct interp_zpetc *z,
		       const struct interp_axis_model *m)
{
	struct interp_axis_quotient q;
	struct poly p;
	double gain, disc;
	int poles = 0;

	*z = (struct interp_zpetc) { 0 };
	interp_axis_model_quotient(m, &q);
	p = (struct poly) { { q.a[2], q.a[1], q.a[0], 1 }, 4, 0 };
	gain = q.b[0] + q.b[1] + q.b[2];
	disc = q.b[1] * q.b[1] - 4 * q.b[0] * q.b[2];
	if (disc < 0) {
		const struct poly f = mirrored_whole(q.b);

		p = product(&p, &f);
	}
	for (int i = 0; i < 2 && disc >= 0; i++) {
		const double zero = (-q.b[1] + (i ? -1 : 1) * sqrt(disc)) /
				    (2 * q.b[0]);
		const struct poly f = mirrored(zero);

		if (fabs(zero) < INTERP_ZPETC_CANCEL) {
			/* 1 / (z - zero) is z^-1 / (1 - zero z^-1). */
			z->pole[poles++] = zero;
			gain /= 1 - zero;
			p.low--;
		} else {
			p = product(&p, &f);
		}
	}
	for (int i = 0; i < p.n; i++)
		z->tap[INTERP_ZPETC_BEHIND + p.low + i] = p.c[i] / gain;
	z->delay = (int)floor(m->loop.delay_s / m->period_s + 0.5);
}

double interp_zpetc_step(struct interp_zpetc *z, const double *set_mm)
{
	const double *s = set_mm + z->delay - INTERP_ZPETC_BEHIND;
	double u = 0;

	for (int i = 0; i < INTERP_ZPETC_NTAPS; i++)
		u += z->tap[i] * s[i];
	/* Two poles are two filters of first order in series. */
	for (int i = 0; i < 2; i++) {
		u += z->pole[i] * z->past[i];
		z->past[i] = u;
	}
	return u;
}
