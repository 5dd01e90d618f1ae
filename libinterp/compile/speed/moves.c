/* SPDX-License-Identifier: Apache-2.0 */
/*
 * moves.c - how long segments take, as moves from stand to stand
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
	if (smaller(from, to) >= PASS_SLOW * v)
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

	return smaller(larger(v - node, PASS_SLOW * v),
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
		if (!(hop.mm > 0) || (!ends && to >= PASS_SLOW * v))
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
