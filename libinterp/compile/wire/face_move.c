/* SPDX-License-Identifier: Apache-2.0 */
/*
 * face_move.c - the outline on the second plane: each piece moved to its side
 *
 * All pieces are moved first, and joined at their corners without regard to
 * anything else: the raw outline.  An arc round a corner is an element of it
 * like any other.  Where there is no room for an element the raw outline
 * crosses itself.  The outline of the part goes along the raw one, and changes
 * at a crossing from one element to a later one; what lies between has
 * vanished (way.c).  The changes must leave out no more than an inner corner
 * would (lost.c).
 */
#include "wire/face_move.h"

#include "interp/angle.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#define ANGLE_SLACK	1e-6		/* the rounding of a right angle */
#define TINY_PULSES	1.5		/* ends so near are one */
#define SLACK_MM	0.0002
#define SAME_MM		5e-5		/* two that touch may cross twice */
#define FAR_EDGE	3.0		/* an edge between two tapers: no
					 * farther than so many moves */

struct mover {
	struct track_work w;
	const struct face_from *from;
	const struct face *still;
	struct vec begin;		/* of the last piece, once it is cut */
};

static void lay_piece(const struct mover *k, uint32_t i, struct track_elem *ret)
{
	const struct face_piece *p = &k->still->piece[i];
	const enum face_fate fate = face_piece_moved(k->from, p->owner,
						     &ret->c);

	ret->owner = p->owner;
	ret->piece = i;
	ret->fitted = fate == FACE_FITTED;
	ret->dead = fate == FACE_GONE;
	if (ret->dead)
		ret->c = curve_line(ret->c.from, ret->c.to);
}

/* -- Corners -------------------------------------------------------------- */

struct corner {
	uint32_t a;			/* the element in front of it */
	struct vec at;			/* where the pieces meet */
	struct vec left[2];		/* of the ways to and from there */
	double turn, shift[2];
	bool same;			/* both are moved by the same */
	bool outer;			/* the moved pieces part there */
	bool edge;			/* they are prolonged until they meet */
};

static double most_of(const struct corner *c)
{
	return fmax(fabs(c->shift[0]), fabs(c->shift[1]));
}

/* From the corner to where straight moved pieces meet. */
static double reach_of(const struct corner *c)
{
	const double a = c->shift[0], b = c->shift[1];

	return sqrt(a * a + b * b - 2 * a * b * cos(c->turn)) /
	       fabs(sin(c->turn));
}

static void corner_init(struct corner *c, const struct mover *k, uint32_t i)
{
	const struct face_piece *p = &k->still->piece[i - 1];
	const struct face_piece *q = i < k->still->n ? p + 1 :
						       k->still->piece;
	const enum interp_taper_corner style = k->from->m[p->owner].corner;
	const struct vec way[2] = { curve_way(&p->c, true),
				    curve_way(&q->c, false) };

	*c = (struct corner) {
		.a = k->w.n - 1, .at = q->c.from,
		.left = { { -way[0].y, way[0].x }, { -way[1].y, way[1].x } },
		.turn = curve_turn(&p->c, &q->c),
		.shift = { p->shift_mm, q->shift_mm },
	};
	c->same = fabs(p->shift_mm - q->shift_mm) < CURVE_SAME_MM;
	c->outer = c->turn * (p->shift_mm + q->shift_mm) < 0;
	if (c->same)
		c->edge = c->outer && (style == INTERP_CORNER_SHARP ||
			  fabs(c->turn) <= ANGLE_RIGHT + ANGLE_SLACK);
	else
		c->edge = reach_of(c) <= FAR_EDGE * most_of(c);
}

static int lay_fill(struct mover *k, uint32_t a, const struct curve *c,
		    bool dead)
{
	const struct track_elem before = k->w.elem[a];
	struct track_elem *e;

	if (curve_distance(c->from, c->to) < CURVE_SAME_MM)
		return 0;
	e = track_add(&k->w);
	if (!e)
		return -ENOMEM;
	*e = (struct track_elem) { .c = *c, .owner = before.owner,
				   .piece = before.piece, .fill = true,
				   .round = true,
				   .dead = dead };
	return 0;
}

/* Does an edge make them meet?  An outer corner must not shorten them. */
static bool meet_in_edge(const struct corner *c, const struct track_elem *a,
			 const struct track_elem *b, struct vec *at)
{
	struct curve p = a->c, q = b->c;

	if (!c->edge || a->dead || b->dead || (p.arc && p.r == 0) ||
	    (q.arc && q.r == 0))
		return false;
	return curve_meet(&p, &q, c->at, at) &&
	       curve_distance(*at, c->at) <= 1.5 * reach_of(c) &&
	       (!c->same || (curve_trim(&p, p.from, *at) &&
			     curve_trim(&q, *at, q.to)));
}

