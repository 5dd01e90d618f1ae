/* SPDX-License-Identifier: Apache-2.0 */
/*
 * way.c - the way along the raw track that is nowhere too near to the outline
 */
#include "wire/track.h"
#include "grow.h"

#include <errno.h>
#include <math.h>

#define BACK_MAX	4096u		/* the most runs to go back if stuck */
#define BACK_REACHES	6.0		/* the same in offsets */
#define STARTS_MAX	10000u		/* crossings tried to begin at */

struct walker {
	struct track_work *w;
	struct track_fault *fault;
	uint32_t elem;			/* where it stands ... */
	double t;
	uint32_t stop_elem;		/* ... and where it ends */
	double stop_t;
	uint32_t farthest;		/* element where it was stuck */
};

/* -- Faults --------------------------------------------------------------- */

static void tell(struct walker *k, enum track_fault_kind kind,
		 const struct face_piece *p, const struct face_piece *q)
{
	*k->fault = (struct track_fault) {
		.kind = kind, .a = p->owner, .b = q->owner, .found_mm = -1,
		.wanted_mm = p->wire_mm + q->wire_mm,
	};
	if (p + 1 < q || q + 1 < p)
		k->fault->found_mm = curve_gap(&p->c, &q->c);
}

/* Lead @i has an arc that the wire cannot go round. */
static void tell_round(struct walker *k, int i)
{
	const struct track_lead *l = &k->w->job->lead[i];
	const uint32_t e = track_lead_first(k->w, i);

	*k->fault = (struct track_fault) {
		.kind = TRACK_ROUND, .a = l->owner,
		.b = track_piece(k->w, e)->owner, .found_mm = l->c.r,
		.wanted_mm = curve_distance(i ? l->c.from : l->c.to,
					    k->w->elem[e].c.to),
	};
}

/* Element @i, a lead, comes too near to the blocker. */
static void tell_lead(struct walker *k, uint32_t i)
{
	const struct track_elem *e = &k->w->elem[i];
	const struct face_piece *q = &k->w->job->face->piece[k->w->blocker];

	if (e->dead) {
		tell_round(k, track_lead_of(k->w, i));
		return;
	}
	*k->fault = (struct track_fault) {
		.kind = TRACK_LEAD, .a = e->owner, .b = q->owner,
		.found_mm = curve_gap(&e->c, &q->c), .wanted_mm = q->wire_mm,
	};
}

static void tell_stuck(struct walker *k)
{
	const struct face_piece *q = &k->w->job->face->piece[k->w->blocker];

	if (k->elem < k->farthest)
		return;
	k->farthest = k->elem;
	if (k->w->elem[k->elem].piece < 0)
		tell_lead(k, k->elem);
	else
		tell(k, TRACK_STUCK, track_piece(k->w, k->elem), q);
}

static bool is_clear(struct track_work *w, uint32_t e, double t0, double t1)
{
	if (!w->elem[e].dead && (t1 - t0) * curve_length(&w->elem[e].c) <
				w->same_mm)
		return true;
	return clear_is(w, e, t0, t1);
}

/* Is lead @i clear?  If not, element @e of it is not. */
static bool is_lead_clear(struct track_work *w, int i, uint32_t *e)
{
	const uint32_t first = track_lead_first(w, i);
	const uint32_t end = first + lead_size(&w->job->lead[i]);

	for (*e = first; *e < end; (*e)++) {
		if (!is_clear(w, *e, 0, 1))
			return false;
	}
	return true;
}

/* -- Is something lost? --------------------------------------------------- */

/* The walls: behind a corner that the wire goes round is the first of them. */
static int check_jump(struct walker *k, struct track_jump *j)
{
	const struct face *f = k->w->job->face;
	const struct face_piece *p = track_piece(k->w, j->e);
	const struct face_piece *q = track_piece(k->w, j->f);

	for (int i = 0; i < 2; i++) {
		const int lead = track_lead_of(k->w, i ? j->f : j->e);
		uint32_t e;

		if (lead < 0 || is_lead_clear(k->w, lead, &e))
			continue;
		tell_lead(k, e);
		return -EINVAL;
	}
	if (!lost_is(k->w, j))
		return 0;
	if (k->w->elem[j->e].round && p + 1 < f->piece + f->n && p + 1 != q)
		p++;
	tell(k, TRACK_LOST, p, q);
	return -EINVAL;
}

/* The fault is none: it is told. */
static int leave(struct walker *k)
{
	struct track_work *w = k->w;

	if (w->nleft == w->left_room &&
	    grow_array(&w->left, &w->left_room, sizeof(*w->left)))
		return -ENOMEM;
	w->left[w->nleft++] = *k->fault;
	return 0;
}

/* A corner in which both motions are cut off where they meet may be too sharp,
 * or too long a horn, to pass unsaid. */
