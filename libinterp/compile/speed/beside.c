/* SPDX-License-Identifier: Apache-2.0 */
/*
 * beside.c - how fast a column beside the path can follow the bends of short
 * lines
 *
 * Such a column has the place B(s) at the way s, and moves by
 *
 *	B'' v^2 + B' a			of its acceleration,
 *	B''' v^3 + 3 B'' v a + B' j	of its jerk.
 *
 * B' is its rate, B'' its bend.  A bend that goes on over the windows before
 * and behind takes no jerk of its own, however tight it is; one that is in this
 * window alone comes and goes within it, and takes what the window shows.
 */
#include "speed/pass.h"

/* Of its jerk, how much counts that a change of its bend takes.  Roundings are
 * left out (dip.c), so it may be more than INTERP_BESIDE_JERK_ROUND. */
#define CHANGE_MOST	0.65

/* What is left of its jerk at least, if a move needs as much along the path. */
#define JERK_ALONG	0.38

/* The chords from node to node over three windows. */
struct bows {
	struct chord chord[4];
	double along;			/* the rounding of the path */
};

static void bows_of(struct pass *w, const struct look *l, struct bows *ret)
{
	const struct interp_seg *s = w->segs;
	struct around *k = l->window;

	if (k->before < w->run)
		k->before = w->run;
	while (k->before < k->behind &&
	       s[k->behind].s_mm - s[k->before + 1].s_mm >= k->mm)
		k->before++;
	if (k->beyond < k->ahead)
		k->beyond = k->ahead;
	while (k->beyond < w->run_end &&
	       s[k->beyond].s_mm - s[k->ahead].s_mm < k->mm)
		k->beyond++;
	ret->along = pass_along_tol(w, l->along);
	pass_chord(w, k->before, k->behind, l->along, &ret->chord[0]);
	pass_chord(w, k->behind, l->node, l->along, &ret->chord[1]);
	pass_chord(w, l->node, k->ahead, l->along, &ret->chord[2]);
	pass_chord(w, k->ahead, k->beyond, l->along, &ret->chord[3]);
}

struct bend {
	double is, rounding;		/* change of the rate in a mm */
};

/* Of column @j, between chord @at and the next one. */
static struct bend bend_of(const struct pass *w, const struct bows *k, int at,
			   uint32_t j)
{
	const struct chord *c = &k->chord[at];
	const double a = c[0].h.rate[j], b = c[1].h.rate[j];
	const double mm = (c[0].way_mm + c[1].way_mm) / 2;
	const double off = w->tol[j] + pass_off(w, j, k->along,
						larger(fabs(a), fabs(b)));

	return (struct bend) {
		(b - a) / mm, off * (1 / c[0].way_mm + 1 / c[1].way_mm) / mm
	};
}

/* By how much the bend changes in a mm. */
struct bend_change {
	double most;			/* before the node or behind it,
					 * whatever is more; INFINITY: there is
					 * no room to see that */
	double less;			/* the same, less another rounding */
	double at;			/* at the node, for certain */
	double fro;			/* the same, if it bends to and fro;
					 * then it is no corner */
};

/* For certain, from the bend before the node to that behind it.  What is a
 * change on one side of the node only is a corner beside it. */
static double change_at(const struct bend side[2], double here)
{
	const double before = side[0].is, behind = side[1].is;
	const double all = fabs(behind - before) - side[0].rounding -
			   side[1].rounding;

	return larger(smaller(all, 2 * smaller(fabs(here - before),
					       fabs(behind - here))), 0);
}

static bool to_and_fro(const struct bend side[2])
{
	return side[0].is * side[1].is < 0 &&
	       fabs(side[0].is) > side[0].rounding &&
	       fabs(side[1].is) > side[1].rounding;
}

static struct bend_change bend_change(struct pass *w, const struct look *l,
				      uint32_t j)
{
	struct bend here, side[2];
	struct bend_change ret = { -1, 0, 0, 0 };
	struct bows k;
	double way_mm;

	bows_of(w, l, &k);
	way_mm = k.chord[1].way_mm + k.chord[2].way_mm;
	here = side[0] = side[1] = bend_of(w, &k, 1, j);
	for (int n = 0; n < 2; n++) {
		double d, off;

		if (!(k.chord[3 * n].mm > 0))
			continue;
		side[n] = bend_of(w, &k, 2 * n, j);
		d = fabs(side[n].is - here.is);
		off = side[n].rounding + here.rounding;
		if (l->certain)
			d = larger(d - off, 0);
		ret.most = larger(ret.most, d / k.chord[1 + n].way_mm);
		ret.less = larger(ret.less, (d - off) / k.chord[1 + n].way_mm);
	}
	if (ret.most < 0)
		return (struct bend_change) { INFINITY, INFINITY, INFINITY, 0 };
	ret.at = smaller(change_at(side, here.is) / way_mm, ret.most);
	ret.fro = to_and_fro(side) ? ret.at : 0;
	return ret;
}

