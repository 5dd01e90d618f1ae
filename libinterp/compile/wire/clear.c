/* SPDX-License-Identifier: Apache-2.0 */
/*
 * clear.c - where the raw track crosses itself, and how near it is to the
 *	     outline
 */
#include "wire/face_move.h"
#include "grow.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

/* Crossings that are looked at, for each element of the track. */
#define HITS_MAX	64u

static int add_hit(struct track_work *w, const struct track_hit *h)
{
	if (w->nhits == w->hits_room &&
	    grow_array(&w->hit, &w->hits_room, sizeof(*w->hit)))
		return -ENOMEM;
	w->hit[w->nhits++] = *h;
	return 0;
}

/* Neighbours share an end; that is no crossing. */
static bool is_joint(const struct curve_hit *h, uint32_t a, uint32_t b,
		     const struct curve *p, const struct curve *q)
{
	return b == a + 1 && (1 - h->t[0]) * curve_length(p) < 1e-6 &&
	       h->t[1] * curve_length(q) < 1e-6;
}

static int find_hits(void *arg, uint32_t a, uint32_t b)
{
	struct track_work *w = arg;
	const struct curve *p = &w->elem[a].c, *q = &w->elem[b].c;
	struct curve_hit hit[2];
	const int n = w->elem[a].dead || w->elem[b].dead ? 0 :
		      curve_cross(p, q, hit);
	int err = 0;

	for (int i = 0; !err && i < n; i++) {
		const struct curve_hit *h = &hit[i];

		if (is_joint(h, a, b, p, q))
			continue;
		if (w->nhits > 2 * (HITS_MAX * w->n + 1000))
			return -E2BIG;
		err = add_hit(w, &(struct track_hit) { a, b, h->t[0], h->t[1],
						      h->at });
		if (!err)
			err = add_hit(w, &(struct track_hit) {
				     b, a, h->t[1], h->t[0], h->at });
	}
	return err;
}

static int by_place(const void *a, const void *b)
{
	const struct track_hit *p = a, *q = b;

	if (p->elem != q->elem)
		return p->elem < q->elem ? -1 : 1;
	if (p->t != q->t)
		return p->t < q->t ? -1 : 1;
	if (p->other != q->other)
		return p->other < q->other ? -1 : 1;
	return p->t_other < q->t_other ? -1 : p->t_other > q->t_other;
}

static void sort_hits(struct track_work *w)
{
	uint32_t k = 0, kept = 0;

	if (w->nhits)
		qsort(w->hit, w->nhits, sizeof(*w->hit), by_place);
	for (uint32_t i = 0; i < w->nhits; i++) {
		if (kept && by_place(&w->hit[kept - 1], &w->hit[i]) == 0)
			continue;
		w->hit[kept++] = w->hit[i];
	}
	w->nhits = kept;
	for (uint32_t i = 0; i < w->n; i++) {
		while (k < w->nhits && w->hit[k].elem < i)
			k++;
		w->elem[i].hit = k;
	}
}

/* Cells about as large as an element is long, and not so small that a single
 * long one fills many of them. */
static double cell_of(const struct track_work *w, double least)
{
	double sum = 0;

	for (uint32_t i = 0; i < w->n; i++)
		sum += curve_length(&w->elem[i].c);
	return curve_max(curve_max(sum / w->n, least), 1e-4);
}

int clear_find_crossings(struct track_work *w)
{
	struct grid g;
	int err = 0;

	grid_init(&g, cell_of(w, w->reach_mm / 8), w->elem[0].c.from);
	for (uint32_t i = 0; !err && i < w->n; i++) {
		if (!w->elem[i].dead)
			err = grid_add(&g, &w->elem[i].c, i);
	}
	if (!err) {
		grid_sort(&g);
		err = grid_pairs(&g, find_hits, w);
	}
	grid_free(&g);
	if (!err)
		sort_hits(w);
	return err;
}

static int enter_outline(struct track_work *w)
{
	const struct face *f = w->job->face;
	int err = 0;

	grid_init(&w->near, cell_of(w, w->reach_mm), w->elem[0].c.from);
	for (uint32_t i = 0; !err && i < f->n; i++) {
		if (!f->piece[i].lead)
			err = grid_add(&w->near, &f->piece[i].c, i);
	}
	if (!err)
		grid_sort(&w->near);
	w->stamp = calloc(f->n, sizeof(*w->stamp));
	return err ? err : w->stamp ? 0 : -ENOMEM;
}