static int check_point(struct walker *k, const struct track_jump *j)
{
	const double left_mm = k->w->sides ? 0 : lost_point(k->w, j);

	if (!(left_mm > 0))
		return 0;
	*k->fault = (struct track_fault) {
		.kind = TRACK_POINT, .a = track_piece(k->w, j->e)->owner,
		.b = track_piece(k->w, j->f)->owner, .found_mm = left_mm,
	};
	return leave(k);
}

static int check_jumps(struct walker *k)
{
	int err = 0;

	for (uint32_t i = 1; !err && i < k->w->nruns; i++) {
		const struct track_run *p = &k->w->run[i - 1], *q = p + 1;
		struct track_jump j = { .e = p->elem, .f = q->elem,
					.te = p->t[1], .tf = q->t[0],
					.run = i };

		err = q->jump ? check_jump(k, &j) : check_point(k, &j);
		if (err == -EINVAL && k->w->job->skip &&
		    k->fault->kind == TRACK_LOST)
			err = leave(k);
	}
	return err;
}

/* -- Along it ------------------------------------------------------------- */

static double slack_of(const struct track_work *w, uint32_t e)
{
	return w->same_mm / curve_max(curve_length(&w->elem[e].c), w->same_mm);
}

static uint32_t hits_end(const struct track_work *w, uint32_t e)
{
	return e + 1 < w->n ? w->elem[e + 1].hit : w->nhits;
}

/* The first crossing of element @e behind @t. */
static uint32_t hit_behind(const struct track_work *w, uint32_t e, double t)
{
	uint32_t lo = w->elem[e].hit, hi = hits_end(w, e);
	const double past = t + slack_of(w, e);

	while (lo < hi) {
		const uint32_t mid = lo + (hi - lo) / 2;

		if (w->hit[mid].t <= past)
			lo = mid + 1;
		else
			hi = mid;
	}
	return lo;
}

static double next_place(const struct track_work *w, uint32_t e, double t)
{
	const uint32_t i = hit_behind(w, e, t);

	return i < hits_end(w, e) ? w->hit[i].t : 1;
}

static int add_run(struct track_work *w, uint32_t e, double t, bool jump)
{
	if (w->nruns == w->runs_room &&
	    grow_array(&w->run, &w->runs_room, sizeof(*w->run)))
		return -ENOMEM;
	w->run[w->nruns++] = (struct track_run) { e, { t, t }, jump };
	return 0;
}

static bool goes_on(struct walker *k, const struct track_hit *h)
{
	const uint32_t f = h->other;

	if (f <= h->elem || f > k->stop_elem || k->w->elem[f].dead)
		return false;
	return is_clear(k->w, f, h->t_other, next_place(k->w, f, h->t_other));
}

/* Of the crossings at one place the one that leaves out least comes first. */
static uint32_t first_at(const struct track_work *w, uint32_t i, double from)
{
	const double slack = slack_of(w, w->hit[i].elem);

	while (i > w->elem[w->hit[i].elem].hit &&
	       w->hit[i - 1].t >= w->hit[i].t - slack &&
	       w->hit[i - 1].t >= from)
		i--;
	return i;
}

/* A change from run @i, from its end back over no more than @most_mm.
 * Return: the crossing, or none. */
static struct track_hit *change_from(struct walker *k, uint32_t i,
				     double most_mm)
{
	struct track_work *w = k->w;
	const struct track_run *r = &w->run[i];
	const uint32_t begin = w->elem[r->elem].hit;
	const double len = curve_max(curve_length(&w->elem[r->elem].c),
				     w->same_mm);
	const double from = curve_max(r->t[0], r->t[1] - most_mm / len) -
			    slack_of(w, r->elem);
	uint32_t end = hit_behind(w, r->elem, r->t[1]);

	while (end > begin && w->hit[end - 1].t >= from) {
		const uint32_t first = first_at(w, end - 1, from);

		for (uint32_t h = first; h < end; h++) {
			if (goes_on(k, &w->hit[h]))
				return &w->hit[h];
		}
		end = first;
	}
	return NULL;
}

/* Go on along another element, from no more than @most_mm back. */
static int change(struct walker *k, double most_mm)
{
	struct track_work *w = k->w;
	const uint32_t least = w->nruns > BACK_MAX ? w->nruns - BACK_MAX : 0;
	double back = 0;

	for (uint32_t i = w->nruns; i-- > least && back < most_mm;) {
		struct track_hit *h = change_from(k, i, most_mm - back);

		back += (w->run[i].t[1] - w->run[i].t[0]) *
			curve_length(&w->elem[w->run[i].elem].c);
		if (!h)
			continue;
		w->nruns = i + 1;
		w->run[i].t[1] = h->t;
		k->elem = h->other;
		k->t = h->t_other;
		h->other = 0;		/* it is not tried again */
		return add_run(w, k->elem, k->t, true);
	}
	return -EINVAL;
}

/* The way is not clear as far as @next: change.  Return: 1: it goes on along
 * its element, because it is nearly clear and nothing crosses it here. */
