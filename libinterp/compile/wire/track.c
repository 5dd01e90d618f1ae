/* SPDX-License-Identifier: Apache-2.0 */
/*
 * track.c - the raw track: the parallels of an outline, joined at its corners
 *
 *	tangent		the one goes on where the other ends
 *	inner corner	both are cut off where they meet, if they do
 *	outer corner	up to a right angle both are prolonged until they meet;
 *			beyond it an arc goes round the corner
 *
 * What does not meet is joined by a line that no way goes along.
 */
#include "wire/track.h"

#include "interp/angle.h"
#include "grow.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ANGLE_SLACK	1e-6
#define MITRE_TURNS	8u	/* ways found before mitres stay */

/* Ends so near are one: half a pulse of rounding on either side, and more. */
#define TINY_PULSES	1.5

struct track_elem *track_add(struct track_work *w)
{
	if (w->n == w->room && grow_array(&w->elem, &w->room, sizeof(*w->elem)))
		return NULL;
	w->elem[w->n] = (struct track_elem) { .piece = -1 };
	return &w->elem[w->n++];
}

double track_shift(const struct track_work *w, uint32_t i)
{
	if (w->sides)
		return w->job->face->piece[i].shift_mm;
	return w->job->side * w->job->face->piece[i].wire_mm;
}

/* The parallel of piece @i; a line that no way goes along if it is turned
 * inside out. */
static int lay_piece(struct track_work *w, uint32_t i)
{
	const struct face_piece *p = &w->job->face->piece[i];
	struct track_elem *e = track_add(w);

	if (!e)
		return -ENOMEM;
	e->owner = p->owner;
	e->piece = i;
	e->fill = p->fill;
	if (curve_parallel(&p->c, track_shift(w, i), &e->c))
		return 0;
	if (e->c.r > -w->slack_mm) {
		/* A wire as thick as the corner: all but a point. */
		e->c.r = 0;
		e->c.from = e->c.to = e->c.centre;
		return 0;
	}
	e->c = curve_line(e->c.from, e->c.to);
	e->dead = true;
	return 0;
}

/* -- Corners -------------------------------------------------------------- */

struct corner {
	uint32_t a;			/* the element in front of it */
	uint32_t b;			/* the piece behind it */
	struct vec at;			/* where their pieces meet */
	double turn, da, db;
};

static int lay_fill(struct track_work *w, const struct corner *k,
		    const struct curve *c, bool dead)
{
	const struct track_elem before = w->elem[k->a];
	struct track_elem *e;

	if (curve_distance(c->from, c->to) < CURVE_SAME_MM)
		return 0;
	e = track_add(w);
	if (!e)
		return -ENOMEM;
	*e = (struct track_elem) { .c = *c, .owner = before.owner,
				   .piece = before.piece, .fill = true,
				   .round = true, .dead = dead };
	return 0;
}

static int lay_round(struct track_work *w, const struct corner *k,
		     const struct track_elem *b)
{
	const struct face_piece *q = &w->job->face->piece[b->piece];
	const struct vec way = curve_way(&q->c, false);
	const struct vec at = vec_add(k->at, k->da,
				      (struct vec) { -way.y, way.x });
	const struct curve round = curve_round(w->elem[k->a].c.to, at, k->at,
					       k->da > 0);
	const struct curve step = curve_line(at, b->c.from);
	const int err = lay_fill(w, k, &round, false);

	return err ? err : lay_fill(w, k, &step, false);
}

/* The bottom of a slot as wide as the wire, but for rounding: what is left of
 * it runs back by less than the slack. */
static bool meet_behind(struct track_elem *a, struct track_elem *b,
			struct vec near, double slack_mm)
{
	struct curve q = b->c;
	struct vec at;

