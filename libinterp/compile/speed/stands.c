/* SPDX-License-Identifier: Apache-2.0 */
/*
 * stands.c - where a move stands because its axes allow much less from there
 * on
 *
 * A move keeps the least acceleration and jerk of all segments that it goes
 * over.  Near a pole, or on a tiny line on which a rotary axis turns far, that
 * may be a millionth of what the rest allows, and the whole move would crawl.
 * So a program is cut into moves, with a stand between them, where that takes
 * less time.
 *
 * A program has sides.  A side ends at a slow node, and where what is allowed
 * becomes half or twice as much.  At first a move stands between any two sides.
 * Then the stands go that save no time.
 */
#include "speed/pass.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

/* -- Sides ----------------------------------------------------------------- */

/* What the segments of a side allow; only what a positioning may use counts. */
struct side {
	double a_least, a_most, j_least, j_most;
	uint32_t last;			/* segment; UINT32_MAX: none */
};

static const struct side no_side = { INFINITY, 0, INFINITY, 0, UINT32_MAX };

static struct side longer(const struct pass *w, const struct side *k,
			  uint32_t i)
{
	const double a = smaller((double)w->segs[i].a_mm_s2,
				 w->travel_a_mm_s2);
	const double j = smaller((double)w->segs[i].j_mm_s3,
				 w->travel_j_mm_s3);

	return (struct side) {
		smaller(k->a_least, a), larger(k->a_most, a),
		smaller(k->j_least, j), larger(k->j_most, j), i
	};
}

static bool is_one_side(const struct side *k)
{
	return k->a_most <= PASS_SIDE * k->a_least &&
	       k->j_most <= PASS_SIDE * k->j_least;
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

	return node < PASS_SLOW * beside_mm_s(w, last, before) &&
	       node < PASS_SLOW * beside_mm_s(w, i, (double)s[i].node_mm_s);
}

static void part_sides(struct pass *w, uint32_t end)
{
	struct side is = no_side;

	for (uint32_t i = 0; i < end; i++) {
		struct side on;

		if (w->segs[i].kind >= INTERP_BEGIN)
			continue;
		on = longer(w, &is, i);
		if (is.last < UINT32_MAX &&
		    (!is_one_side(&on) || is_slow(w, is.last, i))) {
			pass_set_stand(w, is.last, true);
			on = longer(w, &no_side, i);
		}
		is = on;
	}
}

/* -- Moves ----------------------------------------------------------------- */

/* Behind the next stand. */
static uint32_t behind_stand(const struct pass *w, uint32_t at, uint32_t to)
{
	while (at < to && !(w->segs[at].flags & INTERP_SEG_STAND))
		at++;
	return at < to ? at + 1 : to;
}

/* Stands before segment @to.  What is known holds as long as the moves beside
 * it stay. */
struct stands {
	struct pass *pass;
	uint32_t to;
	float *v2;			/* room of pass_moves_s() */
	float *share;			/* of each stand, by the segment before
					 * it; UNKNOWN */
	float *alone_s;			/* of each move, by its last one */
};

#define UNKNOWN		0.0f

/* The move from @from to @to. */
static double alone_s(const struct stands *k, uint32_t from, uint32_t to)
{
	float *s = &k->alone_s[to - 1];

	if (*s == UNKNOWN)
		*s = (float)pass_moves_s(k->pass, from, to, false, k->v2);
	return (double)*s;
}

/* A stand is in the node before @mid.  Return: the share of the time that the
 * move from @from to @to takes with it. */
static double stand_share(const struct stands *k, uint32_t from, uint32_t mid,
			  uint32_t to)
{
	const double apart = alone_s(k, from, mid) + alone_s(k, mid, to);
	double one;

	pass_set_stand(k->pass, mid - 1, false);
	one = pass_moves_s(k->pass, from, to, false, k->v2);
	pass_set_stand(k->pass, mid - 1, true);
	return apart / one;
}

static void find_shares(const struct stands *k)
{
	uint32_t from = 0, mid = behind_stand(k->pass, from, k->to);

	while (mid < k->to) {
		const uint32_t end = behind_stand(k->pass, mid, k->to);

		if (k->share[mid - 1] == UNKNOWN)
			k->share[mid - 1] = (float)stand_share(k, from, mid,
							       end);
		from = mid;
		mid = end;
	}
}

/* Take the stands away that save nothing; but not two beside each other, of
 * which the one that saves less goes: what the other saves depends on it.
 * Return: did any go? */
static bool join_moves(const struct stands *k)
{
	float *share = k->share, before = 0, is, next;
	uint32_t prior = 0, at = behind_stand(k->pass, 0, k->to);
	bool any = false, goes = false;

	for (is = at < k->to ? share[at - 1] : 0; at < k->to; is = next) {
		const uint32_t end = behind_stand(k->pass, at, k->to);
		const bool went = goes;

		next = end < k->to ? share[end - 1] : 0;
		goes = !went && is >= 1 && is >= next && is >= before;
		if (goes) {
			pass_set_stand(k->pass, at - 1, false);
			if (prior > 0)
				share[prior - 1] = UNKNOWN;
			share[end - 1] = UNKNOWN;
			k->alone_s[end - 1] = UNKNOWN;
			any = true;
		}
		before = went ? 0 : is;
		prior = at;
		at = end;
	}
	return any;
}

int pass_stands(struct pass *w)
{
	const size_t n = w->end;
	float *room = calloc(n, 3 * sizeof(*room));
	const struct stands k = { w, w->end, room, room + n, room + 2 * n };

	if (!room)
		return -ENOMEM;
	part_sides(w, w->end);
	do
		find_shares(&k);
	while (join_moves(&k));
	free(room);
	return 0;
}
