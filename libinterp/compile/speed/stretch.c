/* SPDX-License-Identifier: Apache-2.0 */
/*
 * stretch.c - where a move stands because its axes allow much less from there
 * on
 *
 * A move keeps the least acceleration and jerk of all segments that it goes
 * over.  Near a pole, or on a tiny line on which a rotary axis turns far, that
 * may be a millionth of what the rest allows, and the whole move would crawl.
 * So a program is cut into stretches, with a stand between them, where that
 * takes less time.
 *
 * Where the length of the path passes from some axes to others, from mm to
 * degrees, a move is as slow as at a corner, and what both sides allow is
 * hardly alike.  It stands there, too, if that is quicker.
 *
 * Every segment belongs to a class: from one to the next, acceleration or jerk
 * is half as much.  Softer segments between harder ones are a
 * stretch of their own, or they are not; whatever is quicker.
 */
#include "speed/pass.h"

#include <math.h>
#include <stdlib.h>

#define CLASSES_MAX	40

/* Segments @from up to, but not with, @to. */
struct stretch {
	uint32_t from, to;
	double mm, cruise_s;		/* at the speed that is allowed */
	double a_mm_s2, j_mm_s3;	/* the least */
};

struct stretches {
	struct pass *pass;
	struct interp_seg *segs;
	double a_mm_s2, j_mm_s3;	/* the most of all segments */
	double a_least, j_least;	/* and the least */
};

/* A segment with no more than one of these is of a higher class. */
struct border {
	float a_mm_s2, j_mm_s3;
};

static struct border border_of(const struct stretches *w, int c)
{
	if (c >= CLASSES_MAX)
		return (struct border) { 0, 0 };
	return (struct border) {
		(float)ldexp(w->a_mm_s2, -c - 1),
		(float)ldexp(w->j_mm_s3, -c - 1)
	};
}

/* Is any segment above class @c? */
static bool is_any(const struct stretches *w, int c)
{
	const struct border k = border_of(w, c);

	return w->a_least <= (double)k.a_mm_s2 ||
	       w->j_least <= (double)k.j_mm_s3;
}

static inline bool is_above(const struct border *k, const struct interp_seg *s)
{
	return s->a_mm_s2 <= k->a_mm_s2 || s->j_mm_s3 <= k->j_mm_s3;
}

static struct stretch none(uint32_t at)
{
	return (struct stretch) { at, at, 0, 0, INFINITY, INFINITY };
}

/*
 * About as fast as segment @s is passed.  One that is long speeds up between
 * slow nodes; short lines that go on bending are no faster than these.
 */
static double cruise_mm_s(const struct interp_seg *s)
{
	const float node = s->node_mm_s > s[-1].node_mm_s ?
			   s->node_mm_s : s[-1].node_mm_s;
	const float most = s->feed_max_mm_s;

	if (node >= most)
		return (double)most;
	return smaller((double)most,
		       sqrt((double)(node * node + s->a_mm_s2 *
				     (float)s->length_mm)));
}

/* Actions have no length. */
static void append(struct stretch *t, const struct interp_seg *s)
{
	t->to++;
	if (s->kind >= INTERP_BEGIN)
		return;
	t->mm += s->length_mm;
	t->cruise_s += s->length_mm / cruise_mm_s(s);
	t->a_mm_s2 = smaller(t->a_mm_s2, (double)s->a_mm_s2);
	t->j_mm_s3 = smaller(t->j_mm_s3, (double)s->j_mm_s3);
}

static struct stretch join(const struct stretch *a, const struct stretch *b)
{
	return (struct stretch) {
		a->from, b->to, a->mm + b->mm, a->cruise_s + b->cruise_s,
		smaller(a->a_mm_s2, b->a_mm_s2), smaller(a->j_mm_s3, b->j_mm_s3)
	};
}

/* From a stand to that speed, or back. */
static double ramp_s(const struct stretch *t, double v)
{
	const double a = t->a_mm_s2, j = t->j_mm_s3;

	return v * j >= a * a ? v / a + a / j : 2 * sqrt(v / j);
}

/* From a stand to a stand. */
static double time_s(const struct stretch *t)
{
	const double a = t->a_mm_s2, j = t->j_mm_s3;
	const double v = t->mm / t->cruise_s;
	double top, up;

	if (!(t->mm > 0))
		return 0;
	up = ramp_s(t, v);
	if (t->mm >= v * up)
		return t->cruise_s + up;
	top = a * (sqrt(a * a / (j * j) + 4 * t->mm / a) - a / j) / 2;
	if (top * j >= a * a)
		return 2 * (top / a + a / j);
	return 4 * cbrt(t->mm / (2 * j));
}

