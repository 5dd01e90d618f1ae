/* SPDX-License-Identifier: Apache-2.0 */
/*
 * lost.c - is a part of the outline missing where the way leaves something out?
 *
 * Where the way changes from one element to a later one, the wire stands in an
 * inner corner and touches the outline in two places.  What lies between them
 * is not cut.  That is no fault if an inner corner would leave as much.  Two
 * corners are asked for that:
 *
 *	the corner that the outline itself makes between them, if it is open
 *	enough, as beside a step or a rib that is lower than the wire, and
 *	between walls that bulge: no place may be farther from the way than the
 *	point of such a corner
 *	the corner of the tangents in the two places: no place may be outside
 *	of it
 *
 * The outline's own corner is the most by which it turns inward on the way from
 * the one place to the other; turns to and fro, as rounding makes them, do not
 * add up, nor do those on both sides of a place that the wire comes to.  A slot
 * turns by half a turn, a narrow notch by nearly as much, a chamber behind a
 * neck by more: what the wire only spans of these is missing.
 */
#include "wire/track.h"

#include "interp/angle.h"

#include <math.h>

/* What rounding to a micrometre may hide of the outline. */
#define HIDDEN_MM	0.002

#define NO_CORNER	3.0		/* turns by more are slots */
#define OPEN		2.1		/* the outline's own may turn so far */
#define CURVED		0.5		/* or by so much more than the way: its
					 * walls bulge */
#define PLAIN		0.01		/* two turns are one but for rounding */
#define ARC_PARTS	8
#define NEAR_RUNS	16u		/* of the way, on either side */

const struct face_piece *track_piece(const struct track_work *w, uint32_t e)
{
	const struct face *f = w->job->face;
	const int64_t i = w->elem[e].piece;

	return &f->piece[i >= 0 ? i : track_lead_of(w, e) ? f->n - 1 : 0];
}

/* Share of its piece at which element @e touches the outline, from the wire at
 * @at, its own share @t; 1 if it goes round the corner behind it.  A lead
 * touches the outline where it ends.  The begin and the end of a circle are one
 * place: @t tells which it is. */
static double touch_of(const struct track_work *w, uint32_t e, double t,
		       struct vec at)
{
	const struct face_piece *p = track_piece(w, e);
	double share, turn;

	if (w->elem[e].piece < 0)
		return track_lead_of(w, e);
	if (w->elem[e].round || curve_length(&p->c) < CURVE_SAME_MM)
		return 1;
	share = curve_share(&p->c, at);
	turn = p->c.arc ? ANGLE_TURN / fabs(p->c.sweep) : INFINITY;
	if (isfinite(turn))
		share += turn * round((t - share) / turn);
	return fmin(fmax(share, 0), 1);
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

/* By how much the way turns from the one element to the other, + inward. */
static double turn_between(const struct track_work *w,
			   const struct track_jump *j)
{
	struct curve a = curve_part(&w->elem[j->e].c, 0, j->te);
	struct curve b = curve_part(&w->elem[j->f].c, j->tf, 1);

	if (j->te <= 0)
		a = w->elem[j->e].c;
	if (j->tf >= 1)
		b = w->elem[j->f].c;
	return side_of(w, j) * curve_turn(&a, &b);
}

/* ... and from the runs in front of the jump and behind it. */
static double turn_of_runs(const struct track_work *w,
			   const struct track_jump *j)
{
	uint32_t i = j->run - 1, k = j->run;
	struct curve a, b;

	for (a = run_of(w, i); i && curve_length(&a) < HIDDEN_MM;)
		a = run_of(w, --i);
	for (b = run_of(w, k);
	     k + 1 < w->nruns && curve_length(&b) < HIDDEN_MM;)
		b = run_of(w, ++k);
	return side_of(w, j) * curve_turn(&a, &b);
}

/*
 * By how much the way turns in a jump, + inward.  What is shorter than rounding
 * has no direction: a run of nanometres beside a jump would make a corner of
 * what is none.  But between two jumps it may be all that is left of its
 * element, and the turn of the other jump is not that of this one.
 */
static double turn_of(const struct track_work *w, const struct track_jump *j)
{
	const bool tiny = curve_length(&w->elem[j->e].c) < HIDDEN_MM ||
			  curve_length(&w->elem[j->f].c) < HIDDEN_MM;

	if (!j->run)
		return turn_between(w, j);
	return tiny ? turn_of_runs(w, j) :
		      fmin(turn_of_runs(w, j), turn_between(w, j));
}

/* What lies between the two places that the wire touches. */
struct between {
	const struct track_work *w;
	const struct track_jump *j;
	struct vec at;			/* the wire */
	double d;			/* the larger of its two distances */
	uint32_t first, n;		/* pieces, the last one with them */
	double t[2];			/* shares of the first and last */
};

/* Less than this is hidden by rounding. */
static double hidden_by(const struct track_work *w)
{
	return HIDDEN_MM + w->slack_mm;
}

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
	k->t[0] = touch_of(w, j->e, j->te, k->at);
	k->t[1] = touch_of(w, j->f, j->tf, k->at);
	k->d = fmax(fabs(shift_of(w, track_piece(w, j->e))),
		    fabs(shift_of(w, track_piece(w, j->f))));
}

/* Share @s of piece @i that is left out. */
static double share_of(const struct between *k, uint32_t i, double s)
{
	const double t0 = i == 0 ? k->t[0] : 0;
	const double t1 = i + 1 == k->n ? k->t[1] : 1;

	return t0 + s * (t1 - t0);
}

/* Is @at no farther than @most from run @i of the way? */
static bool is_near_run(const struct track_work *w, uint32_t i, struct vec at,
			double most)
{
	const struct curve c = run_of(w, i);

	return curve_from(&c, at) <= most;
}

