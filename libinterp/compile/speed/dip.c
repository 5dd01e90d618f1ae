/* SPDX-License-Identifier: Apache-2.0 */
/*
 * dip.c - places that only a rounding makes slow
 *
 * How the bend of an axis beside the path changes is a difference of
 * differences: roundings show in it most, by more at one node than at the next.
 * It is measured over windows, so what is real shows at all nodes within such a
 * window.  So a node is no slower by it than the fastest node near to it, on
 * one side or on the other.
 */
#include "speed/pass.h"

#include <math.h>

/* The share by which that may be faster: a real bend comes and goes, too.  What
 * is no difference of differences is certain, but for little. */
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
	float most = is->mm_s;

	for (uint32_t n = 0, k = i + way; n < DIP_NODES; n++, k += way) {
		if (w->dips[k % DIP_RING].node != k ||
		    fabs(w->segs[k].s_mm - here) > mm)
			break;
		if (shown(w, k, round)->mm_s > most)
			most = shown(w, k, round)->mm_s;
	}
	return pass_least(most, (round ? ROUND_MOST : BOW_MOST) * is->mm_s);
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
