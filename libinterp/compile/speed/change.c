/* SPDX-License-Identifier: Apache-2.0 */
/*
 * change.c - how fast short lines may be passed whose bend changes
 *
 * Where a path bends by k in a mm, and that changes by k' in a mm, the axes
 * that make its length take a jerk of v^3 k', square to the path.  Where it
 * bends to and fro a little, that is more than all that its radius asks for.
 *
 * A step of the bend may also be rounded off within corner_mm (curl.c).
 *
 * The change is a difference of differences, in which roundings show most.  So
 * it is measured over one window after the other, and only what is certain
 * counts.  It is the same at nodes near to each other: a window moves on by its
 * own length, and keeps what it has seen.
 */
#include "speed/nearby.h"

#include <math.h>

/* Bends that turn by more within a window are tight. */
#define TIGHT		0.1

/* So much longer is a path by roundings at most. */
#define LONGER_MOST	1.02

/* If a rounding hides no more of a bend, a wider window shows no more. */
#define CLEAR		1.03

/* A bend that is so many times what it may be in narrower windows is a corner
 * beside them. */
#define CORNER		2

/* The columns that are looked at, and the greatest speed that is asked for. */
struct asked {
	uint32_t along;
	double most_mm_s;
};

static const struct chord *chord_at(const struct changing *c, uint32_t at)
{
	return &c->chord[(c->first + at) & 3];
}

static double follows_mm_s(const struct pass *w, uint32_t j, double step,
			   double mm)
{
	return larger(pass_cube_root(PASS_CHANGE_SHARE * w->j_mm_s3[j] *
				     mm / step),
		      sqrt(w->curl_mm_s2[j] / step));
}

/* -- The nodes of a window ------------------------------------------------ */

/* The last node of the run that is at least @mm before node @i, or its first
 * one. */
static uint32_t before(const struct pass *w, uint32_t i, double mm)
{
	const double most = w->segs[i].s_mm - mm;
	uint32_t step = 1, from = i;

	if (i <= w->run)
		return i;
	do {
		i = from;
		from = i - w->run > step ? i - step : w->run;
		step *= 2;
	} while (from > w->run && w->segs[from].s_mm > most);
	while (from + 1 < i) {
		const uint32_t k = from + (i - from) / 2;

		if (w->segs[k].s_mm <= most)
			from = k;
		else
			i = k;
	}
	return from;
}

/* The same, where it may be @guess nodes from there. */
static uint32_t before_near(const struct pass *w, uint32_t i, double mm,
			    uint32_t guess)
{
	const double most = w->segs[i].s_mm - mm;
	uint32_t k = i - w->run > guess ? i - guess : w->run;

	while (k > w->run && w->segs[k].s_mm > most)
		k--;
	while (k + 1 < i && w->segs[k + 1].s_mm <= most)
		k++;
	return k;
}

/* The first node of the run that is at least @mm behind node @i, or its last
 * one.  It may be @guess nodes from there. */
static uint32_t behind(const struct pass *w, uint32_t i, double mm,
		       uint32_t guess)
{
	const uint32_t end = w->run_end < w->known ? w->run_end : w->known;
	const double least = w->segs[i].s_mm + mm;
	uint32_t k = i + guess < end ? i + guess : end;

	while (k < end && w->segs[k].s_mm < least)
		k++;
	while (k > i + 1 && w->segs[k - 1].s_mm >= least)
		k--;
	return k;
}

static void begin(const struct pass *w, uint32_t i, uint32_t along, double mm,
		  struct changing *c)
{
	const uint32_t b = before(w, i, mm), a = before_near(w, b, mm, i - b);

	c->node[0] = i;
	c->node[1] = behind(w, i, mm, i - b);
	c->node[2] = behind(w, c->node[1], mm, i - b);
	c->first = 0;
	pass_chord(w, a, b, along, &c->chord[0]);
	pass_chord(w, b, i, along, &c->chord[1]);
	pass_chord(w, i, c->node[1], along, &c->chord[2]);
	pass_chord(w, c->node[1], c->node[2], along, &c->chord[3]);
	c->known = true;
}

