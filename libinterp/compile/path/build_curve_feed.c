/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_curve_feed.c - how fast a curve may be followed
 */
#include "path/build_curve.h"
#include "path/builder.h"

#include "interp/limits.h"

#include <math.h>
#include <string.h>

#define NEAR		0.1		/* between two looks feed and heading
					 * change by no more */
#define NEAR_HALVINGS	10

/* The share of an axis's acceleration that follows the curve. */
static double across_part(const struct curve_plan *p, uint32_t k)
{
	return k < p->curve.counted ? INTERP_BEND_ACROSS : INTERP_BESIDE_ACROSS;
}

void build_curve_limit(struct curve_plan *p)
{
	const struct interp_build_options *o = &p->b->o;
	struct interp_nurbs_limits *l = &p->limits;

	p->a_mm_s2 = p->j_mm_s3 = HUGE_VAL;
	*l = (struct interp_nurbs_limits) {
		.chord_error_mm = HUGE_VAL, .period_s = 1,
		.centripetal_mm_s2 = HUGE_VAL,
	};
	p->chord_mm_s = o->chord_error_mm > 0 && o->period_s > 0 ?
			sqrt(8 * o->chord_error_mm) / o->period_s : HUGE_VAL;
	p->pulse_mm = HUGE_VAL;
	for (uint32_t k = 0; k < p->curve.naxes; k++) {
		const struct interp_axis_limits *m = build_curve_axis(p, k);

		l->v_mm_s[k] = m->v_max_mm_s;
		l->a_mm_s2[k] = across_part(p, k) * m->a_max_mm_s2;
		l->j_mm_s3[k] = INTERP_CURVE_JERK_ROUND * m->j_max_mm_s3;
		p->pulses_mm[p->curve.axis[k]] = 1 / m->pulse_mm;
		p->pulse_mm = fmin(p->pulse_mm, m->pulse_mm);
		p->j_mm_s3 = fmin(p->j_mm_s3, m->j_max_mm_s3);
		p->a_mm_s2 = fmin(p->a_mm_s2, m->a_max_mm_s2);
		if (k < p->curve.counted)
			l->centripetal_mm_s2 = fmin(l->centripetal_mm_s2,
						    l->a_mm_s2[k]);
	}
	/* The axes do not notice a bend whose radius is less than a pulse. */
	p->slowest_mm_s = fmin(cbrt(p->j_mm_s3 * p->pulse_mm * p->pulse_mm),
			       sqrt(p->a_mm_s2 * p->pulse_mm));
	for (uint32_t k = 0; k < p->curve.counted; k++)
		p->slowest_mm_s = fmin(p->slowest_mm_s, l->v_mm_s[k]);
}

/* Where bends allow @v and, of axes beside the path, @beside.  Where that is
 * next to nothing it is more, but no axis is faster than it can. */
static double bend_mm_s(const struct curve_plan *p,
			const struct interp_nurbs_way *w, double v,
			double beside)
{
	double most = HUGE_VAL;

	for (uint32_t k = 0; !w->cusp && k < p->curve.naxes; k++)
		most = fmin(most, p->limits.v_mm_s[k] / fabs(w->d[0][k]));
	return fmin(most, fmin(fmax(v, p->slowest_mm_s),
			       fmax(beside, BUILD_SLOWEST_BESIDE *
					    p->slowest_mm_s)));
}

static void learn(struct curve_plan *p, const struct interp_nurbs_way *w)
{
	struct curve_seen *s = &p->seen;
	double counted = 0;

	s->bend = fmax(s->bend, w->cusp ? HUGE_VAL : w->curvature);
	for (uint32_t k = 0; !w->cusp && k < p->curve.counted; k++)
		counted += w->d[0][k] * w->d[0][k];
	s->counted = fmax(s->counted, sqrt(counted));
	for (uint32_t k = 0; !w->cusp && k < p->curve.naxes; k++)
		s->d[k] = fmax(s->d[k], fabs(w->d[0][k]));
}

/* So slow that the jerk lets it speed up here, by no less than it must; by
 * columns @from up to, but not with, @to. */
static double set_off_mm_s(const struct curve_plan *p,
			   const struct interp_nurbs_way *w, uint32_t from,
			   uint32_t to)
{
	double v = HUGE_VAL;

	for (uint32_t k = from; !w->cusp && k < to; k++)
		if (w->d[1][k] != 0)
			v = fmin(v, interp_bend_mm_s(
				INTERP_CURVE_JERK_BOTH *
					build_curve_axis(p, k)->j_max_mm_s3,
				3 * fabs(w->d[1][k]), p->a_mm_s2, p->j_mm_s3));
	return v;
}

