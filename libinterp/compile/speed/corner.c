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
	double bend[INTERP_NAXES];	/* of each column there, in a mm */
	double all;			/* of all of them */
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

/* What the path bends by itself on this side of the corner: no node there is
 * faster than an arc of that, and no more of it counts than is certain. */
static void look_at_side(const struct pass *w, struct beside *k)
{
	const double half = pass_sees_mm(w) / 2;
	const uint32_t middle = pass_away(w, k->at, k->way, half);
	const uint32_t end = pass_away(w, middle, k->way, half);
	double most = 0, sure = 0, per_mm;
	struct weakest weakest;
	struct headings h;
	struct chord a, b;
	uint32_t moves = 0;

	heading_of(&w->ways, k->way > 0 ? k->at : k->at - 1, &h);
	pass_chord(w, k->way > 0 ? k->at : end, middle, h.first.along, &a);
	pass_chord(w, middle, k->way > 0 ? end : k->at, h.first.along, &b);
	per_mm = a.mm > 0 && b.mm > 0 ? 2 / (a.mm + b.mm) : INFINITY;
	for (uint32_t j = 0; j < w->n; j++) {
		const double turn = fabs(b.h.rate[j] - a.h.rate[j]);
		const double off = w->tol[j] * (a.per_mm + b.per_mm);

		k->bend[j] = INFINITY;
		if (isinf(per_mm) || !(h.first.along >> j & 1))
			continue;
		k->bend[j] = larger(turn - off, 0) * per_mm;
		sure += k->bend[j] * k->bend[j];
		most += turn * per_mm * turn * per_mm;
		moves |= (uint32_t)(a.h.rate[j] != 0 || turn > 0) << j;
	}
	k->all = moves ? sqrt(sure) : INFINITY;
	weakest = pass_weakest(w, moves);
	if (moves)
		k->most_mm_s = pass_least(k->most_mm_s, (float)pass_arc_mm_s(
						&weakest, sqrt(most)));
}

/* Of way @b beside a corner or over it. */
static float of_side(const struct bent_way *b, uint32_t corner, double before,
		     double behind)
{
	if (b->before >= corner)
		return (float)behind;
	return (float)(b->behind < corner ? before : larger(before, behind));
}

/* What was seen of the path's own bend so near to the corner @k was that over
 * the corner. */
static void lessen_ways(struct pass *w, const struct beside k[2])
{
	const uint32_t at = k->at, from = pass_away(w, at, -1, k->mm);
	const uint32_t to = pass_away(w, at, 1, k->mm);
	const struct bent_ways *ways = &w->bent_ways;
	const float mm = (float)w->windows[0].mm;

	for (size_t n = ways->n; n > 0 && ways->at[n - 1].before >= from; n--) {
		struct bent_way *b = &ways->at[n - 1];
		const float is = of_side(b, at, k[0].bend[b->column],
					 k[1].bend[b->column]);

		if (b->before >= to)
			continue;
		b->bend = pass_least(b->bend, is);
		b->change = pass_least(b->change, is / mm);
		b->all = pass_least(b->all, of_side(b, at, k[0].all, k[1].all));
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
	struct beside sides[2];
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
	/* No other node is slow for this corner from here on. */
	pass_dip_firm(w, at - 1, at, (double)w->segs[at - 1].node_mm_s);
	pass_change_anew(w, pass_away(w, at, 1, far));
	again = *w;
	pass_change_anew(&again, UINT32_MAX);
	for (int n = 0; n < 2; n++) {
		sides[n] = (struct beside) {
			at, 2 * n - 1, sharp ? far : mm,
			sharp ? INFINITY : lone.beyond_mm_s[n], { 0 }, 0,
		};
		look_at_side(w, &sides[n]);
		raise_side(w, &again, &sides[n]);
	}
	w->bent_nodes = again.bent_nodes;
	w->bent_ways = again.bent_ways;
	lessen_ways(w, sides);
}