/* By one window. */
static void move_on(const struct pass *w, uint32_t along, double mm,
		    struct changing *c)
{
	const uint32_t last = c->node[2];

	c->node[2] = behind(w, last, mm, last - c->node[1]);
	c->node[0] = c->node[1];
	c->node[1] = last;
	pass_chord(w, last, c->node[2], along, &c->chord[c->first & 3]);
	c->first++;
}

/* Return: false if it is there already. */
static bool go_to(const struct pass *w, uint32_t i, uint32_t along, double mm,
		  struct changing *c)
{
	if (!c->known || i >= c->node[2] || c->chord[0].h.along != along)
		begin(w, i, along, mm, c);
	else if (i >= c->node[1])
		move_on(w, along, mm, c);
	else
		return false;
	return true;
}

/* -- What it shows -------------------------------------------------------- */

/* The bends before the node, at it, and behind it. */
enum { BEFORE, AT, BEHIND, BENDS };

/* What all columns of them have in common. */
struct bends {
	const struct chord *chord[BENDS + 1];
	double per_mm[BENDS];		/* of the change of a rate; 0: there is
					 * none */
	double mm;			/* from the first to the last one; 0:
					 * there are not all of them */
	double rounding[BENDS];		/* of a column whose rounding is 1 */
};

static void bends_of(const struct changing *c, struct bends *ret)
{
	*ret = (struct bends) { .mm = 0 };
	for (uint32_t n = 0; n <= BENDS; n++)
		ret->chord[n] = chord_at(c, n);
	for (uint32_t n = 0; n < BENDS; n++) {
		const struct chord *a = ret->chord[n], *b = ret->chord[n + 1];

		if (!(a->mm > 0 && b->mm > 0))
			continue;
		ret->per_mm[n] = 2 / (a->mm + b->mm);
		ret->rounding[n] = (a->per_mm + b->per_mm) * ret->per_mm[n];
	}
	if (ret->per_mm[BEFORE] > 0 && ret->per_mm[BEHIND] > 0)
		ret->mm = ret->chord[AT]->mm + ret->chord[BEHIND]->mm;
}

/* Of column @j. */
static inline void bend(const struct bends *k, uint32_t j, double ret[BENDS])
{
	for (uint32_t n = 0; n < BENDS; n++)
		ret[n] = (k->chord[n + 1]->h.rate[j] - k->chord[n]->h.rate[j]) *
			 k->per_mm[n];
}

/* Bends to both sides, more than roundings of @tol make? */
static inline bool to_and_fro(const struct bends *k, const double b[BENDS],
			      double tol)
{
	bool left = false, right = false;

	for (uint32_t n = 0; n < BENDS; n++) {
		left |= b[n] > tol * k->rounding[n];
		right |= -b[n] > tol * k->rounding[n];
	}
	return left && right;
}

/*
 * From the bend before the node to that behind it.  What is a change on one
 * side of the node only is a corner beside it; but a corner bends to one side
 * only.
 */
static inline double change_of(const struct bends *k, const double b[BENDS],
			       double tol)
{
	if (to_and_fro(k, b, tol))
		return larger(larger(b[BEFORE], b[AT]), b[BEHIND]) -
		       smaller(smaller(b[BEFORE], b[AT]), b[BEHIND]);
	return smaller(fabs(b[BEHIND] - b[BEFORE]),
		       2 * smaller(fabs(b[AT] - b[BEFORE]),
				   fabs(b[BEHIND] - b[AT])));
}

/* How much of the bend at the node is certain, squared; no more than that; and
 * the same times what it is to both sides, and may be there. */
struct sure {
	double is2, most2, before, behind;
	double before_most, behind_most;
	uint32_t moves;			/* the columns that move */
};

