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
 * counts.  It is the same at nodes near to each other: a window moves on by its
 * own length, and keeps what it has seen.
 */
#include "speed/nearby.h"

#include <math.h>

/* The columns that are looked at, and the greatest speed that is asked for. */
struct asked {
	uint32_t along;
	double most_mm_s;
};

static const struct chord *chord_at(const struct changing *c, uint32_t at)
{
	return &c->chord[(c->first + at) & 3];
}

static double follows_mm_s(const struct pass *w, uint32_t j, double step,
			   double mm)
{
	return larger(pass_cube_root(PASS_CHANGE_SHARE * w->j_mm_s3[j] *
				     mm / step),
		      sqrt(w->curl_mm_s2[j] / step));
}

/* -- The nodes of a window ------------------------------------------------ */

/* The last node of the run that is at least @mm before node @i, or its first
 * one. */
static uint32_t before(const struct pass *w, uint32_t i, double mm)
{
	const double most = w->segs[i].s_mm - mm;
	uint32_t from = w->run;

	while (from + 1 < i) {
		const uint32_t k = from + (i - from) / 2;

		if (w->segs[k].s_mm <= most)
			from = k;
		else
			i = k;
	}
	return from;
}

/* The first node of the run that is at least @mm behind node @i, or its last
 * one.  It may be @guess nodes from there. */
static uint32_t behind(const struct pass *w, uint32_t i, double mm,
		       uint32_t guess)
{
	const uint32_t end = w->run_end < w->known ? w->run_end : w->known;
	const double least = w->segs[i].s_mm + mm;
	uint32_t k = i + guess < end ? i + guess : end;

	while (k < end && w->segs[k].s_mm < least)
		k++;
	while (k > i + 1 && w->segs[k - 1].s_mm >= least)
		k--;
	return k;
}

static void begin(const struct pass *w, uint32_t i, uint32_t along, double mm,
		  struct changing *c)
{
	const uint32_t b = before(w, i, mm), a = before(w, b, mm);

	c->node[0] = i;
	c->node[1] = behind(w, i, mm, i - b);
	c->node[2] = behind(w, c->node[1], mm, i - b);
	c->first = 0;
	pass_chord(w, a, b, along, &c->chord[0]);
	pass_chord(w, b, i, along, &c->chord[1]);
	pass_chord(w, i, c->node[1], along, &c->chord[2]);
	pass_chord(w, c->node[1], c->node[2], along, &c->chord[3]);
	c->known = true;
}

/* By one window. */
static void move_on(const struct pass *w, uint32_t along, double mm,
		    struct changing *c)
{
	const uint32_t last = c->node[2];

	c->node[2] = behind(w, last, mm, last - c->node[1]);
	c->node[0] = c->node[1];
	c->node[1] = last;
	pass_chord(w, last, c->node[2], along, &c->chord[c->first & 3]);
	c->first++;
}

/* Return: false if it is there already. */
static bool go_to(const struct pass *w, uint32_t i, uint32_t along, double mm,
		  struct changing *c)
{
	if (!c->known || i >= c->node[2] || c->chord[0].h.along != along)
		begin(w, i, along, mm, c);
	else if (i >= c->node[1])
		move_on(w, along, mm, c);
	else
		return false;
	return true;
}

/* -- What it shows -------------------------------------------------------- */

/* What the bends of all columns have in common: that before the node, at it,
 * and behind it. */
struct bends {
	double per_mm[3];		/* of the change of a rate */
	double mm;			/* from the first to the last one; 0:
					 * there are not all of them */
	double rounding;		/* of a column whose rounding is 1 */
};

static void bends_of(const struct changing *c, struct bends *ret)
{
	double rounding[3];

	*ret = (struct bends) { .mm = 0 };
	for (uint32_t n = 0; n < 4; n++)
		if (!(c->chord[n].mm > 0))
			return;
	for (uint32_t n = 0; n < 3; n++) {
		const struct chord *a = chord_at(c, n), *b = chord_at(c, n + 1);

		ret->per_mm[n] = 2 / (a->mm + b->mm);
		rounding[n] = (a->per_mm + b->per_mm) * ret->per_mm[n];
	}
	ret->mm = chord_at(c, 1)->mm + chord_at(c, 2)->mm;
	ret->rounding = rounding[0] + rounding[2];
}

