/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pace.c - speeds that a law sets anew in each cycle, within what the axes can
 * do
 *
 * After a cycle at the speed v, braking at once by dv = a * T in each cycle, a
 * place that lies ahead is met at the speed u if
 *
 *	v <= u  or  v*v + 2*dv*v <= u*u + room
 *
 * where room is 2*a times the way there, summed over the segments between.  A
 * segment that allows more than one before it is counted with what that one
 * allows.  So the room never shrinks by more than what a cycle of braking takes
 * off v: what could be met once can be met from then on.  A stop that is nearer
 * than a cycle at dv is gone onto at once: from dv it can stand.
 */
#include "path/pace.h"
#include "path/laws.h"
#include "path/lookahead.h"
#include "path/place.h"
#include "path/walk.h"

#include "interp/limits.h"
#include "interp/smaller.h"

#include <math.h>

/* Beyond so many places that are slower, or softer, it could always stop. */
#define HOPS_MAX	512

/* Any is less; it keeps what is computed finite. */
#define A_MAX		1e9

static double or_any(double a_mm_s2)
{
	return a_mm_s2 > 0 ? a_mm_s2 : INFINITY;
}

/* Of all axes that move, the way it goes. */
static double a_of_axes(const struct cycle *c, int toward)
{
	const struct interp_seg *s;
	double a = c->escape.a_max_mm_s2;

	if (!escape_is_out(&c->escape)) {
		s = lookahead_toward(c, toward);
		s = s ? s : lookahead_toward(c, -toward);
		a = s ? (double)s->a_mm_s2 : c->config.travel_a_mm_s2;
	}
	return a < A_MAX ? a : A_MAX;
}

/* What the law in force leaves of that.  A touch is not the servo's. */
static double a_of_law(const struct cycle *c, double a_mm_s2)
{
	const double own = c->state == STATE_PROBE ? INFINITY :
			   or_any(c->gap.feed_a_mm_s2);

	return own < a_mm_s2 ? own : a_mm_s2;
}

static double a_here(const struct cycle *c, int toward)
{
	return a_of_law(c, a_of_axes(c, toward));
}

static int way_of(double v_mm_s)
{
	return v_mm_s < 0 ? -1 : 1;
}

/* On a node it may turn round onto what it came along.  Between two of them
 * there is one segment, both ways. */
static double a_both_ways(const struct cycle *c)
{
	const struct interp_cursor *at = &c->cursor;

	if (at->seg.kind < INTERP_BEGIN && at->s_mm > MOVER_ONTO_MM &&
	    at->seg.length_mm - at->s_mm > MOVER_ONTO_MM &&
	    !escape_is_out(&c->escape))
		return smaller((double)at->seg.a_mm_s2, A_MAX);
	return smaller(a_of_axes(c, 1), a_of_axes(c, -1));
}

double pace_dv_mm_s(const struct cycle *c)
{
	return a_of_law(c, a_both_ways(c)) * law_period_s(c);
}

/* -- What lies ahead ------------------------------------------------------- */

struct ahead {
	const struct cycle *c;
	int toward;
	double a_mm_s2, dv_mm_s;	/* here */
	double left_mm, room;		/* up to where it looks; mm2/s2 */
	double most_mm_s;		/* the fastest that meets all so far */
	double stop_mm;			/* left to where it has to stand */
	bool only_goal;			/* that is where it was sent: it may
					 * still go beyond */
};

/*
 * What is no faster than the place meets it without braking.  So near in front
 * of a node that it counts as on it, it can no longer brake: behind it, it may
 * have a thousandth of the acceleration.
 */
static void meet(struct ahead *k, double v_mm_s)
{
	const double onto = 2 * k->a_mm_s2 * MOVER_ONTO_MM;
	const double dv = k->dv_mm_s, room = larger(k->room - onto, 0);
	const double v = sqrt(dv * dv + v_mm_s * v_mm_s + room) - dv;

	k->most_mm_s = smaller(k->most_mm_s, larger(v, v_mm_s));
}

