/* SPDX-License-Identifier: Apache-2.0 */
/*
 * near_set.c - some pairs of triangles that stand for all that are near
 *
 * Both bodies are cut into patches, which are nodes of their trees.  Each pair
 * of patches gives its nearest pair of triangles, from the nearest patches on.
 * So it costs about as much for fine meshes as for coarse ones.
 */
#include "near_set.h"

#include "vec.h"
#include "grow.h"

#include <stdlib.h>


static bool same_cell(const struct near_pair *a, const struct near_pair *b)
{
	double u[3], v[3];

	for (int k = 0; k < 3; k++)
		if (floor(a->q[k] / NEAR_CELL_MM) !=
		    floor(b->q[k] / NEAR_CELL_MM))
			return false;
	/* Two walls that meet in a cell are two. */
	v_sub(a->q, a->p, u);
	v_sub(b->q, b->p, v);
	return v_dot(u, v) > 0.8 * a->mm * b->mm;
}

/* Of the same cell the nearer one stays, and of too many the nearest ones. */
static void add(struct near_set *s, const struct near_pair *pair)
{
	uint32_t far = 0;

	for (uint32_t i = 0; i < s->n; i++) {
		if (same_cell(&s->pair[i], pair)) {
			if (pair->mm < s->pair[i].mm)
				s->pair[i] = *pair;
			return;
		}
		if (s->pair[i].mm > s->pair[far].mm)
			far = i;
	}
	if (s->n < s->max)
		s->pair[s->n++] = *pair;
	else if (pair->mm < s->pair[far].mm)
		s->pair[far] = *pair;
}

/* A pair that is farther than that has no place in the set. */
static double farthest(const struct near_set *s, double mm)
{
	double most = 0;

	if (s->n < s->max)
		return mm;
	for (uint32_t i = 0; i < s->n; i++)
		most = fmax(most, s->pair[i].mm);
	return most;
}

/* -- Patches -------------------------------------------------------------- */

struct list {
	struct near_patch *at;
	uint32_t n;
	size_t room;
};

static bool take(void *arg, const struct near_patch *patch)
{
	struct list *l = arg;

	if (l->n == l->room && grow_array(&l->at, &l->room, sizeof(*l->at)))
		return false;
	l->at[l->n++] = *patch;
	return true;
}

static int order(const void *a, const void *b)
{
	const struct near_patch *x = a, *y = b;

	return (x->mm > y->mm) - (x->mm < y->mm);
}

void near_set_collect(const struct bodies *b, const struct pose *pose,
		      double mm, struct near_set *ret)
{
	struct near_asked asked = { mm, NEAR_SET_SLACK_MM };
	struct list l = { 0 };

	ret->n = 0;
	near_patches(b, pose, mm, take, &l);
	if (l.n)
		qsort(l.at, l.n, sizeof(*l.at), order);
	for (uint32_t i = 0; i < l.n; i++) {
		struct near_pair pair;

		asked.mm = farthest(ret, mm);
		if ((double)l.at[i].mm >= asked.mm)
			break;
		if (near_between(b, pose, &l.at[i], &asked, &pair))
			add(ret, &pair);
	}
	free(l.at);
}
