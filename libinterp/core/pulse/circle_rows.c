/* SPDX-License-Identifier: Apache-2.0 */
/*
 * circle_rows.c - counts the lattice points of some rows of a quadrant
 *
 * In the row `out` they are those with in > 0 and out*out + in*in < r2.  The
 * greatest `in` of each row is a point on or under the convex hull of all of
 * them, and so the rows are counted edge by edge of the hull: of an edge that
 * goes a rows on and b inward, with no lattice point between, row i has
 * ceil(b*i/a) points fewer than the first, which sums up to
 * (a - 1)*(b + 1)/2 + b.  The hull has about 0.9 * R^(2/3) edges.
 *
 * The next edge is the least steep vector that leads to a point inside.  It is
 * looked for in the tree of Stern and Brocot: between a vector that leads
 * outside and a steeper one that leads inside, their sum is tried.  What lay
 * inside on the way to it may be the edges behind it, so it is kept.
 */
#include "pulse/pair.h"
#include "pulse/pulse.h"

/* Each level adds another vector, and they grow as the numbers of Fibonacci: a
 * circle of CIRCLE_R_MAX has room for fewer than 42. */
#define LEVELS		64

struct edge {
	int64_t rows, inward;
};

struct hull {
	int64_t r2, last;		/* no row behind this one */
	int64_t out, in;		/* the corner where it stands */
	struct edge steep;		/* leads inside */
	struct {
		struct edge by;		/* was added to it ... */
		int64_t times;
	} level[LEVELS];
	int levels;
};

static bool is_inside(const struct hull *h, const struct edge *e)
{
	const int64_t out = h->out + e->rows, in = h->in - e->inward;

	return out <= h->last && in >= 0 && out * out + in * in < h->r2;
}

/* Does no number of `steep` lead inside from there?  The circle is steeper than
 * it, or there are no more rows. */
static bool is_lost(const struct hull *h, const struct edge *e)
{
	const int64_t out = h->out + e->rows, in = h->in - e->inward;

	return out > h->last || in <= 0 ||
	       in * h->steep.inward <= out * h->steep.rows;
}

/* The sum of `steep` and @by leads inside, too. */
static void push(struct hull *h, const struct edge *by)
{
	const int top = h->levels - 1;

	h->steep.rows += by->rows;
	h->steep.inward += by->inward;
	if (top >= 0 && h->level[top].by.rows == by->rows &&
	    h->level[top].by.inward == by->inward) {
		h->level[top].times++;
		return;
	}
	h->level[h->levels].by = *by;
	h->level[h->levels++].times = 1;
}

static struct edge pop(struct hull *h)
{
	const struct edge e = h->steep;
	const int top = h->levels - 1;

	if (top < 0)
		return e;
	h->steep.rows -= h->level[top].by.rows;
	h->steep.inward -= h->level[top].by.inward;
	if (--h->level[top].times == 0)
		h->levels--;
	return e;
}

/* The next edge, when @e has led outside. */
static struct edge turn(struct hull *h, struct edge e)
{
	while (!is_inside(h, &h->steep) && h->levels > 0)
		e = pop(h);
	while (h->levels < LEVELS) {
		const struct edge sum = { h->steep.rows + e.rows,
					  h->steep.inward + e.inward };

		if (is_inside(h, &sum))
			push(h, &e);
		else if (is_lost(h, &sum))
			break;
		else
			e = sum;
	}
	return pop(h);
}

int64_t circle_rows(int64_t r2, int64_t from, int64_t to)
{
	struct hull h = {
		.r2 = r2, .last = to - 1, .out = from, .steep = { 0, 1 },
	};
	struct edge e = { 1, 0 };
	int64_t sum;

	if (from >= to)
		return 0;
	h.in = pair_isqrt(1, (uint64_t)(r2 - from * from - 1));
	sum = h.in;
	while (h.out < h.last && e.rows > 0) {
		for (; is_inside(&h, &e); h.out += e.rows, h.in -= e.inward)
			sum += e.rows * h.in - e.inward -
			       (e.rows - 1) * (e.inward + 1) / 2;
		if (h.out < h.last)
			e = turn(&h, e);
	}
	return sum;
}
