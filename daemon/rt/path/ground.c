/* SPDX-License-Identifier: Apache-2.0 */
/*
 * ground.c - does the electrode stand on ground that was cut already?
 *
 * Along a segment it is looked where the electrode stands.  Each look says how
 * far on it can be at the earliest, because along a mm of the path no axis of X
 * Y Z goes more than a mm, and most axes go evenly.
 *
 * Beside hundreds of arcs and pieces of curves that is more than one cycle can
 * do.  So a cycle takes GROUND_LOOKS_MAX looks, and the next one goes on.  The
 * place in question stays the one where the short came.
 */
#include "path/ground.h"
#include "cycle.h"
#include "path/laws.h"

#include "interp/at.h"

#include <math.h>
#include <string.h>

#define NEAR_PULSES	2.0
#define LAG_PULSES	2.0		/* of one contour of a pair behind the
					 * other */
#define LOOKS_MAX	64		/* along one segment */

/* How far the lattice may be from the path, on every axis. */
static double near_pulses(const struct interp_program *p,
			  const struct interp_seg *s)
{
	const enum interp_strategy by = (enum interp_strategy)p->head->strategy;
	double near = NEAR_PULSES;

	if (interp_strategy_takes_tolerance(by))
		near += 2 * p->head->tolerance_milli / 1000.0;
	return s->kind == INTERP_PAIR ? near + LAG_PULSES : near;
}

/* The most that an axis goes along a mm of it; INFINITY: nobody knows. */
static double most_rate(const struct interp_program *p,
			const struct interp_seg *s, uint8_t axis, double rate)
{
	const struct interp_couple *k;

	switch (s->kind) {
	case INTERP_ARC:
		return axis == p->arcs[s->arg].axis_a ||
		       axis == p->arcs[s->arg].axis_b ? 1 : fabs(rate);
	case INTERP_PAIR:
		k = &p->couples[s->arg];
		if (axis <= INTERP_Y)
			return 1;
		return k->side[1].r_mm > 0 ? INFINITY : fabs(rate);
	case INTERP_CURVE:
		return axis <= INTERP_Z ? 1 : INFINITY;
	default:
		return fabs(rate);
	}
}

/* What one cycle does of it. */
struct search {
	const struct interp_program *p;
	struct ground *g;
	struct interp_at_curve last;
	int looks;			/* that it may still take */
};

/* Return: 0, it stands at @point; else so far on, at least, INFINITY: never. */
static double way_mm(const struct search *k, double near_by,
		     const struct interp_contour_point *point)
{
	const struct interp_program *p = k->p;
	const struct interp_seg *s = &p->segs[k->g->at];
	double least = INFINITY, most = 0;

	for (uint32_t j = 0; j < p->head->naxes; j++) {
		const uint8_t axis = p->head->column[j];
		const double pulse = p->head->pulse_mm[axis];
		const double near = near_by * pulse;
		const double off = fabs(k->g->pos[axis] * pulse - point->mm[j]);
		double rate;

		if (off <= near)
			continue;
		rate = most_rate(p, s, axis, point->per_u[j]);
		if (isfinite(rate))
			most = fmax(most, (off - near * 3 / 4) / rate);
		else
			least = fmin(least, near / 4 / fabs(point->per_u[j]));
	}
	return most > 0 || isinf(least) ? most : least;
}

/* Farther from its first node than it is long? */
static bool is_far(const struct search *k, double near)
{
	const struct interp_program *p = k->p;
	const uint32_t i = k->g->at;
	const int64_t *node = p->nodes + (uint64_t)i * p->head->naxes;

	for (uint32_t j = 0; j < p->head->naxes; j++) {
		const uint8_t axis = p->head->column[j];
		const double off = (double)node[j] / INTERP_SUB -
				   k->g->pos[axis];

		if (axis <= INTERP_Z && (fabs(off) - near) *
		    p->head->pulse_mm[axis] > p->segs[i].length_mm)
			return true;
	}
	return false;
}

