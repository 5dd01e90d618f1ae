/* SPDX-License-Identifier: Apache-2.0 */
/*
 * moves.c - how long segments take, as moves from stand to stand, and where to
 * stand between sides that are softer and harder
 *
 * A move has the least acceleration and jerk of its segments.  Its speed at
 * each node is found forward and back, as without a limit of jerk, but with as
 * much less acceleration as the jerk takes from a ramp between its slow nodes
 * and what it comes to between them.
 */
#include "speed/pass.h"
#include "speed/ramp.h"

#include <math.h>

/* Segments @from up to, but not with, @to. */
struct move {
	uint32_t from, to;
	bool fed;			/* no faster than F */
	double a_mm_s2, j_mm_s3;	/* the least of them */
	double most_mm_s;		/* it never comes to more */
	double slope_mm_s2;		/* the mean of a ramp */
};

static bool is_way(const struct interp_seg *s)
{
	return s->kind < INTERP_BEGIN && s->length_mm > 0;
}

static double ceiling_mm_s(const struct interp_seg *s, bool fed)
{
	return (double)(fed ? pass_least(s->feed_mm_s, s->feed_max_mm_s) :
			      s->feed_max_mm_s);
}

/* A node is slow if it is passed no faster than this share of what its sides
 * come to. */
#define SLOW	0.5

/* What segment @s comes to, between nodes of @from and @to mm/s.  Short lines
 * that bend are not faster than their nodes. */
static double comes_to_mm_s(const struct interp_seg *s, const struct move *m,
			    double from, double to)
{
	const double top = smaller(ceiling_mm_s(s, m->fed), m->most_mm_s);
	const double node = larger(from, to);
	double v;

	if (node >= top)
		return top;
	v = smaller(top, node + sqrt(m->a_mm_s2 * s->length_mm));
	if (smaller(from, to) >= SLOW * v)
		return v;
	return smaller(v, node + ramp_rise_mm_s(s->length_mm, m->a_mm_s2,
						m->j_mm_s3));
}

/* Between two slow nodes. */
struct hop {
	double mm, s;
	double node_mm_s;		/* the mean of both */
};

/* By how much it gets faster than its nodes. */
static double hop_rise_mm_s(const struct hop *k, const struct move *m)
{
	const double v = k->mm / k->s, node = k->node_mm_s;
	const double rise = ramp_rise_mm_s(k->mm, m->a_mm_s2, m->j_mm_s3);
	const double share = rise / (rise + 2 * node);

	return smaller(larger(v - node, SLOW * v),
		       rise * ramp_root3(share * share));
}

/* What the jerk leaves in the mean of the ramps of move @m: between slow nodes
 * they may be over long before they come to the ceiling. */
static double move_slope_mm_s2(const struct interp_seg *segs,
			       const struct move *m)
{
	struct hop hop = { 0, 0, 0 };
	double from = 0, sum = 0, s = 0;

	for (uint32_t i = m->from; i < m->to; i++) {
		const struct interp_seg *k = &segs[i];
		const bool ends = i + 1 == m->to;
		const double to = ends ? 0 : (double)k->node_mm_s;
		double v = 0, rise, t;

		if (is_way(k)) {
			v = comes_to_mm_s(k, m, from, to);
			hop.mm += k->length_mm;
			hop.s += k->length_mm / v;
			from = to;
		}
		if (!(hop.mm > 0) || (!ends && to >= SLOW * v))
			continue;
		hop.node_mm_s += to / 2;
		rise = hop_rise_mm_s(&hop, m);
		t = hop.mm / (hop.node_mm_s + rise);
		sum += rise * t;
		s += t;
		hop = (struct hop) { 0, 0, to / 2 };
	}
	return s > 0 ? ramp_slope_mm_s2(sum / s, m->a_mm_s2, m->j_mm_s3) :
		       INFINITY;
}