	if (a->dead || b->dead || a->c.arc ||
	    curve_distance(a->c.from, a->c.to) < CURVE_SAME_MM ||
	    !curve_meet(&a->c, &b->c, near, &at) ||
	    curve_distance(at, a->c.from) > slack_mm ||
	    !curve_trim(&q, at, b->c.to))
		return false;
	a->c = curve_line(a->c.from, at);
	b->c = q;
	return true;
}

/* Cut both off where they meet.  Return: false if they do not. */
static bool meet_inside(struct track_elem *a, struct track_elem *b,
			struct vec near)
{
	struct curve p = a->c, q = b->c;
	struct vec at;

	if (a->dead || b->dead || !curve_cross_near(&p, &q, near, &at) ||
	    !curve_trim(&p, a->c.from, at) || !curve_trim(&q, at, b->c.to))
		return false;
	a->c = p;
	b->c = q;
	return true;
}

/* Prolong both until they meet. */
static bool meet_outside(const struct track_work *w, const struct corner *k,
			 struct track_elem *a, struct track_elem *b)
{
	const double most = fmax(fabs(k->da), fabs(k->db));
	struct curve p = a->c, q = b->c;
	struct vec at;

	if (w->round || w->no_mitre[k->b] || a->dead || b->dead ||
	    fabs(k->turn) > ANGLE_RIGHT + ANGLE_SLACK ||
	    (p.arc && p.r == 0) || (q.arc && q.r == 0))
		return false;
	if (!curve_meet(&p, &q, k->at, &at) ||
	    curve_distance(at, k->at) > 1.5 * most / cos(k->turn / 2) ||
	    !curve_trim(&p, a->c.from, at) || !curve_trim(&q, at, b->c.to))
		return false;
	a->c = p;
	a->mitre = true;
	b->c = q;
	return true;
}

/* Join the last element to @b, the parallel of piece @i. */
static int lay_corner(struct track_work *w, uint32_t i, struct track_elem *b)
{
	const struct face_piece *p = &w->job->face->piece[i - 1], *q = p + 1;
	const struct corner k = {
		.a = w->n - 1, .b = i, .at = q->c.from,
		.turn = curve_turn(&p->c, &q->c),
		.da = track_shift(w, i - 1), .db = track_shift(w, i),
	};
	struct track_elem *a = &w->elem[k.a];
	const struct curve gap = curve_line(a->c.to, b->c.from);
	const double most = fmax(fabs(k.da), fabs(k.db));
	const bool step = fabs(k.turn) * most < 2 * fabs(k.da - k.db);
	const bool tiny = curve_length(&gap) < TINY_PULSES * w->job->pulse_mm;

	if (curve_length(&gap) < CURVE_SAME_MM || w->job->side == 0 || step ||
	    (tiny && fabs(k.turn) < 0.1))
		return lay_fill(w, &k, &gap, false);
	if (k.turn * w->job->side > 0 &&
	    fabs(k.turn) < 2 * ANGLE_RIGHT - ANGLE_SLACK) {
		if (meet_inside(a, b, k.at) ||
		    meet_behind(a, b, k.at, w->slack_mm))
			return 0;
		/* A kink so slight that the one end is clear of the other. */
		return lay_fill(w, &k, &gap,
				most * k.turn * k.turn > w->slack_mm);
	}
	return meet_outside(w, &k, a, b) ? 0 : lay_round(w, &k, b);
}

/* -- Leads ---------------------------------------------------------------- */

bool track_put_lead(struct track_work *w, int i, struct vec at)
{
	struct track_elem *e = &w->elem[track_lead_first(w, i)];
	struct curve c[LEAD_PARTS];

	if (!lead_lay(&w->job->lead[i], at, i, c))
		return false;
	for (uint32_t k = 0; k < lead_size(&w->job->lead[i]); k++) {
		e[k].c = c[k];
		e[k].dead = false;
	}
	return true;
}

