/* SPDX-License-Identifier: Apache-2.0 */
/*
 * face_side.c - which parts of the raw outline are the outline of the part
 *
 * The part lies on one side of its outline.  As the pieces are moved from the
 * one plane to the other, the raw outline carries the part along: how often it
 * goes round a place says whether the part is there.  So a stretch of the raw
 * outline belongs to the part if the winding number on its left is what it was
 * on the left of the piece before it was moved.  Where pieces have changed
 * places, as the walls of a rib that is thinner than they move, it is not.
 *
 * An open outline is closed over a place far away, the same before and after; a
 * place that changes from one side of this way back to the other counts one
 * turn more or less.
 */
#include "wire/face_move.h"

#include <errno.h>
#include <stdlib.h>

/* A little off the ends of a piece. */
#define INSIDE		0.01

/* Pieces so near lie on each other: a hundredth of a pulse. */
#define BESIDE_MM	1e-5

/* Contours are written to a micrometre: pieces that were made to lie on one
 * line lie so near to it. */
#define NEARLY_MM	0.001

/* The place far away, in lengths of the outline: along its beginning and to the
 * left of it.  No piece is likely to lie in this direction. */
#define FAR_ALONG	3.7
#define FAR_LEFT	8.3

static bool is_lead(const struct track_work *w, uint32_t e)
{
	return track_piece(w, e)->lead;
}

static void find_way_back(struct face_side *s)
{
	const struct face_piece *p = &s->still->piece[s->first];
	const struct vec from = p[s->n - 1].c.to, to = p->c.from;
	const struct vec way = curve_way(&p->c, false);
	double len = 0;
	struct vec far = from;

	for (uint32_t i = 0; i < s->n; i++)
		len += curve_length(&p[i].c);
	if (!s->still->closed) {
		far = vec_add(to, FAR_ALONG * len, way);
		far = vec_add(far, FAR_LEFT * len,
			      (struct vec) { -way.y, way.x });
	}
	s->back[0] = curve_line(from, far);
	s->back[1] = curve_line(far, to);
}

static int add_as_was(struct face_side *s)
{
	const struct face *f = s->still;
	int err = 0;

	while (s->first < f->n && f->piece[s->first].lead)
		s->first++;
	s->n = f->n;
	while (s->n > s->first && f->piece[s->n - 1].lead)
		s->n--;
	s->n -= s->first;
	for (uint32_t i = 0; !err && i < s->n; i++)
		err = wind_add(&s->as_was, &f->piece[s->first + i].c);
	find_way_back(s);
	for (int k = 0; !err && k < 2; k++)
		err = wind_add(&s->as_was, &s->back[k]);
	return err;
}

static int add_moved(struct face_side *s, const struct track_work *w)
{
	struct curve end;
	int err = 0;

	s->id = malloc(w->n * sizeof(*s->id));
	if (!s->id)
		return -ENOMEM;
	for (uint32_t e = 0; !err && e < w->n; e++) {
		s->id[e] = is_lead(w, e) ? WIND_NO_CURVE : s->moved.n;
		if (!is_lead(w, e))
			err = wind_add(&s->moved, &w->elem[e].c);
	}
	if (err)
		return err;
	end = curve_line(s->moved.c[s->moved.n - 1].to, s->back[0].from);
	err = wind_add(&s->moved, &end);
	for (int k = 0; !err && k < 2; k++)
		err = wind_add(&s->moved, &s->back[k]);
	end = curve_line(s->back[1].to, s->moved.c[0].from);
	return err ? err : wind_add(&s->moved, &end);
}

int face_side_init(struct face_side *s, const struct track_work *w)
{
	int err;

	s->still = w->job->face;
	err = add_as_was(s);
	if (!err)
		err = add_moved(s, w);
	if (!err)
		err = wind_ready(&s->as_was);
	return err ? err : wind_ready(&s->moved);
}

void face_side_free(struct face_side *s)
{
	wind_free(&s->moved);
	wind_free(&s->as_was);
	free(s->id);
	*s = (struct face_side) { .n = 0 };
}

/* -- Questions ------------------------------------------------------------ */

static double side_of(const struct curve *line, struct vec at)
{
	return (line->to.x - line->from.x) * (at.y - line->from.y) -
	       (line->to.y - line->from.y) * (at.x - line->from.x);
}

/* From @a to @b: +1 if that comes to the left of @line, -1 to the right. */
static int over(const struct curve *line, struct vec a, struct vec b)
{
	const struct curve way = curve_line(a, b);
	const double from = side_of(line, a), to = side_of(line, b);

	if ((from > 0) == (to > 0) || (side_of(&way, line->from) > 0) ==
				      (side_of(&way, line->to) > 0))
		return 0;
	return to > 0 ? 1 : -1;
}

/* The winding number that a stretch at @at has on its left if it is on the
 * outline. */
static int wanted(const struct face_side *s, const struct track_work *w,
		  uint32_t e, struct vec at)
{
	uint32_t i = (uint32_t)(track_piece(w, e) - s->still->piece);
	double t = w->elem[e].fill ? 1 : 0;
	const struct curve *c = &s->still->piece[i].c;

	/* A contour that stands has no side: the one beside it. */
	while (curve_length(c) < CURVE_SAME_MM && i > s->first)
		c = &s->still->piece[--i].c;
	while (curve_length(c) < CURVE_SAME_MM && i + 1 < s->first + s->n)
		c = &s->still->piece[++i].c;
	if (!w->elem[e].fill)
		t = curve_share(c, at);
	t = t < INSIDE ? INSIDE : t > 1 - INSIDE ? 1 - INSIDE : t;
	return wind_left(&s->as_was, c, t, i - s->first) +
	       over(&s->back[0], curve_at(c, t), at) +
	       over(&s->back[1], curve_at(c, t), at);
}

/* Is the outline within @by of share @t of @c? */
static bool is_beside(const struct face_side *s, const struct curve *c,
		      double t, double by, int left)
{
	const struct curve part = curve_part(c, t, 1);
	const struct vec way = curve_way(&part, false);
	const struct vec to_left = { -way.y, way.x };

	return wind_at(&s->moved, vec_add(part.from, by, to_left)) >= left &&
	       wind_at(&s->moved, vec_add(part.from, -by, to_left)) < left;
}

bool face_side_is(const struct face_side *s, const struct track_work *w,
		  uint32_t e, double t0, double t1)
{
	const struct curve *c = &w->elem[e].c;
	const double t = (t0 + t1) / 2;
	int left;

	if (w->elem[e].dead)
		return false;
	if (is_lead(w, e) || curve_length(c) < CURVE_SAME_MM)
		return true;
	left = wanted(s, w, e, curve_at(c, t));
	/* Of pieces that lie on each other the way goes along any. */
	return wind_left(&s->moved, c, t, s->id[e]) == left ||
	       is_beside(s, c, t, BESIDE_MM, left);
}

bool face_side_is_near(const struct face_side *s, const struct track_work *w,
		       uint32_t e, double t0, double t1)
{
	const struct curve *c = &w->elem[e].c;
	const double t = (t0 + t1) / 2;

	return !w->elem[e].dead &&
	       is_beside(s, c, t, NEARLY_MM, wanted(s, w, e, curve_at(c, t)));
}
