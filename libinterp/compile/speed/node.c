/* SPDX-License-Identifier: Apache-2.0 */
/*
 * node.c - how fast a node may be passed
 *
 * The ends of lines are rounded: to a pulse, or to the decimals of the program
 * that wrote them.  On short lines this rounding turns the direction at a node
 * by more than the curve does.  No axis follows anything that lies within a
 * rounding.  So what a rounding can cause does not count as a change.  Turns
 * are measured between chords of some length, minus what a rounding of their
 * ends can turn them by.  What a rounding hides on short chords is found on
 * longer ones.
 */
#include "speed/nearby.h"

#include <math.h>
#include <string.h>

/* of the windows, to see a peak of a share */
#define PEAK		0

/* Roundings of a chord over fewer lines than a window. */
#define FEW_LINES	M_SQRT2

/* If all of a turn but this share is more than a rounding, a wider window shows
 * no more. */
#define CLEAR		0.02

/* A path that is so much longer than its chord goes to and fro.  Lines as short
 * as their rounding are steps of a staircase, which is not as much. */
#define CROOKED		1.5

/* An arc between two lines and their node, as far from it as from the middle of
 * both: it is so often nearer than what they turn by goes in a mm of them. */
#define BOW_CHORDS	16

/*
 * How the direction changes at a node.  If both lines are short, a rounding of
 * their ends changes it as well.  So much does not count as a change.
 */
struct change {
	const struct heading *a, *b;	/* before and behind */
	double per_mm;			/* 1 / the length before, and 1 / the
					 * length behind */
	double d[INTERP_NAXES];		/* of the rate of each column; >= 0 */
};

/* For a corner: a change that is twice as much as a rounding counts
 * completely. */
static double heard(double d, double noise)
{
	return d >= 2 * noise ? d : 2 * larger(d - noise, 0);
}

/* For a curve: only what is certain counts.  A wider window is more certain. */
static double sure(double d, double noise)
{
	return larger(d - noise, 0);
}

/* No rounding hides more than this. */
static double at_most(double d, double noise)
{
	return d + noise;
}

/* Of what lies beside the path, the rounding of the path counts too. */
COLUMNS_INLINE void change_of(struct pass *w, double (*of)(double, double),
			      struct change *c, uint32_t both, uint32_t n)
{
	const double along = pass_along_tol(w, both);

	for (uint32_t j = 0; j < n; j++) {
		const double a = c->a->rate[j], b = c->b->rate[j];
		const double most = larger(fabs(a), fabs(b));
		const double off = both >> j & 1 ? 0 :
				   pass_off(w, j, along, most);

		c->d[j] = of(fabs(b - a), (w->tol[j] + off) * c->per_mm);
	}
}

/* The columns that make both lengths: a corner is passed like an arc. */
COLUMNS_INLINE double corner(const struct pass *w, const struct change *c,
			     uint32_t both, uint32_t n)
{
	const struct heading *a = c->a, *b = c->b;
	const uint32_t any = both | a->along | b->along;
	double turn = 0, acc = INFINITY, jerk = INFINITY, half, r;

	for (uint32_t j = 0; j < n; j++) {
		const double d = both >> j & 1 ? c->d[j] : 0;

		turn += d * d;
	}
	if (!both)
		turn = 2;
	if (turn < NEAR_STRAIGHT)
		return INFINITY;
	/* There is no branch here, because corners are like random. x/0 is no
	 * limit. */
	for (uint32_t j = 0; j < n; j++) {
		const double is = (double)(any >> j & 1);
		const double d = is * c->d[j];
		const double m = is * larger(fabs(a->rate[j]),
					     fabs(b->rate[j]));

		acc = smaller(acc, w->a_mm_s2[j] / d);
		jerk = smaller(jerk, w->j_mm_s3[j] / m);
	}
	half = turn < 4 ? sqrt(1 - turn / 4) : 0;
	r = w->corner_mm * half * (1 + half) / (turn / 4);
	return pass_round_mm_s(larger(r, w->corner_mm), acc * sqrt(turn), jerk);
}