static int change_or_go(struct walker *k, double next)
{
	struct track_work *w = k->w;
	const bool nearly = clear_is_nearly(w, k->elem, k->t, next);
	int err;

	if (!nearly)
		tell_stuck(k);
	err = change(k, nearly ? w->same_mm : BACK_REACHES * w->reach_mm);
	return nearly && err == -EINVAL ? 1 : err;
}

static int walk(struct walker *k)
{
	struct track_work *w = k->w;
	int err = add_run(w, k->elem, k->t, false);

	while (err >= 0) {
		double next = next_place(w, k->elem, k->t);

		if (k->elem == k->stop_elem && next > k->stop_t &&
		    k->t <= k->stop_t + slack_of(w, k->elem))
			next = curve_max(k->stop_t, k->t);
		if (!is_clear(w, k->elem, k->t, next)) {
			err = change_or_go(k, next);
			if (err <= 0)
				continue;
		}
		k->t = w->run[w->nruns - 1].t[1] = next;
		if (k->elem == k->stop_elem && next >= k->stop_t &&
		    next - k->stop_t < 2 * slack_of(w, k->elem))
			return 0;
		if (next < 1)
			continue;
		if (k->elem == k->stop_elem)
			return -EINVAL;
		k->t = 0;
		err = add_run(w, ++k->elem, 0, false);
	}
	return err;
}

/* -- A contour begun in an inner corner ----------------------------------- */

/* Let both leads end at @at, if they are clear then. */
static bool lead_to(struct track_work *w, struct vec at)
{
	uint32_t e;

	for (int i = 0; i < 2; i++) {
		if (!track_put_lead(w, i, at) ||
		    !is_lead_clear(w, i, &e))
			return false;
	}
	return true;
}

/* May the way begin at crossing @h and end there too? */
static bool may_begin(struct walker *k, const struct track_hit *h)
{
	struct track_work *w = k->w;
	uint32_t i = hit_behind(w, h->other, h->t_other);
	double before = 0;

	/* At the end of an element nothing of it would be asked about. */
	if (h->other <= h->elem || w->elem[h->other].piece < 0 ||
	    h->t > 1 - slack_of(w, h->elem) ||
	    h->t_other < slack_of(w, h->other) ||
	    !is_clear(w, h->elem, h->t, next_place(w, h->elem, h->t)))
		return false;
	while (i-- > w->elem[h->other].hit) {
		if (w->hit[i].t < h->t_other - slack_of(w, h->other)) {
			before = w->hit[i].t;
			break;
		}
	}
	return is_clear(w, h->other, before, h->t_other) &&
	       lead_to(w, h->at);
}

/* Begin where the first part that is far enough crosses the last one. */
static int find_start(struct walker *k)
{
	struct track_work *w = k->w;
	const uint32_t in = lead_size(&w->job->lead[0]);
	int err = 0;

	for (uint32_t i = w->elem[in].hit;
	     i < w->nhits && i < STARTS_MAX; i++) {
		const struct track_hit *h = &w->hit[i];
		struct track_jump j = { .e = h->other, .f = h->elem,
					.te = h->t_other, .tf = h->t };

		if (!may_begin(k, h))
			continue;
		/* One of a loop of its own leaves all the rest out. */
		err = check_jump(k, &j);
		if (err)
			continue;
		err = check_point(k, &j);
		if (err)
			return err;
		k->elem = h->elem;
		k->t = h->t;
		k->stop_elem = h->other;
		k->stop_t = h->t_other;
		return 0;
	}
	track_lay_leads(w);
	return err;
}

/* Is the beginning of a closed outline out of reach? */
static bool begins_inside(struct track_work *w)
{
	const uint32_t in = lead_size(&w->job->lead[0]);
	const struct face *f = w->job->face;

	return f->closed && w->job->side && !f->piece[0].lead &&
	       !f->piece[f->n - 1].lead &&
	       !is_clear(w, in, 0, next_place(w, in, 0));
}

static int add_lead(struct track_work *w, int i)
{
	const uint32_t first = track_lead_first(w, i);
	int err = 0;

	for (uint32_t k = 0; !err && k < lead_size(&w->job->lead[i]); k++) {
		err = add_run(w, first + k, 0, false);
		if (!err)
			w->run[w->nruns - 1].t[1] = 1;
	}
	return err;
}

static int walk_inside(struct walker *k)
{
	int err = add_lead(k->w, 0);

	if (!err)
		err = walk(k);
	return err ? err : add_lead(k->w, 1);
}

int way_find(struct track_work *w, struct track_fault *fault)
{
	struct walker k = { .w = w, .fault = fault, .stop_elem = w->n - 1,
			    .stop_t = 1 };
	int err;

	if (begins_inside(w)) {
		err = find_start(&k);
		if (err)
			return err;
	}
	err = k.stop_elem < w->n - 1 || k.stop_t < 1 ? walk_inside(&k) :
						      walk(&k);
	return err ? err : check_jumps(&k);
}
