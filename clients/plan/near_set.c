/* SPDX-License-Identifier: Apache-2.0 */
/*
 * near_set.c - some pairs of triangles that stand for all that are near
 */
#include "near_set.h"

#include "vec.h"

#define CELL_MM		5.0

static bool same_cell(const struct near_pair *a, const struct near_pair *b)
{
	double u[3], v[3];

	for (int k = 0; k < 3; k++)
		if (floor(a->q[k] / CELL_MM) != floor(b->q[k] / CELL_MM))
			return false;
	/* Two walls that meet in a cell are two. */
	v_sub(a->q, a->p, u);
	v_sub(b->q, b->p, v);
	return v_dot(u, v) > 0.8 * a->mm * b->mm;
}

static bool take(void *arg, const struct near_pair *pair)
{
	struct near_set *s = arg;
	uint32_t far = 0;

	for (uint32_t i = 0; i < s->n; i++) {
		if (same_cell(&s->pair[i], pair)) {
			if (pair->mm < s->pair[i].mm)
				s->pair[i] = *pair;
			return true;
		}
		if (s->pair[i].mm > s->pair[far].mm)
			far = i;
	}
	if (s->n < s->max)
		s->pair[s->n++] = *pair;
	else if (pair->mm < s->pair[far].mm)
		s->pair[far] = *pair;
	return true;
}

void near_set_collect(const struct bodies *b, const struct pose *pose,
		      double least_mm, double band_mm, struct near_set *ret)
{
	ret->n = 0;
	near_within(b, pose, least_mm + band_mm, take, ret);
}
