/* SPDX-License-Identifier: Apache-2.0 */
/*
 * lookahead.c - what comes on the path, and whether it can still be met
 *
 * A place slower than the plan is met if it can be passed without acceleration:
 * so a plan for it can still be made.  One that is not slower is met if braking
 * at once, to a stand, comes to it at its speed or less: braking for a slower
 * one beyond, it is passed with the brake on.  Braking at once therefore meets
 * all of them together, and is what is left if no plan is good.
 *
 * One that is passed on the way up, before it is too slow, is missed all the
 * same if letting go of the acceleration comes too late for it: it may be slow
 * because of what is behind it, and nodes that are no slower are not looked at.
 *
 * One that is passed on the way down, before the brake is let go, is met if
 * letting go at once passes it at its speed or less: no plan is faster there.
 */
#include "path/lookahead.h"
#include "path/laws.h"
#include "path/walk.h"

#include "interp/limits.h"
#include "path/place.h"

#include <math.h>

/* Entries looked at in one cycle; at the last of them it could stop. */
#define HOPS_MAX	512

/* Of a plan's speed, relative. */
#define ROUNDING	1e-12

/* The place where it is at a speed, braking at once. */
static double slowed_mm(const struct lookahead *k, double v_mm_s)
{
	return k->s.x_mm + interp_scurve_way_mm(&k->l, k->s.v_mm_s,
						k->s.a_mm_s2, v_mm_s);
}

/*
 * How far to look.  From v, at no acceleration, it is farthest not to a stand
 * but to v/3, where the brake is let go earlier: by sqrt(32/27) without a hold
 * at the limit, by less with one.  Already braking, it is less far.
 */
static void set_out(struct lookahead *k, struct interp_scurve_state s)
{
	const double a = s.a_mm_s2;

	k->s = s;
	k->let_go_mm_s = s.v_mm_s + a * fabs(a) / (2 * k->l.j_max_mm_s3);
	k->s.a_mm_s2 = a > 0 ? a : 0;
	k->need_mm = 1.1 * slowed_mm(k, 0);
	k->s.a_mm_s2 = a;
	k->room_mm = INFINITY;
	k->missed_mm = 0;
	k->guessing = false;
	if (k->plan_mm_s < INFINITY)
		interp_scurve_to_speed(&k->brake, &k->l, s.v_mm_s, s.a_mm_s2,
				       0);
}

/* Letting go of the brake at once, where the speed has fallen to @v_mm_s. */
static double lets_go_mm(const struct lookahead *k, double v_mm_s)
{
	const double v = k->s.v_mm_s, a = -k->s.a_mm_s2, j = k->l.j_max_mm_s3;
	const double root = a * a - 2 * j * (v - v_mm_s);
	const double t = (a - sqrt(root > 0 ? root : 0)) / j;

	return (v - (a / 2 - j * t / 6) * t) * t;
}

/* By how much a place is met. */
static double room_mm(const struct lookahead *k, double left_mm, double v_mm_s)
{
	if (v_mm_s <= 0)
		return left_mm + MOVER_ONTO_MM - slowed_mm(k, 0);
	if (v_mm_s < k->plan_mm_s && v_mm_s < k->s.v_mm_s &&
	    v_mm_s >= k->let_go_mm_s)
		return left_mm - MOVER_ONTO_MM - k->s.x_mm -
		       lets_go_mm(k, v_mm_s);
	if (v_mm_s < k->plan_mm_s)
		return left_mm - MOVER_ONTO_MM -
		       slowed_mm(k, v_mm_s < k->let_go_mm_s ? v_mm_s :
							      k->let_go_mm_s);
	return left_mm - MOVER_ONTO_MM - k->s.x_mm -
	       interp_scurve_falls_mm(&k->brake, v_mm_s);
}

static void consider(struct lookahead *k, double left_mm, double v_mm_s)
{
	const struct lookahead_place p = { left_mm, v_mm_s, k->guessing };
	const double top = v_mm_s * (1 + ROUNDING);
	double room;

	if (v_mm_s > 0 && v_mm_s < k->lowest_mm_s)
		k->lowest_mm_s = v_mm_s;
	if (left_mm > MOVER_ONTO_MM && left_mm < k->next_mm)
		k->next_mm = left_mm;
	if (top >= k->let_go_mm_s && top >= k->s.v_mm_s)
		return;
	room = room_mm(k, left_mm, v_mm_s);
	if (room < k->room_mm)
		k->room_mm = room;
	if (-room > k->missed_mm) {
		k->missed_mm = -room;
		k->worst = p;
	}
}

/* Nothing nearer than the horizon is missed. */
static void horizon(struct lookahead *k, double left_mm)
{
	const double room = left_mm - k->need_mm;

	if (room < k->room_mm)
		k->room_mm = room;
}

static bool may_stop(const struct lookahead *k, uint32_t i,
		     const struct interp_seg *s)
{
	if (s->kind >= INTERP_BEGIN)
		return walk_is_due(k->c, i, s) || s->kind == INTERP_END;
	return k->w->positions && (walk_is_cut(k->c, s) ||
				   s->flags & INTERP_SEG_SENSED);
}

/* Sound, and no nearer than what was before; @ret_mm: how far its start is. */
static bool is_next(const struct lookahead *k, uint32_t i, double *ret_mm)
{
	const struct interp_cursor *at = &k->c->cursor;
	double left;

	if (i >= at->p.head->nsegs ||
	    !interp_program_seg_ok(&at->p, i, &at->p.segs[i]))
		return false;
	left = at->p.segs[i].s_mm - interp_cursor_place_mm(at);
	if (left < *ret_mm - MOVER_ONTO_MM)
		return false;
	*ret_mm = left;
	return true;
}