/* The speed of each of @columns makes a step. */
COLUMNS_INLINE double step(const struct pass *w, const double *d,
			   uint32_t columns, uint32_t n)
{
	double v = INFINITY;

	for (uint32_t j = 0; j < n; j++) {
		if (columns >> j & 1 && d[j] * v > w->step_mm_s[j] &&
		    d[j] > 1e-9)
			v = w->step_mm_s[j] / d[j];
	}
	return v;
}

/* -- Of short lines ------------------------------------------------------- */

void pass_chord(const struct pass *w, uint32_t from, uint32_t to,
		uint32_t along, struct chord *ret)
{
	BY_COLUMNS(w->n, near_chord, w, from, to, along, ret);
}

/* It is valid until @k is used again.  Return: false if there is no way to one
 * of the sides. */
COLUMNS_INLINE bool bow_of(const struct pass *w, uint32_t i, struct around *k,
			   uint32_t along, struct bow *ret, uint32_t n)
{
	struct chord *a = &k->chord[k->on], *b = &k->chord[!k->on];

	if (!near_chord_is(a, k->behind, i, along))
		near_chord(w, k->behind, i, along, a, n);
	if (!near_chord_is(b, i, k->ahead, along))
		near_chord(w, i, k->ahead, along, b, n);
	k->on = !k->on;
	*ret = (struct bow) { &a->h, &b->h, (a->mm + b->mm) / 2,
			      (a->way_mm + b->way_mm) / 2,
			      a->per_mm + b->per_mm };
	return a->mm > 0 && b->mm > 0;
}

/* The speed at which the axes beside the path can follow a bow.  @d is the
 * change of each column's rate, @less the same less another rounding. */
COLUMNS_INLINE double bow_beside_mm_s(struct pass *w, struct look *l,
				      const double d[INTERP_NAXES],
				      const double less[INTERP_NAXES],
				      uint32_t along, uint32_t n)
{
	l->round = l->firm = SHOWN_NONE;
	/* A column that turns beside the path is limited by itself. */
	for (uint32_t j = 0; j < n; j++)
		if (!(along >> j & 1) &&
		    (!l->certain || d[j] * l->bow.mm > w->tol[j]))
			pass_beside(w, l, j, d[j], less[j]);
	return (double)pass_least(l->round.mm_s, l->firm.mm_s);
}

/* The same of those that make its length. */
COLUMNS_INLINE double bow_along_mm_s(const struct pass *w, const struct bow *k,
				     const double d[INTERP_NAXES],
				     uint32_t along, uint32_t n)
{
	double turn = 0, acc = INFINITY, jerk = INFINITY;

	for (uint32_t j = 0; j < n; j++) {
		if (!(along >> j & 1))
			continue;
		turn += d[j] * d[j];
		if (!(d[j] > 0) && k->a->rate[j] == 0 && k->b->rate[j] == 0)
			continue;
		acc = smaller(acc, w->a_mm_s2[j]);
		jerk = smaller(jerk, w->j_mm_s3[j]);
	}
	if (turn < NEAR_STRAIGHT)
		return INFINITY;
	return pass_round_mm_s(larger(k->mm / sqrt(turn), w->corner_mm), acc,
			       jerk);
}

/* Does a rounding hide a share of a change that counts? */
COLUMNS_INLINE bool is_clear(const struct change *c,
			     const double all[INTERP_NAXES], uint32_t n)
{
	for (uint32_t j = 0; j < n; j++) {
		if (all[j] - c->d[j] > CLEAR * all[j])
			return false;
	}
	return true;
}

/* No column bends more than in a narrower window it may: a wide one sees a
 * corner from beside it.  Return: the columns of which it sees more. */
COLUMNS_INLINE uint32_t no_more(double d[INTERP_NAXES], const double *per_mm,
				double mm, uint32_t n)
{
	uint32_t more = 0;

	for (uint32_t j = 0; j < n; j++) {
		more |= (uint32_t)(d[j] > per_mm[j] * mm) << j;
		d[j] = smaller(d[j], per_mm[j] * mm);
	}
	return more;
}

COLUMNS_INLINE void bow_change(const struct bow *k, double ret[INTERP_NAXES],
			       uint32_t n)
{
	for (uint32_t j = 0; j < n; j++)
		ret[j] = fabs(k->b->rate[j] - k->a->rate[j]);
}

