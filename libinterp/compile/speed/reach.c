/* SPDX-License-Identifier: Apache-2.0 */
/*
 * reach.c - what bends leave, at the speeds that a move can come to
 *
 * A bend takes the more of what an axis can do the faster it is passed.  Its
 * node may allow a speed that no move comes to: from the slow places behind it
 * and ahead there may be no room for that.  So the bends wait until all nodes
 * are known.
 */
#include "speed/pass.h"

#include "grow.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool moves(const struct interp_seg *s)
{
	return s->kind < INTERP_BEGIN;
}

/* The most over the node behind segment @k. */
static float over_mm_s(const struct pass *w, uint32_t k)
{
	const struct interp_seg *s = &w->segs[k];
	float v = s->node_mm_s;

	if (moves(s))
		v = pass_least(v, s->feed_max_mm_s);
	if (k < w->end && moves(s + 1))
		v = pass_least(v, s[1].feed_max_mm_s);
	return v;
}

/* The square of a speed, after segment @s from another one. */
static inline float from(const struct interp_seg *s, float v2, float other)
{
	/* Mostly there is nothing to speed up for. */
	if (v2 <= other)
		return v2;
	return pass_least(v2, moves(s) ? other + 2 * (float)s->length_mm *
						 s->a_mm_s2 : other);
}

/* Of every node the square of the speed that can be come to, from where the
 * program begins and to its end, forward and back.  So far segments have what
 * their axes can do.  NULL: no memory. */
static float *reach(const struct pass *w)
{
	const struct interp_seg *segs = w->segs;
	float *v2 = malloc((w->end + 1) * sizeof(*v2));
	float v = 0;

	if (!v2)
		return NULL;
	v2[0] = v2[w->end] = 0;
	for (uint32_t k = 1; k < w->end; k++) {
		const float most = over_mm_s(w, k);

		v2[k] = v = from(&segs[k], most * most, v);
	}
	v = 0;
	for (uint32_t k = w->end; k > 0; k--)
		v2[k - 1] = v = from(&segs[k], v2[k - 1], v);
	return v2;
}

/*
 * What the column of a bend goes by in a mm of segment @i at most; less than
 * its windows show, if it turns in another place of them.  Kinematics make
 * lines of a way that goes on bending between them.
 */
static double rate_on(struct pass *w, const struct bent_node *b, uint32_t i)
{
	const struct interp_seg *s = &w->segs[i];
	const double off = pass_along_tol(w, w->ways.xyz);
	double rate;

	if (s->kind > INTERP_ARC || s->flags & INTERP_SEG_KNOWN)
		return b->is.rate;
	rate = fabs(pass_rate(w, i, b->column));
	return smaller(b->is.rate,
		       rate + (w->tol[b->column] +
			       pass_off(w, b->column, off, rate)) /
			       s->length_mm);
}

/* On a segment that is not short each column goes as it is written: it bends at
 * the node, not beside it. */
static void soften_by(struct pass *w, const struct bent_node *b, double v_mm_s)
{
	for (uint32_t i = b->before; i <= b->behind; i++) {
		struct bent_node on = *b;
		struct leave left;

		if (w->segs[i].kind >= INTERP_BEGIN || !pass_is_short(w, i))
			continue;
		on.is.rate = rate_on(w, b, i);
		pass_leave(w, &on, v_mm_s, &left);
		pass_soften_segs(w, i, i, &left);
	}
}

/* How many of the first of @n begin at the same place; and where the last of
 * them ends. */
static size_t of_place(const struct bent_way *k, size_t n, uint32_t *ret_behind)
{
	size_t m;

	*ret_behind = 0;
	for (m = 0; m < n && k[m].before == k->before; m++)
		if (k[m].behind > *ret_behind)
			*ret_behind = k[m].behind;
	return m;
}

/* A node may be faster than its bend as an arc, if it was looked at once more
 * beside a corner.  An arc leaves something for going along it at any speed. */
static double as_arc_mm_s(const struct pass *w, const struct bent_way *k,
			  double v_mm_s)
{
	return smaller(v_mm_s, sqrt(INTERP_BEND_ACROSS * w->a_mm_s2[k->column] /
				    (double)k->bend));
}