/* Farther was not looked: it may be anything. */
static void guess_stop(struct lookahead *k, double left_mm)
{
	k->guessing = true;
	consider(k, left_mm, 0);
	k->guessing = false;
}

/*
 * Forward.  A segment is entered over the node before it.  What the block says
 * of itself is not trusted: what is out of order is a place to stop at.
 */
static void look_forward(struct lookahead *k)
{
	const struct interp_cursor *at = &k->c->cursor;
	double left = at->seg.length_mm - at->s_mm;
	uint32_t i = at->index + 1;

	for (int n = 0; n < HOPS_MAX; n++) {
		const struct interp_seg *s = &at->p.segs[i];
		uint32_t hop = 1;

		if (!is_next(k, i, &left))
			break;
		if (left > k->need_mm) {
			horizon(k, left);
			return;
		}
		if (may_stop(k, i, s)) {
			consider(k, left, 0);
			return;
		}
		if (s->kind < INTERP_BEGIN) {
			consider(k, left, k->scale *
					  interp_limits_into(&at->p, i));
			hop = s->slower_ahead;
		}
		if (hop == 0)
			break;
		i += hop;
	}
	guess_stop(k, left);
}

/* The programmed feeds, by a chain of their own: the override is theirs. */
static void look_feeds(struct lookahead *k)
{
	const struct interp_cursor *at = &k->c->cursor;
	double left = at->seg.length_mm - at->s_mm;
	uint32_t i = at->index + 1;

	for (int n = 0; n < HOPS_MAX; n++) {
		const struct interp_seg *s = &at->p.segs[i];

		if (!is_next(k, i, &left))
			break;
		if (left > k->need_mm) {
			horizon(k, left);
			return;
		}
		if (s->kind < INTERP_BEGIN && !(s->flags & INTERP_SEG_RAPID))
			consider(k, left, k->c->override *
					  (double)s->feed_mm_s);
		if (s->slower_feed == 0)
			return;
		i += s->slower_feed;
	}
	guess_stop(k, left);
}

/* Back: every action behind is done, and is passed. */
static void look_back(struct lookahead *k)
{
	const struct interp_cursor *at = &k->c->cursor;
	const double here = interp_cursor_place_mm(at);
	double left = 0;
	uint32_t i = at->index;

	for (int n = 0; n < HOPS_MAX && i > 0; n++) {
		const struct interp_seg *s = &at->p.segs[--i];
		const double end = here - at->p.segs[i + 1].s_mm;

		if (!interp_program_seg_ok(&at->p, i, s) ||
		    !(end >= left))
			break;
		left = end;
		if (left > k->need_mm) {
			horizon(k, left);
			return;
		}
		if (s->kind < INTERP_BEGIN)
			consider(k, left, k->scale *
					  interp_limits_back_into(&at->p, i));
		if (i == 0) {
			consider(k, left, 0);
			return;
		}
		if (s->slower_behind == 0 || s->slower_behind > i)
			break;
		i -= s->slower_behind - 1u;
	}
	guess_stop(k, left);
}

/* Is there more of this segment that way? */
static bool goes_on(const struct interp_cursor *at, int toward)
{
	return at->seg.kind < INTERP_BEGIN &&
	       (toward > 0 ? at->seg.length_mm - at->s_mm : at->s_mm) >
	       MOVER_ONTO_MM;
}

uint32_t lookahead_index(const struct cycle *c, int toward)
{
	const struct interp_cursor *at = &c->cursor;
	const struct interp_seg *s;
	uint32_t i = at->index;

	if (goes_on(at, toward))
		return i;
	for (int n = 0; n < HOPS_MAX; n++) {
		if (toward < 0 && i == 0)
			return LOOKAHEAD_NONE;
		i = toward > 0 ? i + 1 : i - 1;
		s = &at->p.segs[i];
		if (!interp_program_seg_ok(&at->p, i, s) ||
		    s->kind == INTERP_END)
			return LOOKAHEAD_NONE;
		if (s->kind < INTERP_BEGIN)
			return i;
	}
	return LOOKAHEAD_NONE;
}

const struct interp_seg *lookahead_toward(const struct cycle *c, int toward)
{
	const struct interp_cursor *at = &c->cursor;
	uint32_t i;

	if (goes_on(at, toward))
		return &at->seg;
	i = lookahead_index(c, toward);
	return i == LOOKAHEAD_NONE ? NULL : &at->p.segs[i];
}

/* The next node; the one after it, standing on one. */
static double node_mm(const struct cycle *c, int toward)
{
	const struct interp_cursor *at = &c->cursor;
	const double left = toward > 0 ? at->seg.length_mm - at->s_mm :
					 at->s_mm;
	const struct interp_seg *next;

	if (left > MOVER_ONTO_MM || !mover_is_standing(&c->mover))
		return left;
	next = lookahead_toward(c, toward);
	return next ? left + next->length_mm : INFINITY;
}

void lookahead_from(struct lookahead *k, struct interp_scurve_state s)
{
	const struct cycle *c = k->c;
	const int toward = k->w->toward;

	set_out(k, s);
	if (toward > 0)
		look_forward(k);
	else
		look_back(k);
	if (k->w->positions)
		look_feeds(k);
	if (isfinite(k->w->goal_mm))
		consider(k, toward * (k->w->goal_mm - place_mm(c)), 0);
	if (isfinite(c->ahead.stand_mm))
		consider(k, toward * (c->ahead.stand_mm - place_mm(c)), 0);
	if (k->w->stops_at_nodes)
		consider(k, node_mm(c, toward), 0);
}