/* Is there a column beside the path that may bend so much that it slows down
 * what goes along?  Mostly the second window can tell that there is none. */
COLUMNS_INLINE bool may_bend(const struct pass *w, const struct look *l,
			     const double *per_mm, uint32_t along, uint32_t n)
{
	const double v = l->most_mm_s;

	for (uint32_t j = 0; j < n; j++)
		if (!(along >> j & 1) &&
		    3 * per_mm[j] * v * w->a_linear_mm_s2 >
			    INTERP_ARC_JERK_BOTH * w->j_mm_s3[j])
			return true;
	return false;
}

/* The window that shows the slowest, and the least that all of them would
 * show. */
static void note_shown(const struct look *l, const struct shown *k,
		       struct shown *ret)
{
	ret->most_mm_s = pass_least(ret->most_mm_s, k->most_mm_s);
	if (k->mm_s < ret->mm_s) {
		ret->mm_s = k->mm_s;
		ret->near_mm = (float)(DIP_NEAR * l->window->mm);
	}
}

/*
 * Short lines may turn by any small amount at each node: their curve is that of
 * the chords to both sides.  A turn that is less than a rounding over one
 * window shows over a wider one, if it goes on.  @most: no need to look for
 * more speed than this; but what goes beside the path is looked at until it is
 * clear, because its bend leaves less for going along.
 */
COLUMNS_INLINE double curve(struct pass *w, uint32_t i, double most,
			    uint32_t along, uint32_t n)
{
	const bool beside = (~along & ((1u << n) - 1)) != 0;
	double per_mm[INTERP_NAXES], enough = INFINITY;
	struct look l = { .node = i, .along = along, .most_mm_s = most };
	bool clear = false;

	w->dip.round = w->dip.bow = SHOWN_NONE;
	for (uint32_t j = 0; j < n; j++)
		per_mm[j] = INFINITY;
	for (int at = 0; at < PASS_WINDOWS && !clear; at++) {
		double all[INTERP_NAXES], less[INTERP_NAXES], fast;
		struct change c;

		l.window = &w->windows[at];
		l.certain = false;
		near_look(w, i, l.window);
		if (!bow_of(w, i, l.window, along, &l.bow, n))
			break;
		bow_change(&l.bow, all, n);
		if (at > 0)
			no_more(all, per_mm, l.bow.mm, n);
		fast = smaller(bow_beside_mm_s(w, &l, all, all, along, n),
			       bow_along_mm_s(w, &l.bow, all, along, n));
		if (fast >= most)
			enough = smaller(enough, fast);
		if (fast >= most && !beside)
			break;
		c.a = l.bow.a;
		c.b = l.bow.b;
		c.per_mm = l.bow.per_mm;
		change_of(w, sure, &c, along, n);
		if (at > 0)
			l.beside_corner = no_more(c.d, per_mm,
						  l.bow.mm, n);
		l.certain = true;
		clear = is_clear(&c, all, n);
		for (uint32_t j = 0; j < n; j++)
			less[j] = larger(2 * c.d[j] - all[j], 0);
		/* What bends beside the path is noted in any case. */
		bow_beside_mm_s(w, &l, c.d, less, along, n);
		if (isinf(enough)) {
			note_shown(&l, &l.round, &w->dip.round);
			note_shown(&l, &l.firm, &w->dip.bow);
			fast = bow_along_mm_s(w, &l.bow, c.d, along, n);
			l.firm.mm_s = l.firm.most_mm_s = (float)fast;
			if (fast < most)
				l.firm.most_mm_s = (float)bow_along_mm_s(
					w, &l.bow, less, along, n);
			note_shown(&l, &l.firm, &w->dip.bow);
		}
		change_of(w, at_most, &c, along, n);
		for (uint32_t j = 0; j < n; j++)
			per_mm[j] = smaller(per_mm[j], c.d[j] / l.bow.mm);
		if (enough < INFINITY && !may_bend(w, &l, per_mm, along, n))
			break;
	}
	note_shown(&l, &(struct shown) { (float)enough, 0, (float)enough },
		   &w->dip.bow);
	return (double)pass_least(w->dip.bow.mm_s, w->dip.round.mm_s);
}