static struct leave leave_of(const struct pass *w, const struct bent_way *k,
			     size_t n, double v_mm_s)
{
	struct leave ret = { INFINITY, INFINITY };

	for (size_t m = 0; m < n; m++) {
		const struct bent_node b = pass_way_node(&k[m]);
		struct leave left;

		pass_leave(w, &b, as_arc_mm_s(w, &k[m], v_mm_s), &left);
		ret.a_mm_s2 = smaller(ret.a_mm_s2, left.a_mm_s2);
		ret.j_mm_s3 = smaller(ret.j_mm_s3, left.j_mm_s3);
	}
	return ret;
}

/* By the bends of the path, at the speeds that can be come to; @v2 as reach()
 * has them. */
static void soften_ways(struct pass *w, const float *v2)
{
	const struct bent_ways *k = &w->bent_ways;
	size_t n, columns;

	for (n = 0; n < k->n; n += columns) {
		const struct bent_way *at = &k->at[n];
		struct leave left;
		uint32_t behind;
		float most = 0;

		columns = of_place(at, k->n - n, &behind);
		/* Of squares the root of the most is enough. */
		for (uint32_t i = at->before; i < behind; i++) {
			const float v = v2 ? v2[i] : over_mm_s(w, i);

			most = v > most ? v : most;
		}
		if (v2)
			most = sqrtf(most);
		left = leave_of(w, at, columns, (double)most);
		pass_soften_segs(w, at->before, behind, &left);
	}
}

/* Without memory, its speed is what its segments allow. */
void pass_bent_node(struct pass *w, const struct bent_node *b)
{
	struct bent_nodes *k = &w->bent_nodes;
	size_t m;

	if (k->n == k->room &&
	    grow_array(&k->at, &k->room, sizeof(*k->at)) < 0) {
		k->lost = true;
		soften_by(w, b, (double)over_mm_s(w, b->before));
		return;
	}
	/* Beside a corner, nodes are looked at once more. */
	for (m = k->n++; m > 0 && k->at[m - 1].behind > b->behind; m--)
		k->at[m] = k->at[m - 1];
	k->at[m] = *b;
}

void pass_forget_bends(struct pass *w, uint32_t behind)
{
	struct bent_nodes *k = &w->bent_nodes;
	size_t to = k->n, from;

	while (to > 0 && k->at[to - 1].behind > behind)
		to--;
	for (from = to; from > 0 && k->at[from - 1].behind == behind; from--)
		;
	if (from < to)
		memmove(&k->at[from], &k->at[to],
			(k->n - to) * sizeof(*k->at));
	k->n -= to - from;
}

void pass_forget(struct pass *w)
{
	free(w->bent_ways.at);
	w->bent_ways = (struct bent_ways) { .n = 0 };
	free(w->bent_nodes.at);
	w->bent_nodes = (struct bent_nodes) { .n = 0 };
}

/* The slowest node near to a bent one, on one side. */
static float slowest_mm_s(const struct pass *w, const struct bent_node *b,
			   int way)
{
	const double mm = larger(b->is.near_mm, b->is.change_mm);
	float least = over_mm_s(w, b->before);

	for (int i = 1; i <= DIP_NODES; i++) {
		const int64_t node = (int64_t)b->behind + way * i;

		if (!pass_is_near(w, b, node, mm))
			break;
		least = pass_least(least, over_mm_s(w, (uint32_t)node - 1));
	}
	return least;
}

/* One node that is faster than all near to it on both sides saves no time, but
 * the faster a bend is passed the less it leaves. */
static void cut_peaks(struct pass *w)
{
	struct bent_nodes *k = &w->bent_nodes;

	for (size_t n = 0; n < k->n; n++)
		k->at[n].peak_mm_s = fmaxf(slowest_mm_s(w, &k->at[n], -1),
					   slowest_mm_s(w, &k->at[n], 1));
	/* Of a node with actions, all that it is made of. */
	for (size_t n = 0; n < k->n; n++)
		for (uint32_t i = k->at[n].before; i < k->at[n].behind; i++)
			w->segs[i].node_mm_s = pass_least(
				w->segs[i].node_mm_s, k->at[n].peak_mm_s);
}

void pass_soften(struct pass *w)
{
	struct bent_nodes *k = &w->bent_nodes;
	float *v2;

	cut_peaks(w);
	v2 = k->n + w->bent_ways.n > 0 ? reach(w) : NULL;

	for (size_t n = 0; n < k->n; n++) {
		const uint32_t at = k->at[n].before;

		soften_by(w, &k->at[n], v2 ? sqrt((double)v2[at]) :
					     (double)over_mm_s(w, at));
	}
	soften_ways(w, v2);
	free(v2);
	pass_forget(w);
}