static void meet_stop(struct ahead *k)
{
	const double was = k->most_mm_s;
	const double dv = smaller(k->dv_mm_s, k->a_mm_s2 * law_period_s(k->c));
	const double onto = k->left_mm / law_period_s(k->c);

	meet(k, 0);
	k->most_mm_s = larger(k->most_mm_s, smaller(was, smaller(onto, dv)));
	k->stop_mm = smaller(k->stop_mm, k->left_mm);
}

/* Return: false if all that is farther is met anyway. */
static bool go_on(struct ahead *k, double way_mm)
{
	const double v = k->most_mm_s;

	k->left_mm += larger(way_mm, 0);
	k->room += 2 * k->a_mm_s2 * larger(way_mm, 0);
	return v * v + 2 * k->dv_mm_s * v > k->room;
}

static void meet_place(struct ahead *k, double to_mm)
{
	const double left = k->toward * (to_mm - place_mm(k->c));
	struct ahead there = *k;

	/* It still has to turn round. */
	if (left < -MOVER_ONTO_MM || !go_on(&there, left))
		return;
	meet_stop(&there);
	k->most_mm_s = there.most_mm_s;
}

/* Is it no part of the cut, or something to be done first? */
static bool stops(const struct ahead *k, uint32_t i, const struct interp_seg *s)
{
	if (!interp_program_seg_ok(&k->c->cursor.p, i, s))
		return true;
	if (k->toward < 0)
		return i == 0;
	return s->kind >= INTERP_BEGIN ? walk_is_due(k->c, i, s) ||
					 s->kind == INTERP_END :
					 !walk_is_cut(k->c, s);
}

static double into_mm_s(const struct ahead *k, uint32_t i,
			const struct interp_seg *s)
{
	const struct interp_program *p = &k->c->cursor.p;

	return k->toward > 0 ?
		       smaller(interp_limits_into(p, i), law_seg_speed(s)) :
		       interp_limits_back_into(p, i);
}

static uint32_t nearer(uint32_t hop, uint16_t other)
{
	return other > 0 && other < hop ? other : hop;
}

/* From segment @i on, how many segments away the next one is that may be
 * entered slower, be braked on less, or not be entered at all. */
static uint32_t hop_from(const struct ahead *k, uint32_t i)
{
	const struct interp_seg *s = &k->c->cursor.p.segs[i];

	if (s->kind >= INTERP_BEGIN)
		return 1;
	if (k->toward < 0)
		return nearer(nearer(i, s->slower_behind), s->softer_behind);
	return nearer(nearer(nearer(UINT16_MAX, s->slower_ahead),
			     s->softer_ahead), s->slower_feed);
}

/* From where segment @i is entered to where that so many segments away is. */
static double way_mm(const struct ahead *k, uint32_t i, uint32_t hop)
{
	const struct interp_program *p = &k->c->cursor.p;
	const uint32_t to = i + (uint32_t)k->toward * hop;
	const struct interp_seg *a = &p->segs[i], *b = &p->segs[to];

	if (to >= p->head->nsegs)
		return a->length_mm;
	return k->toward > 0 ? b->s_mm - a->s_mm :
			       a->s_mm + a->length_mm - b->s_mm - b->length_mm;
}

/* Up to the goal, if it is no farther than that way.  Return: false if it need
 * look no farther. */
static bool go_way(struct ahead *k, double goal_mm, double way_mm)
{
	const bool meets = goal_mm <= k->left_mm + way_mm;

	if (!go_on(k, meets ? goal_mm - k->left_mm : way_mm))
		return false;
	k->only_goal = meets;
	if (meets)
		meet_stop(k);
	return !meets;
}

/* From the end of segment @i on.  Most cycles need not look so far. */
static __attribute__((noinline)) void look_farther(struct ahead *k,
						   double goal_mm, uint32_t i)
{
	const struct interp_program *p = &k->c->cursor.p;
	uint32_t hop = 1;

	for (int n = 0; n < HOPS_MAX && (k->toward > 0 || i > 0); n++) {
		const struct interp_seg *s;

		i += (uint32_t)k->toward * hop;
		s = &p->segs[i];
		if (i >= p->head->nsegs || stops(k, i, s))
			break;
		if (s->kind < INTERP_BEGIN) {
			meet(k, into_mm_s(k, i, s));
			k->a_mm_s2 = smaller(k->a_mm_s2, (double)s->a_mm_s2);
		}
		hop = hop_from(k, i);
		if (!go_way(k, goal_mm, way_mm(k, i, hop)))
			return;
	}
	meet_stop(k);
}