/* Up to the next stand. */
static struct move next_move(const struct pass *w, uint32_t from, uint32_t to,
			     bool fed)
{
	const struct interp_seg *segs = w->segs;
	struct move ret = {
		from, from, fed, w->travel_a_mm_s2, w->travel_j_mm_s3, 0, 0
	};
	double mm = 0;

	do {
		const struct interp_seg *k = &segs[ret.to++];

		if (!is_way(k))
			continue;
		ret.a_mm_s2 = smaller(ret.a_mm_s2, (double)k->a_mm_s2);
		ret.j_mm_s3 = smaller(ret.j_mm_s3, (double)k->j_mm_s3);
		mm += k->length_mm;
	} while (ret.to < to && !(segs[ret.to - 1].flags & INTERP_SEG_STAND));
	ret.most_mm_s = ramp_rise_mm_s(mm, ret.a_mm_s2, ret.j_mm_s3);
	ret.slope_mm_s2 = move_slope_mm_s2(segs, &ret);
	return ret;
}

/* The square of the speed behind each segment, into @v2. */
static void speeds(const struct interp_seg *segs, const struct move *m,
		   float *v2)
{
	double at = 0;

	for (uint32_t i = m->from; i < m->to; i++) {
		const struct interp_seg *s = &segs[i];
		const double most = smaller((double)s->node_mm_s,
					    ceiling_mm_s(s, m->fed));

		if (is_way(s))
			at = smaller(most * most,
				     at + 2 * m->slope_mm_s2 * s->length_mm);
		v2[i] = (float)at;
	}
	at = 0;
	for (uint32_t i = m->to; i-- > m->from;) {
		v2[i] = (float)smaller((double)v2[i], at);
		at = (double)v2[i];
		if (is_way(&segs[i]))
			at += 2 * m->slope_mm_s2 * segs[i].length_mm;
	}
}

/* From the speed whose square is @b2 to that of @e2. */
static double way_s(const struct interp_seg *s, const struct move *m,
		    double b2, double e2)
{
	const double feed = ceiling_mm_s(s, m->fed), a = m->slope_mm_s2;
	const double top2 = smaller(feed * feed,
				    (b2 + e2) / 2 + a * s->length_mm);
	const double top = sqrt(top2);
	const double even_mm = s->length_mm - (2 * top2 - b2 - e2) / (2 * a);

	return (2 * top - sqrt(b2) - sqrt(e2)) / a + even_mm / top;
}

double pass_moves_s(const struct pass *w, uint32_t from, uint32_t to,
		    bool fed, float *v2)
{
	const struct interp_seg *segs = w->segs;
	double sum = 0;

	while (from < to) {
		const struct move m = next_move(w, from, to, fed);
		double at = 0;

		speeds(segs, &m, v2);
		for (uint32_t i = m.from; i < m.to; i++) {
			if (!is_way(&segs[i]))
				continue;
			sum += way_s(&segs[i], &m, at, (double)v2[i]);
			at = (double)v2[i];
		}
		from = m.to;
	}
	return sum;
}

/* One side is harder than the other if it may have more than so many times its
 * acceleration or jerk. */
#define SOFTER	1.25

/* Only what a positioning may use counts: @most. */
static bool is_softer(float a, float b, double most)
{
	const double x = smaller((double)a, most), y = smaller((double)b, most);

	return x > SOFTER * y || y > SOFTER * x;
}

/* From a slow node to the next one. */
struct side {
	float a_mm_s2, j_mm_s3;		/* the least */
	uint32_t last;			/* segment; UINT32_MAX: none */
};

static const struct side no_side = { INFINITY, INFINITY, UINT32_MAX };

static void lengthen(struct side *k, const struct interp_seg *s, uint32_t i)
{
	k->a_mm_s2 = pass_least(k->a_mm_s2, s->a_mm_s2);
	k->j_mm_s3 = pass_least(k->j_mm_s3, s->j_mm_s3);
	k->last = i;
}

