/* SPDX-License-Identifier: Apache-2.0 */
/* corner.c - nodes beside a corner, whose windows show it */
#include "speed/pass.h"

/* A node is a corner if those a chord away from it are so much faster. */
#define CORNER		2

/* The next node at least @mm from node @i, forward if @way is 1, back if -1. */
static uint32_t away(const struct pass *w, uint32_t i, int way, double mm)
{
	uint32_t k = i;

	while (k > w->run && k < w->run_end && pass_from_to(w, i, k) < mm)
		k += (uint32_t)way;
	return k;
}

static bool is_corner(const struct pass *w, uint32_t i)
{
	const float v = CORNER * w->segs[i - 1].node_mm_s;

	for (int way = -1; way <= 1; way += 2) {
		const uint32_t k = away(w, i, way, w->near.mm);

		if (k == w->run || k >= w->run_end ||
		    !(w->segs[k - 1].node_mm_s >= v))
			return false;
	}
	return true;
}

/* Between short lines, where no corner goes over tiny ones. */
static bool is_among(const struct pass *w, uint32_t i)
{
	const struct interp_seg *s = &w->segs[i];

	return s[-1].kind == INTERP_LINE && s->kind == INTERP_LINE &&
	       pass_is_short(w, i - 1) && pass_is_short(w, i) &&
	       pass_is_tiny(w, i - 1) == pass_is_tiny(w, i);
}

/* If it is faster now. */
static void raise_node(struct pass *w, uint32_t i)
{
	struct interp_seg *s = &w->segs[i];
	struct headings h[2];
	float most;
	double v;

	for (uint32_t k = 0; k < 2; k++) {
		heading_of(&w->ways, i - 1 + k, &h[k]);
		w->a_own_mm_s2[k] = (double)w->segs[i - 1 + k].a_mm_s2;
	}
	v = pass_node_mm_s(w, i - 1, i, &h[0].last, &h[1].first);
	most = isinf(v) ? INFINITY : pass_level(w, v);
	if (most <= s[-1].node_mm_s)
		return;
	s[-1].node_mm_s = most;
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

/*
 * The windows of nodes beside a corner show the corner, too.  But only the
 * corner itself has to be passed slowly: a move that meets a slow place in
 * front of a slower one brakes in steps.  So windows end in the corner, and are
 * as long on the other side of the node.  What bends more slowly than that does
 * not count so near to a corner: no move is fast enough there.
 */
void pass_beside_corner(struct pass *w)
{
	const uint32_t at = w->slow;
	struct pass again;

	w->slow = 0;
	if (at == 0 || !is_corner(w, at))
		return;
	pass_change_anew(w);
	again = *w;
	again.gate.next_mm = again.gate.most_mm_s = again.gate.v_mm_s = INFINITY;
	for (int way = -1; way <= 1; way += 2) {
		const double mm = pass_sees_mm(w);
		uint32_t i = at + (uint32_t)way;

		while (i > w->run && i < w->run_end &&
		       pass_from_to(w, at, i) < mm && is_among(w, i)) {
			const uint32_t far = away(w, i, way,
						  pass_from_to(w, at, i));

			look_between(&again, way > 0 ? at : far, i,
				     way > 0 ? far : at);
			raise_node(&again, i);
			i += (uint32_t)way;
		}
	}
	w->bent_nodes = again.bent_nodes;
}
