/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_curve_share.c - what a curve keeps of its axes for going along it
 *
 * An axis that speeds up along a bend has its acceleration and jerk for both.
 * Who keeps more for going along passes bends slower, and is back at speed
 * earlier.  What is best depends on how often the curve bends, how tight, and
 * what its axes can do.  So the time that it takes is estimated for some
 * shares, from some places, and the best of them holds for the whole curve: a
 * move keeps the least acceleration and jerk of its way.  A curve for which
 * this estimate would not hold has no share (build_curve_feed.c).
 */
#include "path/build_curve.h"
#include "path/builder.h"
#include "speed/ramp.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LOOKS		8		/* in a span */
#define NEAR		1.25		/* look between speeds that differ by
					 * more */
#define HALVINGS	8
#define PLACES_MOST	100000		/* of a curve; the rest is not looked
					 * at */
#define EVEN		0.6		/* least to mean of what its axes can
					 * speed up by */
#define MOVE_MM		20		/* of curves that follow each other */
#define JUMP_MM		1
#define SHORT_MM	2		/* a shorter curve has no share */
#define CHORDS		16

static const struct curve_share shares[] = {
	{ 0.6, 0.45 }, { 0.75, 0.6 }, { 0.9, 0.45 }, { 0.45, 0.45 },
	{ 0.3, 0.3 }, { 0.15, 0.2 }, { 0.05, 0.4 },
	{ 0.2, 0.8 }, { 0.5, 0.7 }, { 0.7, 0.8 }, { 0.9, 0.9 },
};

#define NSHARES			(sizeof(shares) / sizeof(shares[0]))

/* -- What a share allows ------------------------------------------------- */

/*
 * How fast a curve can be sped up along, where its axes go by @mm in a mm, and
 * do not bend: in whatever direction those go that count.  From 0 to the speed
 * v no move with the jerk j comes to more than sqrt(v * j).
 */
static struct curve_go can_go(const struct curve_plan *p,
			      const double mm[INTERP_NAXES])
{
	struct curve_go ret = { HUGE_VAL, HUGE_VAL };
	double v = 0;

	for (uint32_t k = 0; k < p->curve.naxes; k++) {
		const struct interp_axis_limits *m = build_curve_axis(p, k);
		const double d = k < p->curve.counted ? 1 : fabs(mm[k]);

		ret.a_mm_s2 = fmin(ret.a_mm_s2, m->a_max_mm_s2 / d);
		ret.j_mm_s3 = fmin(ret.j_mm_s3, m->j_max_mm_s3 / d);
		if (k < p->curve.counted)
			v += m->v_max_mm_s;
	}
	ret.a_mm_s2 = fmin(ret.a_mm_s2, sqrt(v * ret.j_mm_s3));
	return ret;
}

/* What is kept of that. */
static struct curve_go keep(const struct curve_plan *p,
			    const double mm[INTERP_NAXES],
			    const struct curve_share *share)
{
	const struct curve_go can = can_go(p, mm);

	return (struct curve_go) { share->a * can.a_mm_s2,
				   share->j * can.j_mm_s3 };
}

/* The v with @cubic v^3 + @linear v = @all; none of them is negative.  It is
 * never too little, and too much by a millionth at most. */
static double root(double cubic, double linear, double all)
{
	double v = fmin(cbrt(all / cubic), all / linear);

	if (!(v > 0 && v < HUGE_VAL))
		return v;
	for (int i = 0; i < 4; i++)
		v -= (cubic * v * v * v + linear * v - all) /
		     (3 * cubic * v * v + linear);
	return v;
}

/* How fast the axes of columns @from up to, but not with, @to can follow, when
 * @go goes along the curve. */
static double follow_mm_s(const struct curve_plan *p,
			  const struct interp_nurbs_way *w,
			  const struct curve_go *go, uint32_t from, uint32_t to)
{
	double v = HUGE_VAL;

	for (uint32_t k = from; k < to; k++) {
		const struct interp_axis_limits *m = build_curve_axis(p, k);
		const double d = fabs(w->d[0][k]), bend = fabs(w->d[1][k]);

		v = fmin(v, m->v_max_mm_s / d);
		v = fmin(v, sqrt((m->a_max_mm_s2 - d * go->a_mm_s2) / bend));
		v = fmin(v, root(fabs(w->d[2][k]), 3 * bend * go->a_mm_s2,
				 m->j_max_mm_s3 - d * go->j_mm_s3));
	}
	return v;
}