/* Moved piece @i as far as an edge behind it prolongs it. */
static struct curve prolonged(const struct mover *k, uint32_t i,
			      const struct track_elem *e)
{
	struct track_elem next = { .piece = -1 };
	struct curve c = e->c;
	struct corner edge;
	struct vec at;

	if (i + 1 >= k->still->n)
		return c;
	lay_piece(k, i + 1, &next);
	corner_init(&edge, k, i + 1);
	if (!meet_in_edge(&edge, e, &next, &at) ||
	    !curve_trim(&c, c.from, at) ||
	    curve_length(&c) < curve_length(&e->c))
		return e->c;
	return c;
}

/* Find where the last element and @b, which is piece @i, cross; both are cut
 * off there.  They count as long as the edges at their other ends make them. */
static bool meet_inside(const struct mover *k, const struct corner *c,
			uint32_t i, const struct track_elem *b, struct vec *at)
{
	const struct track_elem *a = &k->w.elem[c->a];
	struct curve p = a->c;
	const struct curve q = prolonged(k, i, b);

	if (c->outer || a->dead || b->dead || (p.arc && p.r == 0) ||
	    (q.arc && q.r == 0))
		return false;
	if (!curve_trim(&p, k->begin, p.to) ||
	    curve_length(&p) < curve_length(&a->c))
		p = a->c;
	return curve_cross_near(&p, &q, c->at, at);
}

/*
 * An arc round the corner at the smaller of both distances, and straight to
 * and from it; the same on the way back.  With moves to both sides straight
 * from the one end to the other.
 */
static int lay_round(struct mover *k, const struct corner *c,
		     const struct track_elem *b)
{
	const bool first = fabs(c->shift[0]) < fabs(c->shift[1]);
	const double r = c->outer && c->shift[0] * c->shift[1] > 0 ?
			 c->shift[!first] : 0;
	const struct vec p = k->w.elem[c->a].c.to, q = b->c.from;
	const struct vec from = vec_add(c->at, r, c->left[0]);
	const struct vec to = vec_add(c->at, r, c->left[1]);
	const struct curve round = curve_round(from, to, c->at, r > 0);
	const struct curve step[2] = { curve_line(p, from),
				       curve_line(to, q) };
	const struct curve straight = curve_line(p, q);
	int err;

	if (r == 0)
		return lay_fill(k, c->a, &straight, false);
	err = lay_fill(k, c->a, &step[0], false);
	if (!err)
		err = lay_fill(k, c->a, &round, false);
	return err ? err : lay_fill(k, c->a, &step[1], false);
}

/* Join them over the corner that they had before they were moved.  These lines
 * are dead: no way goes along them. */
static int lay_dead(struct mover *k, const struct corner *c,
		    const struct track_elem *b)
{
	const struct curve to = curve_line(k->w.elem[c->a].c.to, c->at);
	const struct curve from = curve_line(c->at, b->c.from);
	const int err = lay_fill(k, c->a, &to, true);

	return err ? err : lay_fill(k, c->a, &from, true);
}

/* The last piece runs from its first corner to @to.  If it would run backwards,
 * it is dead: no way goes along it. */
static void end_piece(struct mover *k, struct vec to)
{
	struct track_elem *e = &k->w.elem[k->w.n - 1];
	struct curve c = e->c;
	const bool whole = curve_distance(k->begin, c.from) < CURVE_SAME_MM &&
			   curve_distance(to, c.to) < CURVE_SAME_MM;

	if (whole || (!e->dead && curve_trim(&c, k->begin, to))) {
		e->c = c;
		return;
	}
	e->c = curve_line(k->begin, to);
	e->dead = true;
}

/* Join the last element to @b, the moved piece @i; behind the last piece comes
 * the first one. */
static int lay_corner(struct mover *k, uint32_t i, const struct track_elem *b)
{
	const struct track_elem a = k->w.elem[k->w.n - 1];
	const double gap = curve_distance(a.c.to, b->c.from);
	struct corner c;
	struct vec at;
	bool kink;

	corner_init(&c, k, i);
	kink = fabs(c.turn) < 0.1 && !a.dead && !b->dead &&
	       (gap < TINY_PULSES * k->from->pulse_mm ||
		most_of(&c) * c.turn * c.turn < SLACK_MM);
	if (a.fitted || b->fitted)
		at = a.fitted ? a.c.to : b->c.from;
	else if (gap < CURVE_SAME_MM)
		at = a.c.to;
	else if (!meet_in_edge(&c, &a, b, &at) &&
		 !meet_inside(k, &c, i, b, &at)) {
		end_piece(k, a.c.to);
		k->begin = b->c.from;
		return c.outer || kink || (!c.same && !c.edge) ?
		       lay_round(k, &c, b) : lay_dead(k, &c, b);
	}
	end_piece(k, at);
	k->begin = at;
	return 0;
}