/* In [@from, @to). */
static bool has_stands(const struct stretches *w, uint32_t from, uint32_t to)
{
	for (uint32_t i = from; i + 1 < to; i++)
		if (w->segs[i].flags & INTERP_SEG_STAND)
			return true;
	return false;
}

static void take_stands(struct stretches *w, uint32_t from, uint32_t to)
{
	for (uint32_t i = from; i + 1 < to; i++)
		pass_set_stand(w->pass, i, false);
}

/* From @from on, as long as the class is @c, or as long as it is above it. */
static struct stretch run(const struct stretches *w, uint32_t from, uint32_t to,
			  int c, bool above)
{
	const struct border k = border_of(w, c);
	struct stretch t = none(from);

	while (t.to < to && (w->segs[t.to].kind >= INTERP_BEGIN ||
			     is_above(&k, &w->segs[t.to]) == above))
		append(&t, &w->segs[t.to]);
	return t;
}

/* Two softer ways may be so near to each other that stands between them would
 * take longer than one soft move over both.  Then they become one stretch. */
static struct stretch run_softer(const struct stretches *w, uint32_t from,
				 uint32_t to, int c)
{
	struct stretch t = run(w, from, to, c, true);

	while (t.to < to) {
		const struct stretch gap = run(w, t.to, to, c, false);
		const struct stretch next = run(w, gap.to, to, c, true);
		struct stretch all = join(&t, &gap);

		all = join(&all, &next);
		if (next.to == next.from ||
		    time_s(&all) > time_s(&t) + time_s(&gap) + time_s(&next))
			break;
		t = all;
	}
	return t;
}

static struct stretch as_soft(const struct stretch *t,
			      const struct stretch *as)
{
	struct stretch soft = *t;

	soft.a_mm_s2 = as->a_mm_s2;
	soft.j_mm_s3 = as->j_mm_s3;
	return soft;
}

/* What it saves not to stand between two ways that are as soft as @as. */
static double pass_s(const struct stretches *w, const struct stretch *a,
		     const struct stretch *b, const struct stretch *as)
{
	double v;

	if (!(a->mm > 0 && b->mm > 0))
		return 0;
	v = smaller(a->mm / a->cruise_s, b->mm / b->cruise_s);
	v = smaller(v, (double)w->segs[b->from - 1].node_mm_s);
	return ramp_s(as, v);
}

/* The time of [@from, @to) as one move, @all.  Where a slow way lies between
 * faster ones it slows down and sets off again as softly. */
static double one_move_s(const struct stretches *w, uint32_t from, uint32_t to,
			 int c, const struct stretch *all)
{
	struct stretch last = none(from);
	double sum = 0;

	for (uint32_t i = from; i < to; ) {
		const struct stretch hard = run(w, i, to, c, false);
		const struct stretch soft = run_softer(w, hard.to, to, c);
		const struct stretch one = as_soft(&hard, all);
		const struct stretch two = as_soft(&soft, all);

		sum += time_s(&one) - pass_s(w, &last, &one, all) +
		       time_s(&two) - pass_s(w, &one, &two, all);
		last = two;
		i = soft.to;
	}
	return larger(sum, time_s(all));
}

/* Put stands into [@from, @to), where it is class @c at least.  Return: the
 * time. */
static double divide(struct stretches *w, uint32_t from, uint32_t to, int c)
{
	struct stretch all = none(from);
	double sum = 0, one;

	for (uint32_t i = from; i < to; ) {
		const struct stretch hard = run(w, i, to, c, false);
		const struct stretch soft = run_softer(w, hard.to, to, c);

		all = join(&all, &hard);
		all = join(&all, &soft);
		sum += time_s(&hard);
		if (soft.to > soft.from && c < CLASSES_MAX)
			sum += divide(w, soft.from, soft.to, c + 1);
		if (hard.mm > 0 && soft.mm > 0)
			pass_set_stand(w->pass, soft.from - 1, true);
		i = soft.to;
		if (i < to)
			pass_set_stand(w->pass, i - 1, true);
	}
	one = one_move_s(w, from, to, c, &all);
	if (sum < PASS_WORTH * one)
		return sum;
	take_stands(w, from, to);
	return one;
}

/* time_s() of a stretch that does not reach its speed may be more than its
 * cruise and one ramp, by less than this. */
#define RAMP_MOST	1.1

/* What can save no tenth is not worth the time of looks. */
#define LOOK_WORTH	0.9

/*
 * May stands save enough?  No division takes less than all at the speed that is
 * allowed; and one move over all no more than that, and a ramp for each time
 * that it passes from a class to another one.  To know this takes one look at
 * each segment, and for most programs it is the answer.
 */