/* A bend, the same less another rounding, and how it changes. */
struct is_bent {
	double bend, less, change;
};

static double rate_of(const struct look *l, uint32_t j)
{
	return fabs(l->bow.a->rate[j] + l->bow.b->rate[j]) / 2;
}

/* So much of the rate is certain. */
static double sure_rate_of(struct pass *w, const struct look *l, uint32_t j)
{
	const double rate = rate_of(l, j);
	const double off = w->tol[j] +
			   pass_off(w, j, pass_along_tol(w, l->along), rate);

	return larger(rate - off / (2 * l->bow.way_mm), 0);
}

/* What is noted of the column at this node.  Its rate is the most of which a
 * window is certain that shows something: a wide one sees less of a rate that
 * comes and goes, and an axis took up to 1.6 times its jerk on its top. */
static struct bent *noted(struct pass *w, const struct look *l, uint32_t j)
{
	struct bent *b = &w->bent[j];

	if (!(w->bends >> j & 1))
		*b = (struct bent) { 0 };
	b->rate = larger(b->rate, sure_rate_of(w, l, j));
	w->bends |= 1u << j;
	return b;
}

static void show_change(struct bent *b, const struct look *l, double change)
{
	if (change <= b->change)
		return;
	b->change = change;
	b->change_mm = DIP_NEAR * l->window->mm;
}

/* How its bend changes takes jerk also where it hardly bends, as on the top of
 * a peak of its rate: there the change is the most. */
static void note_change(struct pass *w, const struct look *l, uint32_t j,
			double change)
{
	const double v = l->most_mm_s, jerk = w->j_mm_s3[j];

	if (!l->certain || change * v * v * v <= PASS_HARDLY_JERK * jerk)
		return;
	show_change(noted(w, l, j), l, change);
}

/* If to speed up on it takes jerk, or more acceleration than there is.  A
 * corner beside the node is no bend of it. */
static void note_bent(struct pass *w, const struct look *l, uint32_t j,
		      const struct is_bent *is)
{
	const double v = l->most_mm_s, own = pass_own_mm_s2(w);
	struct bent *b;

	if (!l->certain || l->beside_corner >> j & 1 ||
	    (3 * is->bend * v * own <= INTERP_ARC_JERK_BOTH * w->j_mm_s3[j] &&
	     is->bend * v * v + rate_of(l, j) * own <= w->a_mm_s2[j]))
		return;
	b = noted(w, l, j);
	b->bend = larger(b->bend, is->less);
	if (is->bend > b->shown) {
		b->shown = is->bend;
		b->near_mm = DIP_NEAR * l->window->mm;
	}
	show_change(b, l, is->change);
}

/* What its bend may take.  What a move needs along the path may point the same
 * way, and it has INTERP_LEAST_ALONG. */
static double for_bend_mm_s2(const struct pass *w, const struct look *l,
			     uint32_t j)
{
	const double a = w->a_mm_s2[j];
	const double rate = larger(fabs(l->bow.a->rate[j]),
				   fabs(l->bow.b->rate[j]));
	const double along = smaller(rate * pass_own_mm_s2(w) / a, 1);

	return a * (1 - INTERP_LEAST_ALONG * along);
}

/* cbrt(INTERP_ARC_JERK_ROUND) */
#define ROUND_SPEED	0.66943295

/* How fast a bend may be followed that changes by @change in a mm, by @at of it
 * for certain.  One that is in this window alone may turn back in it, and so
 * change by more than all of it. */
static double round_mm_s(const struct pass *w, uint32_t j, double change,
			 double at, double alone_mm_s)
{
	const double jerk = w->j_mm_s3[j], v = cbrt(jerk / change);
	const double share = cbrt(INTERP_BESIDE_JERK_ROUND * jerk /
				  smaller(at, change));

	if (!(change < INFINITY))
		return alone_mm_s;
	return larger(ROUND_SPEED * v,
		      smaller(alone_mm_s, smaller(v, share)));
}

/* How fast a bend may be followed by itself, if it comes and goes within this
 * window; @a_mm_s2: what it may take. */
static double alone_mm_s(const struct pass *w, const struct look *l, uint32_t j,
			 double a_mm_s2, double d)
{
	if (!(d > 0))
		return INFINITY;
	return pass_round_mm_s(l->bow.way_mm / d, a_mm_s2, w->j_mm_s3[j] * d);
}

/* If it goes on. */
static double on_mm_s(const struct pass *w, uint32_t j, double a_mm_s2,
		      double bend)
{
	const double set_off = INTERP_ARC_JERK_BOTH * w->j_mm_s3[j] /
			       (3 * bend * INTERP_LEAST_ALONG *
				pass_own_mm_s2(w));

	return smaller(set_off, sqrt(a_mm_s2 / bend));
}