int clear_init(struct track_work *w)
{
	const struct face *f = w->job->face;

	for (uint32_t i = 0; i < f->n; i++) {
		const double end = f->piece[i].way_mm +
				   curve_length(&f->piece[i].c);

		w->reach_mm = curve_max(w->reach_mm, f->piece[i].wire_mm);
		w->total_mm = curve_max(w->total_mm, end);
	}
	for (uint32_t i = 0; i < w->n; i++)
		w->elem[i].hit = 0;
	if (w->job->side == 0)
		return 0;
	const int err = clear_find_crossings(w);

	return err ? err : enter_outline(w);
}

/* -- Questions ------------------------------------------------------------ */

struct question {
	struct track_work *w;
	const struct track_elem *e;
	struct curve c;
	struct vec mid;			/* its places are no farther off */
	double half_mm;			/* than this */
	bool clear;
};

/* Along the outline from the one piece to the other. */
static double way_between(const struct track_work *w,
			  const struct face_piece *p,
			  const struct face_piece *q)
{
	const struct face_piece *a = p < q ? p : q, *b = p < q ? q : p;
	const double way = curve_max(
		b->way_mm - a->way_mm - curve_length(&a->c), 0);

	if (!w->job->face->closed)
		return way;
	return curve_min(way, curve_max(w->total_mm - (b->way_mm - a->way_mm) -
			      curve_length(&b->c), 0));
}

/*
 * What is wanted of element @e beside piece @q.  Where neighbours want
 * different distances, the smaller one holds about their corner.
 */
static double wanted_of(const struct track_work *w, const struct track_elem *e,
			const struct face_piece *q)
{
	const struct face *f = w->job->face;
	const struct face_piece *p;
	double other;

	if (e->piece < 0) {
		other = curve_min(f->piece[0].wire_mm,
				  f->piece[f->n - 1].wire_mm);
		return curve_min(other, q->wire_mm);
	}
	p = &f->piece[e->piece];
	other = p->wire_mm;
	if (e->fill && e->piece + 1 < f->n)
		other = curve_min(other, p[1].wire_mm);
	if (other >= q->wire_mm || way_between(w, p, q) > w->reach_mm)
		return q->wire_mm;
	return other;
}

/*
 * A lead touches the outline where it ends: one piece of it, or both if the
 * outline is written closed.  That is no fault of an open one, nor of a lead
 * that is programmed to come through the outline from its other side.
 */
static bool is_own_end(const struct track_work *w, const struct track_elem *e,
		       uint32_t id)
{
	const struct face *f = w->job->face;

	const int lead = track_lead_of(w, (uint32_t)(e - w->elem));

	return (id == (lead ? f->n - 1 : 0) ||
		(f->written_closed && (id == 0 || id == f->n - 1))) &&
	       (!f->closed || w->job->lead[lead].through);
}

static bool ask(void *arg, uint32_t id)
{
	struct question *k = arg;
	struct track_work *w = k->w;
	const struct face_piece *q = &w->job->face->piece[id];

	if (w->stamp[id] == w->stamp_now)
		return true;
	w->stamp[id] = w->stamp_now;
	if (curve_from(&q->c, k->mid) >= q->wire_mm + k->half_mm)
		return true;
	if (k->e->piece < 0 && is_own_end(w, k->e, id))
		return true;
	if (curve_gap(&k->c, &q->c) >= wanted_of(w, k->e, q) - w->slack_mm)
		return true;
	w->blocker = id;
	k->clear = false;
	return false;
}

bool clear_is_nearly(const struct track_work *w, uint32_t e, double t0,
		     double t1)
{
	return w->sides && face_side_is_near(w->sides, w, e, t0, t1);
}

bool clear_is(struct track_work *w, uint32_t e, double t0, double t1)
{
	struct question k = { .w = w, .e = &w->elem[e], .clear = true };

	if (w->sides)
		return face_side_is(w->sides, w, e, t0, t1);
	if (k.e->dead || w->job->side == 0)
		return !k.e->dead;
	k.c = t0 == 0 && t1 == 1 ? k.e->c : curve_part(&k.e->c, t0, t1);
	k.mid = curve_at(&k.c, 0.5);
	k.half_mm = curve_length(&k.c) / 2;
	w->stamp_now++;
	grid_near(&w->near, &k.c, w->reach_mm, ask, &k);
	return k.clear;
}
