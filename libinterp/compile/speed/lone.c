/* SPDX-License-Identifier: Apache-2.0 */
/*
 * lone.c - is a slow node a lone corner?
 *
 * Its windows show a shallow corner as an arc, and those of the nodes beside it
 * do so, too.  But if the path is straight on both sides, there is no arc, and
 * the node is a corner between two lines, however short the pieces are in which
 * they are written.
 */
#include "speed/pass.h"

/* Nodes so far from the corner must be faster. */
#define FASTER		1.05f

/* So many roundings off a line are none. */
#define STRAIGHT	2

/* The middle of an arc is as far from its chord as its turn times its length,
 * by so much. */
#define SAGITTA		8

/* By so little a rounding must not bring a speed to the next level below. */
#define HARDLY		(1 + 1.0 / 128)

/* The path on one side of a corner. */
struct side {
	struct chord chord;
	double along;			/* the rounding of the path */
};

/* A node, seen along a chord. */
struct seen {
	double on, off2;		/* so far along, and from it, squared */
};

/* In the columns along. */
static struct seen seen_from(const struct pass *w, const struct chord *c,
			     uint32_t i)
{
	const int64_t *a = w->p->nodes + (uint64_t)c->from * w->n;
	const int64_t *b = w->p->nodes + (uint64_t)i * w->n;
	double sum = 0, on = 0;

	for (uint32_t j = 0; j < w->n; j++) {
		const double mm = (double)(b[j] - a[j]) * w->ways.sub_mm[j];

		if (!(c->h.along >> j & 1))
			continue;
		sum += mm * mm;
		on += mm * c->h.rate[j];
	}
	return (struct seen) { on, larger(sum - on * on, 0) };
}

/* Do the columns beside the path turn evenly, too? */
static bool is_even(const struct pass *w, const struct side *k, uint32_t i)
{
	const struct chord *c = &k->chord;
	const int64_t *a = w->p->nodes + (uint64_t)c->from * w->n;
	const int64_t *b = w->p->nodes + (uint64_t)i * w->n;
	const double way = pass_from_to(w, c->from, i);

	for (uint32_t j = 0; j < w->n; j++) {
		const double rate = c->h.rate[j];
		const double at = (double)(b[j] - a[j]) * w->ways.sub_mm[j];

		if (!(c->h.along >> j & 1) &&
		    fabs(at - rate * way) >
			    w->tol[j] + pass_off(w, j, k->along, fabs(rate)))
			return false;
	}
	return true;
}

/* Are there lines alone, straight on and never back? */
static bool is_straight(const struct pass *w, const struct side *k)
{
	const struct chord *c = &k->chord;
	const double most = STRAIGHT * k->along;
	double on = 0;

	for (uint32_t i = c->from; i < c->to; i++) {
		const struct seen is = seen_from(w, c, i);

		if (w->segs[i].kind != INTERP_LINE || is.off2 > most * most ||
		    is.on < on - most || is.on > c->mm + most ||
		    !is_even(w, k, i))
			return false;
		on = larger(on, is.on);
	}
	return true;
}

/* Which node is the farthest from the chord, of those about as near to node @at
 * as a window is wide? */
static uint32_t apex(const struct pass *w, const struct chord *c, uint32_t at)
{
	uint32_t best = c->from;
	double most = -1;

	for (uint32_t i = c->from + 1; i < c->to; i++) {
		const double off = pass_from_to(w, i, at) < w->windows[0].mm ?
				   seen_from(w, c, i).off2 : -1;

		if (off > most)
			best = i;
		most = larger(most, off);
	}
	return best;
}

/* The speed of node @k; at the ends of the run there is none. */
static float mm_s_of(const struct pass *w, uint32_t k)
{
	return k <= w->run || k >= w->run_end ? INFINITY :
						w->segs[k - 1].node_mm_s;
}

/* An arc that turns as much over both sides would not look straight. */
static bool is_no_arc(const struct pass *w, const struct side k[2])
{
	const struct chord *a = &k[0].chord, *b = &k[1].chord;
	double turn = 0;

	for (uint32_t j = 0; j < w->n; j++) {
		const double d = b->h.rate[j] - a->h.rate[j];

		turn += a->h.along >> j & 1 ? d * d : 0;
	}
	return sqrt(turn) * smaller(a->mm, b->mm) >
	       SAGITTA * STRAIGHT * k->along;
}

/* One line of many on a curve says nothing of it. */
static bool shows(const struct pass *w, const struct chord *c)
{
	return c->to - c->from > 1 || !pass_is_short(w, c->from);
}

/* Is the path straight for so far to both sides? */
static bool is_between(struct pass *w, double mm, uint32_t at, uint32_t along,
		       struct lone *ret)
{
	struct side k[2];
	struct chord all;

	pass_chord(w, pass_away(w, at, -1, mm), pass_away(w, at, 1, mm), along,
		   &all);
	ret->at = apex(w, &all, at);
	if (ret->at == all.from)
		return false;
	pass_chord(w, pass_away(w, ret->at, -1, mm), ret->at, along,
		   &k[0].chord);
	pass_chord(w, ret->at, pass_away(w, ret->at, 1, mm), along,
		   &k[1].chord);
	for (int n = 0; n < 2; n++) {
		k[n].along = pass_along_tol(w, along);
		if (!(k[n].chord.mm > 0) || !is_straight(w, &k[n]))
			return false;
	}
	ret->mm_s = shows(w, &k[0].chord) && shows(w, &k[1].chord) &&
		    is_no_arc(w, k) ?
		    pass_corner(w, &k[0].chord, &k[1].chord) : 0;
	return true;
}

bool pass_lone(struct pass *w, uint32_t at, uint32_t known, struct lone *ret)
{
	const float v = FASTER * w->segs[at - 1].node_mm_s;
	const double sees = pass_sees_mm(w);
	struct headings h;
	struct lone k;

	/* Between long lines it has its own turn already. */
	if ((!pass_is_short(w, at - 1) && !pass_is_short(w, at)) ||
	    mm_s_of(w, pass_away(w, at, 1, sees)) < v ||
	    mm_s_of(w, pass_away(w, at, -1, sees)) < v)
		return false;
	heading_of(&w->ways, at, &h);
	/* The longer both lines are, the less a rounding turns them. */
	ret->mm_s = 0;
	for (double mm = sees; mm <= w->windows[PASS_WINDOWS - 1].mm &&
			       is_between(w, mm, at, h.first.along, &k);
	     mm *= 2)
		*ret = k;
	if (!(ret->mm_s > 0))
		return false;
	for (int n = 0; n < 2; n++) {
		const uint32_t beyond = pass_away(w, ret->at, 2 * n - 1,
						  w->windows[0].mm);

		if (beyond > known)
			return false;
		ret->beyond_mm_s[n] = mm_s_of(w, beyond);
	}
	ret->mm_s = smaller(HARDLY * ret->mm_s, (double)pass_least(
			ret->beyond_mm_s[0], ret->beyond_mm_s[1]));
	return true;
}