/* Of one more column. */
static inline void add_bend(const struct bends *k, const double b[BENDS],
			    double tol, double d, struct sure *ret)
{
	const double most = fabs(b[AT]) + tol * k->rounding[AT];
	const double way = b[AT] > 0 ? d : -d;

	ret->is2 += d * d;
	ret->most2 += most * most;
	ret->before += way * b[BEFORE] - d * tol * k->rounding[BEFORE];
	ret->behind += way * b[BEHIND] - d * tol * k->rounding[BEHIND];
	ret->before_most += way * b[BEFORE] + d * tol * k->rounding[BEFORE];
	ret->behind_most += way * b[BEHIND] + d * tol * k->rounding[BEHIND];
}

/* What of the bend at the node goes on to both sides of it, or, at an end of
 * the run, to the one that there is.  A corner does not. */
static double goes_on(const struct bends *k, double is2, double before,
		      double behind)
{
	double least = INFINITY;

	if (k->per_mm[BEFORE] > 0)
		least = before;
	if (k->per_mm[BEHIND] > 0)
		least = smaller(least, behind);
	return least < INFINITY ? larger(smaller(2 * least / is2, 1), 0) : 0;
}

/* No more of the bend goes on than in this window and in all narrower ones it
 * may: wide ones see two corners as one bend. */
static void no_more_on(const struct bends *k, const struct sure *sure,
		       struct changing *c)
{
	c->on_most = smaller(c->on_most, c->bend_most);
	if (sure->is2 > 0)
		c->on_most = smaller(c->on_most, sqrt(sure->most2) *
				     goes_on(k, sure->is2, sure->before_most,
					     sure->behind_most));
}

/* Does a bend leave less for going along it? */
static bool leaves_less(const struct pass *w, const struct weakest *k,
			double bend, double v)
{
	const double own = smaller(w->a_own_mm_s2[0], w->a_own_mm_s2[1]);

	return 3 * bend * v * own >
		       INTERP_ARC_JERK_BOTH * k->j_mm_s3 ||
	       bend * v * v > PASS_HARDLY * k->a_mm_s2;
}

/* The bend of the path: as an arc of it. */
static void show_bend(const struct pass *w, const struct bends *k,
		      const struct sure *sure, struct changing *c)
{
	const struct weakest weakest = pass_weakest(w, sure->moves);
	const double is = sqrt(sure->is2), narrower = c->on_most;
	double share;

	c->bend_most = smaller(c->bend_most, sqrt(sure->most2));
	no_more_on(k, sure, c);
	if (c->on_most > CLEAR * is &&
	    leaves_less(w, &weakest, c->on_most, c->most_mm_s))
		c->clear = false;
	share = is > 0 && is <= CORNER * narrower ?
			smaller(goes_on(k, sure->is2, sure->before,
					sure->behind), c->on_most / is) : 0;
	if (share > 0)
		c->arc_mm_s = pass_arc_mm_s(&weakest, share * is);
	c->v_mm_s = smaller(c->v_mm_s, c->arc_mm_s);
	for (uint32_t j = 0; j < w->n; j++)
		c->bent[j].bend *= share;
}

/* How fast column @j can follow what changes, and whether a wider window may
 * show more. */
static inline void show_change(const struct pass *w, uint32_t j,
			       const struct bends *k, double change,
			       struct changing *c)
{
	const double v = c->most_mm_s, vvv = v * v * v, most = c->per_mm[j];
	const double enough = PASS_CHANGE_SHARE * w->j_mm_s3[j];
	const double off = w->tol[j] *
			   (k->rounding[BEFORE] + k->rounding[BEHIND]);
	const double step = smaller(change - off, most * k->mm);

	if (vvv * step > enough * k->mm)
		c->v_mm_s = smaller(c->v_mm_s,
				    follows_mm_s(w, j, step, k->mm));
	c->per_mm[j] = smaller(most, (change + off) / k->mm);
	if (vvv * c->per_mm[j] > enough)
		c->clear = false;
	c->bent[j].change = larger(step, 0) / k->mm;
}

