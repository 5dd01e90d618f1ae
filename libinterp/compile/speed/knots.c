/* SPDX-License-Identifier: Apache-2.0 */
/* knots.c - the speeds of a way as a table of few knots */
#include "speed/knots.h"

#include "speed/caps.h"

#include "interp/smaller.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

/* Between two knots the acceleration is even by time, but for so much of what
 * the axes can do. */
#define OFF	0.02

/* The same places with their times and accelerations. */
static void all_knots(const struct profile *p, struct interp_speed_knot *ret)
{
	const double *v = p->v_mm_s, *s = p->s_mm;
	double t = 0;

	for (size_t i = 0; i < p->n; i++) {
		const size_t a = i > 0 && s[i - 1] < s[i] ? i - 1 : i;
		const size_t b = i + 1 < p->n && s[i + 1] > s[i] ? i + 1 : i;
		const double before = a < i ? (v[i] - v[a]) /
				      caps_interval_s(p, a) : 0;
		const double behind = b > i ? (v[b] - v[i]) /
				      caps_interval_s(p, i) : 0;

		ret[i] = (struct interp_speed_knot) {
			s[i], t, (float)v[i],
			(float)(a < i && b > i ? (before + behind) / 2 :
				before + behind),
		};
		t += i + 1 < p->n ? caps_interval_s(p, i) : 0;
	}
	ret[0].a_mm_s2 = ret[p->n - 1].a_mm_s2 = 0;
}

/* How even the acceleration can be between a knot and those behind it. */
struct cone {
	double least, most;		/* jerks */
};

/* Return: the jerk to the second one. */
static double narrow(struct cone *c, const struct interp_speed_knot *from,
		     const struct interp_speed_knot *to, double off)
{
	const double t = to->t_s - from->t_s;
	const double a = (double)to->a_mm_s2 - (double)from->a_mm_s2;

	if (!(t > 0)) {
		c->most = -INFINITY;
		return 0;
	}
	c->least = larger(c->least, (a - off) / t);
	c->most = smaller(c->most, (a + off) / t);
	return a / t;
}

/* The last one that a piece from knot @i leads to. */
static size_t end_of(const struct profile *p, const struct interp_axes *x,
		     const struct interp_speed_knot *k, size_t i)
{
	struct cone c = { -INFINITY, INFINITY };
	size_t end = i + 1;

	for (size_t j = i + 1; j < p->n && c.least <= c.most; j++) {
		const double off = OFF * interp_axes_straight(
			x, p->way + j * p->columns * INTERP_AXES_WAY).a_mm_s2;

		const double jerk = narrow(&c, &k[i], &k[j], off);

		if (jerk >= c.least && jerk <= c.most)
			end = j;
	}
	return end;
}

long knots_make(const struct profile *p, const struct interp_axes *x,
		struct interp_speed_knot **ret)
{
	struct interp_speed_knot *k = malloc(p->n * sizeof(*k));
	long n = 0;

	*ret = k;
	if (!k)
		return -ENOMEM;
	all_knots(p, k);
	for (size_t i = 0; i + 1 < p->n;) {
		const size_t end = end_of(p, x, k, i);

		k[n++] = k[i];
		i = end;
	}
	k[n++] = k[p->n - 1];
	return n;
}
