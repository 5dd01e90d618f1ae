/* SPDX-License-Identifier: Apache-2.0 */
/*
 * moves.c - how long segments take, as moves from stand to stand
 *
 * A move has the least acceleration and jerk of its segments.  Its speed at
 * each node is found forward and back, as without a limit of jerk, but with as
 * much less acceleration as the jerk takes from a ramp to its mean speed.
 */
#include "speed/pass.h"

#include <math.h>

/* Segments @from up to, but not with, @to. */
struct move {
	uint32_t from, to;
	double a_mm_s2;
};

static bool is_way(const struct interp_seg *s)
{
	return s->kind < INTERP_BEGIN && s->length_mm > 0;
}

/* What is left of acceleration @a, in the mean of a ramp to @v. */
static double slope_mm_s2(double v, double a, double j)
{
	return v * j >= a * a ? v / (v / a + a / j) : sqrt(v * j) / 2;
}

/* Up to the next stand. */
static struct move next_move(const struct interp_seg *segs, uint32_t from,
			     uint32_t to)
{
	struct move ret = { from, from, INFINITY };
	double a = INFINITY, j = INFINITY, mm = 0, s = 0;

	do {
		const struct interp_seg *k = &segs[ret.to++];

		if (!is_way(k))
			continue;
		a = smaller(a, (double)k->a_mm_s2);
		j = smaller(j, (double)k->j_mm_s3);
		mm += k->length_mm;
		s += k->length_mm / (double)k->feed_max_mm_s;
	} while (ret.to < to && !(segs[ret.to - 1].flags & INTERP_SEG_STAND));
	if (mm > 0)
		ret.a_mm_s2 = slope_mm_s2(mm / s, a, j);
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
					    (double)s->feed_max_mm_s);

		if (is_way(s))
			at = smaller(most * most,
				     at + 2 * m->a_mm_s2 * s->length_mm);
		v2[i] = (float)at;
	}
	at = 0;
	for (uint32_t i = m->to; i-- > m->from;) {
		v2[i] = (float)smaller((double)v2[i], at);
		at = (double)v2[i];
		if (is_way(&segs[i]))
			at += 2 * m->a_mm_s2 * segs[i].length_mm;
	}
}

/* From the speed whose square is @b2 to that of @e2. */
static double way_s(const struct interp_seg *s, double a, double b2, double e2)
{
	const double feed = (double)s->feed_max_mm_s;
	const double top2 = smaller(feed * feed,
				    (b2 + e2) / 2 + a * s->length_mm);
	const double top = sqrt(top2);
	const double even_mm = s->length_mm - (2 * top2 - b2 - e2) / (2 * a);

	return (2 * top - sqrt(b2) - sqrt(e2)) / a + even_mm / top;
}

double pass_moves_s(const struct interp_seg *segs, uint32_t from, uint32_t to,
		    float *v2)
{
	double sum = 0;

	while (from < to) {
		const struct move m = next_move(segs, from, to);
		double at = 0;

		speeds(segs, &m, v2);
		for (uint32_t i = m.from; i < m.to; i++) {
			if (!is_way(&segs[i]))
				continue;
			sum += way_s(&segs[i], m.a_mm_s2, at, (double)v2[i]);
			at = (double)v2[i];
		}
		from = m.to;
	}
	return sum;
}