/* An axis beside the path notices every bend, because it goes on there. */
static double beside_mm_s(const struct curve_plan *p,
			  const struct interp_nurbs_way *w)
{
	const struct interp_nurbs_limits *l = &p->limits;
	double v = set_off_mm_s(p, w, p->curve.counted, p->curve.naxes);

	for (uint32_t k = p->curve.counted; !w->cusp && k < p->curve.naxes; k++)
		v = fmin(v, fmin(l->v_mm_s[k] / fabs(w->d[0][k]),
				 fmin(sqrt(l->a_mm_s2[k] / fabs(w->d[1][k])),
				      cbrt(l->j_mm_s3[k] / fabs(w->d[2][k])))));
	return v;
}

static double feed_mm_s(struct curve_plan *p, const struct interp_nurbs_way *w)
{
	const double v = fmin(interp_nurbs_feed_mm_s(&p->walk.eval.c, w,
						     &p->limits),
			      set_off_mm_s(p, w, 0, p->curve.counted));
	double beside = HUGE_VAL;

	if (p->curve.counted < p->curve.naxes) {
		beside = beside_mm_s(p, w);
		p->beside_mm_s = fmin(p->beside_mm_s, beside);
		beside = w->cusp ? 0 : beside;
	}
	return bend_mm_s(p, w, v, beside);
}

struct curve_look build_curve_look(struct curve_plan *p, double u)
{
	struct interp_nurbs_eval *e = &p->walk.eval;
	struct curve_look ret = { .u = u };
	struct interp_nurbs_way w;

	interp_nurbs_way(e, u, &w);
	learn(p, &w);
	ret.mm_s = feed_mm_s(p, &w);
	if (w.cusp)
		return ret;
	for (uint32_t k = 0; k < p->curve.naxes; k++) {
		ret.heading[k] = w.d[0][k];
		ret.turn[k] = w.d[1][k] * w.by_u_mm;
	}
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
			turn = fmax(turn, d);
			continue;
		}
		size = fmax(size, fabs(a->heading[k]));
		beside = fmax(beside, d);
	}
	return turn <= NEAR && beside <= NEAR * size &&
	       fmax(a->mm_s, b->mm_s) <= (1 + NEAR) * fmin(a->mm_s, b->mm_s);
}

/* If column @k goes farthest in a mm between two looks that are alike, it goes
 * so far as a parabola does that fits both; otherwise 0. */
static double farthest(const struct curve_look *a, const struct curve_look *b,
		       uint32_t k)
{
	const double sign = a->heading[k] < 0 ? -1 : 1;
	const double up = sign * a->turn[k], down = -sign * b->turn[k];
	const double most = fmax(fabs(a->heading[k]), fabs(b->heading[k]));

	return up > 0 && down > 0 ?
	       fmin(sign * a->heading[k] +
		    up * up * (b->u - a->u) / (2 * (up + down)),
		    (1 + NEAR) * most) : 0;
}

/* No axis is faster between two looks that are alike. */
static void limit_between(struct curve_plan *p, const struct curve_look *a,
			  const struct curve_look *b)
{
	for (uint32_t k = 0; k < p->curve.naxes; k++) {
		const double far = farthest(a, b, k);

		p->seen.d[k] = fmax(p->seen.d[k], far);
		if (far * p->least_mm_s > p->limits.v_mm_s[k])
			p->least_mm_s = p->limits.v_mm_s[k] / far;
	}
}

/* The tightest place of a bend may lie between two looks: look there, until
 * neighbours are alike. */
static void look_between(struct curve_plan *p, const struct curve_look *a,
			 const struct curve_look *b, int halvings)
{
	struct curve_look middle;

	if (is_near(p, a, b)) {
		limit_between(p, a, b);
		return;
	}
	if (halvings == 0)
		return;
	middle = build_curve_look(p, (a->u + b->u) / 2);
	p->least_mm_s = fmin(p->least_mm_s, middle.mm_s);
	p->most_mm_s = fmax(p->most_mm_s, middle.mm_s);
	look_between(p, a, &middle, halvings - 1);
	look_between(p, &middle, b, halvings - 1);
}

void build_curve_look_between(struct curve_plan *p, const struct curve_look *a,
			      const struct curve_look *b)
{
	look_between(p, a, b, NEAR_HALVINGS);
}

double build_curve_feed(const struct curve_plan *p)
{
	const double chord = p->chord_mm_s / sqrt(p->seen.bend);

	return fmax(chord, p->slowest_mm_s);
}

double build_curve_rate(const struct curve_plan *p)
{
	double rate = 0;

	for (uint32_t k = 0; k < p->curve.naxes; k++)
		rate = fmax(rate, p->seen.d[k] *
				  p->pulses_mm[p->curve.axis[k]]);
	return rate;
}
