/* SPDX-License-Identifier: Apache-2.0 */
/*
 * floor.c - bends that are passed a little slower, because they leave too
 * little
 *
 * The faster a bend is passed the less it leaves for going along it, and a move
 * has the least of its whole way.  So the worst of many bends makes all of a
 * move slow, and which one that is, and by how much, may be a matter of
 * roundings.  To pass those that are the worst a little slower takes next to no
 * time, and the move has more.  How much more is found by trying: floors for
 * what is left, each a little higher, as long as all of the way as one move
 * takes less time.
 */
#include "speed/pass.h"

#include <math.h>
#include <stdlib.h>

/* From one floor to the next, and so many are tried.  Higher ones would make
 * long moves quicker still, but some short ones more than others. */
#define HIGHER		1.04
#define TRIES		3

/* A bend is passed slower in such steps, and by so many at most. */
#define SLOWER		0.99
#define STEPS		30

struct floors {
	struct pass *w;
	const float *v2;		/* squares of the speeds that can be
					 * come to, at each node */
	float *top2, *room;
	struct leave least;		/* what bends should leave */
	struct leave other;		/* what there is without them */
	double mean_mm_s;		/* about as fast as the way is */
	double best_s;			/* the least so far */
};

static bool is_way(const struct interp_seg *s)
{
	return s->kind < INTERP_BEGIN && s->length_mm > 0;
}

static struct leave least_of(const struct leave *a, const struct leave *b)
{
	return (struct leave) { smaller(a->a_mm_s2, b->a_mm_s2),
				smaller(a->j_mm_s3, b->j_mm_s3) };
}

static double come_to_mm_s(const float *v2, const struct bent_node *b)
{
	return sqrt((double)v2[b->before]);
}

/* How fast bend @b may be passed, and what it leaves then. */
static double speed_over(const struct floors *k, const struct bent_node *b,
			 struct leave *ret)
{
	double v = come_to_mm_s(k->v2, b);

	*ret = b->left;
	for (int i = 0; i < STEPS && (ret->a_mm_s2 < k->least.a_mm_s2 ||
				      ret->j_mm_s3 < k->least.j_mm_s3); i++) {
		v *= SLOWER;
		pass_leave(k->w, b, v, ret);
	}
	return v;
}

/* No faster than @v_mm_s over any node that @b is made of. */
static void pass_by(float *v2, const struct bent_node *b, double v_mm_s)
{
	for (uint32_t i = b->before; i < b->behind; i++)
		v2[i] = pass_least(v2[i], (float)(v_mm_s * v_mm_s));
}

/* -- All of the way as one move ------------------------------------------- */

/* What the jerk leaves of the acceleration in a ramp. */
static double slope_mm_s2(const struct leave *l, double v)
{
	const double a = l->a_mm_s2, j = l->j_mm_s3;

	return v * j >= a * a ? v / (v / a + a / j) : sqrt(v * j) / 2;
}

/* The time over segment @s, from the speed @b to @e, times the acceleration. */
static double seg_mm_s(const struct interp_seg *s, double a, double b, double e)
{
	const double feed = (double)s->feed_max_mm_s;
	const double most2 = (b * b + e * e) / 2 + a * s->length_mm;
	const double top = feed * feed < most2 ? feed : sqrt(most2);

	return 2 * top - b - e + (most2 - top * top) / top;
}

/* Forward and back, no faster over a node than top2 says. */
static double way_s(const struct floors *k, double a)
{
	const struct interp_seg *s = k->w->segs;
	double sum = 0, at2 = 0, at = 0;

	k->room[0] = 0;
	for (uint32_t i = 1; i <= k->w->end; i++) {
		if (is_way(&s[i]))
			at2 += 2 * a * s[i].length_mm;
		at2 = smaller(at2, (double)k->top2[i]);
		k->room[i] = (float)at2;
	}
	for (uint32_t i = k->w->end; i > 0; i--) {
		const double end = at;

		if (!is_way(&s[i]))
			continue;
		at = sqrt(smaller((double)k->room[i - 1],
				  end * end + 2 * a * s[i].length_mm));
		sum += seg_mm_s(&s[i], a, at, end);
	}
	return sum / a;
}