/* One that cannot go to its end of the track is dead: no way goes along it. */
static void lay_lead(struct track_work *w, int i)
{
	const struct track_lead *l = &w->job->lead[i];
	const uint32_t first = track_lead_first(w, i), n = lead_size(l);
	const struct vec at = i ? w->elem[first - 1].c.to :
				  w->elem[n].c.from;

	for (uint32_t k = first; k < first + n; k++)
		w->elem[k] = (struct track_elem) {
			.c = curve_line(l->far, at), .owner = l->owner,
			.piece = -1, .dead = true,
		};
	track_put_lead(w, i, at);
}

void track_lay_leads(struct track_work *w)
{
	for (int i = 0; i < 2; i++) {
		if (w->job->lead[i].there)
			lay_lead(w, i);
	}
}

static int add_lead(struct track_work *w, int i)
{
	for (uint32_t k = lead_size(&w->job->lead[i]); k; k--) {
		if (!track_add(w))
			return -ENOMEM;
	}
	return 0;
}

/* The raw track.  Return: 0 or -ENOMEM. */
static int track_lay(struct track_work *w)
{
	int err;

	w->n = 0;
	err = add_lead(w, 0);
	for (uint32_t i = 0; !err && i < w->job->face->n; i++) {
		struct track_elem e;

		err = lay_piece(w, i);
		if (err || i == 0)
			continue;
		/* It stands behind what fills the corner in front of it. */
		e = w->elem[--w->n];
		err = lay_corner(w, i, &e);
		if (!err && track_add(w))
			w->elem[w->n - 1] = e;
		else if (!err)
			err = -ENOMEM;
	}
	if (!err)
		err = add_lead(w, 1);
	if (!err)
		track_lay_leads(w);
	return err;
}

/* -- The way as curves ---------------------------------------------------- */

void track_free(struct track *t)
{
	free(t->c);
	free(t->owner);
	free(t->fill);
	free(t->left);
	*t = (struct track) { .n = 0 };
}

static bool put(struct track *t, const struct track_elem *e,
		const struct curve *c)
{
	t->c[t->n] = *c;
	t->owner[t->n] = e->owner;
	t->fill[t->n++] = e->fill;
	return true;
}

/* Ends that rounding has parted meet half way. */
static void close_gaps(struct track *t, double pulse_mm)
{
	uint32_t n = 0;

	for (uint32_t i = 0; i < t->n; i++) {
		const bool tiny = t->fill[i] && curve_length(&t->c[i]) <
					        TINY_PULSES * pulse_mm;

		if (tiny && n > 0 && i + 1 < t->n)
			continue;
		if (n > 0 && curve_distance(t->c[n - 1].to, t->c[i].from) <
			     3 * TINY_PULSES * pulse_mm) {
			const struct vec at = {
				(t->c[n - 1].to.x + t->c[i].from.x) / 2,
				(t->c[n - 1].to.y + t->c[i].from.y) / 2,
			};

			t->c[n - 1].to = t->c[i].from = at;
		}
		t->c[n] = t->c[i];
		t->owner[n] = t->owner[i];
		t->fill[n++] = t->fill[i];
	}
	t->n = n;
}

static int take_way(struct track *t, struct track_work *w)
{
	t->c = malloc(w->nruns * sizeof(*t->c));
	t->owner = malloc(w->nruns * sizeof(*t->owner));
	t->fill = malloc(w->nruns * sizeof(*t->fill));
	if (!t->c || !t->owner || !t->fill)
		return -ENOMEM;
	for (uint32_t i = 0; i < w->nruns; i++) {
		const struct track_run *r = &w->run[i];
		const struct track_elem *e = &w->elem[r->elem];
		const struct curve part = curve_part(&e->c, r->t[0], r->t[1]);

		put(t, e, &part);
	}
	close_gaps(t, w->job->pulse_mm);
	t->left = w->left;
	t->nleft = w->nleft;
	w->left = NULL;
	return 0;
}

void track_forget(struct track_work *w)
{
	grid_free(&w->near);
	free(w->elem);
	free(w->hit);
	free(w->run);
	free(w->left);
	free(w->stamp);
	free(w->no_mitre);
}

