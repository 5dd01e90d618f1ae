/* SPDX-License-Identifier: Apache-2.0 */
/* corner.c - nodes beside a corner, whose windows show it */
#include "speed/pass.h"

/* A node is a corner if those a chord away from it are so much faster. */
#define CORNER		2

/* The windows of a node beside a corner may show it as little slower than the
 * corner itself, or as slower: they see a rounding more of it. */
#define ALIKE		1.25f

/* The square of what both lines turn by at node @i. */
static double turn_of(const struct pass *w, uint32_t i)
{
	struct headings a, b;
	double sum = 0;

	heading_of(&w->ways, i - 1, &a);
	heading_of(&w->ways, i, &b);
	for (uint32_t j = 0; j < w->n; j++) {
		const double d = b.first.rate[j] - a.last.rate[j];

		sum += a.last.along >> j & 1 ? d * d : 0;
	}
	return sum;
}

/* Which of the nodes that are about as slow as node @at, and near to it, turns
 * most by itself? */
static uint32_t sharpest(const struct pass *w, uint32_t at)
{
	const struct interp_seg *s = w->segs;
	const float v = ALIKE * s[at - 1].node_mm_s;
	double most = turn_of(w, at);
	uint32_t best = at;

	for (int way = -1; way <= 1; way += 2) {
		uint32_t k = at + (uint32_t)way;

		for (; k > w->run && k < w->run_end &&
		       pass_from_to(w, at, k) < w->near.mm &&
		       s[k - 1].kind == INTERP_LINE &&
		       s[k].kind == INTERP_LINE; k += (uint32_t)way) {
			const double turn = s[k - 1].node_mm_s <= v ?
					    turn_of(w, k) : 0;

			if (turn > most)
				best = k;
			most = larger(most, turn);
		}
	}
	return best;
}

static bool is_corner(const struct pass *w, uint32_t i)
{
	const float v = CORNER * w->segs[i - 1].node_mm_s;

	for (int way = -1; way <= 1; way += 2) {
		const uint32_t k = pass_away(w, i, way, w->near.mm);

		if (k == w->run || k >= w->run_end ||
		    !(w->segs[k - 1].node_mm_s >= v))
			return false;
	}
	return true;
}

/* Between short lines. */
static bool is_among(const struct pass *w, uint32_t i)
{
	const struct interp_seg *s = &w->segs[i];

	return s[-1].kind == INTERP_LINE && s->kind == INTERP_LINE &&
	       pass_is_short(w, i - 1) && pass_is_short(w, i);
}

/* The speed over node @i, if it is in a corner over tiny lines.  If that is the
 * corner @at, that node alone is slow. */
static double over_mm_s(struct pass *w, uint32_t at, uint32_t i)
{
	const struct interp_seg *s = w->segs;
	struct headings behind;
	uint32_t to = i, first;
	double v;

	while (s[to].kind < INTERP_BEGIN && pass_is_tiny(w, to) &&
	       pass_from_to(w, i, to) < w->near.mm)
		to++;
	if (s[to].kind >= INTERP_BEGIN || pass_is_tiny(w, to) ||
	    !pass_is_tiny(w, to - 1))
		return INFINITY;
	heading_of(&w->ways, to, &behind);
	first = to - 1;
	v = pass_over_mm_s(w, &first, to, &behind.first);
	return first < i && !(first < at && at <= to) ? v : INFINITY;
}

/* One side of a corner. */
struct beside {
	uint32_t at;			/* the corner */
	int way;			/* 1: behind it, -1: before it */
	double mm;			/* so far nodes see it */
	float most_mm_s;		/* they are no faster */
};

/* If it is faster now.  What bends there was seen over the corner. */
static void raise_node(struct pass *w, const struct beside *k, uint32_t i)
{
	struct interp_seg *s = &w->segs[i];
	struct headings h[2];
	float most;
	double v;

	for (uint32_t n = 0; n < 2; n++) {
		heading_of(&w->ways, i - 1 + n, &h[n]);
		w->a_own_mm_s2[n] = (double)w->segs[i - 1 + n].a_mm_s2;
	}
	/* They are not asked in their order. */
	w->gate.way.to_mm = -INFINITY;
	v = smaller(over_mm_s(w, k->at, i),
		    pass_node_mm_s(w, i - 1, i, &h[0].last, &h[1].first));
	most = pass_least(k->most_mm_s, (float)v);
	if (most > s[-1].node_mm_s)
		s[-1].node_mm_s = most;
	pass_forget_bends(w, i);
	if (w->bends)
		pass_note_bends(w, i - 1, i);
}

static void look_between(struct pass *w, uint32_t run, uint32_t i,
			 uint32_t run_end)
{
	w->run = run;
	w->run_end = run_end;
	w->near.behind = run;
	w->near.ahead = i;
	for (int k = 0; k < PASS_WINDOWS; k++) {
		w->windows[k].behind = w->windows[k].before = run;
		w->windows[k].ahead = w->windows[k].beyond = i;
	}
}

/* Those beside the corner on this side. */
static void raise_side(const struct pass *w, struct pass *again,
		       const struct beside *k)
{
	const uint32_t at = k->at;
	uint32_t i = at + (uint32_t)k->way;

	while (i > w->run && i < w->run_end &&
	       pass_from_to(w, at, i) < k->mm && is_among(w, i)) {
		const uint32_t far = pass_away(w, i, k->way,
					       pass_from_to(w, at, i));

		look_between(again, k->way > 0 ? at : far, i,
			     k->way > 0 ? far : at);
		raise_node(again, k, i);
		i += (uint32_t)k->way;
	}
}

/*
 * The windows of nodes beside a corner show the corner, too.  But only the
 * corner itself has to be passed slowly: a move that meets a slow place in
 * front of a slower one brakes in steps.  So windows end in the corner, and are
 * as long on the other side of the node.  What bends more slowly than that does
 * not count so near to a corner: no move is fast enough there.  A shallow
 * corner does not slow moves down so much: there, no node is faster than the
 * next one that does not see it.
 */
void pass_beside_corner(struct pass *w, uint32_t known)
{
	const double far = pass_sees_mm(w), mm = w->windows[0].mm;
	uint32_t at = w->slow;
	struct pass again;
	struct lone lone;
	bool sharp, alone;

	w->slow = 0;
	if (at == 0)
		return;
	sharp = is_corner(w, at);
	alone = pass_lone(w, at, known, &lone);
	if (!sharp && !alone)
		return;
	at = alone ? lone.at : sharpest(w, at);
	if (alone)
		w->segs[at - 1].node_mm_s = (float)lone.mm_s;
	pass_change_anew(w, pass_away(w, at, 1, far));
	again = *w;
	pass_change_anew(&again, UINT32_MAX);
	for (int n = 0; n < 2; n++)
		raise_side(w, &again, &(struct beside) {
			at, 2 * n - 1, sharp ? far : mm,
			sharp ? INFINITY : lone.beyond_mm_s[n],
		});
	w->bent_nodes = again.bent_nodes;
	w->bent_ways = again.bent_ways;
}