static bool is_apart(const struct pass *w, const struct side *a,
		     const struct side *b)
{
	return a->last < UINT32_MAX &&
	       (is_softer(a->a_mm_s2, b->a_mm_s2, w->travel_a_mm_s2) ||
		is_softer(a->j_mm_s3, b->j_mm_s3, w->travel_j_mm_s3));
}

/* What a node is slow beside: the ceiling of a segment, but no more than a
 * short one comes to from its other node. */
static double beside_mm_s(const struct pass *w, uint32_t i, double other_mm_s)
{
	const struct interp_seg *s = &w->segs[i];
	const double feed = (double)s->feed_max_mm_s;

	return s->kind == INTERP_LINE && s->length_mm < w->short_mm ?
	       smaller(feed, other_mm_s +
			     sqrt(w->travel_a_mm_s2 * s->length_mm)) : feed;
}

/* Is the node between segments @last and @i slow?  A bend of short lines is as
 * slow all the way. */
static bool is_slow(const struct pass *w, uint32_t last, uint32_t i)
{
	const struct interp_seg *s = w->segs;
	const double node = (double)s[last].node_mm_s;
	const double before = last > 0 ? (double)s[last - 1].node_mm_s : 0;

	return node < SLOW * beside_mm_s(w, last, before) &&
	       node < SLOW * beside_mm_s(w, i, (double)s[i].node_mm_s);
}

/* Stands in all corners between what is softer and what is harder. */
static bool set_apart(struct pass *w, uint32_t from, uint32_t to)
{
	struct side was = no_side, is = no_side;
	bool any = false;

	for (uint32_t i = from; i <= to; i++) {
		if (i < to && w->segs[i].kind >= INTERP_BEGIN)
			continue;
		if (is.last < UINT32_MAX &&
		    (i == to || is_slow(w, is.last, i))) {
			if (is_apart(w, &was, &is)) {
				pass_set_stand(w, was.last, true);
				any = true;
			}
			was = is;
			was.last = i - 1;
			is = no_side;
		}
		if (i < to)
			lengthen(&is, &w->segs[i], i);
	}
	return any;
}

/* Behind the next stand. */
static uint32_t behind_stand(const struct pass *w, uint32_t at, uint32_t to)
{
	while (at < to && !(w->segs[at].flags & INTERP_SEG_STAND))
		at++;
	return at < to ? at + 1 : to;
}

/* Of the time of the moves beside it, a stand must save so much.  It is little:
 * what is lost where one goes adds up over all that go. */
#define JOIN_WORTH	0.998

/* Where stands save a little more, two of them may still cost time together. */
#define JOIN_ON		0.97

/* Stands between segments @from and @to.  What is known holds as long as the
 * moves beside it stay. */
struct apart {
	struct pass *pass;
	uint32_t from, to;
	float *v2;			/* room of pass_moves_s() */
	float *share;			/* of each stand, by the segment before
					 * it; UNKNOWN */
	float *alone_s[2];		/* of each move, by its last one; fed */
	float *stood;			/* 0, or it did before */
};

#define UNKNOWN		0.0f

/* The move from @from to @to. */
static double alone_s(const struct apart *k, uint32_t from, uint32_t to,
		      bool fed)
{
	float *s = &k->alone_s[fed][to - 1];

	if (*s == UNKNOWN)
		*s = (float)pass_moves_s(k->pass, from, to, fed, k->v2);
	return (double)*s;
}

/* A stand is in the node before @mid.  Return: the share of the time that the
 * move from @from to @to takes with it. */
static double share_of(const struct apart *k, uint32_t from, uint32_t mid,
		       uint32_t to, bool fed)
{
	const double apart = alone_s(k, from, mid, fed) +
			     alone_s(k, mid, to, fed);
	double one;

	pass_set_stand(k->pass, mid - 1, false);
	one = pass_moves_s(k->pass, from, to, fed, k->v2);
	pass_set_stand(k->pass, mid - 1, true);
	return apart / one;
}