/* A closed outline has a corner where it begins, too. */
static int close_outline(struct mover *k)
{
	struct track_elem *e, b = k->w.elem[0];
	int err = lay_corner(k, k->still->n, &b);

	e = &k->w.elem[0];
	b = *e;
	if (err || curve_distance(k->begin, b.c.from) < CURVE_SAME_MM)
		return err;
	if (!b.dead && curve_trim(&b.c, k->begin, b.c.to)) {
		e->c = b.c;
		return 0;
	}
	e->c = curve_line(k->begin, e->c.to);
	e->dead = true;
	return 0;
}

static int lay_all(struct mover *k)
{
	const struct face *f = k->still;
	const struct face_piece *last = &f->piece[f->n - 1];
	/* Between two tapers the wire does not come along the step. */
	const bool closes = f->closed && f->n > 1 && !f->piece[0].lead &&
			    !last->lead &&
			    last->shift_mm == f->piece[0].shift_mm;

	int err = 0;

	k->w.n = k->w.nhits = k->w.nruns = 0;
	for (uint32_t i = 0; !err && i < k->still->n; i++) {
		struct track_elem b = { .piece = i }, *e;

		lay_piece(k, i, &b);
		if (i)
			err = lay_corner(k, i, &b);
		else
			k->begin = b.c.from;
		e = err ? NULL : track_add(&k->w);
		if (e)
			*e = b;
		else if (!err)
			err = -ENOMEM;
	}
	if (err)
		return err;
	if (closes)
		return close_outline(k);
	end_piece(k, k->w.elem[k->w.n - 1].c.to);
	return 0;
}

/* -- The outline ---------------------------------------------------------- */

/* Rounding parts the ends where two nearly touch: they meet half way. */
static void close_gap(struct face_piece *p, struct face_piece *q)
{
	const struct vec at = { (p->c.to.x + q->c.from.x) / 2,
				(p->c.to.y + q->c.from.y) / 2 };

	p->c.to = q->c.from = at;
}

static int take_runs(struct face *f, const struct mover *k)
{
	for (uint32_t i = 0; i < k->w.nruns; i++) {
		const struct track_run *r = &k->w.run[i];
		const struct track_elem *e = &k->w.elem[r->elem];
		const struct curve c = curve_part(&e->c, r->t[0], r->t[1]);
		struct face_piece *p;

		if (curve_length(&c) < CURVE_SAME_MM &&
		    !(e->c.arc && e->c.r == 0))
			continue;
		p = face_add(f, k->from, e->owner, &c, e->fitted);
		if (!p)
			return -ENOMEM;
		p->fill = e->fill;
		if (f->n > 1)
			close_gap(p - 1, p);
	}
	return 0;
}

static int find_outline(struct mover *k, struct face_side *side,
			struct face_fault *fault)
{
	struct track_fault bad = { .a = 0 };
	int err = lay_all(k);

	if (!err)
		err = face_side_init(side, &k->w);
	if (!err)
		err = clear_find_crossings(&k->w);
	if (!err)
		err = way_find(&k->w, &bad);
	if (err == -EINVAL) {
		fault->a = bad.a < bad.b ? bad.a : bad.b;
		fault->b = bad.a < bad.b ? bad.b : bad.a;
	} else if (err == -E2BIG) {
		*fault = (struct face_fault) {
			k->from->first, k->from->first + k->from->n - 1, true,
		};
		err = -EINVAL;
	}
	return err;
}

int face_move(struct face *f, const struct face_from *from,
	      const struct face *still, struct face_fault *fault)
{
	const struct track_job job = { .face = still, .side = 1,
				       .pulse_mm = from->pulse_mm };
	struct face_side side = { .n = 0 };
	struct mover k = {
		.w = { .job = &job, .sides = &side, .slack_mm = SLACK_MM,
		       .same_mm = SAME_MM },
		.from = from, .still = still,
	};
	int err;

	*fault = (struct face_fault) { .a = 0 };
	for (uint32_t i = 0; i < still->n; i++)
		k.w.reach_mm = fmax(k.w.reach_mm,
				    fabs(still->piece[i].shift_mm));
	err = find_outline(&k, &side, fault);
	face_side_free(&side);
	if (!err)
		err = take_runs(f, &k);
	track_forget(&k.w);
	/* All of it has vanished. */
	if (!err && f->n == 0) {
		*fault = (struct face_fault) { from->first,
					       from->first + from->n - 1,
					       false };
		err = -EINVAL;
	}
	return err;
}
