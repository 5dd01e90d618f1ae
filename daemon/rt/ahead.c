/* SPDX-License-Identifier: Apache-2.0 */
/*
 * ahead.c - go along the path at a speed that what lies ahead can be met with
 *
 * Each cycle has a plan: to the fastest speed allowed here, or to pass a slow
 * place at its speed, or to stand at one.  Where the plan leads to within the
 * cycle is known, so it is asked whether everything ahead can still be met from
 * there.  If so, the plan is good for the cycle.  If not, the place that is
 * missed by most is planned for instead, exactly.
 *
 * A place slower than the plan is met if it can be passed without acceleration:
 * so a plan for it can still be made.  One that is not slower is met if braking
 * at once, to a stand, comes to it at its speed or less: braking for a slower
 * one beyond, it is passed with the brake on.  Braking at once therefore meets
 * all of them together, and is what is left if no plan is good.
 *
 * "Way" and "left" are in the direction of the move, here, and so is the sign
 * of every speed.
 */
#include "ahead.h"
#include "laws.h"
#include "walk.h"

#include "interp/limits.h"

#include <math.h>

/* Entries looked at in one cycle; at the last of them it could stop. */
#define HOPS_MAX	512

/* Other plans tried in one cycle. */
#define PLANS_MAX	4

/* A slow place is planned for so much before it, and met so much before it;
 * a stand is met but for a rounding. */
#define EARLY_MM	2e-9
#define MARGIN_MM	1e-9

/* Of a plan's speed, relative. */
#define ROUNDING	1e-12

/* More than this was never promised to be met: the program lies. */
#define LIE_MM		1e-6

/* A place ahead, and how fast it may be come to. */
struct place {
	double left_mm, v_mm_s;
	bool guessed;			/* it may be faster; nobody looked */
};

struct look {
	const struct cycle *c;
	const struct ahead_move *w;
	struct interp_scurve_limits l;	/* in the direction of the move */
	struct interp_scurve_state s;	/* after the cycle */
	double let_go_mm_s;		/* without acceleration, after that */
	double plan_mm_s;		/* of the plan's place; INFINITY: none */
	struct interp_scurve brake;	/* to a stand at once, if there is one */
	double need_mm;			/* nothing beyond can be missed */
	double scale;			/* of ceilings: the override, up to 1 */
	bool guessing;			/* what follows was not looked at */
	/* Found: */
	double room_mm;			/* what is met is met by so much */
	double missed_mm;		/* what is missed by most, if > 0: */
	struct place worst;
};

static double override_of(const struct cycle *c, const struct ahead_move *w)
{
	return w->positions ? c->override : 1;
}

/* The place where it is at a speed, braking at once. */
static double slowed_mm(const struct look *k, double v_mm_s)
{
	return k->s.x_mm + interp_scurve_way_mm(&k->l, k->s.v_mm_s,
						k->s.a_mm_s2, v_mm_s);
}

/*
 * How far to look.  From v, at no acceleration, it is farthest not to a stand
 * but to v/3, where the brake is let go earlier: by sqrt(32/27) without a hold
 * at the limit, by less with one.  Already braking, it is less far.
 */
static void look_from(struct look *k, struct interp_scurve_state s)
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

/* By how much a place is met. */
static double room_mm(const struct look *k, double left_mm, double v_mm_s)
{
	if (v_mm_s <= 0)
		return left_mm + MARGIN_MM - slowed_mm(k, 0);
	if (v_mm_s < k->plan_mm_s)
		return left_mm - MARGIN_MM -
		       slowed_mm(k, v_mm_s < k->let_go_mm_s ? v_mm_s :
							      k->let_go_mm_s);
	return left_mm - MARGIN_MM - k->s.x_mm -
	       interp_scurve_falls_mm(&k->brake, v_mm_s);
}

