/* SPDX-License-Identifier: Apache-2.0 */
/*
 * along.c - what bends of the path itself leave for going along it
 *
 * An axis that makes the length of a path has the bend B'' of it, too, and the
 * same parts of its acceleration and jerk as one beside it (beside.c).  The
 * speed of an arc leaves enough of both; where short lines go on bending, they
 * are an arc.
 */
#include "speed/pass.h"

#include "grow.h"

#include <string.h>

/* Does it leave less for going along it? */
static bool takes(const struct pass *w, const struct bent *is, uint32_t column,
		  double v)
{
	const double own = smaller(w->a_own_mm_s2[0], w->a_own_mm_s2[1]);

	return 3 * is->bend * v * own >
		       INTERP_ARC_JERK_BOTH * w->j_mm_s3[column] ||
	       is->bend * v * v + is->rate * own >
		       (1 + PASS_HARDLY) * w->a_mm_s2[column];
}

void pass_note_way(struct pass *w, uint32_t before, uint32_t behind,
		   const struct way_bend *b)
{
	struct bent_ways *k = &w->bent_ways;

	pass_way_end(w, before);
	pass_way_known(w);
	k->behind = behind;
	for (uint32_t j = 0; j < w->n; j++) {
		const struct bent *is = &b->is[j];

		if (!(is->bend > 0) || !takes(w, is, j, b->v_mm_s))
			continue;
		if (k->n == k->room &&
		    grow_array(&k->at, &k->room, sizeof(*k->at)) < 0) {
			k->lost = true;
			return;
		}
		k->at[k->n++] = (struct bent_way) {
			before, behind, j, (float)is->bend, (float)is->change,
			(float)is->rate, (float)b->all
		};
		k->last++;
	}
}

void pass_way_on(struct pass *w, uint32_t i, const struct heading *a,
		 const struct heading *b)
{
	struct way_on *k = &w->gate.way;
	struct way_bend to;
	struct bent *is = to.is;
	double sum = 0;

	to.all = k->bend;
	to.v_mm_s = smaller(k->most_mm_s, k->v_mm_s);
	for (uint32_t j = 0; j < w->n; j++) {
		is[j] = (struct bent) { 0 };
		if (!(a->along & b->along & 1u << j))
			continue;
		is[j].bend = fabs(b->rate[j] - a->rate[j]);
		is[j].rate = fabs(b->rate[j] + a->rate[j]) / 2;
		is[j].change = k->bend * k->bend * is[j].rate;
		sum += is[j].bend * is[j].bend;
	}
	sum = sqrt(sum);
	for (uint32_t j = 0; j < w->n; j++)
		is[j].bend *= k->bend / sum;
	pass_note_way(w, i - 1, i, &to);
	k->same_mm = w->segs[i].s_mm + PASS_SAME_WAY / k->bend;
}

struct weakest pass_weakest(const struct pass *w, uint32_t columns)
{
	struct weakest ret = { INFINITY, INFINITY };

	for (uint32_t j = 0; j < w->n; j++) {
		if (!(columns >> j & 1))
			continue;
		ret.a_mm_s2 = smaller(ret.a_mm_s2, w->a_mm_s2[j]);
		ret.j_mm_s3 = smaller(ret.j_mm_s3, w->j_mm_s3[j]);
	}
	return ret;
}

/* -- Long lines ----------------------------------------------------------- */

void pass_turn_behind(const struct pass *w, uint32_t i,
		      double ret[INTERP_NAXES])
{
	struct heading h[2];
	int64_t sub[INTERP_NAXES];

	memset(ret, 0, w->n * sizeof(*ret));
	if (i < w->run || i + 1 >= w->run_end ||
	    w->segs[i].kind != INTERP_LINE ||
	    w->segs[i + 1].kind != INTERP_LINE)
		return;
	for (uint32_t k = 0; k < 2; k++)
		heading_straight(&w->ways, i + k, &h[k], sub, w->n);
	for (uint32_t j = 0; j < w->n; j++)
		ret[j] = h[1].rate[j] - h[0].rate[j];
}

/* How column rates change in a mm at the node in front of segment @i, which is
 * between two lines. */
static void bend_at(const struct pass *w, uint32_t i, double ret[INTERP_NAXES])
{
	const double mm = w->segs[i - 1].length_mm + w->segs[i].length_mm;

	pass_turn_behind(w, i - 1, ret);
	for (uint32_t j = 0; j < w->n; j++)
		ret[j] *= mm > 0 ? 2 / mm : 0;
}

/* How much of the bend @here is that of the next node, too, on one side at
 * least. */
static double goes_on(const struct pass *w, uint32_t i, uint32_t along,
		      const double here[INTERP_NAXES])
{
	double sum = 0, most = 0;

	for (uint32_t side = i - 1; side <= i + 1; side += 2) {
		double bend[INTERP_NAXES], on = 0;

		sum = 0;
		bend_at(w, side, bend);
		for (uint32_t j = 0; j < w->n; j++) {
			sum += along >> j & 1 ? here[j] * here[j] : 0;
			on += along >> j & 1 ? here[j] * bend[j] : 0;
		}
		most = larger(most, on);
	}
	return sum > 0 ? smaller(most / sum, 1) : 0;
}

/* What nodes turn by one behind the other adds up over the lines between. */
double pass_arch(struct pass *w, uint32_t i, uint32_t along, double most_mm_s)
{
	double here[INTERP_NAXES], sum = 0, share, v;
	struct way_bend to = { .all = 0 };
	struct bent *is = to.is;
	struct weakest weakest;
	uint32_t moves = 0;

	bend_at(w, i, here);
	share = goes_on(w, i, along, here);
	for (uint32_t j = 0; j < w->n; j++) {
		if (!(along >> j & 1))
			continue;
		is[j].bend = share * fabs(here[j]);
		is[j].rate = fabs(pass_rate(w, i - 1, j) +
				  pass_rate(w, i, j)) / 2;
		sum += is[j].bend * is[j].bend;
		if (is[j].bend > 0 || is[j].rate > 0)
			moves |= 1u << j;
	}
	if (!(sum > 0))
		return INFINITY;
	weakest = pass_weakest(w, moves);
	to.all = sqrt(sum);
	v = pass_arc_mm_s(&weakest, to.all);
	to.v_mm_s = smaller(v, most_mm_s);
	pass_note_way(w, i - 1, i, &to);
	pass_way_begin(w, i, &(struct way_on) {
		.bend = to.all, .most_mm_s = most_mm_s, .v_mm_s = v,
	});
	return v;
}