static bool may_pay(const struct stretches *w, uint32_t from, uint32_t to,
		    int c)
{
	const struct border k = border_of(w, c);
	struct stretch all = none(from);
	double most_mm_s = 0, ramps = 1;
	bool was = false;

	while (all.to < to) {
		const struct interp_seg *s = &w->segs[all.to];

		append(&all, s);
		if (s->kind >= INTERP_BEGIN)
			continue;
		most_mm_s = larger(most_mm_s, (double)s->feed_max_mm_s);
		ramps += is_above(&k, s) != was;
		was = is_above(&k, s);
	}
	return all.cruise_s < LOOK_WORTH * (all.cruise_s + RAMP_MOST * ramps *
				       ramp_s(&all, most_mm_s));
}

/* -- Which stands are the best -------------------------------------------- */

struct tried {
	uint32_t from, to;
	float *room;			/* of pass_stand_apart() */
	double none_s, fed_s;		/* without stands; also at F */
	double least_s;			/* stands must take less */
};

/* Begin with no stands. */
static bool try_none(struct stretches *w, struct tried *k)
{
	k->room = malloc((size_t)k->to * 5 * sizeof(*k->room));
	if (!k->room)
		return false;
	k->none_s = pass_moves_s(w->pass, k->from, k->to, false, k->room);
	k->fed_s = pass_moves_s(w->pass, k->from, k->to, true, k->room);
	k->least_s = PASS_WORTH * k->none_s;
	return true;
}

/* Are the stands that are there the best so far? */
static bool is_best(struct stretches *w, struct tried *k)
{
	double s;

	if (!has_stands(w, k->from, k->to))
		return false;
	s = pass_moves_s(w->pass, k->from, k->to, false, k->room);
	if (s >= k->least_s ||
	    pass_moves_s(w->pass, k->from, k->to, true, k->room) >=
		    pass_most_at_feed(s / k->none_s) * k->fed_s)
		return false;
	k->least_s = s;
	return true;
}

/*
 * Where the axes that move change all the way, as round an arc of short lines,
 * so does the class, and to stand at each change takes too long.  A softer way
 * may lie there all the same.  So what is hard for one class may be all of the
 * softer ones, too.  What each class comes to was estimated from means; the
 * quickest is found node by node.
 */
static void divide_all(struct stretches *w, uint32_t from, uint32_t to)
{
	struct tried k = { .from = from, .to = to };
	int best = CLASSES_MAX;

	for (int c = 0; c < CLASSES_MAX && is_any(w, c); c++) {
		if (!may_pay(w, from, to, c))
			continue;
		if (!k.room && !try_none(w, &k))
			return;
		divide(w, from, to, c);
		if (is_best(w, &k))
			best = c;
		take_stands(w, from, to);
	}
	if (!k.room)
		return;
	pass_stand_apart(w->pass, from, to, k.room);
	if (!is_best(w, &k)) {
		take_stands(w, from, to);
		if (best < CLASSES_MAX)
			divide(w, from, to, best);
	}
	free(k.room);
}

/* Up to the next node where the length passes to other axes. */
static struct stretch part(const struct stretches *w, uint32_t from,
			   uint32_t to)
{
	struct stretch t = none(from);

	do
		append(&t, &w->segs[t.to]);
	while (t.to < to && !(w->segs[t.to - 1].flags & INTERP_SEG_STAND));
	return t;
}

/* One move over both parts has the limits of the softer part all the way.  At
 * the node between them it is about as slow as a stand, so its time is counted
 * as that of two moves with these limits. */
static bool parts_pay(const struct stretches *w, const struct stretch *a,
		      const struct stretch *b)
{
	const double v = (double)w->segs[a->to - 1].node_mm_s;
	const struct stretch both = join(a, b);
	const struct stretch one = as_soft(a, &both), two = as_soft(b, &both);
	const double stand = (ramp_s(a, v) + ramp_s(b, v)) / 2;

	return time_s(a) + time_s(b) + stand < time_s(&one) + time_s(&two);
}

/* The nodes where the length passes to other axes have stands so far. */
static void divide_parts(struct stretches *w, uint32_t end)
{
	struct stretch t = part(w, 0, end);

	while (t.to < end) {
		const struct stretch next = part(w, t.to, end);

		if (parts_pay(w, &t, &next)) {
			divide_all(w, t.from, t.to);
			t = next;
			continue;
		}
		pass_set_stand(w->pass, t.to - 1, false);
		t = join(&t, &next);
	}
	divide_all(w, t.from, t.to);
}

void pass_stretches(struct pass *pass)
{
	const struct pass_soft *k = &pass->soft;
	struct stretches w = {
		pass, pass->segs, k->a_most, k->j_most, k->a_least, k->j_least
	};

	if (pass->parts)
		divide_parts(&w, pass->p->head->nsegs - 1);
	else
		divide_all(&w, 0, pass->p->head->nsegs - 1);
}
