/* SPDX-License-Identifier: Apache-2.0 */
/*
 * corner_word.c - corners that a word of the program rounds or cuts off: ,R ,C
 *
 * The corner is between two motions as programmed, before any offset.  The arc
 * touches both of them: its centre is where their parallels meet that lie on
 * the inner side, as far away as its radius.  Both motions become shorter.
 */
#include "wire/contour.h"

#include <errno.h>
#include <string.h>

/* A path that turns by less goes on straight: there is nothing to round. */
#define STRAIGHT_RAD	1e-6

struct refusal {
	const char *found, *wanted;
};

static int refuse(const struct contour_motion *a, struct interp_diag *diag,
		  struct refusal why)
{
	diag->line = a->word.line;
	return interp_diag_say(diag, "%s; %s", why.found, why.wanted);
}

int contour_refuse_corner(const struct contour *k, struct interp_diag *diag)
{
	return refuse(&k->m[k->n - 1], diag, (struct refusal) {
		"a corner to be rounded or cut, and no line or arc in X Y "
		"behind it", "one, or no ,R ,C" });
}

int contour_refuse_still(const struct contour_motion *m,
			 struct interp_diag *diag)
{
	return refuse(m, diag, (struct refusal) {
		"a corner behind a motion that goes nowhere in X Y",
		",R ,C behind one that does" });
}

/* Where on @c, or its prolongation, @at is nearest. */
static struct vec foot(const struct curve *c, struct vec at)
{
	const struct vec way = curve_way(c, false);
	const double from = c->arc ? curve_distance(c->centre, at) : 0;

	if (!c->arc)
		return vec_add(c->from, way.x * (at.x - c->from.x) +
					way.y * (at.y - c->from.y), way);
	return vec_add(c->centre, c->r / from, vec_add(at, -1, c->centre));
}

/* What is left of @c.  A line may be used up: by two corners of half the width
 * of a slot. */
static bool trim(struct curve *c, struct vec from, struct vec to)
{
	const bool ends = !c->arc && curve_distance(from, to) <= CURVE_SAME_MM;

	return curve_trim(c, from, to) || ends;
}

static bool is_used_up(const struct curve *c)
{
	return !c->arc && curve_length(c) <= CURVE_SAME_MM;
}

static bool round_off(struct curve *a, struct curve *b, double r,
		      struct curve *ret)
{
	const double side = curve_turn(a, b) > 0 ? r : -r;
	struct curve beside[2];
	struct vec centre, from, to;

	if (!curve_parallel(a, side, &beside[0]) ||
	    !curve_parallel(b, side, &beside[1]) ||
	    !curve_meet(&beside[0], &beside[1], a->to, &centre))
		return false;
	from = foot(a, centre);
	to = foot(b, centre);
	*ret = curve_round(from, to, centre, side < 0);
	return trim(a, a->from, from) && trim(b, to, b->to);
}

/* From the same distance in front of it to behind it. */
static bool cut_off(struct curve *a, struct curve *b, double mm,
		    struct curve *ret)
{
	const struct vec from = vec_add(a->to, -mm, curve_way(a, true));
	const struct vec to = vec_add(b->from, mm, curve_way(b, false));

	*ret = curve_line(from, to);
	return trim(a, a->from, from) && trim(b, to, b->to);
}

static bool differs(const struct contour_motion *m)
{
	return fabs(curve_length(&m->c[0]) - curve_length(&m->c[1])) >
	       CURVE_SAME_MM;
}

/* Return: nothing found, if it may. */
static struct refusal why_not(const struct contour *k,
			      const struct contour_motion *a,
			      const struct contour_motion *b)
{
	const bool two = guides_on(&k->guides);

	if (a->lead || b->lead || a->step || b->step)
		return (struct refusal) { "a corner beside a lead", ",R ,C "
			"between motions of the contour" };
	if (a->word.rapid || b->word.rapid)
		return (struct refusal) { "a corner beside a rapid motion",
			",R ,C between G1 G2 G3" };
	if (a->end.cut && (a->c[0].arc || b->c[0].arc))
		return (struct refusal) { "a corner beside an arc that is to "
			"be cut: controls differ in where", ",R, or the line "
			"itself" };
	for (int i = 0; i < INTERP_NAXES; i++)
		if (i > INTERP_Y && (!two || i < INTERP_U) &&
		    (a->from_mm[i] != a->end_mm[i] ||
		     b->from_mm[i] != b->end_mm[i]))
			return (struct refusal) { "a corner beside a motion of "
				"other axes than X and Y", "these alone" };
	if (two && (differs(a) || differs(b)))
		return (struct refusal) { "a corner where the top has a way of "
			"its own", "the arc itself, on both planes" };
	return (struct refusal) { NULL, NULL };
}

static void set_place(double mm[INTERP_NAXES], int plane, struct vec at)
{
	mm[plane ? INTERP_U : INTERP_X] = at.x;
	mm[plane ? INTERP_V : INTERP_Y] = at.y;
}

int contour_cut_corner(struct contour *k, struct contour_motion *b,
		       struct interp_diag *diag)
{
	struct contour_motion *a = &k->m[k->n - 1], fill = *a;
	const struct contour_corner end = a->end;
	const bool two = guides_on(&k->guides);
	const struct refusal why = why_not(k, a, b);
	int err = 0;

	if (why.found)
		return refuse(a, diag, why);
	a->end.mm = fill.end.mm = 0;
	if (fabs(curve_turn(&a->c[0], &b->c[0])) < STRAIGHT_RAD)
		return 0;
	for (int p = 0; p < 2; p++) {
		if (!(end.cut ? cut_off : round_off)(&a->c[p], &b->c[p], end.mm,
						     &fill.c[p]) ||
		    (b->end.mm > 0 && is_used_up(&b->c[p])))
			return refuse(a, diag, (struct refusal) {
				"a corner that is larger than the motions "
				"beside it, or that turns back",
				"a smaller ,R ,C" });
		if (p && !two)
			continue;
		set_place(a->end_mm, p, a->c[p].to);
		set_place(b->from_mm, p, b->c[p].from);
	}
	memcpy(fill.from_mm, a->end_mm, sizeof(fill.from_mm));
	memcpy(fill.end_mm, b->from_mm, sizeof(fill.end_mm));
	if (is_used_up(&a->c[0])) {
		*a = fill;
	} else {
		fill.todo = k->ntodo;
		fill.ntodo = 0;
		err = contour_keep(k, &fill, diag);
	}
	return err ? err : is_used_up(&b->c[0]);
}
