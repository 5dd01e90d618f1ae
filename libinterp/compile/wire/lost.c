/* SPDX-License-Identifier: Apache-2.0 */
/*
 * lost.c - is a part of the outline missing where the way leaves something out?
 *
 * Where the way changes from one element to a later one, the wire stands in an
 * inner corner and touches the outline in two places.  What lies between them
 * is not cut.  That is no fault if it lies no farther from the way than the
 * point of an inner corner would.  Two corners are asked for that:
 *
 *	the corner of the tangents in the two places
 *	the corner that the outline itself makes between them: it may be the
 *	sharper one beside a step or a rib that is lower than the wire, if it
 *	is open enough, and between walls that bulge
 *
 * The outline's own corner is the most by which it turns inward on the way from
 * the one place to the other; turns to and fro, as rounding makes them, do not
 * add up.  A slot turns by half a turn, a narrow notch by nearly as much: what
 * the wire only spans of these is missing.
 */
#include "wire/track.h"

#include <math.h>

/* What rounding to a micrometre may hide of the outline. */
#define HIDDEN_MM	0.002

#define NO_CORNER	3.0		/* turns by more are slots */
#define OPEN		2.1		/* the outline's own may turn so far */
#define WOUND		3.3		/* by so much more than the way: it goes
					 * on behind a neck, as a spiral does */
#define CURVED		0.5		/* or by so much more than the way: its
					 * walls bulge */
#define ARC_PARTS	8
#define NEAR_RUNS	16u		/* of the way, on either side */

const struct face_piece *track_piece(const struct track_work *w, uint32_t e)
{
	const struct face *f = w->job->face;
	const int64_t i = w->elem[e].piece;

	return &f->piece[i >= 0 ? i : e == 0 ? 0 : f->n - 1];
}

/* Share of its piece at which element @e touches the outline, from the wire at
 * @at; 1 if it goes round the corner behind it. */
static double touch_of(const struct track_work *w, uint32_t e, struct vec at)
{
	const struct face_piece *p = track_piece(w, e);

	if (w->elem[e].fill || curve_length(&p->c) < CURVE_SAME_MM)
		return 1;
	return fmin(fmax(curve_share(&p->c, at), 0), 1);
}

/* By how much piece @p's parallel is to its left. */
static double shift_of(const struct track_work *w, const struct face_piece *p)
{
	return track_shift(w, (uint32_t)(p - w->job->face->piece));
}

/* The side to which the pieces at both ends of a jump are moved: +1 left. */
static int side_of(const struct track_work *w, const struct track_jump *j)
{
	return shift_of(w, track_piece(w, j->e)) +
	       shift_of(w, track_piece(w, j->f)) < 0 ? -1 : 1;
}

static struct curve run_of(const struct track_work *w, uint32_t i)
{
	const struct track_run *r = &w->run[i];

	return curve_part(&w->elem[r->elem].c, r->t[0], r->t[1]);
}

/* By how much the way turns in a jump, + inward.  What is shorter than rounding
 * has no direction. */
static double turn_of(const struct track_work *w, const struct track_jump *j)
{
	struct curve a = curve_part(&w->elem[j->e].c, 0, j->te);
	struct curve b = curve_part(&w->elem[j->f].c, j->tf, 1);

	if (j->te <= 0)
		a = w->elem[j->e].c;
	if (j->tf >= 1)
		b = w->elem[j->f].c;
	if (j->run) {
		uint32_t i = j->run - 1, k = j->run;

		for (a = run_of(w, i); i && curve_length(&a) < HIDDEN_MM;)
			a = run_of(w, --i);
		for (b = run_of(w, k);
		     k + 1 < w->nruns && curve_length(&b) < HIDDEN_MM;)
			b = run_of(w, ++k);
	}
	return side_of(w, j) * curve_turn(&a, &b);
}

/* What lies between the two places that the wire touches. */
struct between {
	const struct track_work *w;
	const struct track_jump *j;
	struct vec at;			/* the wire */
	uint32_t first, n;		/* pieces, the last one with them */
	double t[2];			/* shares of the first and last */
};

static const struct curve *piece_of(const struct between *k, uint32_t i)
{
	const struct face *f = k->w->job->face;

	return &f->piece[(k->first + i) % f->n].c;
}

