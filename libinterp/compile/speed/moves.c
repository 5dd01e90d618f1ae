/* SPDX-License-Identifier: Apache-2.0 */
/*
 * moves.c - how long segments take, as moves from stand to stand
 *
 * A move has the least acceleration and jerk of its segments.  Its speed at
 * each node is found forward and back, as without a limit of jerk, but with as
 * much less acceleration as the jerk takes from a ramp to the mean of what its
 * segments allow.
 */
#include "speed/pass.h"
#include "speed/ramp.h"

#include <math.h>

/* Segments @from up to, but not with, @to. */
struct move {
	uint32_t from, to;
	bool fed;			/* no faster than F */
	double a_mm_s2, j_mm_s3;	/* the least of them */
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

/* Up to the next stand. */
static struct move next_move(const struct pass *w, uint32_t from, uint32_t to,
			     bool fed)
{
	const struct interp_seg *segs = w->segs;
	struct move ret = {
		from, from, fed, w->travel_a_mm_s2, w->travel_j_mm_s3, 0
	};
	double mm = 0, s = 0, most_mm_s;

	do {
		const struct interp_seg *k = &segs[ret.to++];

		if (!is_way(k))
			continue;
		ret.a_mm_s2 = smaller(ret.a_mm_s2, (double)k->a_mm_s2);
		ret.j_mm_s3 = smaller(ret.j_mm_s3, (double)k->j_mm_s3);
		mm += k->length_mm;
		s += k->length_mm / ceiling_mm_s(k, fed);
	} while (ret.to < to && !(segs[ret.to - 1].flags & INTERP_SEG_STAND));
	most_mm_s = ramp_rise_mm_s(mm, ret.a_mm_s2, ret.j_mm_s3);
	ret.slope_mm_s2 = ramp_slope_mm_s2(smaller(most_mm_s, mm / s),
					   ret.a_mm_s2, ret.j_mm_s3);
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
