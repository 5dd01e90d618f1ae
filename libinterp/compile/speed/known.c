/* SPDX-License-Identifier: Apache-2.0 */
/*
 * known.c - how the axes beside a known way bend at its nodes
 *
 * Windows do not see what a rounding may be, nor are there any between long
 * lines.  But the nodes of a known way are on it, to a subpulse: two lines show
 * the bend of the node between them, and four how that changes.  The lines are
 * already no faster than the bend (code/tip_way.c).
 */
#include "speed/pass.h"

/* Lines to both sides of a node. */
#define SIDE		2

/* A bend that goes on is no more than so many times that of the next node; a
 * corner in the way is. */
#define GOES_ON		2

/* A node between lines: the one before it, it, and the one behind it. */
enum { BEFORE, AT, BEHIND, NODES };

struct known_node {
	double mm[2 * SIDE];		/* of the lines around it; 0: it is
					 * none of the way */
	double rate[2 * SIDE][INTERP_NAXES];
};

/* @along: what makes the length; where other axes do, it is in other units. */
static void look_at(const struct pass *w, uint32_t i, uint32_t along,
		    struct known_node *ret)
{
	for (uint32_t k = 0; k < 2 * SIDE; k++) {
		const uint32_t line = i + k - SIDE;
		struct headings h;

		ret->mm[k] = 0;
		if (i + k < w->run + SIDE || line >= w->run_end ||
		    !pass_is_known(w, i, line))
			continue;
		heading_of(&w->ways, line, &h);
		memcpy(ret->rate[k], h.first.rate, w->n * sizeof(double));
		if (h.first.along == along)
			ret->mm[k] = w->segs[line].length_mm;
	}
}

/* How the rate of column @j changes in a mm at these nodes; NAN: there is no
 * way to one side. */
static void bends_of(const struct known_node *k, uint32_t j, double ret[NODES])
{
	for (int n = 0; n < NODES; n++) {
		const double mm = (k->mm[n] + k->mm[n + 1]) / 2;

		ret[n] = k->mm[n] > 0 && k->mm[n + 1] > 0 ?
			 (k->rate[n + 1][j] - k->rate[n][j]) / mm : NAN;
	}
}

static double bend_at(const double b[NODES])
{
	const double way = b[AT] > 0 ? 1 : -1;
	const double on = fmax(way * b[BEFORE], way * b[BEHIND]);

	return isnan(on) ? fabs(b[AT]) :
			   smaller(fabs(b[AT]), GOES_ON * larger(on, 0));
}

/* What is a change on one side only is a corner. */
static double change_at(const struct known_node *k, const double b[NODES])
{
	const double mm = k->mm[SIDE - 1] + k->mm[SIDE];

	if (isnan(b[BEFORE]) || isnan(b[BEHIND]))
		return 0;
	return smaller(fabs(b[BEHIND] - b[BEFORE]),
		       2 * smaller(fabs(b[AT] - b[BEFORE]),
				   fabs(b[BEHIND] - b[AT]))) / mm;
}

/* If it leaves less for going along. */
static void note(struct pass *w, uint32_t j, const struct bent *is, double v)
{
	const double own = pass_own_mm_s2(w), jerk = w->j_mm_s3[j];

	if (3 * is->bend * v * own <= INTERP_ARC_JERK_BOTH * jerk &&
	    is->bend * v * v + is->rate * own <= w->a_mm_s2[j] &&
	    is->change * v * v * v <= PASS_HARDLY_JERK * jerk)
		return;
	w->bent[j] = *is;
	w->bends |= 1u << j;
}

void pass_known(struct pass *w, uint32_t i, uint32_t along)
{
	const double v = smaller((double)w->segs[i - 1].feed_max_mm_s,
				 (double)w->segs[i].feed_max_mm_s);
	struct known_node k;

	look_at(w, i, along, &k);
	w->bends = 0;
	for (uint32_t j = 0; j < w->n; j++) {
		double b[NODES], bend;

		if (along >> j & 1)
			continue;
		bends_of(&k, j, b);
		bend = bend_at(b);
		note(w, j, &(struct bent) {
			.bend = bend, .shown = bend, .change = change_at(&k, b),
			.rate = (fabs(k.rate[SIDE - 1][j]) +
				 fabs(k.rate[SIDE][j])) / 2,
		}, v);
	}
}

double pass_known_own(const struct pass *w, uint32_t before, uint32_t behind)
{
	const struct interp_seg *a = &w->segs[before], *b = &w->segs[behind];
	const double v = smaller((double)a->feed_max_mm_s,
				 (double)b->feed_max_mm_s);
	const double jerk = smaller((double)a->j_mm_s3, (double)b->j_mm_s3);

	return smaller(pass_own_mm_s2(w), sqrt(v * jerk));
}