double build_share_mm_s(const struct curve_plan *p,
			const struct interp_nurbs_way *w,
			const struct curve_share *share)
{
	const struct curve_go go = keep(p, w->d[0], share);
	const double v = follow_mm_s(p, w, &go, 0, p->curve.counted);
	/* An axis beside the path notices every bend: it goes on there. */
	const double beside = follow_mm_s(p, w, &go, p->curve.counted,
					  p->curve.naxes);

	return build_curve_bend_mm_s(p, w, v, beside);
}

/* -- The best share ------------------------------------------------------- */

/* How fast each share may be there. */
struct look {
	double u, by_u_mm;
	struct curve_go can;
	double heading[INTERP_NAXES];
	float mm_s[NSHARES];
};

/* From a look to the next one. */
struct place {
	double mm;
	float mm_s[NSHARES];
};

struct way {
	struct curve_plan *p;
	struct table places;
	bool turns_back;		/* it has a cusp */
	double *v2;			/* the square of the speed at each */
	double mm;
	struct curve_go can;		/* the least of its places */
	double by_a;			/* the sum of mm by what can be done */
	int err;
};

static struct look look_at(struct way *y, double u)
{
	struct look ret = { .u = u };
	struct interp_nurbs_way w;
	double chord;

	interp_nurbs_way(&y->p->walk.eval, u, &w);
	ret.by_u_mm = w.by_u_mm;
	if (w.cusp) {
		y->turns_back = true;
		return ret;
	}
	memcpy(ret.heading, w.d[0], sizeof(ret.heading));
	ret.can = can_go(y->p, w.d[0]);
	chord = fmax(y->p->chord_mm_s / sqrt(w.curvature), y->p->slowest_mm_s);
	for (size_t i = 0; i < NSHARES; i++)
		ret.mm_s[i] = (float)fmin(chord, build_share_mm_s(y->p, &w,
								  &shares[i]));
	return ret;
}

static void add_place(struct way *y, const struct look *a, const struct look *b)
{
	const double mm = (a->by_u_mm + b->by_u_mm) / 2 * (b->u - a->u);
	const struct curve_go can = {
		fmin(a->can.a_mm_s2, b->can.a_mm_s2),
		fmin(a->can.j_mm_s3, b->can.j_mm_s3),
	};
	struct place *q;

	if (!(mm > 0) || y->err < 0 || y->places.n >= PLACES_MOST)
		return;
	q = build_table_add(&y->places);
	y->err = q ? 0 : -ENOMEM;
	if (!q)
		return;
	q->mm = mm;
	y->mm += mm;
	y->by_a += mm / can.a_mm_s2;
	y->can.a_mm_s2 = fmin(y->can.a_mm_s2, can.a_mm_s2);
	y->can.j_mm_s3 = fmin(y->can.j_mm_s3, can.j_mm_s3);
	for (size_t i = 0; i < NSHARES; i++)
		q->mm_s[i] = fminf(a->mm_s[i], b->mm_s[i]);
}

static void add_between(struct way *y, const struct look *a,
			const struct look *b, int halvings)
{
	const float v = a->mm_s[0], w = b->mm_s[0];
	const bool turns = interp_nurbs_dot(&y->p->walk.eval.c, a->heading,
					    b->heading) < 0;
	struct look middle;

	if (halvings == 0 ||
	    (!turns && fmaxf(v, w) <= (float)NEAR * fminf(v, w))) {
		y->turns_back |= turns;
		add_place(y, a, b);
		return;
	}
	middle = look_at(y, (a->u + b->u) / 2);
	add_between(y, a, &middle, halvings - 1);
	add_between(y, &middle, b, halvings - 1);
}

static void add_places(struct way *y)
{
	struct interp_nurbs_eval *e = &y->p->walk.eval;
	const double end = interp_nurbs_last(&e->c);
	double from = interp_nurbs_first(&e->c);
	struct look last = look_at(y, from);

	while (y->err == 0 && from < end && y->places.n < PLACES_MOST) {
		struct interp_nurbs_point at;
		double to;

		interp_nurbs_at(e, from, 0, &at);
		to = e->to;
		for (int i = 1; i <= LOOKS; i++) {
			const struct look here = look_at(y, i < LOOKS ?
				from + (to - from) * i / LOOKS : to);

			add_between(y, &last, &here, HALVINGS);
			last = here;
		}
		from = to;
	}
}

/* The speeds with share @i up to @most_mm_s, and with an acceleration of
 * @a_mm_s2, forward and back. */
