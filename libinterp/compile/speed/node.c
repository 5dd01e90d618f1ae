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
#include "speed/pass.h"

#include <math.h>

/* Nodes that turn by less are on a line: (2*sin(phi/2))^2. */
#define STRAIGHT	1e-12

/* of the windows, to see the direction of a line itself */
#define AROUND		1
#define PEAK		0

/* Roundings of a chord over fewer lines than a window. */
#define FEW_LINES	M_SQRT2

/* If all of a turn but this share is more than a rounding, a wider window shows
 * no more. */
#define CLEAR		0.02

/* Of its own roundings, that an axis beside the path has from that of the
 * path. */
#define MOST_BESIDE	20

/* The greatest speed around a bend, if the axes have so much acceleration. */
double pass_round_mm_s(double r_mm, double a_mm_s2, double j_mm_s3)
{
	const double v = sqrt(a_mm_s2 * r_mm), jrr = j_mm_s3 * r_mm * r_mm;

	return v * v * v <= jrr ? v : cbrt(jrr);
}

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

double pass_along_tol(struct pass *w, uint32_t columns)
{
	if (columns == w->tol_of)
		return w->tol_most;
	w->tol_of = columns;
	w->tol_most = 0;
	for (uint32_t j = 0; j < w->n; j++)
		if (columns >> j & 1)
			w->tol_most = larger(w->tol_most, w->tol[j]);
	return w->tol_most;
}

/* Never more than MOST_BESIDE roundings of its own: an axis that turns far on a
 * tiny line really turns there. */
double pass_off(const struct pass *w, uint32_t j, double along, double rate)
{
	return smaller(along * rate, MOST_BESIDE * w->tol[j]);
}

