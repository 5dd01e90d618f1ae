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
 * A program has sides.  A side ends where what is allowed becomes half or twice
 * as much.  At first a move stands between any two sides.  The stands in each
 * half of the program are judged first, then the one between the halves.
 */
#include "speed/pass.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

/* -- Sides ----------------------------------------------------------------- */

/* A side ends where it would allow so many times as much in one place as in
 * another. */
#define SIDE		2

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
	return k->a_most <= SIDE * k->a_least && k->j_most <= SIDE * k->j_least;
}

uint32_t pass_sides(struct pass *w)
{
	struct side is = no_side;
	uint32_t n = 1;

	for (uint32_t i = 0; i < w->end; i++) {
		struct side on;

		if (w->segs[i].kind >= INTERP_BEGIN)
			continue;
		on = longer(w, &is, i);
		if (!is_one_side(&on)) {
			pass_set_stand(w, is.last, true);
			on = longer(w, &no_side, i);
			n++;
		}
		is = on;
	}
	return n;
}

/* -- Stands ---------------------------------------------------------------- */

struct joining {
	struct pass *pass;
	const uint32_t *side;		/* the first segment of each, and the
					 * end */
	float *v2;			/* room of pass_moves_s() */
};

/* Is one move from @from to @to as quick as the two that it has now? */
static bool is_one(const struct joining *k, uint32_t from, uint32_t to)
{
	return pass_moves_s(k->pass, from, to, k->v2, true) <=
	       pass_moves_s(k->pass, from, to, k->v2, false);
}

/* Sides @lo up to, but not with, @hi. */
static void join_sides(const struct joining *k, uint32_t lo, uint32_t hi)
{
	const struct interp_seg *s = k->pass->segs;
	const uint32_t half = lo + (hi - lo) / 2, mid = k->side[half];
	uint32_t from = mid - 1, to = mid + 1;

	if (hi - lo < 2)
		return;
	join_sides(k, lo, half);
	join_sides(k, half, hi);
	while (from > k->side[lo] && !(s[from - 1].flags & INTERP_SEG_STAND))
		from--;
	while (to < k->side[hi] && !(s[to - 1].flags & INTERP_SEG_STAND))
		to++;
	if (is_one(k, from, to))
		pass_set_stand(k->pass, mid - 1, false);
}

int pass_join(struct pass *w, uint32_t sides, float *v2)
{
	uint32_t *side = malloc((sides + 1) * sizeof(*side)), n = 0;
	const struct joining k = { w, side, v2 };

	if (!side)
		return -ENOMEM;
	side[n++] = 0;
	for (uint32_t i = 1; i < w->end; i++)
		if (w->segs[i - 1].flags & INTERP_SEG_STAND)
			side[n++] = i;
	side[n] = w->end;
	join_sides(&k, 0, n);
	free(side);
	return 0;
}
