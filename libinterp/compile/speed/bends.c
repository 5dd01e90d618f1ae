/* SPDX-License-Identifier: Apache-2.0 */
/* bends.c - the bends of each run of segments, for moves that are slow there */
#include "speed/looks.h"

#include "interp/bends.h"
#include "interp/smaller.h"

#include <math.h>
#include <string.h>

static void lessen(float *least, double v)
{
	*least = (float)smaller((double)*least, v);
}

static void raise_to(float *most, double v)
{
	*most = (float)larger((double)*most, v);
}

static void add_column(struct interp_bends *b, const struct interp_axes *x,
		       uint32_t k, const double *way)
{
	const double by = fabs(way[0]);
	const double a = x->a_mm_s2[k], j = x->j_mm_s3[k];
	const bool bent = way[1] != 0 || way[2] != 0;

	if (by > 0) {
		lessen(&b->a_mm_s2, a / by);
		lessen(&b->j_mm_s3, j / by);
	}
	if (by > 0 && bent) {
		lessen(&b->bent_a_mm_s2, a / by);
		lessen(&b->bent_j_mm_s3, j / by);
	}
	raise_to(&b->by_v2, fabs(way[1]) / a);
	raise_to(&b->by_va, 3 * fabs(way[1]) / j);
	raise_to(&b->by_v3, fabs(way[2]) / j);
}

static void add_seg(struct interp_bends *b, const struct look_all *all,
		    const struct looks *of)
{
	double way[INTERP_NAXES * INTERP_AXES_WAY];

	for (uint32_t i = 0; i < of->n; i++) {
		looks_way(all, of->at + i, way);
		for (uint32_t k = 0; k < all->axes.n; k++)
			add_column(b, &all->axes, k,
				   way + k * INTERP_AXES_WAY);
	}
}

void looks_bends(const struct look_all *k, struct interp_bends *bends)
{
	const uint64_t n = k->p->head->nbends, segs = k->p->head->nsegs;
	uint64_t i = 0;

	while (i < segs && k->of[i].n <= 1)
		i++;
	if (i == segs) {
		memset(bends, 0, n * sizeof(*bends));
		return;
	}
	for (uint64_t b = 0; b < n; b++) {
		const uint64_t from = b * INTERP_BENDS_SEGS;

		bends[b] = INTERP_BENDS_NONE;
		for (i = from; i < from + INTERP_BENDS_SEGS && i < segs; i++)
			add_seg(&bends[b], k, &k->of[i]);
	}
}