double pass_curve(struct pass *w, uint32_t i, uint32_t along, double most_mm_s)
{
	return BY_WAYS(w->n, along, curve, w, i, most_mm_s);
}

/* Look near the node, but not over a long line behind a short one: a long line
 * has its own turn. */
static void look_near(struct pass *w, uint32_t i)
{
	const struct interp_seg *s = w->segs;
	struct around *k = &w->near;

	near_look(w, i, k);
	if (k->behind + 1 < i && s[i].s_mm - s[k->behind].s_mm > 2 * k->mm)
		k->behind++;
	if (k->ahead > i + 1 && s[k->ahead].s_mm - s[i].s_mm > 2 * k->mm)
		k->ahead--;
}

/* Is the path to here, or on from here, longer than a chord of it, by more than
 * roundings make it? */
static bool is_crooked(const struct pass *w, const struct around *k)
{
	for (int at = 0; at < 2; at++) {
		const struct chord *c = &k->chord[at];
		const double way = w->segs[c->to].s_mm -
				   w->segs[c->from].s_mm;

		if (way > CROOKED * c->mm)
			return true;
	}
	return false;
}

/* By a corner, and by the steps of these columns. */
COLUMNS_INLINE double around(struct pass *w, struct change *c, uint32_t both,
			     uint32_t columns, uint32_t n)
{
	change_of(w, heard, c, both, n);
	return smaller(corner(w, c, both, n), step(w, c->d, columns, n));
}

/* Are all of these segments parts of known ways? */
static bool are_known(const struct pass *w, uint32_t from, uint32_t to)
{
	for (uint32_t i = from; i <= to; i++)
		if (!(w->segs[i].flags & INTERP_SEG_KNOWN))
			return false;
	return true;
}

/* By the steps of what is beside known ways.  No rounding hides them.  Over
 * chords, a bend of a tiny way would be a step, and a step less than it is. */
COLUMNS_INLINE double step_known(const struct pass *w, const struct heading *a,
				 const struct heading *b, uint32_t both,
				 uint32_t n)
{
	double d[INTERP_NAXES];

	for (uint32_t j = 0; j < n; j++)
		d[j] = fabs(b->rate[j] - a->rate[j]);
	return step(w, d, ~both & near_all(n), n);
}

double pass_corner(struct pass *w, const struct chord *a,
		   const struct chord *b)
{
	struct change c = { .a = &a->h, .b = &b->h,
			    .per_mm = a->per_mm + b->per_mm };

	return around(w, &c, a->h.along, near_all(w->n), w->n);
}

/*
 * What columns that make the length step by, if the nodes before and behind
 * turn the same way: then an arc between both lines and the node is as near to
 * them as a share of what a corner may be, and no axis notices the node but for
 * what it turns by more than they do, within the other share.
 */
static void apart(const struct pass *w, uint32_t i, double d[INTERP_NAXES])
{
	const double mm = smaller(w->segs[i - 1].length_mm,
				  w->segs[i].length_mm);
	double before[INTERP_NAXES], here[INTERP_NAXES], behind[INTERP_NAXES];

	pass_turn_behind(w, i - 2, before);
	pass_turn_behind(w, i - 1, here);
	pass_turn_behind(w, i, behind);
	for (uint32_t j = 0; j < w->n; j++) {
		const double around = (before[j] + behind[j]) / 2;
		const double left = 1 - fabs(around) * mm /
					(BOW_CHORDS * w->corner_mm);

		if (fabs(here[j] - around) < left * d[j])
			d[j] = fabs(here[j] - around) / left;
	}
}

/* The turn of a node between lines; between longer chords, if the lines are
 * short. */