/* With these floors. */
static double time_s(struct floors *k)
{
	const struct bent_nodes *bents = &k->w->bent_nodes;
	struct leave is = k->other, left;

	memcpy(k->top2, k->v2, (k->w->end + 1) * sizeof(*k->top2));
	for (size_t n = 0; n < bents->n; n++) {
		const struct bent_node *b = &bents->at[n];

		pass_by(k->top2, b, speed_over(k, b, &left));
		is = least_of(&is, &left);
	}
	return way_s(k, slope_mm_s2(&is, k->mean_mm_s));
}

/* -- Floors --------------------------------------------------------------- */

/* Raise the one at @at. */
static void lift(struct floors *k, double *at)
{
	double best = *at;

	for (int n = 0; n < TRIES; n++) {
		double s;

		*at *= HIGHER;
		s = time_s(k);
		if (!(s < k->best_s))
			continue;
		best = *at;
		k->best_s = s;
	}
	*at = best;
}

static double mean_mm_s(const struct floors *k)
{
	const struct interp_seg *s = k->w->segs;
	double mm = 0, sum = 0;

	for (uint32_t i = 1; i <= k->w->end; i++) {
		const float v2 = k->v2[i] > k->v2[i - 1] ? k->v2[i] :
							   k->v2[i - 1];

		if (!is_way(&s[i]) || !(v2 > 0))
			continue;
		mm += s[i].length_mm;
		sum += s[i].length_mm / sqrt((double)v2);
	}
	return mm / sum;
}

/* So far no bend is slower. */
static void begin(struct floors *k)
{
	struct bent_nodes *bents = &k->w->bent_nodes;

	k->least = (struct leave) { INFINITY, INFINITY };
	for (size_t n = 0; n < bents->n; n++) {
		struct bent_node *b = &bents->at[n];

		pass_leave(k->w, b, come_to_mm_s(k->v2, b), &b->left);
		k->least = least_of(&k->least, &b->left);
	}
}

/* Pass bends as slowly as the best floors ask for. */
static void slow_down(const struct floors *k, float *v2)
{
	const struct bent_nodes *bents = &k->w->bent_nodes;
	struct leave left;

	for (size_t n = 0; n < bents->n; n++) {
		const struct bent_node *b = &bents->at[n];
		const double v = speed_over(k, b, &left);

		if (v < come_to_mm_s(k->v2, b))
			for (uint32_t i = b->before; i < b->behind; i++)
				k->w->segs[i].node_mm_s = pass_least(
					k->w->segs[i].node_mm_s, (float)v);
		pass_by(k->top2, b, v);
	}
	memcpy(v2, k->top2, (k->w->end + 1) * sizeof(*v2));
}

void pass_raise_floors(struct pass *w, float *v2)
{
	struct floors k = { .w = w, .v2 = v2, .other = {
		smaller(w->soft.a_least, w->travel_a_mm_s2),
		smaller(w->soft.j_least, w->travel_j_mm_s3),
	} };
	bool a, j;

	begin(&k);
	a = k.least.a_mm_s2 < k.other.a_mm_s2;
	j = k.least.j_mm_s3 < k.other.j_mm_s3;
	if (!a && !j)
		return;
	k.top2 = malloc((w->end + 1) * 2 * sizeof(*k.top2));
	if (!k.top2)
		return;
	k.room = k.top2 + w->end + 1;
	k.mean_mm_s = mean_mm_s(&k);
	k.best_s = time_s(&k);
	if (a)
		lift(&k, &k.least.a_mm_s2);
	if (j)
		lift(&k, &k.least.j_mm_s3);
	slow_down(&k, v2);
	free(k.top2);
}