static void between_init(struct between *k, const struct track_work *w,
			 const struct track_jump *j)
{
	const struct face *f = w->job->face;
	const int64_t first = track_piece(w, j->e) - f->piece;
	const int64_t last = track_piece(w, j->f) - f->piece;

	*k = (struct between) {
		.w = w, .j = j, .at = curve_at(&w->elem[j->e].c, j->te),
		.first = (uint32_t)first,
		.n = (uint32_t)(last - first + (last < first ? f->n : 0)) + 1,
	};
	k->t[0] = touch_of(w, j->e, k->at);
	k->t[1] = touch_of(w, j->f, k->at);
}

/* Share @s of piece @i that is left out. */
static double share_of(const struct between *k, uint32_t i, double s)
{
	const double t0 = i == 0 ? k->t[0] : 0;
	const double t1 = i + 1 == k->n ? k->t[1] : 1;

	return t0 + s * (t1 - t0);
}

/* The most by which the outline turns inward. */
static double rise_of(const struct between *k)
{
	const int side = side_of(k->w, k->j);
	double heading = 0, low = 0, rise = 0;

	for (uint32_t i = 0; i < k->n; i++) {
		const struct curve *c = piece_of(k, i);

		if (i)
			heading += side * curve_turn(piece_of(k, i - 1), c);
		low = fmin(low, heading);
		rise = fmax(rise, heading - low);
		if (c->arc)
			heading += side * c->sweep *
				   (share_of(k, i, 1) - share_of(k, i, 0));
		low = fmin(low, heading);
		rise = fmax(rise, heading - low);
	}
	return rise;
}

/* How far the point of an inner corner is from a wire in it. */
static double reach_of(const struct between *k)
{
	const double a = shift_of(k->w, track_piece(k->w, k->j->e));
	const double b = shift_of(k->w, track_piece(k->w, k->j->f));
	const double d = fmax(fabs(a), fabs(b));
	const double turn = turn_of(k->w, k->j), own = rise_of(k);
	const bool counts = own <= OPEN || (own <= turn + CURVED &&
					    own < NO_CORNER);
	const double most = fmax(turn, counts ? own : 0);
	double reach = most < NO_CORNER ? d / cos(most / 2) : d;

	if (own > turn + WOUND)
		return fmin(reach, d / cos(OPEN / 2));
	if (turn <= 0 || turn >= NO_CORNER)
		return reach;
	if (fabs(a - b) > 1e-6 && fabs(sin(turn)) > 0.05)
		reach = fmax(reach, sqrt(a * a + b * b - 2 * a * b *
					 cos(turn)) / fabs(sin(turn)));
	return reach;
}

/* Is @at no farther than @most from run @i of the way? */
static bool is_near_run(const struct track_work *w, uint32_t i, struct vec at,
			double most)
{
	const struct curve c = run_of(w, i);

	return curve_from(&c, at) <= most;
}

/* ... or from the way close to the jump, on either side of it? */
static bool is_near_way(const struct between *k, struct vec at, double most)
{
	const struct track_work *w = k->w;
	const uint32_t run = k->j->run;

	for (uint32_t i = 0; run && i < NEAR_RUNS; i++) {
		if ((i < run && is_near_run(w, run - 1 - i, at, most)) ||
		    (run + i < w->nruns && is_near_run(w, run + i, at, most)))
			return true;
	}
	return false;
}

bool lost_is(const struct track_work *w, const struct track_jump *j)
{
	struct between k;
	double most;

	between_init(&k, w, j);
	if (k.n < 2)
		return false;
	most = reach_of(&k) + HIDDEN_MM + w->slack_mm;
	for (uint32_t i = 0; i < k.n; i++) {
		const struct curve *c = piece_of(&k, i);
		const int parts = c->arc ? ARC_PARTS : 1;

		for (int s = 1; s <= parts; s++) {
			const double t = share_of(&k, i, (double)s / parts);
			const struct vec at = curve_at(c, t);

			if (curve_distance(at, k.at) > most &&
			    !is_near_way(&k, at, most))
				return true;
		}
	}
	return false;
}
