/* SPDX-License-Identifier: Apache-2.0 */
/*
 * lost.c - is a part of the outline missing where the way leaves something out?
 *
 * Where the way changes from one element to a later one, the wire touches the
 * outline in two places.  What lies between them is not cut.  It may be what a
 * round wire leaves in an inner corner of these two sides, and no more.
 *
 * The wire touches a side of the outline, or, where that side is too short, the
 * outer corner at its end:
 *
 *	two sides		the corner of these two
 *	a side, a corner	a step or a rib lower than the wire: the inner
 *				corner between them
 *	two corners		the mouth of a notch that is too narrow: what
 *				two sides square to the touch would hide
 */
#include "wire/track.h"

#include <math.h>

#define SAME_MM		1e-7

/* What rounding to a micrometre may hide of the outline. */
#define HIDDEN_MM	0.002

#define NO_CORNER	3.0		/* turns by more are slots */
#define SHARP		2.1		/* ... or notches, if one wall is short */
#define TANGENT		0.02		/* of neighbours that are written rounded */
#define SAME_TURN	0.001

const struct face_piece *track_piece(const struct track_work *w, uint32_t e)
{
	const struct face *f = w->job->face;
	const int64_t i = w->elem[e].piece;

	return &f->piece[i >= 0 ? i : e == 0 ? 0 : f->n - 1];
}

/* Where the wire touches on one side of a jump. */
struct touch {
	struct vec at;
	const struct face_piece *side;	/* NULL: a corner, and no side */
};

/* Piece @by places on, round the end of the outline. */
static const struct face_piece *beside(const struct track_work *w,
				       const struct face_piece *p, int by)
{
	const struct face *f = w->job->face;

	return &f->piece[(uint32_t)(p - f->piece + f->n + by) % f->n];
}

/* By element @e, from the wire at @at. */
static struct touch touch_of(const struct track_work *w, uint32_t e,
			     struct vec at)
{
	const struct face_piece *p = track_piece(w, e);
	const double len = curve_length(&p->c);
	const double slack = len > SAME_MM ? HIDDEN_MM / len : 0;
	const double t = len > SAME_MM ? curve_share(&p->c, at) : 0;

	if (w->elem[e].fill)
		return (struct touch) { p->c.to, NULL };
	return (struct touch) {
		curve_at(&p->c, fmin(fmax(t, 0), 1)),
		t < -slack || t > 1 + slack ? NULL : p,
	};
}

/* By how much the way turns in a jump. */
static double turn_of(const struct track_work *w, const struct track_jump *j)
{
	const struct curve a = curve_part(&w->elem[j->e].c, 0, j->te);
	const struct curve b = curve_part(&w->elem[j->f].c, j->tf, 1);

	return curve_turn(j->te > 0 ? &a : &w->elem[j->e].c,
			  j->tf < 1 ? &b : &w->elem[j->f].c);
}

/* The one inner corner between two places that the wire touches. */
struct inner {
	double turn;			/* 0: there is none, or several */
	const struct face_piece *wall[2];	/* its sides */
};

/* Into the corner and out of it the outline may turn round outer ones. */
static struct inner inner_between(const struct track_work *w,
				  const struct face_piece *a,
				  const struct face_piece *b)
{
	enum { BEFORE, IN, BEHIND } part = BEFORE;
	struct inner ret = { .turn = 0 };

	for (const struct face_piece *p = a, *next; p != b; p = next) {
		double turn;

		next = beside(w, p, 1);
		turn = curve_turn(&p->c, &next->c) * w->job->side;
		if (p != a && p->c.arc)
			turn += p->c.sweep * w->job->side;
		if (turn > TANGENT && part == BEHIND)
			return (struct inner) { .turn = 0 };
		if (turn > TANGENT && part == BEFORE) {
			part = IN;
			ret.wall[0] = p;
		}
		if (turn < -TANGENT && part == IN)
			part = BEHIND;
		if (part != IN)
			continue;
		ret.turn += turn;
		ret.wall[1] = next;
	}
	return ret;
}

