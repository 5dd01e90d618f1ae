/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_curve_feed.c - how fast a curve may be followed, to cut it
 */
#include "path/build_curve.h"
#include "path/builder.h"

#include "interp/smaller.h"

#include <math.h>

#define NEAR		0.1		/* between two looks feed and heading
					 * change by no more */
#define NEAR_HALVINGS	10

static void add_axis(struct interp_axes *x, const struct interp_axis_limits *m)
{
	x->v_mm_s[x->n] = m->v_max_mm_s;
	x->a_mm_s2[x->n] = m->a_max_mm_s2;
	x->j_mm_s3[x->n] = m->j_max_mm_s3;
	x->n++;
}

void build_curve_limit(struct curve_plan *p)
{
	const struct interp_nurbs *c = &p->walk.eval.c;
	double a = INFINITY, j = INFINITY;

	p->pulse_mm = INFINITY;
	for (uint32_t k = 0; k < c->naxes; k++) {
		const struct interp_axis_limits *m = build_curve_axis(p, k);

		add_axis(k < c->counted ? &p->along : &p->beside, m);
		p->pulses_mm[p->curve.axis[k]] = 1 / m->pulse_mm;
		p->pulse_mm = smaller(p->pulse_mm, m->pulse_mm);
		a = smaller(a, m->a_max_mm_s2);
		j = smaller(j, m->j_max_mm_s3);
	}
	p->slowest_mm_s = smaller(cbrt(j * p->pulse_mm * p->pulse_mm),
				  sqrt(a * p->pulse_mm));
	for (uint32_t k = 0; k < c->counted; k++)
		p->slowest_mm_s = smaller(p->slowest_mm_s, p->along.v_mm_s[k]);
}

static void learn(struct curve_plan *p, const struct interp_nurbs_way *w)
{
	struct curve_seen *s = &p->seen;
	double counted = 0;

	for (uint32_t k = 0; k < p->curve.counted; k++)
		counted += w->d[0][k] * w->d[0][k];
	s->counted = larger(s->counted, sqrt(counted));
	for (uint32_t k = 0; k < p->curve.naxes; k++)
		s->d[k] = larger(s->d[k], fabs(w->d[0][k]));
}

/* If no more is kept for going along. */
static double feed_mm_s(struct curve_plan *p, const struct interp_nurbs_way *w)
{
	static const struct interp_straight none = { 0, 0 };
	double way[INTERP_NAXES * INTERP_AXES_WAY], v, beside;
	struct interp_straight left;

	for (uint32_t k = 0; k < p->curve.naxes; k++)
		for (uint32_t i = 0; i < INTERP_AXES_WAY; i++)
			way[k * INTERP_AXES_WAY + i] = w->d[i][k];
	for (uint32_t k = 0; k < p->along.n; k++)
		interp_axes_overlook(way + k * INTERP_AXES_WAY, p->pulse_mm);
	v = interp_axes_mm_s(&p->along, way, &none, &left);
	beside = interp_axes_mm_s(&p->beside,
				  way + p->along.n * INTERP_AXES_WAY, &none,
				  &left);
	p->beside_mm_s = smaller(p->beside_mm_s, beside);
	return smaller(v, beside);
}

struct curve_look build_curve_look(struct curve_plan *p, double u)
{
	struct curve_look ret = { .u = u, .mm_s = p->slowest_mm_s };
	struct interp_nurbs_way w;

	interp_nurbs_way(&p->walk.eval, u, &w);
	if (w.cusp)
		return ret;
	learn(p, &w);
	ret.mm_s = feed_mm_s(p, &w);
	for (uint32_t k = 0; k < p->curve.naxes; k++)
		ret.heading[k] = w.d[0][k];
	return ret;
}

/* A counted axis goes by 1 at most, however far one beside it turns. */
static bool is_near(const struct curve_plan *p, const struct curve_look *a,
		    const struct curve_look *b)
{
	double size = 1, turn = 0, beside = 0;

	for (uint32_t k = 0; k < p->curve.naxes; k++) {
		const double d = fabs(a->heading[k] - b->heading[k]);

		if (k < p->curve.counted) {
			turn = larger(turn, d);
			continue;
		}
		size = larger(size, fabs(a->heading[k]));
		beside = larger(beside, d);
	}
	return turn <= NEAR && beside <= NEAR * size &&
	       larger(a->mm_s, b->mm_s) <=
	       (1 + NEAR) * smaller(a->mm_s, b->mm_s);
}

/* The tightest place of a bend may lie between two looks: look there, until
 * neighbours are alike. */
static void look_between(struct curve_plan *p, const struct curve_look *a,
			 const struct curve_look *b, int halvings)
{
	struct curve_look middle;

	if (halvings == 0 || is_near(p, a, b))
		return;
	middle = build_curve_look(p, (a->u + b->u) / 2);
	p->least_mm_s = smaller(p->least_mm_s, middle.mm_s);
	p->most_mm_s = larger(p->most_mm_s, middle.mm_s);
	look_between(p, a, &middle, halvings - 1);
	look_between(p, &middle, b, halvings - 1);
}

void build_curve_look_between(struct curve_plan *p, const struct curve_look *a,
			      const struct curve_look *b)
{
	look_between(p, a, b, NEAR_HALVINGS);
}

double build_curve_rate(const struct curve_plan *p)
{
	double rate = 0;

	for (uint32_t k = 0; k < p->curve.naxes; k++)
		rate = larger(rate, p->seen.d[k] *
				    p->pulses_mm[p->curve.axis[k]]);
	return rate;
}