/* On the first most_mm of the segment?  GROUND_NEW: not on this one. */
static enum ground_answer look_along(struct search *k)
{
	struct ground *g = k->g;
	const struct interp_seg *s = &k->p->segs[g->at];
	const double near = near_pulses(k->p, s);
	const double end_mm = fmin(g->most_mm, s->length_mm);

	if (g->looks == 0 && is_far(k, near))
		return GROUND_NEW;
	for (; g->looks < LOOKS_MAX; g->looks++) {
		struct interp_contour_point point;
		double way;

		if (k->looks-- == 0)
			return GROUND_ASKED;
		if (!interp_program_any_at(k->p, g->at, g->mm, &k->last,
					   &point))
			return GROUND_NEW;
		way = way_mm(k, near, &point);
		if (way == 0)
			return GROUND_CUT;
		if (g->mm >= end_mm)
			return GROUND_NEW;
		g->mm = fmin(g->mm + way, end_mm);
	}
	return GROUND_NEW;
}

static bool was_cut(const struct interp_seg *s)
{
	return s->kind < INTERP_BEGIN &&
	       !(s->flags & INTERP_SEG_UNCUT);
}

static void look_from(struct ground *g, uint32_t i, double most_mm)
{
	g->at = i;
	g->most_mm = most_mm;
	g->mm = 0;
	g->looks = 0;
}

/* The motion that comes next, if it is a cut that has begun. */
static bool find_ahead(const struct cycle *c, struct ground *g)
{
	const struct interp_cursor *at = &c->cursor;
	uint32_t i = at->index + 1;
	double gone_mm;

	for (int n = 0; n < GROUND_SEGMENTS_MAX && i < at->p.head->nsegs &&
	     at->p.segs[i].kind >= INTERP_BEGIN; n++)
		i++;
	if (i >= at->p.head->nsegs || !was_cut(&at->p.segs[i]))
		return false;
	gone_mm = c->far_mm - at->p.segs[i].s_mm;
	look_from(g, i, gone_mm);
	return gone_mm > MOVER_ONTO_MM;
}

/* The next one behind that was cut. */
static bool find_behind(const struct interp_program *p, struct ground *g)
{
	while (g->left > 0 && g->behind > 0) {
		const struct interp_seg *s = &p->segs[--g->behind];

		g->left--;
		/* Places counted from elsewhere, and another electrode. */
		if (s->flags & INTERP_SEG_SENSED ||
		    s->kind == INTERP_ELECTRODE)
			return false;
		if (s->kind == INTERP_TIMED_END || s->kind == INTERP_TIMED)
			g->left_out = s->kind == INTERP_TIMED_END;
		else if (!g->left_out && was_cut(s)) {
			look_from(g, g->behind, INFINITY);
			return true;
		}
	}
	return false;
}

static void ask(const struct cycle *c, struct ground *g)
{
	*g = (struct ground) {
		.answer = GROUND_ASKED, .behind = c->cursor.index,
		.left = GROUND_SEGMENTS_MAX,
	};
	memcpy(g->pos, c->cursor.pos, sizeof(g->pos));
	/* Where it stands on a cut it was before, or brakes. */
	if (c->cursor.seg.flags & INTERP_SEG_OUT || was_cut(&c->cursor.seg))
		g->answer = GROUND_CUT;
	else if (!find_ahead(c, g) && !find_behind(&c->cursor.p, g))
		g->answer = GROUND_NEW;
}

enum ground_answer ground_look(struct cycle *c)
{
	struct ground *g = &c->ground;
	struct search k = {
		.p = &c->cursor.p, .g = g, .looks = GROUND_LOOKS_MAX,
	};

	if (g->answer != GROUND_ASKED)
		ask(c, g);
	while (g->answer == GROUND_ASKED) {
		const enum ground_answer a = look_along(&k);

		if (a == GROUND_ASKED)
			break;
		if (a == GROUND_CUT || !find_behind(&c->cursor.p, g))
			g->answer = a;
	}
	return g->answer;
}