static void limit(struct shown *k, double mm_s, double most_mm_s)
{
	k->mm_s = pass_least(k->mm_s, (float)mm_s);
	k->most_mm_s = pass_least(k->most_mm_s, (float)most_mm_s);
}

void pass_beside(struct pass *w, struct look *l, uint32_t j, double d,
		 double less)
{
	const double a = for_bend_mm_s2(w, l, j), jerk = w->j_mm_s3[j];
	const double mm = l->bow.way_mm, most = l->most_mm_s;
	struct is_bent is = { d / mm, less / mm, 0 };
	double alone, alone_less, round, firm;
	struct bend_change change;
	bool goes_on;

	if (most * most * is.bend <= a &&
	    most * most * most * is.bend <= PASS_HARDLY_JERK * jerk * mm) {
		note_bent(w, l, j, &is);
		return;
	}
	alone = alone_mm_s(w, l, j, a, d);
	alone_less = alone_mm_s(w, l, j, a, less);
	change = bend_change(w, l, j);
	/* Where it turns from one side to the other, it changes by more than it
	 * is, and is none the less there. */
	goes_on = 2 * change.most * mm < is.bend || change.fro > 0;
	is.change = change.at;
	note_change(w, l, j, change.fro);
	if (alone * alone * is.bend >= a) {
		if (goes_on)
			note_bent(w, l, j, &is);
		limit(&l->firm, alone, alone_less);
		return;
	}
	round = round_mm_s(w, j, change.most, change.at, alone);
	firm = on_mm_s(w, j, a, is.bend);
	/* A corner is no bend that takes jerk all of the way. */
	if (smaller(round, firm) > alone || goes_on)
		note_bent(w, l, j, &is);
	limit(&l->round, round, round_mm_s(w, j, change.less, change.at,
				       alone_less));
	limit(&l->firm, larger(firm, alone),
	      larger(on_mm_s(w, j, a, is.less), alone_less));
}

/* Of its jerk, what the change of a bend takes.  What only this node shows may
 * be a rounding. */
static double change_share(const struct bent *b, double vvv, double jerk)
{
	const double sure = smaller(b->sure * vvv / jerk, CHANGE_MOST);

	if (!(b->bend > 0))
		return sure;
	return larger(sure, smaller(b->change * vvv / jerk,
				    INTERP_ARC_JERK_ROUND));
}

/* Where the path itself bends, what it needs is square to the way along it,
 * whatever direction an axis has. */
static double square_mm_s2(const struct bent_node *k, double a, double v)
{
	const double across = (double)k->all * v * v;

	return k->all > 0 && across < a ? sqrt(a * a - across * across) : 0;
}

/* Unlike on an arc, what an axis needs along the path and for its bend may
 * point one way. */
void pass_leave(const struct pass *w, const struct bent_node *k, double v_mm_s,
		struct leave *ret)
{
	const double least = INTERP_LEAST_ALONG * (double)k->own_mm_s2;
	const double jerk = w->j_mm_s3[k->column], a = w->a_mm_s2[k->column];
	const struct bent *b = &k->is;
	const double v = v_mm_s;
	const double across = smaller(b->bend * v * v / a, 1);
	const double round = change_share(b, v * v * v, jerk);
	const double along = smaller(JERK_ALONG,
				     (double)k->own_mm_s3 * b->rate / jerk);
	const double other = smaller(round + along, 1);
	const double most = smaller(sqrt(1 - other * other),
				    INTERP_ARC_JERK_BOTH);
	double left, both;

	left = b->bend > 0 ? most * jerk / (3 * b->bend * v) : INFINITY;
	if (b->rate > 0)
		left = smaller(left, larger((1 - across) * a / b->rate,
					    square_mm_s2(k, a, v)));
	left = larger(left, least);
	both = b->bend > 0 ? smaller(3 * b->bend * v * left / jerk, most) : 0;
	ret->a_mm_s2 = left;
	ret->j_mm_s3 = b->rate > 0 ? (sqrt(1 - both * both) - round) * jerk /
				     b->rate : INFINITY;
}

void pass_note_bends(struct pass *w, uint32_t before, uint32_t behind)
{
	const float a = w->segs[before].j_mm_s3, b = w->segs[behind].j_mm_s3;
	const float own_mm_s3 = a < b ? a : b;
	const double own = pass_is_known(w, before, behind) ?
			   pass_known_own(w, before, behind) :
			   pass_own_mm_s2(w);


	for (uint32_t j = 0; j < w->n; j++)
		if (w->bends >> j & 1)
			pass_bent_node(w, &(struct bent_node) {
				w->bent[j], j, before, behind,
				(float)own, own_mm_s3, INFINITY, 0,
			});
}
