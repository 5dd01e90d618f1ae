/* SPDX-License-Identifier: Apache-2.0 */
/*
 * caps.c - tops of a speed that the jerk rounds off
 *
 * By time, the speeds below P whose second derivative is -j at least are those
 * for which v + J is convex, where J is the second integral of j.  So the
 * highest of them is the lower hull of P + J, less J.  The time is that of the
 * speeds themselves: some turns find both.
 */
#include "speed/caps.h"

#include "interp/smaller.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TURNS	5		/* after one, the jerk may be 1.25 times as
				 * much */

struct caps {
	double *top;		/* P */
	double *j;		/* that the axes have for letting go */
	double *t, *y;		/* time, and P + J */
	size_t *hull, n;	/* places on it */
};

double caps_interval_s(const struct profile *p, size_t i)
{
	const double mm = p->s_mm[i + 1] - p->s_mm[i];
	const double a = p->v_mm_s[i], b = p->v_mm_s[i + 1];

	/* From a stand the jerk is constant. */
	return !(mm > 0) ? 0 : (a > 0 && b > 0 ? 2 : 3) * mm / (a + b);
}

static double a_at(const struct profile *p, size_t i)
{
	const double *v = p->v_mm_s, *s = p->s_mm;

	if (i == 0 || i + 1 == p->n)
		return 0;
	return (v[i + 1] * v[i + 1] - v[i - 1] * v[i - 1]) /
	       (2 * (s[i + 1] - s[i - 1]));
}

static void find_jerks(struct caps *c, const struct profile *p,
		       const struct interp_axes *x, bool again)
{
	for (size_t i = 0; i < p->n; i++) {
		const double *way = p->way +
				    i * p->columns * INTERP_AXES_WAY;
		const struct interp_range r = interp_axes_mm_s3(
			x, way, p->v_mm_s[i], a_at(p, i));
		const double j = larger(-r.least, INTERP_AXES_KEPT *
				interp_axes_straight(x, way).j_mm_s3);

		c->j[i] = again ? sqrt(c->j[i] * j) : j;
	}
}

/* From place @i - 1 to @i: J and its slope go on. */
static void go_on(const struct caps *c, const struct profile *p, size_t i,
		  double integral[2])
{
	const double dt = caps_interval_s(p, i - 1);
	const double j = (c->j[i] + c->j[i - 1]) / 2;

	integral[1] += integral[0] * dt + j * dt * dt / 2;
	integral[0] += j * dt;
}

static bool is_above(const struct caps *c, size_t a, size_t b, size_t i)
{
	return (c->y[b] - c->y[a]) * (c->t[i] - c->t[b]) >=
	       (c->y[i] - c->y[b]) * (c->t[b] - c->t[a]);
}

static void find_hull(struct caps *c, const struct profile *p)
{
	double integral[2] = { 0, 0 };

	c->n = 0;
	for (size_t i = 0; i < p->n; i++) {
		c->t[i] = i > 0 ? c->t[i - 1] + caps_interval_s(p, i - 1) : 0;
		if (i > 0)
			go_on(c, p, i, integral);
		c->y[i] = c->top[i] + integral[1];
		/* Where it stands a new hull begins. */
		while (c->n >= 2 && c->top[c->hull[c->n - 1]] > 0 &&
		       is_above(c, c->hull[c->n - 2], c->hull[c->n - 1], i))
			c->n--;
		c->hull[c->n++] = i;
	}
}

/* Speeds down onto the hull. */
static void lower(const struct caps *c, struct profile *p)
{
	for (size_t k = 0; k + 1 < c->n; k++) {
		const size_t a = c->hull[k], b = c->hull[k + 1];
		const double by = (c->y[b] - c->y[a]) / (c->t[b] - c->t[a]);

		p->v_mm_s[a] = c->top[a];
		p->v_mm_s[b] = c->top[b];
		for (size_t i = a + 1; i < b; i++) {
			const double is = c->y[a] + by * (c->t[i] - c->t[a]);

			p->v_mm_s[i] = larger(
				smaller(is - (c->y[i] - c->top[i]),
					c->top[i]), 0);
		}
	}
}

int caps_round(struct profile *p, const struct interp_axes *x)
{
	struct caps c = {
		.top = malloc(p->n * sizeof(double)),
		.j = malloc(p->n * sizeof(double)),
		.t = malloc(p->n * sizeof(double)),
		.y = malloc(p->n * sizeof(double)),
		.hull = malloc(p->n * sizeof(size_t)),
	};
	const bool room = c.top && c.j && c.t && c.y && c.hull;

	if (room)
		memcpy(c.top, p->v_mm_s, p->n * sizeof(double));
	for (int turn = 0; room && turn < TURNS; turn++) {
		find_jerks(&c, p, x, turn > 0);
		find_hull(&c, p);
		lower(&c, p);
	}
	free(c.top);
	free(c.j);
	free(c.t);
	free(c.y);
	free(c.hull);
	return room ? 0 : -ENOMEM;
}