/* The turn of the inner corner, if the wire touches enough of its walls for
 * what it leaves to be that corner's: one of them, if it is not too sharp. */
static double corner_turn(const struct track_work *w, const struct track_jump *j,
			  const struct touch *a, const struct touch *b)
{
	const struct inner c = inner_between(w, track_piece(w, j->e),
					     track_piece(w, j->f));
	const int walls = (a->side && a->side == c.wall[0]) +
			  (b->side && b->side == c.wall[1]);

	return c.turn > (walls == 2 ? NO_CORNER : SHARP) || !walls ? 0 : c.turn;
}

/* The reach where the wire does not touch two sides of a corner; 0: it does. */
static double corner_reach(const struct track_work *w,
			   const struct track_jump *j, struct vec at,
			   double wire_mm)
{
	const struct touch a = touch_of(w, j->e, at);
	const struct touch b = touch_of(w, j->f, at);
	const struct curve u = curve_line(at, a.at), v = curve_line(at, b.at);
	double turn, own;

	if (curve_length(&u) < SAME_MM || curve_length(&v) < SAME_MM)
		return 0;
	turn = fabs(curve_turn(&u, &v));
	own = corner_turn(w, j, &a, &b);
	if (a.side && b.side && own < turn + SAME_TURN)
		return 0;
	turn = fmax(turn, own);
	return turn < NO_CORNER ? wire_mm / cos(turn / 2) : wire_mm;
}

/* How far the wire's axis is from the corner of the outline, if what it
 * changes between are two sides of one. */
static double reach_of(const struct track_work *w, const struct track_jump *j,
		       struct vec at)
{
	const struct face_piece *p = track_piece(w, j->e);
	const struct face_piece *q = track_piece(w, j->f);
	const double d = fmax(p->wire_mm, q->wire_mm);
	const double other = fmin(p->wire_mm, q->wire_mm);
	const double turn = turn_of(w, j);
	double reach = corner_reach(w, j, at, d);
	struct vec corner;

	if (turn * w->job->side <= 0 || fabs(turn) > 3.14)
		return d;
	if (reach > 0)
		return reach;
	reach = d / cos(turn / 2);
	if (d - other > 1e-6 && fabs(sin(turn)) > 0.05)
		reach = fmax(reach, sqrt(d * d + other * other -
					 2 * d * other * cos(turn)) /
				    fabs(sin(turn)));
	if ((p->c.arc || q->c.arc) &&
	    curve_meet(&p->c, &q->c, at, &corner) &&
	    curve_distance(at, corner) < 3 * reach)
		reach = fmax(reach, curve_distance(at, corner));
	return reach;
}

static bool is_hidden(const struct track_work *w, const struct track_jump *j,
		      double reach, struct vec at)
{
	const double most = reach + HIDDEN_MM + w->slack_mm;
	struct curve part = curve_part(&w->elem[j->e].c, j->e_from, j->te);

	if (curve_from(&part, at) <= most)
		return true;
	part = curve_part(&w->elem[j->f].c, j->tf, 1);
	return curve_from(&part, at) <= most;
}

bool lost_is(const struct track_work *w, const struct track_jump *j)
{
	const struct face *f = w->job->face;
	const struct vec at = curve_at(&w->elem[j->e].c, j->te);
	const double reach = reach_of(w, j, at);
	const int64_t first = track_piece(w, j->e) - f->piece;
	const int64_t last = track_piece(w, j->f) - f->piece;
	const int64_t n = last - first + (last < first ? f->n : 0);

	if (n <= 1)
		return false;
	for (int64_t i = 0; i < n; i++) {
		const struct curve *c = &f->piece[(first + i) % f->n].c;

		if (!is_hidden(w, j, reach, c->to))
			return true;
		for (int s = 1; i && c->arc && s < 4; s++) {
			if (!is_hidden(w, j, reach, curve_at(c, s / 4.0)))
				return true;
		}
	}
	return false;
}
