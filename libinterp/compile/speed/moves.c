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

#include <math.h>
#include <string.h>

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

/* What is left of acceleration @a, in the mean of a ramp to @v. */
static double slope_mm_s2(double v, double a, double j)
{
	return v * j >= a * a ? v / (v / a + a / j) : sqrt(v * j) / 2;
}

/* The cube root of @x >= 0, within 10^-5 of it: near enough for a time that is
 * an estimate, and it costs a tenth of cbrt().  A third of the bits of a float
 * is within 4 %. */
static double root3(double x)
{
	const float near = (float)x;
	uint32_t bits;
	double y;
	float f;

	memcpy(&bits, &near, sizeof(bits));
	bits = bits / 3 + 709921077;
	memcpy(&f, &bits, sizeof(f));
	y = (double)f;
	y = (2 * y + x / (y * y)) / 3;
	return (2 * y + x / (y * y)) / 3;
}

/* How much faster it gets on @mm, from a stand and back to one. */
static double rise_mm_s(double mm, double a, double j)
{
	return 16 * a * a * a < j * j * mm ? sqrt(a * mm) :
					     root3(j * mm * mm / 4);
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
	return smaller(v, node + rise_mm_s(s->length_mm, m->a_mm_s2,
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
	const double rise = rise_mm_s(k->mm, m->a_mm_s2, m->j_mm_s3);
	const double share = rise / (rise + 2 * node);

	return smaller(larger(v - node, SLOW * v), rise * root3(share * share));
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
	return s > 0 ? slope_mm_s2(sum / s, m->a_mm_s2, m->j_mm_s3) : INFINITY;
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
	ret.most_mm_s = rise_mm_s(mm, ret.a_mm_s2, ret.j_mm_s3);
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

	return pass_is_short(w, i) ?
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

/* A stand is in the node before @mid.  Return: the share of the time that the
 * move from @from to @to takes with it; at F, if there it costs too much. */
static double stand_share(struct pass *w, uint32_t from, uint32_t mid,
			  uint32_t to, float *v2)
{
	const double apart = pass_moves_s(w, from, to, false, v2);
	double share, fed = 0;

	pass_set_stand(w, mid - 1, false);
	share = apart / pass_moves_s(w, from, to, false, v2);
	if (share < PASS_WORTH)
		fed = 1 / pass_moves_s(w, from, to, true, v2);
	pass_set_stand(w, mid - 1, true);
	if (fed > 0)
		fed *= pass_moves_s(w, from, to, true, v2);
	return fed >= PASS_COST ? fed : share;
}

/* A share that is not known. */
#define UNKNOWN		0.0f

/* The shares of the stands, by the segment in front of each.  What is known of
 * one holds as long as the stands beside it stay. */
static void find_shares(struct pass *w, uint32_t from, uint32_t to, float *v2,
			float *share)
{
	uint32_t mid = behind_stand(w, from, to);

	while (mid < to) {
		const uint32_t end = behind_stand(w, mid, to);

		if (share[mid - 1] == UNKNOWN)
			share[mid - 1] = (float)stand_share(w, from, mid, end,
							    v2);
		from = mid;
		mid = end;
	}
}

/* If fewer stands go than one for so many that stay, the next look would find
 * hardly any. */
#define JOIN_SHARE	4

/* Take the stands away that save too little, of those beside each other only
 * the one that saves least: what the others save depends on it.  Return: does
 * another look pay? */
static bool join_moves(struct pass *w, uint32_t from, uint32_t to, float *share)
{
	float before = UNKNOWN, is, next;
	uint32_t kept = 0, taken = 0, prior = 0;
	uint32_t at = behind_stand(w, from, to);

	for (is = at < to ? share[at - 1] : 0; at < to; is = next) {
		const uint32_t end = behind_stand(w, at, to);

		next = end < to ? share[end - 1] : 0;
		if ((double)is >= PASS_WORTH && is >= next && is > before) {
			pass_set_stand(w, at - 1, false);
			if (prior > 0)
				share[prior - 1] = UNKNOWN;
			if (end < to)
				share[end - 1] = UNKNOWN;
			taken++;
		} else {
			kept++;
		}
		before = is;
		prior = at;
		at = end;
	}
	return taken > kept / JOIN_SHARE;
}

#define JOIN_MOST	16		/* looks */

void pass_stand_apart(struct pass *w, uint32_t from, uint32_t to, float *room)
{
	float *share = room + to;
	bool more = set_apart(w, from, to);

	for (uint32_t i = from; i < to; i++)
		share[i] = UNKNOWN;
	for (int i = 0; more && i < JOIN_MOST; i++) {
		find_shares(w, from, to, room, share);
		more = join_moves(w, from, to, share);
	}
}
