/* SPDX-License-Identifier: Apache-2.0 */
/*
 * lost.c - is a part of the outline missing where the way leaves something out?
 *
 * Where the way changes from one element to a later one, the wire touches the
 * outline in two places.  What lies between them is not cut.  It may be what a
 * round wire leaves in an inner corner of these two sides, and no more.
 *
 * The wire touches a side of the outline along its length, or, where that side
 * ends in an outer corner, that corner:
 *
 *	two sides		the corner of these two
 *	a side, a corner	a step lower than the wire: the corner of the
 *				side and the wall of the step
 *	two corners		the mouth of a notch that is too narrow: what
 *				two sides square to the touch would hide
 */
#include "wire/track.h"

#include <math.h>

#define SAME_MM		1e-7

/* What rounding to a micrometre may hide of the outline. */
#define HIDDEN_MM	0.002

#define NO_CORNER	3.0		/* turns by more are slots */

const struct face_piece *track_piece(const struct track_work *w, uint32_t e)
{
	const struct face *f = w->job->face;
	const int64_t i = w->elem[e].piece;

	return &f->piece[i >= 0 ? i : e == 0 ? 0 : f->n - 1];
}

/* Where the wire touches on one side of a jump. */
struct touch {
	struct vec at;
	const struct face_piece *wall;	/* the side, or the one behind it */
	bool corner;
};

/* Piece @by places on, round the end of the outline. */
static const struct face_piece *beside(const struct track_work *w,
				       const struct face_piece *p, int by)
{
	const struct face *f = w->job->face;

	return &f->piece[(uint32_t)(p - f->piece + f->n + by) % f->n];
}

/* From the wire at @at; @ahead: on the later side. */
static struct touch touch_of(const struct track_work *w, uint32_t e,
			     struct vec at, bool ahead)
{
	const struct face_piece *p = track_piece(w, e);
	const double len = curve_length(&p->c);
	const double slack = len > SAME_MM ? HIDDEN_MM / len : 0;
	const double t = len > SAME_MM ? curve_share(&p->c, at) : 0;
	struct touch ret = {
		.at = curve_at(&p->c, fmin(fmax(t, 0), 1)), .wall = p,
	};

	if (w->elem[e].fill || t > 1 + slack) {
		ret.at = p->c.to;
		ret.corner = true;
		ret.wall = ahead ? p : beside(w, p, 1);
	} else if (t < -slack) {
		ret.corner = true;
		ret.wall = ahead ? beside(w, p, -1) : p;
	}
	return ret;
}

/* By how much the way turns in a jump. */
static double turn_of(const struct track_work *w, const struct track_jump *j)
{
	const struct curve a = curve_part(&w->elem[j->e].c, 0, j->te);
	const struct curve b = curve_part(&w->elem[j->f].c, j->tf, 1);

	return curve_turn(j->te > 0 ? &a : &w->elem[j->e].c,
			  j->tf < 1 ? &b : &w->elem[j->f].c);
}

/* The reach where the wire touches a corner; 0: it touches two sides. */
static double corner_reach(const struct track_work *w,
			   const struct track_jump *j, struct vec at)
{
	const struct touch a = touch_of(w, j->e, at, false);
	const struct touch b = touch_of(w, j->f, at, true);
	const struct curve u = curve_line(at, a.at), v = curve_line(at, b.at);
	const double far = fmax(curve_length(&u), curve_length(&v));
	double turn, step;

	if (curve_length(&u) < SAME_MM || curve_length(&v) < SAME_MM ||
	    (!a.corner && !b.corner))
		return 0;
	turn = fabs(curve_turn(&u, &v));
	step = curve_turn(&a.wall->c, &b.wall->c) * w->job->side;
	if (a.corner != b.corner && step > turn && step < NO_CORNER)
		turn = step;
	return turn < NO_CORNER ? far / cos(turn / 2) : far;
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
	double reach = corner_reach(w, j, at);
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