/* ... or from the wire, or the way close to it, on either side of the jump? */
static bool is_near_way(const struct between *k, struct vec at, double most)
{
	const struct track_work *w = k->w;
	const uint32_t run = k->j->run;

	if (curve_distance(at, k->at) <= most)
		return true;
	for (uint32_t i = 0; run && i < NEAR_RUNS; i++) {
		if ((i < run && is_near_run(w, run - 1 - i, at, most)) ||
		    (run + i < w->nruns && is_near_run(w, run + i, at, most)))
			return true;
	}
	return false;
}

/* The outline's turns, + inward, and the most of them since its lowest
 * heading. */
struct turns {
	double heading, low, rise;
};

/* It turns, at a place that the wire comes to or not. */
static void turns_add(struct turns *t, double turn, bool reached)
{
	t->heading += turn;
	t->low = reached ? t->heading : fmin(t->low, t->heading);
	t->rise = fmax(t->rise, t->heading - t->low);
}

/* ... along piece @i.  Does the wire come to its end? */
static bool turns_along(struct turns *t, const struct between *k, uint32_t i,
			double most)
{
	const double from = share_of(k, i, 0), to = share_of(k, i, 1);
	const struct curve *c = piece_of(k, i);
	const struct curve part = curve_part(c, from, to);
	const int parts = c->arc ? ARC_PARTS : 1;
	const double sweep = side_of(k->w, k->j) * c->sweep * (to - from);
	bool reached = false;

	for (int s = 1; s <= parts; s++) {
		if (c->arc)
			turns_add(t, sweep / parts, false);
		reached = is_near_way(k, curve_at(&part, (double)s / parts),
				      most);
		if (reached || (!c->arc && curve_from(&part, k->at) <= most))
			t->low = t->heading;
	}
	return reached;
}

/* The most by which the outline turns inward between places that the wire comes
 * to. */
static double rise_of(const struct between *k)
{
	const int side = side_of(k->w, k->j);
	const double most = k->d + hidden_by(k->w);
	struct turns t = { 0 };
	bool reached = true;

	for (uint32_t i = 0; i < k->n; i++) {
		if (i)
			turns_add(&t, side * curve_turn(piece_of(k, i - 1),
							piece_of(k, i)),
				  reached);
		reached = turns_along(&t, k, i, most);
	}
	return t.rise;
}

/* A corner: how far from the way its places may be, and whether those beyond
 * the tangents count as well. */
struct corner {
	double most;
	bool beyond;
};

/* The corner that the wire stands in. */
static struct corner corner_of(const struct between *k)
{
	const double a = shift_of(k->w, track_piece(k->w, k->j->e));
	const double b = shift_of(k->w, track_piece(k->w, k->j->f));
	const double turn = turn_of(k->w, k->j), own = rise_of(k);
	const bool counts = own <= OPEN || (own <= turn + CURVED &&
					    own < NO_CORNER);
	const double most = fmax(turn, counts ? own : 0);
	struct corner c = {
		.most = most < NO_CORNER ? k->d / cos(most / 2) : k->d,
		.beyond = counts,
	};

	if (turn > 0 && turn < NO_CORNER && fabs(a - b) > 1e-6 &&
	    fabs(sin(turn)) > 0.05)
		c.most = fmax(c.most, sqrt(a * a + b * b - 2 * a * b *
					   cos(turn)) / fabs(sin(turn)));
	return c;
}

/* Does @at lie beyond the tangent in one of the places that the wire
 * touches? */
static bool is_beyond(const struct between *k, struct vec at)
{
	for (int i = 0; i < 2; i++) {
		const struct vec foot = curve_at(piece_of(k, i ? k->n - 1 : 0),
						 k->t[i]);
		const struct vec n = vec_add(foot, -1, k->at);
		const struct vec d = vec_add(at, -1, foot);

		if (n.x * d.x + n.y * d.y > hidden_by(k->w) *
					    curve_hypot(n.x, n.y))
			return true;
	}
	return false;
}

/* Is place @at missing?  Not if the wire comes to it. */
static bool is_missing(const struct between *k, const struct corner *c,
		       struct vec at)
{
	const double hidden = hidden_by(k->w);

	if (!c->beyond && is_beyond(k, at))
		return !is_near_way(k, at, k->d + hidden);
	return !is_near_way(k, at, c->most + hidden);
}

static bool is_any_missing(const struct between *k)
{
	const struct corner corner = corner_of(k);

	for (uint32_t i = 0; i < k->n; i++) {
		const struct curve *c = piece_of(k, i);
		const int parts = c->arc ? ARC_PARTS : 1;

		for (int s = 1; s <= parts; s++) {
			const double t = share_of(k, i, (double)s / parts);

			if (is_missing(k, &corner, curve_at(c, t)))
				return true;
		}
	}
	return false;
}

/* The corner of two straight walls, beside both of which the wire goes: it is
 * one, however sharp. */
static bool is_plain(const struct between *k)
{
	return k->n == 2 && !piece_of(k, 0)->arc && !piece_of(k, 1)->arc &&
	       fabs(rise_of(k) - turn_of(k->w, k->j)) < PLAIN;
}

bool lost_is(const struct track_work *w, const struct track_jump *j)
{
	struct between k;

	between_init(&k, w, j);
	return !is_plain(&k) && is_any_missing(&k);
}

double lost_point(const struct track_work *w, const struct track_jump *j)
{
	struct between k;

	between_init(&k, w, j);
	if (k.n != 2 || w->elem[j->e].round || w->elem[j->f].round ||
	    rise_of(&k) <= OPEN || !is_any_missing(&k))
		return 0;
	return curve_distance(piece_of(&k, 0)->to, k.at) - k.d;
}
