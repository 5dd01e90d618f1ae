/* SPDX-License-Identifier: Apache-2.0 */
/*
 * moves.c - how long segments take, as moves from stand to stand
 *
 * A move has the least acceleration and jerk of its segments.  Its speed at
 * each node is found forward and back, as without a limit of jerk, but with the
 * mean acceleration of a ramp to the fastest that it could come to.
 */
#include "speed/pass.h"

#include <math.h>

/* Segments @from up to, but not with, @to. */
struct move {
	uint32_t from, to;
	bool fed;			/* no faster than F */
	double a_mm_s2, j_mm_s3;	/* the least of them */
	double mean_mm_s2;		/* of its ramps */
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

/* Of a ramp up to the fastest that move @m comes to on @mm, between stands, but
 * no more than @most_mm_s. */
static double mean_mm_s2(const struct move *m, double mm, double most_mm_s)
{
	const double a = m->a_mm_s2, j = m->j_mm_s3;
	const double v = smaller(most_mm_s, 16 * a * a * a < j * j * mm ?
				 sqrt(a * mm) : cbrt(j * mm * mm / 4));

	return v * j >= a * a ? v / (v / a + a / j) : sqrt(v * j) / 2;
}

static struct move move_of(const struct pass *w, uint32_t from, uint32_t to,
			   bool fed)
{
	struct move ret = { from, to, fed, w->travel_a_mm_s2,
			    w->travel_j_mm_s3, 0 };
	double mm = 0, most = 0;

	for (uint32_t i = from; i < to; i++) {
		const struct interp_seg *s = &w->segs[i];

		if (!is_way(s))
			continue;
		ret.a_mm_s2 = smaller(ret.a_mm_s2, (double)s->a_mm_s2);
		ret.j_mm_s3 = smaller(ret.j_mm_s3, (double)s->j_mm_s3);
		mm += s->length_mm;
		most = larger(most, ceiling_mm_s(s, fed));
	}
	if (mm > 0)
		ret.mean_mm_s2 = mean_mm_s2(&ret, mm, most);
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
				     at + 2 * m->mean_mm_s2 * s->length_mm);
		v2[i] = (float)at;
	}
	at = 0;
	for (uint32_t i = m->to; i-- > m->from;) {
		v2[i] = (float)smaller((double)v2[i], at);
		at = (double)v2[i];
		if (is_way(&segs[i]))
			at += 2 * m->mean_mm_s2 * segs[i].length_mm;
	}
}

/* From the speed whose square is @b2 to that of @e2. */
static double way_s(const struct interp_seg *s, const struct move *m,
		    double b2, double e2)
{
	const double feed = ceiling_mm_s(s, m->fed), a = m->mean_mm_s2;
	const double top2 = smaller(feed * feed,
				    (b2 + e2) / 2 + a * s->length_mm);
	const double top = sqrt(top2);
	const double even_mm = s->length_mm - (2 * top2 - b2 - e2) / (2 * a);

	return (2 * top - sqrt(b2) - sqrt(e2)) / a + even_mm / top;
}

static double move_s(const struct interp_seg *segs, const struct move *m,
		     float *v2)
{
	double at = 0, sum = 0;

	speeds(segs, m, v2);
	for (uint32_t i = m->from; i < m->to; i++) {
		if (!is_way(&segs[i]))
			continue;
		sum += way_s(&segs[i], m, at, (double)v2[i]);
		at = (double)v2[i];
	}
	return sum;
}

/* Behind the next stand. */
static uint32_t behind_stand(const struct pass *w, uint32_t at, uint32_t to)
{
	while (at < to && !(w->segs[at].flags & INTERP_SEG_STAND))
		at++;
	return at < to ? at + 1 : to;
}

double pass_moves_s(const struct pass *w, uint32_t from, uint32_t to,
		    float *v2, bool one)
{
	double sum = 0;

	for (uint32_t end; from < to; from = end) {
		end = one ? to : behind_stand(w, from, to);
		for (int fed = 0; fed < 2; fed++) {
			const struct move m = move_of(w, from, end, fed);

			sum += move_s(w->segs, &m, v2);
		}
	}
	return sum;
}