/* Up to a place to stand at: what lies between may be braked on less. */
static void look_along(struct ahead *k, double to_mm)
{
	const struct interp_cursor *at = &k->c->cursor;
	const double goal = k->toward * (to_mm - place_mm(k->c));
	/* It may still have to turn round. */
	const double goal_mm = goal < -MOVER_ONTO_MM ? INFINITY : goal;
	const double way = k->toward > 0 ? at->seg.length_mm - at->s_mm :
					   at->s_mm;

	if (go_way(k, goal_mm, way))
		look_farther(k, goal_mm, at->index);
}

/* Beside the path it stands at corners, and where the path begins again: there
 * any way onward ends the escape. */
static void look_beside(struct ahead *k, double to_mm)
{
	const struct cycle *c = k->c;
	const double end = k->toward > 0 ? interp_cursor_place_mm(&c->cursor) :
					   place_outer_mm(c);

	k->most_mm_s = smaller(k->most_mm_s, c->escape.v_max_mm_s);
	if (k->toward < 0 || c->escape.way_mm > MOVER_ONTO_MM)
		meet_place(k, escape_stop_mm(c, isinf(to_mm) ? end : to_mm));
}

/* How fast to go by now, and where to stand. */
static void look(struct ahead *k, double to_mm)
{
	const struct interp_seg *s = lookahead_toward(k->c, k->toward);

	if (escape_is_out(&k->c->escape)) {
		look_beside(k, to_mm);
		return;
	}
	if (s)
		k->most_mm_s = smaller(k->most_mm_s, (double)s->feed_max_mm_s);
	look_along(k, to_mm);
}

/* It was sent there when it was too fast to stand there. */
static bool passes(const struct ahead *k, double v_mm_s)
{
	return k->only_goal && fabs(v_mm_s) > k->dv_mm_s * (1 + 1e-6);
}

/* Onto what stops it, so that it is met; there it stands. */
static double go(struct cycle *c, const struct ahead *k, double v_mm_s)
{
	const double ds = law_go_at(c, v_mm_s);

	if (fabs(ds) < k->stop_mm - MOVER_ONTO_MM || passes(k, v_mm_s))
		return ds;
	c->mover.v_mm_s = 0;
	return k->toward * (k->stop_mm + MOVER_ONTO_MM);
}

/* @was: the speed of the cycle before. */
static double change(struct cycle *c, double was, double v_mm_s, double to_mm)
{
	const int from = way_of(was != 0 ? was : v_mm_s);
	const double axes = a_both_ways(c), a = a_of_law(c, axes);
	const double dv = a * law_period_s(c);
	const double v = smaller(larger(v_mm_s, was - dv), was + dv);
	struct ahead k = {
		.c = c, .toward = way_of(v), .a_mm_s2 = a,
		.most_mm_s = fabs(v), .stop_mm = INFINITY,
	};

	/* It came to a stand in the last cycle, in front of a segment that
	 * cannot brake from what that cycle still went. */
	if (v == 0 || (mover_is_standing(&c->mover) && fabs(was) > dv))
		return law_go_at(c, 0);
	if (k.toward != from)
		k.a_mm_s2 = a_here(c, k.toward);
	k.dv_mm_s = k.a_mm_s2 * law_period_s(c);
	look(&k, to_mm);
	/* A planned move may have been quicker: no harder than the axes
	 * brake. */
	if (was * v > 0)
		k.most_mm_s = larger(k.most_mm_s,
				     fabs(was) - axes * law_period_s(c));
	return go(c, &k, k.toward * smaller(fabs(v), k.most_mm_s));
}

double pace_go(struct cycle *c, double v_mm_s, double to_mm)
{
	const double was = c->mover.mean_mm_s;

	return was == 0 && v_mm_s == 0 ? law_go_at(c, 0) :
					 change(c, was, v_mm_s, to_mm);
}
