/* SPDX-License-Identifier: Apache-2.0 */
/*
 * moves.c - how long segments take, as moves from stand to stand, and where to
 * stand between sides that are softer and harder
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
static struct move next_move(const struct pass *w, uint32_t from, uint32_t to)
{
	const struct interp_seg *segs = w->segs;
	struct move ret = { from, from, INFINITY };
	double a = w->travel_a_mm_s2, j = w->travel_j_mm_s3, mm = 0, s = 0;

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

double pass_moves_s(const struct pass *w, uint32_t from, uint32_t to,
		    float *v2)
{
	const struct interp_seg *segs = w->segs;
	double sum = 0;

	while (from < to) {
		const struct move m = next_move(w, from, to);
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

/* One side is harder than the other if it may have more than so many times its
 * acceleration or jerk. */
#define SOFTER	1.25

/* A corner between them is passed no faster than this share of both feeds. */
#define SLOW	0.5f

/* Only what a positioning may use counts: @most. */
static bool is_softer(float a, float b, double most)
{
	const double x = smaller((double)a, most), y = smaller((double)b, most);

	return x > SOFTER * y || y > SOFTER * x;
}

static bool is_apart(const struct pass *w, const struct interp_seg *a,
		     const struct interp_seg *b)
{
	return a->node_mm_s < SLOW * a->feed_max_mm_s &&
	       a->node_mm_s < SLOW * b->feed_max_mm_s &&
	       (is_softer(a->a_mm_s2, b->a_mm_s2, w->travel_a_mm_s2) ||
		is_softer(a->j_mm_s3, b->j_mm_s3, w->travel_j_mm_s3));
}

/* Stands in all corners between what is softer and what is harder. */
static bool set_apart(struct pass *w, uint32_t from, uint32_t to)
{
	const struct interp_seg *last = NULL;
	bool any = false;

	for (uint32_t i = from; i < to; i++) {
		const struct interp_seg *s = &w->segs[i];

		if (s->kind >= INTERP_BEGIN)
			continue;
		if (last && is_apart(w, last, s)) {
			pass_set_stand(w, i - 1, true);
			any = true;
		}
		last = s;
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

/* If fewer stands go than one for so many that stay, the next look would find
 * hardly any, and takes as long as this one. */
#define JOIN_SHARE	4

/* Of each two moves that follow each other, take the stand away that saves too
 * little.  Return: does another look pay? */
static bool join_moves(struct pass *w, uint32_t from, uint32_t to, float *v2)
{
	uint32_t kept = 0, taken = 0;

	while (from < to) {
		const uint32_t mid = behind_stand(w, from, to);
		const uint32_t end = behind_stand(w, mid, to);
		double apart;

		if (mid == to)
			break;
		apart = pass_moves_s(w, from, end, v2);
		pass_set_stand(w, mid - 1, false);
		if (apart < PASS_WORTH * pass_moves_s(w, from, end, v2)) {
			pass_set_stand(w, mid - 1, true);
			kept++;
			from = mid;
		} else {
			taken++;
			from = end;
		}
	}
	return taken > kept / JOIN_SHARE;
}

#define JOIN_MOST	16		/* each may halve their number */

void pass_stand_apart(struct pass *w, uint32_t from, uint32_t to, float *v2)
{
	if (!set_apart(w, from, to))
		return;
	for (int i = 0; i < JOIN_MOST && join_moves(w, from, to, v2); i++)
		;
}
