/* SPDX-License-Identifier: Apache-2.0 */
/*
 * change.c - how fast short lines may be passed whose bend changes
 *
 * Where a path bends by k in a mm, and that changes by k' in a mm, the axes
 * that make its length take a jerk of v^3 k', square to the path.  Where it
 * bends to and fro a little, that is more than all that its radius asks for.
 *
 * A step of the bend may also be rounded off within corner_mm (curl.c).
 *
 * The change is a difference of differences, in which roundings show most.  So
 * it is measured over one window after the other, and only what is certain
 * counts.  It is the same at nodes near to each other, and looked at by some of
 * them only.
 */
#include "speed/nearby.h"

#include <math.h>
#include <string.h>

/* Of a window, from look to look. */
#define STEP	1

/* By how much a column's bend changes over a window. */
struct change {
	double is, rounding;
	double mm;
};

struct bend {
	double is, rounding;
};

static struct bend bend_of(const struct pass *w, const struct chord *c,
			   uint32_t j)
{
	const double mm = (c[0].mm + c[1].mm) / 2;

	return (struct bend) {
		(c[1].h.rate[j] - c[0].h.rate[j]) / mm,
		w->tol[j] * (c[0].per_mm + c[1].per_mm) / mm,
	};
}

/*
 * From the bend before the node to that behind it.  What is a change on one
 * side of the node only is a corner beside it.
 */
static struct change change_of(const struct pass *w, const struct bows *k,
			       uint32_t j)
{
	const bool from = k->chord[0].mm > 0, to = k->chord[3].mm > 0;
	const struct bend at = bend_of(w, &k->chord[1], j);
	const struct bend a = from ? bend_of(w, &k->chord[0], j) : at;
	const struct bend b = to ? bend_of(w, &k->chord[2], j) : at;
	struct change ret = {
		fabs(b.is - a.is), a.rounding + b.rounding,
		(from ? k->chord[1].mm : 0) + (to ? k->chord[2].mm : 0),
	};

	if (from && to)
		ret.is = smaller(ret.is, 2 * smaller(fabs(at.is - a.is),
						     fabs(b.is - at.is)));
	return ret;
}

static double follows_mm_s(const struct pass *w, uint32_t j, double step,
			   double mm)
{
	return larger(cbrt(PASS_CHANGE_SHARE * w->j_mm_s3[j] * mm / step),
		      sqrt(w->curl_mm_s2[j] / step));
}

/* The last node from @from on that is at least @mm before node @i; @from, if
 * none is. */
static uint32_t back(const struct pass *w, uint32_t from, uint32_t i, double mm)
{
	const double most = w->segs[i].s_mm - mm;

	while (from + 1 < i) {
		const uint32_t k = from + (i - from) / 2;

		if (w->segs[k].s_mm <= most)
			from = k;
		else
			i = k;
	}
	return from;
}

/* What near_look() and pass_bows() would come to node by node. */
static void catch_up(const struct pass *w, uint32_t i, struct around *k)
{
	const uint32_t run = w->run;

	k->behind = back(w, k->behind > run ? k->behind : run, i, k->mm);
	k->before = back(w, k->before > run ? k->before : run, k->behind,
			 k->mm);
}

/* One window.  No column bends more than @narrower says, which may be NULL. */
static void look(struct pass *w, struct look *l,
		 const struct changing *narrower, struct changing *ret)
{
	const double v = l->most_mm_s;
	struct bows k;

	*ret = (struct changing) {
		.next_mm = w->segs[l->node].s_mm + STEP * l->window->mm,
		.most_mm_s = v, .v_mm_s = INFINITY, .clear = true,
	};
	for (uint32_t j = 0; j < w->n; j++)
		ret->per_mm[j] = narrower ? narrower->per_mm[j] : INFINITY;
	catch_up(w, l->node, l->window);
	near_look(w, l->node, l->window);
	pass_bows(w, l, &k);
	if (!(k.chord[1].mm > 0 && k.chord[2].mm > 0))
		return;
	for (uint32_t j = 0; j < w->n; j++) {
		struct change c;
		double step;

		if (!(l->along >> j & 1))
			continue;
		c = change_of(w, &k, j);
		if (!(c.mm > 0))
			continue;
		step = smaller(c.is - c.rounding, ret->per_mm[j] * c.mm);
		if (step > 0)
			ret->v_mm_s = smaller(ret->v_mm_s,
					      follows_mm_s(w, j, step, c.mm));
		ret->per_mm[j] = smaller(ret->per_mm[j],
					 (c.is + c.rounding) / c.mm);
		if (v * v * v * ret->per_mm[j] > PASS_CHANGE_SHARE * w->j_mm_s3[j])
			ret->clear = false;
	}
}

/* As look().  What limits by the narrowest window may be a corner beside the
 * node: then it is none in a still narrower one. */
static void look_near(struct pass *w, struct look *l, struct changing *ret)
{
	struct around *k = l->window;
	struct changing own;

	look(w, l, NULL, ret);
	if (!(ret->v_mm_s < l->most_mm_s))
		return;
	l->window = &w->windows[PASS_CHANGE_FIRST - 1];
	look(w, l, NULL, &own);
	l->window = k;
	look(w, l, &own, ret);
}

double pass_change(struct pass *w, uint32_t i, uint32_t along,
		   double most_mm_s)
{
	struct look l = { .node = i, .along = along, .most_mm_s = most_mm_s };
	const struct changing *narrower = NULL;
	struct change_gate *gate = &w->gate;

	gate->next_mm = gate->v_mm_s = INFINITY;
	gate->most_mm_s = most_mm_s;
	for (uint32_t at = PASS_CHANGE_FIRST; at < PASS_WINDOWS; at++) {
		struct changing *c = &w->changing[at];
		const bool due = w->segs[i].s_mm >= c->next_mm ||
				 most_mm_s > c->most_mm_s;

		l.window = &w->windows[at];
		if (due && narrower)
			look(w, &l, narrower, c);
		else if (due)
			look_near(w, &l, c);
		gate->next_mm = smaller(gate->next_mm, c->next_mm);
		gate->v_mm_s = smaller(gate->v_mm_s, c->v_mm_s);
		if (c->clear)
			break;
		narrower = c;
	}
	return gate->v_mm_s;
}

void pass_change_anew(struct pass *w)
{
	memset(w->changing, 0, sizeof(w->changing));
	w->gate.next_mm = 0;
	w->gate.node = 0;
}
