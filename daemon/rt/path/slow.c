/* SPDX-License-Identifier: Apache-2.0 */
/*
 * slow.c - which ceiling of speed makes a short move the quickest
 *
 * The higher the ceiling, the less acceleration is left, and the lower the
 * speed that is come to on a way.  Where both are the same is the ceiling:
 * above it acceleration is given away for a speed that is not come to.
 */
#include "path/slow.h"
#include "path/lookahead.h"
#include "path/place.h"

#include "interp/bends.h"

#include <math.h>

/* Runs of segments looked at; if it goes farther, nothing is changed. */
#define RUNS_MAX	256

/* The way is counted in so many parts at most: an even number. */
#define PARTS_MAX	8

/* To halve the range of the ceiling: a thousandth of it is left. */
#define HALVINGS	10

/* The bends of a way, in parts of so many runs each. */
struct parts {
	struct interp_bends at[PARTS_MAX];
	int n, runs;			/* the last part has no more than the
					 * others */
	int last;			/* runs in it */
};

/* Two become one. */
static void halve(struct parts *p)
{
	for (int k = 0; k < PARTS_MAX / 2; k++) {
		p->at[k] = p->at[2 * k];
		interp_bends_join(&p->at[k], &p->at[2 * k + 1]);
	}
	p->n = PARTS_MAX / 2;
	p->runs *= 2;
	p->last = p->runs;
}

static void add(struct parts *p, const struct interp_bends *run)
{
	if (p->last == p->runs && p->n == PARTS_MAX)
		halve(p);
	if (p->last == p->runs) {
		p->at[p->n++] = INTERP_BENDS_NONE;
		p->last = 0;
	}
	interp_bends_join(&p->at[p->n - 1], run);
	p->last++;
}

/* Is the run in front of, or behind, segment @i the last one? */
static bool is_last(const struct interp_program *p, const struct ahead_move *w,
		    uint64_t i, double end_mm)
{
	return w->toward > 0 ?
	       i >= p->head->nsegs || p->segs[i].s_mm >= end_mm :
	       i == 0 || p->segs[i].s_mm <= end_mm;
}

/* Of all segments from here to @end_mm.  Return: false if none bends, or if
 * that is not known. */
static bool bends_to(const struct cycle *c, const struct ahead_move *w,
		     double end_mm, struct parts *ret)
{
	const struct interp_program *p = &c->cursor.p;
	uint64_t k = lookahead_index(c, w->toward) / INTERP_BENDS_SEGS;

	ret->n = 0;
	ret->runs = ret->last = 1;
	for (int n = 0; n < RUNS_MAX && k < p->head->nbends; n++) {
		const uint64_t edge = w->toward > 0 ? k + 1 : k;

		if (!(p->bends[k].a_mm_s2 > 0))
			return false;
		add(ret, &p->bends[k]);
		if (is_last(p, w, edge * INTERP_BENDS_SEGS, end_mm))
			return true;
		k = w->toward > 0 ? k + 1 : k - 1;
	}
	return false;
}

/* From a stand to the ceiling, or back. */
static double ramp_s(const struct mover_limits *l, double a_mm_s2)
{
	const double v = l->v_max_mm_s, a = a_mm_s2, j = l->j_max_mm_s3;

	return v * j >= a * a ? v / a + a / j : 2 * sqrt(v / j);
}

static double back_mm_s2(const struct mover_limits *l)
{
	return l->a_back_mm_s2 > 0 ? l->a_back_mm_s2 : l->a_max_mm_s2;
}

static struct mover_limits under(const struct mover_limits *l,
				 const struct parts *p, double v_mm_s)
{
	struct interp_along left = {
		fmax(l->a_max_mm_s2, l->a_back_mm_s2), l->j_max_mm_s3
	};
	struct mover_limits ret = *l;

	for (int k = 0; k < p->n; k++)
		left = interp_bends_leave(&p->at[k], v_mm_s, &left);
	ret.v_max_mm_s = v_mm_s;
	ret.a_max_mm_s2 = fmin(l->a_max_mm_s2, left.a_mm_s2);
	ret.a_back_mm_s2 = fmin(l->a_back_mm_s2, left.a_mm_s2);
	ret.j_max_mm_s3 = left.j_mm_s3;
	return ret;
}

static bool is_sound(const struct mover_limits *l)
{
	return l->v_max_mm_s > 0 && l->a_max_mm_s2 > 0 && l->j_max_mm_s3 > 0;
}

/* From a stand, on the way to a stand. */
static bool comes_to(const struct mover_limits *l, double way_mm)
{
	return is_sound(l) &&
	       l->v_max_mm_s / 2 * (ramp_s(l, l->a_max_mm_s2) +
				    ramp_s(l, back_mm_s2(l))) < way_mm;
}

/* The highest ceiling that is come to. */
static struct mover_limits choose(const struct mover_limits *l,
				  const struct parts *b, double way_mm)
{
	struct mover_limits low = under(l, b, l->v_max_mm_s);
	double from = 0, to = l->v_max_mm_s;

	if (comes_to(&low, way_mm))
		return low;
	low.v_max_mm_s = 0;
	for (int n = 0; n < HALVINGS; n++) {
		const double v = (from + to) / 2;
		const struct mover_limits at = under(l, b, v);

		if (comes_to(&at, way_mm)) {
			low = at;
			from = v;
		} else {
			to = v;
		}
	}
	return low;
}

static double time_s(const struct cycle *c, const struct mover_limits *l,
		     double way_mm)
{
	const struct interp_scurve_limits by = mover_curve(l);
	struct interp_scurve plan;

	interp_scurve_to_place(&plan, &by, c->mover.v_mm_s, c->mover.a_mm_s2,
			       way_mm);
	return plan.end_s;
}

/* Does it keep to the limits from where it begins? */
static bool is_within(const struct cycle *c, const struct ahead_move *w,
		      const struct mover_limits *l)
{
	return mover_is_standing(&c->mover) ||
	       (w->toward * c->mover.v_mm_s >= 0 &&
		fabs(c->mover.v_mm_s) <= l->v_max_mm_s);
}

void slow_limits(const struct cycle *c, const struct ahead_move *w,
		 double end_mm, struct mover_limits *l)
{
	const double way_mm = end_mm - place_mm(c);
	struct mover_limits fast = *l, slow;
	struct parts b;

	l->v_max_mm_s = INFINITY;
	if (w->stops_at_nodes || !isfinite(end_mm) ||
	    !(fabs(way_mm) > MOVER_ONTO_MM) || !bends_to(c, w, end_mm, &b))
		return;
	slow = choose(&w->l, &b, fabs(way_mm));
	if (is_sound(&slow) && is_within(c, w, &slow) &&
	    time_s(c, &slow, way_mm) < time_s(c, &fast, way_mm))
		*l = slow;
}
