/* SPDX-License-Identifier: Apache-2.0 */
/* bends.c - what bends leave at a speed */
#include "interp/bends.h"
#include "interp/limits.h"
#include "interp/smaller.h"

#include <math.h>

static float least(float a, float b)
{
	return a < b ? a : b;
}

static float most(float a, float b)
{
	return a > b ? a : b;
}

void interp_bends_join(struct interp_bends *sum, const struct interp_bends *b)
{
	*sum = (struct interp_bends) {
		.a_mm_s2 = least(sum->a_mm_s2, b->a_mm_s2),
		.j_mm_s3 = least(sum->j_mm_s3, b->j_mm_s3),
		.bent_a_mm_s2 = least(sum->bent_a_mm_s2, b->bent_a_mm_s2),
		.bent_j_mm_s3 = least(sum->bent_j_mm_s3, b->bent_j_mm_s3),
		.by_v2 = most(sum->by_v2, b->by_v2),
		.by_v3 = most(sum->by_v3, b->by_v3),
		.by_va = most(sum->by_va, b->by_va),
	};
}

struct interp_along interp_bends_leave(const struct interp_bends *b,
				       double v_mm_s,
				       const struct interp_along *most)
{
	const double v = v_mm_s, v2 = v * v;
	const double across = smaller((double)b->by_v2 * v2, 1);
	const double round = (double)b->by_v3 * v2 * v;
	const double per_a = (double)b->by_va * v;
	double a = smaller(most->a_mm_s2, (double)b->a_mm_s2);
	double j = smaller(most->j_mm_s3, (double)b->j_mm_s3);
	double comes_to, both;

	if (across > 0)
		a = smaller(a, (1 - across) * (double)b->bent_a_mm_s2);
	comes_to = smaller(a, sqrt(v * j));
	if (per_a * comes_to > INTERP_ARC_JERK_BOTH)
		a = comes_to = INTERP_ARC_JERK_BOTH / per_a;
	both = per_a * comes_to;
	if (both > 0)
		j = smaller(j, (sqrt(1 - both * both) - round) *
			       (double)b->bent_j_mm_s3);
	return (struct interp_along) { a, j };
}
