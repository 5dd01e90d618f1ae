/* SPDX-License-Identifier: Apache-2.0 */
/*
 * dip.c - places that only a rounding makes slow
 *
 * How the bend of an axis beside the path changes is a difference of
 * differences: roundings show in it most, by more at one node than at the next.
 * It is measured over windows, so what is real shows at all nodes within such a
 * window.  So a node is no slower by it than the fastest node near to it, on
 * one side or on the other.
 *
 * The same is so of a bend, and the last per cent of it counts: where it takes
 * nine tenths of what an axis can do, one more leaves a tenth less for going
 * along the path, and a move has the least of its whole way.
 */
#include "speed/pass.h"

#include <math.h>

/* Of what a node shows, another rounding may be wrong; and so may this share of
 * the speed: a real bend comes and goes, too. */
#define ROUND_MOST	1.06f
#define BOW_MOST	1.03f

void pass_note_dip(struct pass *w, uint32_t i)
{
	w->dip.node = i;
	w->dips[i % DIP_RING] = w->dip;
}

void pass_dip_firm(struct pass *w, uint32_t first, uint32_t i, double v_mm_s)
{
	for (uint32_t k = i; k > first && i - k < DIP_RING; k--) {
		struct dip *d = &w->dips[k % DIP_RING];

		if (d->node == k)
			d->firm_mm_s = pass_least(d->firm_mm_s, (float)v_mm_s);
	}
}

static const struct shown *shown(const struct pass *w, uint32_t i, bool round)
{
	const struct dip *d = &w->dips[i % DIP_RING];

	return round ? &d->round : &d->bow;
}

/* On one side of node @i; @way is 1 or -1. */
static float fastest(const struct pass *w, uint32_t i, uint32_t way, bool round)
{
	const struct shown *is = shown(w, i, round);
	const double mm = (double)is->near_mm, here = w->segs[i].s_mm;
	const float share = round ? ROUND_MOST : BOW_MOST;
	float most = is->mm_s;

	for (uint32_t n = 0, k = i + way; n < DIP_NODES; n++, k += way) {
		if (w->dips[k % DIP_RING].node != k ||
		    fabs(w->segs[k].s_mm - here) > mm)
			break;
		if (shown(w, k, round)->mm_s > most)
			most = shown(w, k, round)->mm_s;
	}
	if (is->most_mm_s > share * is->mm_s)
		return pass_least(most, is->most_mm_s);
	return pass_least(most, share * is->mm_s);
}

double pass_dip_mm_s(const struct pass *w, uint32_t i)
{
	const struct dip *d = &w->dips[i % DIP_RING];
	float v = d->firm_mm_s;

	if (d->node != i || pass_least(d->round.mm_s, d->bow.mm_s) >= v)
		return 0;
	for (int round = 0; round < 2; round++)
		v = pass_least(v, pass_least(fastest(w, i, UINT32_MAX, round),
					     fastest(w, i, 1, round)));
	return (double)v;
}

/* -- Bends ---------------------------------------------------------------- */

/* What is noted of the column of @b at node @node; *@at: where it was looked
 * for last.  NULL: nothing, so it hardly bends there. */
static const struct bent_node *noted(const struct bent_nodes *k,
				     const struct bent_node *b, int64_t node,
				     size_t *at)
{
	const int way = node > b->behind ? 1 : -1;

	for (size_t m = *at; m < k->n; m += (size_t)way) {
		const int64_t is = k->at[m].behind;

		if (way * is > way * node)
			return NULL;
		*at = m;
		if (is == node && k->at[m].column == b->column)
			return &k->at[m];
	}
	return NULL;
}

/* How a bend changes, or how much it is. */
struct of_bend {
	double is, near_mm;
};

static struct of_bend change_of(const struct bent *b)
{
	return (struct of_bend) { b->change, b->change_mm };
}

static struct of_bend shown_of(const struct bent *b)
{
	return (struct of_bend) { b->shown, b->near_mm };
}

/* On one side of bend @n. */
static double least_of(const struct pass *w, size_t n, int way,
		       struct of_bend (*of)(const struct bent *b))
{
	const struct bent_nodes *k = &w->bent_nodes;
	const struct bent_node *b = &k->at[n];
	const struct of_bend is = of(&b->is);
	double least = is.is;
	size_t at = n;

	for (int i = 1; i <= DIP_NODES; i++) {
		const int64_t node = (int64_t)b->behind + way * i;
		const struct bent_node *next;

		if (!pass_is_near(w, b, node, is.near_mm))
			break;
		next = noted(k, b, node, &at);
		if (!next)
			return 0;
		least = smaller(least, of(&next->is).is);
	}
	return least;
}

/* On one side or the other. */
static double sure_of(const struct pass *w, size_t n,
		      struct of_bend (*of)(const struct bent *b))
{
	return larger(least_of(w, n, -1, of), least_of(w, n, 1, of));
}

void pass_dip_bends(struct pass *w)
{
	struct bent_nodes *k = &w->bent_nodes;
	size_t kept = 0;

	for (size_t n = 0; n < k->n; n++) {
		const double most = sure_of(w, n, shown_of);
		struct bent *is = &k->at[n].is;

		/* One that no other node shows is none. */
		is->bend = most > 0 ? larger(is->bend, most) : 0;
		is->sure = sure_of(w, n, change_of);
	}
	/* Nor does its rate count: its windows may have seen a corner. */
	for (size_t n = 0; n < k->n; n++)
		if (k->at[n].is.bend > 0 || k->at[n].is.sure > 0)
			k->at[kept++] = k->at[n];
	k->n = kept;
}
