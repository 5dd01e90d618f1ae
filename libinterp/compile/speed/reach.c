/* SPDX-License-Identifier: Apache-2.0 */
/*
 * reach.c - what bends beside the path leave, at the speeds that a move can
 * come to
 *
 * A bend takes the more of what an axis can do the faster it is passed.  Its
 * node may allow a speed that no move comes to: from the slow places behind it
 * and ahead there may be no room for that.  So the bends wait until all nodes
 * are known.
 */
#include "speed/pass.h"

#include <math.h>
#include <stdlib.h>

#define ROOM	1024

static bool moves(const struct interp_seg *s)
{
	return s->kind < INTERP_BEGIN;
}

/* The most over the node behind segment @k. */
static double over_mm_s(const struct pass *w, uint32_t k)
{
	const struct interp_seg *s = &w->segs[k];
	double v = (double)s->node_mm_s;

	if (moves(s))
		v = smaller(v, (double)s->feed_max_mm_s);
	if (k < w->end && moves(s + 1))
		v = smaller(v, (double)s[1].feed_max_mm_s);
	return v;
}

/* The square of a speed, after segment @k from another one. */
static float from(const struct pass *w, uint32_t k, float v2, float other)
{
	const struct interp_seg *s = &w->segs[k];

	if (!moves(s))
		return pass_least(v2, other);
	return pass_least(v2, other + (float)(2 * s->length_mm *
					      (double)s->a_mm_s2));
}

/* Of every node the square of the speed that can be come to, from where the
 * program begins and to its end, forward and back.  So far segments have what
 * their axes can do.  NULL: no memory. */
static float *reach(const struct pass *w)
{
	float *v2 = malloc((w->end + 1) * sizeof(*v2));

	if (!v2)
		return NULL;
	for (uint32_t k = 0; k <= w->end; k++) {
		const bool stands = k == 0 || k + 1 >= w->end;
		const double v = stands ? 0 : over_mm_s(w, k);

		v2[k] = (float)(v * v);
		if (k > 0)
			v2[k] = from(w, k, v2[k], v2[k - 1]);
	}
	for (uint32_t k = w->end; k-- > 0; )
		v2[k] = from(w, k + 1, v2[k], v2[k + 1]);
	return v2;
}

static void soften_by(struct pass *w, const struct bent_node *b, double v_mm_s)
{
	struct leave left;

	pass_leave(w, b, v_mm_s, &left);
	pass_soften_seg(w, b->before, &left);
	pass_soften_seg(w, b->behind, &left);
}

static bool make_room(struct bent_nodes *k)
{
	const size_t room = k->room ? 2 * k->room : ROOM;
	struct bent_node *at;

	if (k->n < k->room)
		return true;
	at = realloc(k->at, room * sizeof(*at));
	if (!at)
		return false;
	k->at = at;
	k->room = room;
	return true;
}

/* Without memory, its speed is what its segments allow. */
void pass_bent_node(struct pass *w, const struct bent_node *b)
{
	if (make_room(&w->bent_nodes)) {
		w->bent_nodes.at[w->bent_nodes.n++] = *b;
		return;
	}
	w->bent_nodes.lost = true;
	soften_by(w, b, over_mm_s(w, b->before));
}

void pass_forget(struct pass *w)
{
	free(w->bent_nodes.at);
	w->bent_nodes = (struct bent_nodes) { .n = 0 };
}

/* The slowest node near to a bent one, on one side. */
static double slowest_mm_s(const struct pass *w, const struct bent_node *b,
			   int way)
{
	double least = over_mm_s(w, b->before);

	for (int i = 1; i <= DIP_NODES; i++) {
		const int64_t node = (int64_t)b->behind + way * i;

		if (!pass_is_near(w, b, node))
			break;
		least = smaller(least, over_mm_s(w, (uint32_t)node - 1));
	}
	return least;
}

/* One node that is faster than all near to it on both sides saves no time, but
 * the faster a bend is passed the less it leaves. */
static void cut_peaks(struct pass *w)
{
	struct bent_nodes *k = &w->bent_nodes;

	for (size_t n = 0; n < k->n; n++)
		k->at[n].peak_mm_s = (float)larger(
			slowest_mm_s(w, &k->at[n], -1),
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
	v2 = k->n > 0 ? reach(w) : NULL;

	for (size_t n = 0; n < k->n; n++) {
		const uint32_t at = k->at[n].before;

		soften_by(w, &k->at[n], v2 ? sqrt((double)v2[at]) :
					     over_mm_s(w, at));
	}
	free(v2);
	pass_forget(w);
}