static void run(struct way *y, size_t i, double most_mm_s, double a_mm_s2)
{
	const struct place *q = y->places.at;
	double v2 = most_mm_s * most_mm_s;

	for (size_t k = 0; k < y->places.n; k++) {
		const double most = fmin((double)q[k].mm_s[i], most_mm_s);

		y->v2[k] = v2 = fmin(v2, most * most);
		v2 += 2 * a_mm_s2 * q[k].mm;
	}
	for (size_t k = y->places.n - 1; k-- > 0;)
		y->v2[k] = fmin(y->v2[k],
				y->v2[k + 1] + 2 * a_mm_s2 * q[k].mm);
}

/* What the jerk leaves of the acceleration, in the mean of all ramps.  A dip of
 * a tenth is none. */
static double slope_mm_s2(const struct way *y, const struct curve_go *go)
{
	double low = y->v2[0], high = low, rise = 0, s = 0;

	for (size_t k = 1; k <= y->places.n; k++) {
		const double v2 = k < y->places.n ? y->v2[k] : 0;

		if (v2 > high)
			high = v2;
		if (v2 >= high || v2 > 0.8 * high)
			continue;
		if (high > 1.25 * low) {
			const double by = sqrt(high) - sqrt(low);

			rise += by;
			s += ramp_s(by, go->a_mm_s2, go->j_mm_s3);
		}
		low = high = v2;
	}
	return s > 0 ? rise / s : go->a_mm_s2;
}

/* From a stand to a stand over @mm, along a curve that goes on like this one,
 * with share @i, no faster than @most_mm_s. */
static double time_s(struct way *y, size_t i, double mm, double most_mm_s)
{
	const struct curve_go go = { shares[i].a * y->can.a_mm_s2,
				     shares[i].j * y->can.j_mm_s3 };
	const double most = fmin(most_mm_s, ramp_rise_mm_s(
					    mm, go.a_mm_s2, go.j_mm_s3));
	const struct place *q = y->places.at;
	double s = 0;

	run(y, i, most, go.a_mm_s2);
	run(y, i, most, slope_mm_s2(y, &go));
	for (size_t k = 0; k < y->places.n; k++)
		s += q[k].mm / sqrt(y->v2[k]);
	return s * mm / y->mm + ramp_s(y->mm / s, go.a_mm_s2, go.j_mm_s3);
}

/* The product of what moves take: of the curve alone, of one that has more such
 * curves, of a jump; and at F, which only dry runs and cuts know. */
static double cost(struct way *y, size_t i)
{
	const double f = y->p->feed_mm_s;

	return time_s(y, i, y->mm, HUGE_VAL) *
	       time_s(y, i, fmax(y->mm, MOVE_MM), HUGE_VAL) *
	       time_s(y, i, JUMP_MM, HUGE_VAL) *
	       (f > 0 ? time_s(y, i, y->mm, f) : 1);
}

/* Where the path turns back, or an axis beside it turns much farther in some mm
 * than in others, there are stands beside these places, which the estimate does
 * not know. */
static bool is_even(const struct way *y)
{
	return !y->turns_back && y->places.n > 0 &&
	       y->can.a_mm_s2 * y->by_a > EVEN * y->mm;
}

/* What moves a short curve is a part of is not known. */
static bool is_short(const struct curve_plan *p)
{
	const struct interp_nurbs_eval *e = &p->walk.eval;
	struct interp_nurbs_eval here = *e;
	const double first = interp_nurbs_first(&e->c);
	const double by = (interp_nurbs_last(&e->c) - first) / CHORDS;
	struct interp_nurbs_point a, b;
	double mm = 0;

	interp_nurbs_at(&here, first, 0, &a);
	for (int i = 1; i <= CHORDS && mm < SHORT_MM; i++) {
		interp_nurbs_at(&here, first + i * by, 0, &b);
		for (uint32_t k = 0; k < p->curve.counted; k++)
			mm += fabs(b.d[0][k] - a.d[0][k]);
		a = b;
	}
	return mm < SHORT_MM;
}

int build_share_choose(struct curve_plan *p)
{
	struct way y = { .p = p, .places.size = sizeof(struct place),
			 .can = { HUGE_VAL, HUGE_VAL } };
	double least = HUGE_VAL;

	if (is_short(p))
		return 0;
	add_places(&y);
	y.v2 = malloc((y.places.n + 1) * sizeof(*y.v2));
	if (!y.v2)
		y.err = -ENOMEM;
	for (size_t i = 0; y.err == 0 && is_even(&y) && i < NSHARES; i++) {
		const double here = cost(&y, i);

		if (here < least) {
			least = here;
			p->share = &shares[i];
		}
	}
	build_table_free(&y.places);
	free(y.v2);
	return y.err;
}