/* Of what lies beside the path, the rounding of the path counts too. */
COLUMNS_INLINE void change_of(struct pass *w, double (*of)(double, double),
			      struct change *c, uint32_t n)
{
	const uint32_t both = c->a->along & c->b->along;
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
			     uint32_t n)
{
	const struct heading *a = c->a, *b = c->b;
	const uint32_t both = a->along & b->along, any = a->along | b->along;
	double turn = 0, acc = INFINITY, jerk = INFINITY, half, r;

	for (uint32_t j = 0; j < n; j++) {
		const double d = both >> j & 1 ? c->d[j] : 0;

		turn += d * d;
	}
	if (!both)
		turn = 2;
	if (turn < STRAIGHT)
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

/* The other columns: their speed makes a step. */
COLUMNS_INLINE double step(const struct pass *w, const struct change *c,
			   uint32_t n)
{
	const uint32_t both = c->a->along & c->b->along;
	double v = INFINITY;

	for (uint32_t j = 0; j < n; j++) {
		if (!(both >> j & 1) && c->d[j] * v > w->step_mm_s[j] &&
		    c->d[j] > 1e-9)
			v = w->step_mm_s[j] / c->d[j];
	}
	return v;
}

/* -- Of short lines ------------------------------------------------------- */

COLUMNS_INLINE void chord_by(const struct pass *w, uint32_t from, uint32_t to,
			     uint32_t along, struct chord *ret, uint32_t n)
{
	const int64_t *a = w->p->nodes + (uint64_t)from * n;
	const int64_t *b = w->p->nodes + (uint64_t)to * n;
	const uint32_t all = (1u << n) - 1;
	double mm[INTERP_NAXES], sum = 0, path;

	ret->from = from;
	ret->to = to;
	ret->h.along = along;
	for (uint32_t j = 0; j < n; j++) {
		mm[j] = (double)(b[j] - a[j]) * w->ways.sub_mm[j];
		sum += along >> j & 1 ? mm[j] * mm[j] : 0;
	}
	ret->mm = sqrt(sum);
	ret->way_mm = ret->mm;
	ret->per_mm = ret->mm > 0 ? 1 / ret->mm : 0;
	for (uint32_t j = 0; j < n; j++)
		ret->h.rate[j] = mm[j] * ret->per_mm;
	if ((along & all) == all)
		return;
	/* A chord cuts corners.  What is beside it goes all of the way. */
	ret->way_mm = path = w->segs[to].s_mm - w->segs[from].s_mm;
	for (uint32_t j = 0; j < n; j++)
		if (!(along >> j & 1))
			ret->h.rate[j] = path > 0 ? mm[j] / path : 0;
}

void pass_chord(const struct pass *w, uint32_t from, uint32_t to,
		uint32_t along, struct chord *ret)
{
	BY_COLUMNS(w->n, chord_by, w, from, to, along, ret);
}

static bool chord_is(const struct chord *c, uint32_t from, uint32_t to,
		     uint32_t along)
{
	return c->from == from && c->to == to && c->h.along == along;
}

/* Not over a place from which the length is in other columns. */
static void look_around(const struct pass *w, uint32_t i, struct around *k)
{
	const struct interp_seg *s = w->segs;
	const double here = s[i].s_mm, mm = k->mm;
	uint32_t behind = k->behind, ahead = k->ahead > i ? k->ahead : i;

	if (behind < w->run)
		behind = w->run;
	while (behind < i && here - s[behind + 1].s_mm >= mm)
		behind++;
	while (ahead < w->run_end && s[ahead].s_mm - here < mm)
		ahead++;
	k->behind = behind;
	k->ahead = ahead;
}

/* It is valid until @k is used again.  Return: false if there is no way to one
 * of the sides. */
COLUMNS_INLINE bool bow_of(const struct pass *w, uint32_t i, struct around *k,
			   uint32_t along, struct bow *ret, uint32_t n)
{
	struct chord *a = &k->chord[k->on], *b = &k->chord[!k->on];

	if (!chord_is(a, k->behind, i, along))
		chord_by(w, k->behind, i, along, a, n);
	chord_by(w, i, k->ahead, along, b, n);
	k->on = !k->on;
	*ret = (struct bow) { &a->h, &b->h, (a->mm + b->mm) / 2,
			      (a->way_mm + b->way_mm) / 2,
			      a->per_mm + b->per_mm };
	return a->mm > 0 && b->mm > 0;
}

/* The speed at which the axes can follow a bow.  @d is the change of each
 * column's rate. */
COLUMNS_INLINE double bow_mm_s(struct pass *w, const struct look *l,
			       const double d[INTERP_NAXES], uint32_t n)
{
	const struct bow *k = &l->bow;
	double turn = 0, acc = INFINITY, jerk = INFINITY, v = INFINITY;

	for (uint32_t j = 0; j < n; j++) {
		if (!(l->along >> j & 1)) {
			/* A column that turns beside the path is limited by
			 * itself. */
			if (!l->certain || d[j] * k->mm > w->tol[j])
				v = smaller(v, pass_beside_mm_s(w, l, j, d[j]));
			continue;
		}
		turn += d[j] * d[j];
		if (k->a->rate[j] == 0 && k->b->rate[j] == 0)
			continue;
		acc = smaller(acc, w->a_mm_s2[j]);
		jerk = smaller(jerk, w->j_mm_s3[j]);
	}
	if (turn < STRAIGHT)
		return v;
	return smaller(v,
		       pass_round_mm_s(larger(k->mm / sqrt(turn), w->corner_mm),
				       acc, jerk));
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
 * corner from beside it. */
COLUMNS_INLINE void no_more(double d[INTERP_NAXES], const double *per_mm,
			    double mm, uint32_t n)
{
	for (uint32_t j = 0; j < n; j++)
		d[j] = smaller(d[j], per_mm[j] * mm);
}

/* Is there a column beside the path that may bend so much that it slows down
 * what goes along?  Mostly the second window can tell that there is none. */
COLUMNS_INLINE bool may_bend(const struct pass *w, const struct look *l,
			     const double *per_mm, uint32_t n)
{
	const double v = l->most_mm_s;

	for (uint32_t j = 0; j < n; j++)
		if (!(l->along >> j & 1) &&
		    3 * per_mm[j] * v * w->a_linear_mm_s2 >
			    INTERP_ARC_JERK_BOTH * w->j_mm_s3[j])
			return true;
	return false;
}

/*
 * Short lines may turn by any small amount at each node: their curve is that of
 * the chords to both sides.  A turn that is less than a rounding over one
 * window shows over a wider one, if it goes on.  @most: no need to look for
 * more speed than this; but what goes beside the path is looked at until it is
 * clear, because its bend leaves less for going along.
 */
COLUMNS_INLINE double curve(struct pass *w, uint32_t i, uint32_t along,
			    double most, uint32_t n)
{
	const bool beside = (~along & ((1u << n) - 1)) != 0;
	double per_mm[INTERP_NAXES], v = INFINITY, enough = INFINITY;
	struct look l = { .node = i, .along = along, .most_mm_s = most };
	bool clear = false;

	for (uint32_t j = 0; j < n; j++)
		per_mm[j] = INFINITY;
	for (int at = 0; at < PASS_WINDOWS && !clear; at++) {
		double all[INTERP_NAXES], fast;
		struct change c;

		l.window = &w->windows[at];
		l.certain = false;
		look_around(w, i, l.window);
		if (!bow_of(w, i, l.window, along, &l.bow, n))
			break;
		for (uint32_t j = 0; j < n; j++)
			all[j] = fabs(l.bow.b->rate[j] - l.bow.a->rate[j]);
		no_more(all, per_mm, l.bow.mm, n);
		fast = bow_mm_s(w, &l, all, n);
		if (fast >= most)
			enough = smaller(enough, fast);
		if (fast >= most && !beside)
			break;
		c.a = l.bow.a;
		c.b = l.bow.b;
		c.per_mm = l.bow.per_mm;
		change_of(w, sure, &c, n);
		no_more(c.d, per_mm, l.bow.mm, n);
		l.certain = true;
		clear = is_clear(&c, all, n);
		fast = bow_mm_s(w, &l, clear ? all : c.d, n);
		if (isinf(enough))
			v = smaller(v, fast);
		change_of(w, at_most, &c, n);
		for (uint32_t j = 0; j < n; j++)
			per_mm[j] = smaller(per_mm[j], c.d[j] / l.bow.mm);
		if (enough < INFINITY && !may_bend(w, &l, per_mm, n))
			break;
	}
	return smaller(v, enough);
}

/* Look near the node, but not over a long line behind a short one: a long line
 * has its own turn. */
static void look_near(struct pass *w, uint32_t i)
{
	const struct interp_seg *s = w->segs;
	struct around *k = &w->near;

	look_around(w, i, k);
	if (k->behind + 1 < i && s[i].s_mm - s[k->behind].s_mm > 2 * k->mm)
		k->behind++;
	if (k->ahead > i + 1 && s[k->ahead].s_mm - s[i].s_mm > 2 * k->mm)
		k->ahead--;
}

/* The turn of a node between lines; between longer chords, if the lines are
 * short. */
COLUMNS_INLINE double turn(struct pass *w, uint32_t last, uint32_t i,
			   struct change *change, uint32_t n)
{
	const struct interp_seg *s = w->segs;
	struct bow k;

	if (s[last].kind == INTERP_LINE && s[i].kind == INTERP_LINE &&
	    smaller(s[last].length_mm, s[i].length_mm) < w->near.mm) {
		look_near(w, i);
		if (change->a->along == change->b->along &&
		    bow_of(w, i, &w->near, change->a->along, &k, n)) {
			struct change c = { .a = k.a, .b = k.b,
					    .per_mm = k.per_mm };

			change_of(w, heard, &c, n);
			return smaller(corner(w, &c, n), step(w, &c, n));
		}
	}
	change->per_mm = 1 / s[last].length_mm + 1 / s[i].length_mm;
	change_of(w, heard, change, n);
	return smaller(corner(w, change, n), step(w, change, n));
}

/*
 * Does turn() certainly allow @v_mm_s?  On most curves of lines it does, and
 * the answer costs less than turn() itself.  Of a turn below 1 the radius of
 * corner() is at least 6.46 * corner_mm / turn; all of a change counts here,
 * and of all axes the one that can do least.
 */
COLUMNS_INLINE bool turns_faster(const struct pass *w, uint32_t last,
				 uint32_t i, const struct change *c,
				 double v_mm_s, uint32_t n)
{
	const struct interp_seg *s = w->segs;
	const double v = v_mm_s, far = 6.4 * w->corner_mm;
	double turn = 0;

	if (s[last].kind != INTERP_LINE || s[i].kind != INTERP_LINE ||
	    c->a->along != c->b->along || s[last].length_mm < w->near.mm ||
	    s[i].length_mm < w->near.mm)
		return false;
	for (uint32_t j = 0; j < n; j++) {
		const double d = c->b->rate[j] - c->a->rate[j];

		if (c->a->along >> j & 1)
			turn += d * d;
		else if (!(fabs(d) * v < 0.99 * w->step_mm_s[j]))
			return false;
	}
	return turn < 1 && v * v * turn < w->a_least_mm_s2 * far &&
	       v * v * v * turn * turn < w->j_least_mm_s3 * far * far;
}

/* The node in front of segment @i; @last is the segment before it that
 * moves. */
COLUMNS_INLINE double node_mm_s(struct pass *w, uint32_t last, uint32_t i,
				const struct heading *a,
				const struct heading *b, uint32_t n)
{
	const struct interp_seg *s = w->segs;
	struct change c;
	double v = INFINITY;

	c.a = a;
	c.b = b;
	if (pass_is_short(w, last) || pass_is_short(w, i))
		v = curve(w, i, a->along & b->along,
			  smaller((double)s[last].feed_max_mm_s,
				  (double)s[i].feed_max_mm_s), n);
	return turns_faster(w, last, i, &c, v, n) ?
	       v : smaller(v, turn(w, last, i, &c, n));
}

double pass_node_mm_s(struct pass *w, uint32_t last, uint32_t i,
		      const struct heading *a, const struct heading *b)
{
	w->bends = 0;
	return BY_COLUMNS(w->n, node_mm_s, w, last, i, a, b);
}

double pass_over_mm_s(struct pass *w, uint32_t *first, uint32_t i,
		      const struct heading *b)
{
	const struct interp_seg *s = w->segs;
	struct headings before;
	struct change c;
	uint32_t m = *first;

	while (m > 0 && s[m].kind < INTERP_BEGIN && pass_is_tiny(w, m) &&
	       s[i].s_mm - s[m].s_mm < w->near.mm)
		m--;
	if (s[m].kind >= INTERP_BEGIN || pass_is_tiny(w, m))
		return INFINITY;
	heading_find(&w->ways, m, &before);
	c.a = &before.last;
	c.b = b;
	c.per_mm = 1 / s[m].length_mm + 1 / s[i].length_mm;
	change_of(w, heard, &c, w->n);
	*first = m;
	return smaller(corner(w, &c, w->n), step(w, &c, w->n));
}

/* A peak of the share of an axis beside the path: over the shorter way @c it is
 * more than over the longer one, by more than @times what both are rounded. */
COLUMNS_INLINE void raise_rates(struct pass *w, const struct chord *c,
				double times, struct chord *around, uint32_t n)
{
	const double along = pass_along_tol(w, around->h.along);
	const double per_mm = times * (c->per_mm + around->per_mm);

	for (uint32_t j = 0; j < n; j++) {
		double *rate = &around->h.rate[j];
		const double off = pass_off(w, j, along, fabs(*rate));

		if (!(c->h.along >> j & 1) &&
		    fabs(c->h.rate[j]) - fabs(*rate) >
			    (w->tol[j] + off) * per_mm)
			*rate = c->h.rate[j];
	}
}

/* A peak may be narrower than any window, and yet so high that no rounding
 * makes it: so the way around the line is halved down to its neighbours.  Over
 * so few lines, the roundings of X and of Y both count in the way. */
COLUMNS_INLINE void find_peaks(struct pass *w, uint32_t i,
			       struct chord *around, uint32_t n)
{
	struct around *k = &w->windows[PEAK];
	uint32_t behind, ahead;
	double times = 1;
	struct chord c;

	look_around(w, i, k);
	behind = i - k->behind;
	ahead = k->ahead - i;
	do {
		chord_by(w, i - behind, i + ahead, around->h.along, &c, n);
		raise_rates(w, &c, times, around, n);
		times = FEW_LINES;
		behind /= 2;
		ahead = (ahead + 1) / 2;
	} while (behind > 0 || ahead > 1);
}

/*
 * On a short line the share of an axis is rounded.  If the share is the same as
 * on the ways around the line, but for a rounding, then the share of those ways
 * is used.
 */
COLUMNS_INLINE void line_rates(struct pass *w, uint32_t i,
			       const struct heading *h, struct rates *ret,
			       uint32_t n)
{
	struct around *k = &w->windows[AROUND];
	const double per_mm = 1 / w->segs[i].length_mm;
	const double *around;
	struct chord c;
	double along;

	look_around(w, i, k);
	chord_by(w, k->behind, k->ahead, h->along, &c, n);
	around = c.mm > 0 ? c.h.rate : h->rate;
	along = pass_along_tol(w, h->along);
	if (c.mm > 0 && ~h->along & ((1u << n) - 1))
		find_peaks(w, i, &c, n);
	ret->v_mm_s = INFINITY;
	for (uint32_t j = 0; j < n; j++) {
		/* So far the length and the axis may be off, if the share is
		 * that of the ways around. */
		const double off = h->along >> j & 1 ? 0 :
			pass_off(w, j, along, fabs(around[j]));
		const double d = fabs(h->rate[j] - around[j]);
		const double by = fabs(d > (w->tol[j] + off) * per_mm ?
				       h->rate[j] : around[j]);

		ret->by[j] = by;
		if (by * ret->v_mm_s > w->v_mm_s[j])
			ret->v_mm_s = w->v_mm_s[j] / by;
	}
}

COLUMNS_INLINE void other_rates(const struct interp_seg *s,
				const struct headings *h, struct rates *ret,
				uint32_t n)
{
	ret->v_mm_s = 0;
	for (uint32_t j = 0; j < n; j++) {
		const double ends = larger(fabs(h->first.rate[j]),
					   fabs(h->last.rate[j]));
		/* U V go round a bend of their own. */
		const bool bends = s->kind != INTERP_LINE && ends > 0 &&
				   (s->kind == INTERP_PAIR ||
				    (h->first.along | h->last.along) >> j & 1);

		/* On its way it may go in the direction of the axis alone. */
		ret->by[j] = bends ? larger(ends, larger(h->share, 1)) : ends;
		ret->bends |= (uint32_t)bends << j;
	}
}

void pass_rates(struct pass *w, uint32_t i, const struct headings *h,
		struct rates *ret)
{
	const struct interp_seg *s = &w->segs[i];

	ret->bends = 0;
	if (s->kind == INTERP_LINE && pass_is_short(w, i))
		BY_COLUMNS(w->n, line_rates, w, i, &h->first, ret);
	else
		BY_COLUMNS(w->n, other_rates, s, h, ret);
}