/* Share @t of element @e as a share of its piece: below 0 and above 1 where the
 * element is prolonged. */
static double share_of(const struct track_work *w, uint32_t e, double t)
{
	const struct track_elem *k = &w->elem[e];
	const double len = curve_length(&k->c);
	const double slack = CURVE_SAME_MM / fmax(len, CURVE_SAME_MM);
	double share;

	if (k->piece < 0 || k->fill)
		return 0.5;
	share = curve_share(&w->job->face->piece[k->piece].c,
			    curve_at(&k->c, t));
	return share > -slack && share < 1 + slack ? 0.5 : share;
}

/* The mitres of run @i that the way does not go along. */
static bool give_up_mitre(struct track_work *w, uint32_t i)
{
	const struct track_run *r = &w->run[i];
	const struct track_elem *k = &w->elem[r->elem];
	const double from = share_of(w, r->elem, r->t[0]);
	const double to = share_of(w, r->elem, r->t[1]);
	const bool jump = i + 1 < w->nruns && r[1].jump;
	const bool start = r->elem && w->elem[r->elem - 1].mitre &&
			   (to < 0 || (r->jump && from < 0));
	const bool end = k->mitre && (from > 1 || (jump && to > 1));

	if (start)
		w->no_mitre[k->piece] = true;
	if (end)
		w->no_mitre[k->piece + 1] = true;
	return start || end;
}

/* What is tried in turn: nearer by rounding, then corners without points. */
static const struct attempt {
	double slack_mm;
	bool round;
} attempts[] = {
	{ 0.0002, false }, { 0.002, false }, { 0.0002, true }, { 0.002, true },
};

#define NATTEMPTS	(sizeof(attempts) / sizeof(attempts[0]))

/*
 * A mitre that the way does not go along to its point keeps the wire off what
 * lies behind the corner.  From now on an arc goes round these.
 * Return: were there any?
 */
static bool give_up_mitres(struct track_work *w)
{
	bool any = false;

	for (uint32_t i = 0; i < w->nruns; i++)
		any = give_up_mitre(w, i) || any;
	return any;
}

static int find_way(struct track_work *w, struct track_fault *fault)
{
	int err;

	grid_free(&w->near);
	free(w->stamp);
	w->stamp = NULL;
	w->nhits = w->nruns = w->nleft = 0;
	err = track_lay(w);
	if (!err)
		err = clear_init(w);
	if (err != -E2BIG)
		return err ? err : way_find(w, fault);
	*fault = (struct track_fault) {
		.kind = TRACK_CROWDED, .a = w->elem[0].owner,
		.b = w->elem[w->n - 1].owner,
	};
	return -EINVAL;
}

static int attempt(struct track *t, const struct track_job *j, uint32_t i,
		   struct track_fault *fault)
{
	struct track_work w = { .job = j, .slack_mm = attempts[i].slack_mm,
				.same_mm = CURVE_SAME_MM,
				.round = attempts[i].round };
	uint32_t turns = 0;
	int err;

	w.no_mitre = calloc(j->face->n, sizeof(*w.no_mitre));
	if (!w.no_mitre)
		return -ENOMEM;
	do
		err = find_way(&w, fault);
	while ((!err || err == -EINVAL) && turns++ < MITRE_TURNS &&
	       give_up_mitres(&w));
	if (!err)
		err = take_way(t, &w);
	track_forget(&w);
	return err;
}

int track_make(struct track *t, const struct track_job *j,
	       struct track_fault *fault)
{
	struct track_job strict = *j;
	struct track_fault first;
	int err = -EINVAL;

	strict.skip = false;
	for (uint32_t i = 0; err == -EINVAL && i < NATTEMPTS; i++) {
		err = attempt(t, &strict, i, i == 1 ? fault : &first);
	}
	for (uint32_t i = 0; err == -EINVAL && j->skip && i < NATTEMPTS; i++)
		err = attempt(t, j, i, fault);
	return err;
}
