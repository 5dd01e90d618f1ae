/* SPDX-License-Identifier: Apache-2.0 */
/*
 * feed.c - set values along a curve, one for each period
 *
 * The speed is the programmed one.  It is less at the start, and where v^2 /
 * radius would be more than the limit.  The place goes on by the midpoint rule
 * in many small steps.
 */
#include "contour_try.h"

#include <math.h>
#include <stdlib.h>

#define START_MM_S2	100.0		/* from the stand */
#define STEPS	8			/* in a period */
#define MOST	200000

void *must(void *p)
{
	if (p)
		return p;
	fputs("out of memory\n", stderr);
	exit(1);
}

/* du/dt at @u, @t_s after the start. */
static double rate(const struct spline *c, double u, double feed_mm_s,
		   double t_s)
{
	double d[3][2], speed, cross, v;

	spline_at(c, u, d);
	speed = hypot(d[1][0], d[1][1]);
	cross = fabs(d[1][0] * d[2][1] - d[1][1] * d[2][0]);
	feed_mm_s = fmin(feed_mm_s, START_MM_S2 * t_s);
	v = fmin(feed_mm_s, sqrt(NORMAL_MM_S2 * speed * speed * speed /
				 fmax(cross, 1e-12)));
	return v / speed;
}

void feed_make(struct feed *f, const struct spline *c, double mm_min)
{
	const size_t before = INTERP_COMPENSATE_BEHIND;
	const size_t room = before + MOST + INTERP_COMPENSATE_AHEAD + 1;
	double u = c->path.u_min;

	*f = (struct feed) { .curve = c, .u = must(calloc(room, sizeof(u))) };
	for (int k = 0; k < 2; k++)
		f->mm[k] = (double *)must(calloc(room, sizeof(u))) + before;
	for (size_t i = 0; i < before; i++)
		for (int k = 0; k < 2; k++)
			f->mm[k][-(long)i - 1] = c->point[0][k] /
						 c->point[0][2];
	for (size_t i = 0; i < MOST + INTERP_COMPENSATE_AHEAD; i++) {
		double d[3][2];

		spline_at(c, u, d);
		f->mm[0][i] = d[0][0];
		f->mm[1][i] = d[0][1];
		f->u[i] = u;
		if (u >= c->path.u_max && f->n == 0)
			f->n = i + 1;
		if (f->n && i > f->n + INTERP_COMPENSATE_AHEAD)
			return;
		for (int s = 0; s < STEPS && u < c->path.u_max; s++) {
			const double h = PERIOD_S / STEPS;
			const double t = ((double)i * STEPS + s + 0.5) * h;
			const double mid = u + h / 2 *
					   rate(c, u, mm_min / 60, t);

			u += h * rate(c, fmin(mid, c->path.u_max),
				      mm_min / 60, t);
		}
		u = fmin(u, c->path.u_max);
	}
	fprintf(stderr, "a feed of %g mm/min takes too long\n", mm_min);
	exit(1);
}

void feed_free(struct feed *f)
{
	for (int k = 0; k < 2; k++)
		free(f->mm[k] - INTERP_COMPENSATE_BEHIND);
	free(f->u);
}
