/* SPDX-License-Identifier: Apache-2.0 */
/* bends.c - the bends of each run of segments, for moves that are slow there */
#include "speed/pass.h"

#include "interp/bends.h"

#include <string.h>

/* What the first of the segments @s allow, @n at most, as if nothing bent. */
static struct interp_bends own_of(const struct interp_seg *s, uint32_t n)
{
	struct interp_bends b = INTERP_BENDS_NONE;

	n = n < INTERP_BENDS_SEGS ? n : INTERP_BENDS_SEGS;
	for (uint32_t i = 0; i < n; i++) {
		b.a_mm_s2 = pass_least(s[i].a_mm_s2, b.a_mm_s2);
		b.j_mm_s3 = pass_least(s[i].j_mm_s3, b.j_mm_s3);
	}
	return b;
}

static struct interp_bends bends_of(const struct pass *w,
				    const struct bent_node *k)
{
	const double a = w->a_mm_s2[k->column], j = w->j_mm_s3[k->column];
	const struct bent *is = &k->is;
	struct interp_bends b = INTERP_BENDS_NONE;

	b.by_v2 = (float)(is->bend / a);
	b.by_v3 = (float)(is->change / j);
	b.by_va = (float)(3 * is->bend / j);
	if (is->rate > 0) {
		b.bent_a_mm_s2 = (float)(a / is->rate);
		b.bent_j_mm_s3 = (float)(j / is->rate);
	}
	return b;
}

/* Of all runs that it is on. */
static void join(const struct pass *w, const struct bent_node *k,
		 struct interp_bends *bends)
{
	const struct interp_bends b = bends_of(w, k);
	const uint32_t to = k->behind / INTERP_BENDS_SEGS;

	for (uint32_t i = k->before / INTERP_BENDS_SEGS; i <= to; i++)
		interp_bends_join(&bends[i], &b);
}

void pass_bends(const struct pass *w, struct interp_bends *bends)
{
	const struct bent_nodes *k = &w->bent_nodes;
	const struct bent_ways *ways = &w->bent_ways;
	const size_t n = w->p->head->nbends;
	const uint32_t segs = w->p->head->nsegs;

	if (n == 0)
		return;
	if (k->n + ways->n == 0 || k->lost || ways->lost) {
		memset(bends, 0, n * sizeof(*bends));
		return;
	}
	for (uint32_t i = 0; i < segs; i += INTERP_BENDS_SEGS)
		bends[i / INTERP_BENDS_SEGS] = own_of(&w->segs[i], segs - i);
	for (size_t i = 0; i < k->n; i++)
		join(w, &k->at[i], bends);
	for (size_t i = 0; i < ways->n; i++) {
		const struct bent_node b = pass_way_node(&ways->at[i]);

		join(w, &b, bends);
	}
}