COLUMNS_INLINE double turn(struct pass *w, uint32_t last, uint32_t i,
			   const struct heading *a, const struct heading *b,
			   uint32_t both, uint32_t n)
{
	const struct interp_seg *s = w->segs;
	const double own_per_mm = 1 / s[last].length_mm + 1 / s[i].length_mm;
	const bool lines = s[last].kind == INTERP_LINE &&
			   s[i].kind == INTERP_LINE;
	struct change c = { .a = a, .b = b, .per_mm = own_per_mm };
	bool near = lines && smaller(s[last].length_mm, s[i].length_mm) <
				     w->near.mm;
	const bool known = a->along == b->along && are_known(w, last, i);
	double v, along;
	struct bow k;

	if (near) {
		look_near(w, i);
		near = a->along == b->along &&
		       bow_of(w, i, &w->near, both, &k, n);
	}
	if (near) {
		c.a = k.a;
		c.b = k.b;
		c.per_mm = k.per_mm;
	}
	change_of(w, heard, &c, both, n);
	v = smaller(corner(w, &c, both, n), known ?
		    step_known(w, a, b, both, n) :
		    step(w, c.d, ~both & near_all(n), n));
	along = step(w, c.d, both, n);
	if (along < v && !near && lines && last + 1 == i) {
		apart(w, i, c.d);
		along = step(w, c.d, both, n);
	}
	v = smaller(v, along);
	/* Tiny lines may go to and fro within the chords. */
	if (near && (both != near_all(n) || is_crooked(w, &w->near))) {
		c.a = a;
		c.b = b;
		c.per_mm = own_per_mm;
		v = smaller(v, around(w, &c, both, near_all(n), n));
	}
	return v;
}

double pass_turn(struct pass *w, uint32_t last, uint32_t i,
		 const struct heading *a, const struct heading *b)
{
	return BY_WAYS(w->n, a->along & b->along, turn, w, last, i, a, b);
}

double pass_node_mm_s(struct pass *w, uint32_t last, uint32_t i,
		      const struct heading *a, const struct heading *b)
{
	struct joint k = { .a = a, .b = b, .last = last, .i = i };

	return BY_COLUMNS(w->n, near_node_mm_s, w, &k);
}

double pass_over_mm_s(struct pass *w, uint32_t *first, uint32_t i,
		      const struct heading *b)
{
	const struct interp_seg *s = w->segs;
	struct headings before;
	struct change c;
	uint32_t m = *first, both, steps = near_all(w->n);

	while (m > 0 && s[m].kind < INTERP_BEGIN && pass_is_tiny(w, m) &&
	       s[i].s_mm - s[m].s_mm < w->near.mm)
		m--;
	if (s[m].kind >= INTERP_BEGIN || pass_is_tiny(w, m))
		return INFINITY;
	heading_of(&w->ways, m, &before);
	c.a = &before.last;
	c.b = b;
	both = c.a->along & b->along;
	c.per_mm = 1 / s[m].length_mm + 1 / s[i].length_mm;
	*first = m;
	if (c.a->along == b->along && are_known(w, m, i))
		steps = both;
	return around(w, &c, both, steps, w->n);
}

/* From node @from to node @to, what column @j moves in a mm of the path. */
static double rate_over(const struct pass *w, uint32_t from, uint32_t to,
			uint32_t j)
{
	const int64_t *nodes = w->p->nodes + j;
	const int64_t d = nodes[(uint64_t)to * w->n] -
			  nodes[(uint64_t)from * w->n];

	return (double)d * w->ways.sub_mm[j] / pass_from_to(w, from, to);
}

/*
 * On chord @c the rate of column @j has a peak, if that is more than on the
 * ways from there to the ends of the wider one, both.  A round top takes jerk.
 * What differs on one side only is a corner.
 */
static void limit_top(const struct pass *w, const struct chord *c,
		      uint32_t j, double tol, struct peaks *ret)
{
	const double half_mm = c->way_mm / 2;
	const double rate = c->h.rate[j], way = rate > 0 ? 1 : -1;
	double bend = INFINITY;

	for (int ahead = 0; ahead < 2; ahead++) {
		const uint32_t from = ahead ? c->to : ret->from;
		const uint32_t to = ahead ? ret->to : c->from;
		double mm, less;

		if (from == to)
			return;
		mm = pass_from_to(w, from, to);
		less = way * (rate - rate_over(w, from, to, j)) -
		       tol * (1 / mm + 1 / c->way_mm);
		mm += half_mm;
		bend = smaller(bend, 6 * less / (mm * (mm + half_mm)));
	}
	if (bend > 0)
		ret->v_mm_s = smaller(ret->v_mm_s,
				      cbrt(INTERP_BESIDE_JERK_ROUND *
					   w->j_mm_s3[j] / bend));
}