static double bend(const struct changing *c, const struct bends *k, uint32_t n,
		   uint32_t j)
{
	return (chord_at(c, n + 1)->h.rate[j] - chord_at(c, n)->h.rate[j]) *
	       k->per_mm[n];
}

/*
 * From the bend before the node to that behind it.  What is a change on one
 * side of the node only is a corner beside it.
 */
static double change_of(const struct changing *c, const struct bends *k,
			uint32_t j)
{
	const double a = bend(c, k, 0, j), at = bend(c, k, 1, j);
	const double b = bend(c, k, 2, j);

	return smaller(fabs(b - a), 2 * smaller(fabs(at - a), fabs(b - at)));
}

/* No column bends more than @narrower says, which may be NULL. */
static void show(const struct pass *w, const struct asked *asked,
		 const struct changing *narrower, struct changing *c)
{
	const double v = asked->most_mm_s, vvv = v * v * v;
	struct bends k;

	bends_of(c, &k);
	c->most_mm_s = v;
	c->v_mm_s = INFINITY;
	c->clear = true;
	for (uint32_t j = 0; j < w->n; j++) {
		const double most = narrower ? narrower->per_mm[j] : INFINITY;
		const double enough = PASS_CHANGE_SHARE * w->j_mm_s3[j];
		double change, off, step;

		c->per_mm[j] = most;
		if (!(asked->along >> j & 1 && k.mm > 0))
			continue;
		change = change_of(c, &k, j);
		off = w->tol[j] * k.rounding;
		step = smaller(change - off, most * k.mm);
		if (vvv * step > enough * k.mm)
			c->v_mm_s = smaller(c->v_mm_s,
					    follows_mm_s(w, j, step, k.mm));
		c->per_mm[j] = smaller(most, (change + off) / k.mm);
		if (vvv * c->per_mm[j] > enough)
			c->clear = false;
	}
}

/* Where the narrowest window limits, that may be a corner beside the node: then
 * it is none in a still narrower one. */
static void show_near(struct pass *w, const struct asked *asked,
		      struct changing *c)
{
	struct changing *near = &w->changing[PASS_CHANGE_FIRST - 1];

	show(w, asked, NULL, c);
	if (!(c->v_mm_s < asked->most_mm_s))
		return;
	begin(w, c->node[0], asked->along,
	      w->windows[PASS_CHANGE_FIRST - 1].mm, near);
	show(w, asked, NULL, near);
	show(w, asked, near, c);
}

double pass_change(struct pass *w, uint32_t i, uint32_t along,
		   double most_mm_s)
{
	const struct asked asked = { along, most_mm_s };
	const struct changing *narrower = NULL;
	struct change_gate *gate = &w->gate;

	gate->next = UINT32_MAX;
	gate->v_mm_s = INFINITY;
	gate->most_mm_s = most_mm_s;
	for (uint32_t at = PASS_CHANGE_FIRST; at < PASS_WINDOWS; at++) {
		struct changing *c = &w->changing[at];

		if (go_to(w, i, along, w->windows[at].mm, c) ||
		    most_mm_s > c->most_mm_s) {
			if (narrower)
				show(w, &asked, narrower, c);
			else
				show_near(w, &asked, c);
		}
		if (c->node[1] < gate->next)
			gate->next = c->node[1];
		gate->v_mm_s = smaller(gate->v_mm_s, c->v_mm_s);
		if (c->clear)
			break;
		narrower = c;
	}
	return gate->v_mm_s;
}

void pass_change_anew(struct pass *w, uint32_t i)
{
	for (uint32_t at = 0; at < PASS_WINDOWS; at++)
		w->changing[at].known = false;
	w->gate.next = i;
	w->gate.node = 0;
	w->gate.most_mm_s = w->gate.v_mm_s = INFINITY;
}