/* At F, if there it costs too much. */
static double stand_share(const struct apart *k, uint32_t from, uint32_t mid,
			  uint32_t to)
{
	const double share = share_of(k, from, mid, to, false);
	double fed;

	if (share >= JOIN_WORTH)
		return share;
	fed = share_of(k, from, mid, to, true);
	return fed >= pass_most_at_feed(share) ? fed : share;
}

static void find_shares(const struct apart *k)
{
	uint32_t from = k->from, mid = behind_stand(k->pass, from, k->to);

	while (mid < k->to) {
		const uint32_t end = behind_stand(k->pass, mid, k->to);

		if (k->share[mid - 1] == UNKNOWN)
			k->share[mid - 1] = (float)stand_share(k, from, mid,
							       end);
		from = mid;
		mid = end;
	}
}

/* Take the stands away that save less than @worth, of those beside each other
 * only the one that saves least: what the others save depends on it.  Return:
 * did any go? */
static bool join_moves(const struct apart *k, double worth)
{
	float *share = k->share, before = UNKNOWN, is, next;
	uint32_t prior = 0, at = behind_stand(k->pass, k->from, k->to);
	bool any = false;

	for (is = at < k->to ? share[at - 1] : 0; at < k->to; is = next) {
		const uint32_t end = behind_stand(k->pass, at, k->to);

		next = end < k->to ? share[end - 1] : 0;
		if ((double)is >= worth && is >= next && is > before) {
			pass_set_stand(k->pass, at - 1, false);
			if (prior > 0)
				share[prior - 1] = UNKNOWN;
			share[end - 1] = UNKNOWN;
			k->alone_s[0][end - 1] = UNKNOWN;
			k->alone_s[1][end - 1] = UNKNOWN;
			any = true;
		}
		before = is;
		prior = at;
		at = end;
	}
	return any;
}

#define JOIN_MOST	16		/* looks */

static void join(const struct apart *k, double worth)
{
	bool more = true;

	for (int i = 0; more && i < JOIN_MOST; i++) {
		find_shares(k);
		more = join_moves(k, worth);
	}
}

static bool is_any(const float *stood, uint32_t from, uint32_t to)
{
	while (from < to && !(stood[from] > 0))
		from++;
	return from < to;
}

static void set_stands(const struct apart *k, uint32_t from, uint32_t to,
		       bool stands)
{
	for (uint32_t i = from; i < to; i++)
		if (k->stood[i] > 0)
			pass_set_stand(k->pass, i, stands);
}

/* In each move in which it stood before, it stands again if that is quicker. */
static void stand_again(const struct apart *k)
{
	for (uint32_t at = k->from, end; at < k->to; at = end) {
		double one;

		end = behind_stand(k->pass, at, k->to);
		if (!is_any(k->stood, at, end - 1))
			continue;
		one = alone_s(k, at, end, false);
		set_stands(k, at, end - 1, true);
		if (pass_moves_s(k->pass, at, end, false, k->v2) >= one)
			set_stands(k, at, end - 1, false);
	}
}

void pass_stand_apart(struct pass *w, uint32_t from, uint32_t to, float *room)
{
	const struct apart k = {
		w, from, to, room, room + to,
		{ room + (size_t)to * 2, room + (size_t)to * 3 },
		room + (size_t)to * 4
	};

	if (!set_apart(w, from, to))
		return;
	for (uint32_t i = from; i < to; i++)
		k.share[i] = k.alone_s[0][i] = k.alone_s[1][i] = UNKNOWN;
	join(&k, JOIN_WORTH);
	for (uint32_t i = from; i < to; i++)
		k.stood[i] = w->segs[i].flags & INTERP_SEG_STAND ? 1 : 0;
	join(&k, JOIN_ON);
	stand_again(&k);
}
