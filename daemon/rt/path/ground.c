/* SPDX-License-Identifier: Apache-2.0 */
/*
 * ground.c - does the electrode stand on ground that was cut already?
 *
 * Along a segment it is looked where the electrode stands.  Each look says how
 * far on it can be at the earliest, because along a mm of the path no axis of X
 * Y Z goes more than a mm, and most axes go evenly.
 */
#include "path/ground.h"
#include "path/laws.h"

#include "interp/at.h"

#include <math.h>

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

/* Return: 0, it stands at @point; else so far on, at least, INFINITY: never. */
static double way_mm(const struct interp_cursor *at, uint32_t i,
		     double near_by, const struct interp_contour_point *point)
{
	const struct interp_program *p = &at->p;
	const struct interp_seg *s = &p->segs[i];
	double least = INFINITY, most = 0;

	for (uint32_t j = 0; j < p->head->naxes; j++) {
		const uint8_t axis = p->head->column[j];
		const double pulse = p->head->pulse_mm[axis];
		const double near = near_by * pulse;
		const double off = fabs(at->pos[axis] * pulse - point->mm[j]);
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
static bool is_far(const struct interp_cursor *at, uint32_t i, double near)
{
	const struct interp_program *p = &at->p;
	const int64_t *node = p->nodes + (uint64_t)i * p->head->naxes;

	for (uint32_t j = 0; j < p->head->naxes; j++) {
		const uint8_t axis = p->head->column[j];
		const double off = (double)node[j] / INTERP_SUB - at->pos[axis];

		if (axis <= INTERP_Z && (fabs(off) - near) *
		    p->head->pulse_mm[axis] > p->segs[i].length_mm)
			return true;
	}
	return false;
}

/* On the first @most_mm of it? */
static bool is_on(const struct interp_cursor *at, uint32_t i, double most_mm,
		  struct interp_at_curve *last)
{
	const struct interp_seg *s = &at->p.segs[i];
	const double near = near_pulses(&at->p, s);
	const double end_mm = fmin(most_mm, s->length_mm);
	struct interp_contour_point point;
	double mm = 0;

	if (is_far(at, i, near))
		return false;
	for (int n = 0; n < LOOKS_MAX; n++) {
		double way;

		if (!interp_program_any_at(&at->p, i, mm, last, &point))
			return false;
		way = way_mm(at, i, near, &point);
		if (way == 0)
			return true;
		if (mm >= end_mm)
			return false;
		mm = fmin(mm + way, end_mm);
	}
	return false;
}

static bool was_cut(const struct interp_seg *s)
{
	return s->kind < INTERP_BEGIN &&
	       !(s->flags & (INTERP_SEG_RAPID | INTERP_SEG_SENSED));
}

/* The motion that comes next, if it is a cut that has begun. */
static bool is_cut_ahead(const struct cycle *c)
{
	const struct interp_cursor *at = &c->cursor;
	struct interp_at_curve last = { .open = false };
	uint32_t i = at->index + 1;
	double gone_mm;

	for (int n = 0; n < GROUND_SEGMENTS_MAX && i < at->p.head->nsegs &&
	     at->p.segs[i].kind >= INTERP_BEGIN; n++)
		i++;
	if (i >= at->p.head->nsegs || !was_cut(&at->p.segs[i]))
		return false;
	gone_mm = c->far_mm - at->p.segs[i].s_mm;
	return gone_mm > MOVER_ONTO_MM && is_on(at, i, gone_mm, &last);
}

static bool is_cut_behind(const struct interp_cursor *at)
{
	struct interp_at_curve last = { .open = false };
	bool left_out = false;
	uint32_t i = at->index;

	for (int n = 0; n < GROUND_SEGMENTS_MAX && i > 0; n++) {
		const struct interp_seg *s = &at->p.segs[--i];

		/* Places counted from elsewhere, and another electrode. */
		if (s->flags & INTERP_SEG_SENSED ||
		    s->kind == INTERP_ELECTRODE)
			return false;
		if (s->kind == INTERP_TIMED_END || s->kind == INTERP_TIMED)
			left_out = s->kind == INTERP_TIMED_END;
		else if (!left_out && was_cut(s) &&
			 is_on(at, i, INFINITY, &last))
			return true;
	}
	return false;
}

bool ground_is_cut(const struct cycle *c)
{
	return c->cursor.seg.flags & INTERP_SEG_OUT || is_cut_ahead(c) ||
	       is_cut_behind(&c->cursor);
}