static void consider(struct look *k, double left_mm, double v_mm_s)
{
	const struct place p = { left_mm, v_mm_s, k->guessing };
	const double top = v_mm_s * (1 + ROUNDING);
	double room;

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
static void horizon(struct look *k, double left_mm)
{
	const double room = left_mm - k->need_mm;

	if (room < k->room_mm)
		k->room_mm = room;
}

static bool may_stop(const struct look *k, uint32_t i,
		     const struct interp_seg *s)
{
	if (s->kind >= INTERP_BEGIN)
		return walk_is_due(k->c, i, s) || s->kind == INTERP_END;
	return k->w->positions && (walk_is_cut(k->c, s) ||
				   s->flags & INTERP_SEG_SENSED);
}

/* Sound, and no nearer than what was before; @ret_mm: how far its start is. */
static bool is_next(const struct look *k, uint32_t i, double *ret_mm)
{
	const struct interp_cursor *at = &k->c->cursor;
	double left;

	if (i >= at->p.head->nsegs ||
	    !interp_program_seg_ok(&at->p, i, &at->p.segs[i]))
		return false;
	left = at->p.segs[i].s_mm - interp_cursor_place_mm(at);
	if (left < *ret_mm - LAW_ONTO_MM)
		return false;
	*ret_mm = left;
	return true;
}

/* Farther was not looked: it may be anything. */
static void guess_stop(struct look *k, double left_mm)
{
	k->guessing = true;
	consider(k, left_mm, 0);
	k->guessing = false;
}

/*
 * Forward.  A segment is entered over the node before it.  What the block says
 * of itself is not trusted: what is out of order is a place to stop at.
 */
static void look_forward(struct look *k)
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
static void look_feeds(struct look *k)
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
static void look_back(struct look *k)
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

static bool is_standing(const struct cycle *c)
{
	return c->mover.v_mm_s == 0 && c->mover.a_mm_s2 == 0;
}

/* The segment it is on or, from its very end, about to be on; NULL: none. */
static const struct interp_seg *seg_toward(const struct cycle *c, int toward)
{
	const struct interp_cursor *at = &c->cursor;
	const struct interp_seg *s = &at->seg;
	uint32_t i = at->index;

	if (s->kind < INTERP_BEGIN &&
	    (toward > 0 ? s->length_mm - at->s_mm : at->s_mm) > LAW_ONTO_MM)
		return s;
	for (int n = 0; n < HOPS_MAX; n++) {
		if (toward < 0 && i == 0)
			return NULL;
		i = toward > 0 ? i + 1 : i - 1;
		s = &at->p.segs[i];
		if (!interp_program_seg_ok(&at->p, i, s) ||
		    s->kind == INTERP_END)
			return NULL;
		if (s->kind < INTERP_BEGIN)
			return s;
	}
	return NULL;
}

/* The next node; the one after it, standing on one. */
static double node_mm(const struct cycle *c, int toward)
{
	const struct interp_cursor *at = &c->cursor;
	const double left = toward > 0 ? at->seg.length_mm - at->s_mm :
					 at->s_mm;
	const struct interp_seg *next;

	if (left > LAW_ONTO_MM || !is_standing(c))
		return left;
	next = seg_toward(c, toward);
	return next ? left + next->length_mm : INFINITY;
}

static void look(struct look *k)
{
	const struct cycle *c = k->c;
	const int toward = k->w->toward;

	if (toward > 0)
		look_forward(k);
	else
		look_back(k);
	if (k->w->positions)
		look_feeds(k);
	if (isfinite(k->w->goal_mm))
		consider(k, toward * (k->w->goal_mm - law_place(c)), 0);
	if (k->w->stops_at_nodes)
		consider(k, node_mm(c, toward), 0);
}

/* -- The plan ---------------------------------------------------------------- */

/* The fastest here; @ret_most: by the program alone. */
static double speed_here(const struct cycle *c, const struct ahead_move *w,
			 double *ret_most)
{
	const struct interp_seg *s = seg_toward(c, w->toward);
	const double by = override_of(c, w), scale = by < 1 ? by : 1;
	double v = w->l.v_max_mm_s;

	*ret_most = INFINITY;
	if (!s)
		return c->gap.approach_mm_s < v ? c->gap.approach_mm_s : v;
	*ret_most = (double)s->feed_max_mm_s;
	if (*ret_most < v)
		v = *ret_most;
	v *= scale;
	if (w->positions && !(s->flags & INTERP_SEG_RAPID) &&
	    (double)s->feed_mm_s * by < v)
		v = (double)s->feed_mm_s * by;
	return v;
}

/*
 * A move begins: with another state, another way, or another override.  One
 * that was held up by too many points is where no plan had it: it begins anew.
 */
static void begin(struct cycle *c, const struct ahead_move *w)
{
	const double by = override_of(c, w), acc = w->toward * c->mover.a_mm_s2;
	struct cycle_ahead *a = &c->ahead;
	const bool short_of = c->cut_short;

	c->cut_short = false;
	if (!short_of && a->state == c->state && a->toward == w->toward &&
	    a->override == by && a->goal_mm == w->goal_mm)
		return;
	if (a->state != c->state || a->toward != w->toward)
		a->l = w->l;
	a->state = c->state;
	a->toward = w->toward;
	a->override = by;
	a->goal_mm = w->goal_mm;
	a->entered_mm_s = w->toward * c->mover.v_mm_s +
			  acc * fabs(acc) / (2 * a->l.j_max_mm_s3);
	a->entered_mm_s = fmax(a->entered_mm_s, w->toward * c->mover.v_mm_s);
	a->room_mm = 0;
	a->to_place = false;
}

/* Is what was planned for still to come? */
static bool plan_holds(struct cycle *c, double v_mm_s)
{
	const struct cycle_ahead *a = &c->ahead;
	const double left = a->place_mm - law_place(c);
	struct mover *m = &c->mover;

	if (!a->to_place || m->kind != MOVER_TO_PLACE ||
	    a->v_max_mm_s > v_mm_s ||
	    (a->toward * left < LAW_ONTO_MM &&
	     (m->pass_mm_s != 0 || is_standing(c))) ||
	    fabs(m->goal - m->gone_mm - left) > LAW_ONTO_MM)
		return false;
	m->left_mm = left;
	return true;
}

static void plan_speed(struct cycle *c, double v_mm_s)
{
	struct mover_limits l = c->ahead.l;

	l.v_max_mm_s = v_mm_s;
	mover_aim_speed(&c->mover, &l, c->ahead.toward * v_mm_s);
	c->ahead.to_place = false;
}

/*
 * For the place that would be missed.  One too near to be passed at its speed
 * exactly is passed slower, or, if that is no more to be had, braked for.
 */
static void plan_place(struct cycle *c, const struct look *k, double v_mm_s)
{
	const int toward = c->ahead.toward;
	const double now = toward * c->mover.v_mm_s;
	const double a = toward * c->mover.a_mm_s2;
	const double let_go = now + a * fabs(a) / (2 * k->l.j_max_mm_s3);
	const double v = k->worst.v_mm_s;
	const double left = k->worst.left_mm - (v > 0 ? EARLY_MM : 0);
	struct mover_limits l = c->ahead.l;

	l.v_max_mm_s = fmax(v_mm_s, v) > 0 ? fmax(v_mm_s, v) : now;
	if (l.v_max_mm_s <= 0 ||
	    (v > 0 && left < interp_scurve_way_mm(&k->l, now, a, v))) {
		plan_speed(c, let_go <= v && now <= v ? fmin(v, v_mm_s) : 0);
		return;
	}
	mover_aim_place(&c->mover, &l, toward * left, toward * v);
	c->ahead.to_place = true;
	c->ahead.place_mm = law_place(c) + toward * left;
	c->ahead.v_max_mm_s = l.v_max_mm_s;
}

static bool is_braking(const struct cycle *c)
{
	return c->mover.kind == MOVER_TO_SPEED && c->mover.goal == 0;
}

static void look_after_plan(struct cycle *c, struct look *k)
{
	const int toward = c->ahead.toward;
	struct interp_scurve_state s = mover_peek(&c->mover, k->w->l.period_s);

	s.x_mm *= toward;
	s.v_mm_s *= toward;
	s.a_mm_s2 *= toward;
	k->plan_mm_s = c->ahead.to_place ? fabs(c->mover.pass_mm_s) : INFINITY;
	look_from(k, s);
	look(k);
}

/* It was promised that everything can be met, whatever it set out with. */
static bool is_lie(const struct cycle *c, const struct look *k)
{
	const double v = c->ahead.toward * c->mover.v_mm_s;
	const double a = c->ahead.toward * c->mover.a_mm_s2;
	struct interp_scurve brake;

	if (k->worst.guessed || v <= k->worst.v_mm_s ||
	    v <= c->ahead.entered_mm_s * (1 + 1e-6) + 1e-9)
		return false;
	interp_scurve_to_speed(&brake, &k->l, v, a, 0);
	return (k->worst.v_mm_s > 0 ?
		interp_scurve_falls_mm(&brake, k->worst.v_mm_s) :
		brake.end.x_mm) > k->worst.left_mm + LIE_MM;
}

static void choose(struct cycle *c, struct look *k, double v_mm_s)
{
	if (!plan_holds(c, v_mm_s))
		plan_speed(c, v_mm_s);
	for (int n = 0; n < PLANS_MAX; n++) {
		look_after_plan(c, k);
		if (k->missed_mm <= 0)
			return;
		if (n == 0 && is_lie(c, k)) {
			cycle_fail(c, FAULT_PROGRAM);
			return;
		}
		plan_place(c, k, v_mm_s);
		if (is_braking(c))
			return;
	}
	look_after_plan(c, k);
	if (k->missed_mm > 0)
		plan_speed(c, 0);
}

static struct look look_of(const struct cycle *c, const struct ahead_move *w)
{
	const struct interp_scurve_limits l = mover_curve(&c->ahead.l);
	const double by = override_of(c, w);
	struct look k = { .c = c, .w = w, .l = l, .scale = by < 1 ? by : 1 };

	if (w->toward < 0) {
		k.l.a_up_mm_s2 = l.a_down_mm_s2;
		k.l.a_down_mm_s2 = l.a_up_mm_s2;
	}
	return k;
}

/* In front of what stops it, standing: onto it, so that it is met. */
static double go(struct cycle *c, const struct ahead_move *w)
{
	const bool onto = c->ahead.to_place && c->mover.pass_mm_s == 0 &&
			  !w->stops_at_nodes &&
			  !(fabs(c->ahead.place_mm - w->goal_mm) <= LAW_ONTO_MM);
	const double left = c->mover.left_mm;
	const double ds = mover_go(&c->mover, w->l.period_s);

	return onto && is_standing(c) && fabs(ds - left) <= LAW_ONTO_MM ?
	       left + w->toward * LAW_ONTO_MM : ds;
}

double ahead_distance(struct cycle *c, const struct ahead_move *w)
{
	struct look k;
	double v, most, step;

	begin(c, w);
	v = speed_here(c, w, &most);
	/* First to a stand: what lies between here and there is not seen. */
	if (w->toward * c->mover.v_mm_s < 0)
		v = 0;
	step = v * w->l.period_s;
	if (c->mover.v_mm_s == w->toward * v && c->mover.a_mm_s2 == 0 &&
	    c->ahead.room_mm > step) {
		c->ahead.room_mm -= step;
		return w->toward * step;
	}
	if (w->toward * c->mover.v_mm_s >
	    fmax(most, c->ahead.entered_mm_s) * (1 + 1e-6) + 1e-9) {
		cycle_fail(c, FAULT_PROGRAM);
		return 0;
	}
	k = look_of(c, w);
	choose(c, &k, v);
	c->ahead.room_mm = k.missed_mm > 0 ? 0 : k.room_mm;
	return c->fault == FAULT_PROGRAM ? 0 : go(c, w);
}