/*
 * A peak of the share of an axis beside the path: over the shorter way @c it is
 * more than over the longer one, by more than @times what both are rounded.
 *
 * The mean over a way is less than the top in its middle.  A round top makes
 * that grow with the square of the way, so both means tell how much it is.
 */
COLUMNS_INLINE void raise_rates(struct pass *w, const struct chord *c,
				double times, struct peaks *ret, uint32_t n)
{
	struct chord *around = ret->around;
	const uint32_t ways = around->h.along;
	const double along = pass_along_tol(w, ways);
	/* A chord may end where it began. */
	const double own_per_mm = 1 / c->way_mm;
	const double per_mm = times * (own_per_mm + around->per_mm);

	for (uint32_t j = 0; j < n; j++) {
		double *rate = &around->h.rate[j];
		const double off = pass_off(w, j, along, fabs(*rate));

		const double more = fabs(c->h.rate[j]) - fabs(*rate);
		/* The way before is so many times as long. */
		const double times_as_long = own_per_mm / ret->per_mm[j];

		if (ways >> j & 1 || !(more > (w->tol[j] + off) * per_mm))
			continue;
		if (times > 1)
			limit_top(w, c, j, w->tol[j] + off, ret);
		*rate = c->h.rate[j];
		ret->top[j] = times_as_long < M_SQRT2 ? 0 : more /
				(times_as_long * times_as_long - 1);
		ret->per_mm[j] = own_per_mm;
	}
}

/* Where lines begin or end, a way around line @i goes far to one side only.  Of
 * a share that grows or shrinks its mean says little. */
static void even_sides(const struct pass *w, uint32_t i, uint32_t *behind,
		       uint32_t *ahead)
{
	const struct interp_seg *s = w->segs;
	const double mm = w->windows[PEAK].mm;
	const double before = s[i].s_mm - s[i - *behind].s_mm;
	const double after = s[i + *ahead].s_mm - s[i + 1].s_mm;

	while (before < mm && *ahead > 1 &&
	       s[i + *ahead].s_mm - s[i + 1].s_mm > before)
		--*ahead;
	while (after < mm && *behind > 0 &&
	       s[i].s_mm - s[i - *behind].s_mm > after)
		--*behind;
}

/* A peak may be narrower than any window, and yet so high that no rounding
 * makes it: so the way around the line is halved down to its neighbours.  Over
 * so few lines, the roundings of X and of Y both count in the way. */
COLUMNS_INLINE void find_peaks(struct pass *w, uint32_t i, struct peaks *ret,
			       uint32_t along, uint32_t n)
{
	struct around *k = &w->windows[PEAK];
	uint32_t behind, ahead;
	double times = 1;
	struct chord c;

	ret->v_mm_s = INFINITY;
	for (uint32_t j = 0; j < n; j++) {
		ret->per_mm[j] = ret->around->per_mm;
		ret->top[j] = 0;
	}
	near_look(w, i, k);
	behind = i - k->behind;
	ahead = k->ahead - i;
	do {
		near_chord(w, i - behind, i + ahead, along, &c, n);
		raise_rates(w, &c, times, ret, n);
		if (times == 1)
			even_sides(w, i, &behind, &ahead);
		times = FEW_LINES;
		ret->from = c.from;
		ret->to = c.to;
		behind /= 2;
		ahead = (ahead + 1) / 2;
	} while (behind > 0 || ahead > 1);
}

void pass_peaks(struct pass *w, uint32_t i, struct peaks *ret)
{
	BY_WAYS(w->n, ret->around->h.along, find_peaks, w, i, ret);
}

void pass_rates(struct pass *w, uint32_t i, const struct headings *h,
		struct rates *ret)
{
	const struct interp_seg *s = &w->segs[i];

	ret->bends = 0;
	if (s->kind == INTERP_LINE && pass_is_short(w, i))
		BY_WAYS(w->n, h->first.along, near_rates, w, i, &h->first,
			ret);
	else
		BY_COLUMNS(w->n, near_other_rates, h, ret);
}