COLUMNS_INLINE void show_columns(const struct pass *w, struct changing *c,
				 uint32_t along, uint32_t n)
{
	struct sure sure = { .moves = 0 };
	struct bends k;

	bends_of(c, &k);
	for (uint32_t j = 0; j < n; j++) {
		struct bent *is = &c->bent[j];
		double b[BENDS];

		*is = (struct bent) { 0 };
		if (!(along >> j & 1))
			continue;
		bend(&k, j, b);
		is->rate = fabs(k.chord[AT]->h.rate[j] +
				k.chord[BEHIND]->h.rate[j]) / 2;
		is->bend = larger(fabs(b[AT]) - w->tol[j] * k.rounding[AT], 0);
		sure.moves |= (uint32_t)(is->rate > 0 || fabs(b[AT]) > 0) << j;
		add_bend(&k, b, w->tol[j], is->bend, &sure);
		if (k.mm > 0)
			show_change(w, j, &k, change_of(&k, b, w->tol[j]),
				    c);
	}
	/* At an end of the run, wide windows see corners on one side only. */
	if (k.mm > 0 ||
	    (c <= &w->changing[PASS_CHANGE_FIRST] && k.per_mm[AT] > 0))
		show_bend(w, &k, &sure, c);
	else
		for (uint32_t j = 0; j < n; j++)
			c->bent[j].bend = 0;
}

/* No column bends more than @narrower says, which may be NULL. */
static void show(const struct pass *w, const struct asked *asked,
		 const struct changing *narrower, struct changing *c)
{
	c->most_mm_s = asked->most_mm_s;
	c->v_mm_s = c->arc_mm_s = INFINITY;
	c->clear = true;
	c->bend_most = narrower ? narrower->bend_most : INFINITY;
	c->on_most = narrower ? narrower->on_most : INFINITY;
	for (uint32_t j = 0; j < w->n; j++)
		c->per_mm[j] = narrower ? narrower->per_mm[j] : INFINITY;
	BY_WAYS(w->n, asked->along, show_columns, w, c);
}

static bool is_tight(const struct pass *w)
{
	return w->changing[PASS_CHANGE_FIRST].bend_most *
		       w->windows[PASS_CHANGE_FIRST].mm > TIGHT;
}

/* Where the narrowest window limits, that may be a corner beside the node: then
 * it is none in a still narrower one. */
static void show_near(struct pass *w, const struct asked *asked,
		      struct changing *c)
{
	struct changing *near = &w->changing[PASS_CHANGE_FIRST - 1];

	show(w, asked, NULL, c);
	near->known = false;
	if (!(c->v_mm_s < asked->most_mm_s) && !is_tight(w))
		return;
	begin(w, c->node[0], asked->along,
	      w->windows[PASS_CHANGE_FIRST - 1].mm, near);
	show(w, asked, NULL, near);
	show(w, asked, near, c);
}

/* A tight bend is over before a wider window shows it.  In a narrower one, how
 * it changes is no more than roundings. */
static void look_at_tight(struct pass *w, uint32_t i, const struct asked *asked)
{
	struct changing *near = &w->changing[PASS_CHANGE_FIRST - 1];

	if (go_to(w, i, asked->along, w->windows[PASS_CHANGE_FIRST - 1].mm,
		  near) || asked->most_mm_s > near->most_mm_s)
		show(w, asked, NULL, near);
	if (near->node[1] < w->gate.next)
		w->gate.next = near->node[1];
	w->gate.v_mm_s = smaller(w->gate.v_mm_s, near->arc_mm_s);
}

/* A path that is rounded goes to and fro, and is longer than its chords.  An
 * axis follows the chords. */
static double longer(const struct pass *w)
{
	const struct changing *c = &w->changing[PASS_CHANGE_FIRST];
	const struct chord *a = chord_at(c, 1), *b = chord_at(c, 2);
	const double mm = a->mm + b->mm;

	return mm > 0 ? smaller(pass_from_to(w, a->from, b->to) / mm,
				LONGER_MOST) : 1;
}

/* Of all columns, as one window shows it. */
static double bend_of(const struct pass *w, const struct changing *c)
{
	double sum = 0;

	for (uint32_t j = 0; j < w->n; j++)
		sum += c->bent[j].bend * c->bent[j].bend;
	return sqrt(sum);
}

/* What windows up to @wide show of the bend, from node @i on until more is
 * asked. */
static void note_way(struct pass *w, uint32_t i, const struct asked *asked,
		     uint32_t wide)
{
	const uint32_t from = PASS_CHANGE_FIRST - is_tight(w);
	const struct changing *near = &w->changing[PASS_CHANGE_FIRST];
	const double by = longer(w);
	struct way_bend to = { .all = 0 };
	struct bent *is = to.is;
	double sum = 0, arc_mm_s = INFINITY;

	w->gate.v_mm_s *= by;
	for (uint32_t at = from; at <= wide; at++) {
		arc_mm_s = smaller(arc_mm_s, w->changing[at].arc_mm_s);
		to.all = larger(to.all, bend_of(w, &w->changing[at]));
	}
	for (uint32_t j = 0; j < w->n; j++) {
		if (!(asked->along >> j & 1))
			continue;
		for (uint32_t at = from; at <= wide; at++)
			is[j].bend = larger(is[j].bend,
					    w->changing[at].bent[j].bend);
		for (uint32_t at = PASS_CHANGE_FIRST; at <= wide; at++)
			is[j].change = larger(is[j].change,
					      w->changing[at].bent[j].change);
		/* What changes by all of it within the narrowest window is a
		 * corner beside it. */
		is[j].change = smaller(is[j].change,
				       is[j].bend / w->windows[0].mm);
		sum += is[j].bend * is[j].bend;
		is[j].rate = near->bent[j].rate / by;
		is[j].bend /= by * by;
		is[j].change /= by * by * by;
	}
	to.all /= by * by;
	to.v_mm_s = smaller(asked->most_mm_s, w->gate.v_mm_s);
	pass_note_way(w, i - 1, w->gate.next - 1, &to);
	sum = sqrt(sum);
	pass_way_begin(w, i, &(struct way_on) {
		.bend = sum, .off = larger(near->bend_most - sum, 0),
		.most_mm_s = asked->most_mm_s, .v_mm_s = arc_mm_s * by,
	});
}

double pass_change(struct pass *w, uint32_t i, uint32_t along,
		   double most_mm_s)
{
	const struct asked asked = { along, most_mm_s };
	uint32_t wide = PASS_CHANGE_FIRST;
	const struct changing *narrower = NULL;
	struct change_gate *gate = &w->gate;

	gate->next = UINT32_MAX;
	gate->v_mm_s = INFINITY;
	gate->most_mm_s = most_mm_s;
	for (uint32_t at = PASS_CHANGE_FIRST; at < PASS_WINDOWS; at++) {
		struct changing *c = &w->changing[at];

		if (go_to(w, i, along, w->windows[at].mm, c) ||
		    most_mm_s > c->most_mm_s) {
			if (narrower)
				show(w, &asked, narrower, c);
			else
				show_near(w, &asked, c);
		}
		if (c->node[1] < gate->next)
			gate->next = c->node[1];
		gate->v_mm_s = smaller(gate->v_mm_s, c->v_mm_s);
		wide = at;
		if (c->clear)
			break;
		narrower = c;
	}
	if (is_tight(w))
		look_at_tight(w, i, &asked);
	note_way(w, i, &asked, wide);
	return gate->v_mm_s;
}

void pass_change_anew(struct pass *w, uint32_t i)
{
	for (uint32_t at = 0; at < PASS_WINDOWS; at++)
		w->changing[at].known = false;
	pass_way_end(w, i - 1);
	w->gate.next = i;
	w->gate.node = 0;
	w->gate.way.to_mm = -INFINITY;
	w->gate.most_mm_s = w->gate.v_mm_s = INFINITY;
}
