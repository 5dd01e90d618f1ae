/* SPDX-License-Identifier: Apache-2.0 */
/*
 * ahead.c - go along the path at a speed that what lies ahead can be met with
 *
 * Each cycle has a plan: to reach the fastest speed allowed here, or to pass a
 * slow place at its speed, or to stop at a place.  Where the plan leads within
 * one cycle is known.  So the question is whether everything ahead can still be
 * met from there (lookahead.h). If so, the plan is good for the cycle.  If not,
 * the place that is missed by most is planned for instead, exactly.  If no plan
 * is good, braking at once is what is left: it meets all that could be met
 * before.
 *
 * "Way" and "left" are in the direction of the move, here, and so is the sign
 * of every speed.
 */
#include "path/ahead.h"
#include "path/laws.h"
#include "path/lookahead.h"
#include "path/walk.h"
#include "path/place.h"

#include <math.h>

/* Other plans tried in one cycle. */
#define PLANS_MAX	4

/* Softer segments looked at; at the next one it stands. */
#define SOFTER_MAX	512

/* More than this was never promised to be met: the program lies. */
#define LIE_MM		1e-6

/* The fastest here; @ret_most: by the program alone. */
static double speed_here(const struct cycle *c, const struct ahead_move *w,
			 double *ret_most)
{
	const struct interp_seg *s = lookahead_toward(c, w->toward);
	const double by = lookahead_override(c, w), scale = by < 1 ? by : 1;
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

/* Is segment @i beyond what counts for a move that begins here? */
static bool is_beyond(const struct cycle *c, const struct ahead_move *w,
		      uint32_t i)
{
	const struct interp_seg *s = &c->cursor.p.segs[i];

	if (!interp_program_seg_ok(&c->cursor.p, i, s) ||
	    (s->kind >= INTERP_BEGIN && w->toward > 0 && walk_is_due(c, i, s)))
		return true;
	return isfinite(w->goal_mm) &&
	       (w->toward > 0 ? s->s_mm >= w->goal_mm :
				s->s_mm + s->length_mm <= w->goal_mm);
}

/* Where segment @i begins, coming from the other side. */
static double begin_mm(const struct cycle *c, int toward, uint32_t i)
{
	const struct interp_seg *s = &c->cursor.p.segs[i];

	return toward > 0 ? s->s_mm : s->s_mm + s->length_mm;
}

/* Does a move stand between segment @i and the one before it? */
static bool is_stand(const struct cycle *c, int toward, uint32_t i)
{
	const struct interp_seg *s = &c->cursor.p.segs[i];

	return (toward > 0 ? s[-1].flags : s->flags) & INTERP_SEG_STAND;
}

static bool is_softer(const struct mover_limits *l,
		      const struct mover_limits *than)
{
	return l->a_max_mm_s2 < than->a_max_mm_s2 ||
	       l->a_back_mm_s2 < than->a_back_mm_s2 ||
	       l->j_max_mm_s3 < than->j_max_mm_s3;
}

/* What every axis allows, up to a place. */
struct soft {
	struct mover_limits l;
	double stand_mm;		/* INFINITY: everywhere */
};

/* From here to where the move ends or has to stand.  It is the same for the
 * whole of a move, so what can be met can be met to its end. */
static struct soft limits_of(const struct cycle *c, const struct ahead_move *w)
{
	const struct interp_program *p = &c->cursor.p;
	struct soft ret = { w->l, INFINITY };
	uint32_t i = lookahead_index(c, w->toward);

	for (int n = 0; i < p->head->nsegs; n++) {
		const struct interp_seg *s = &p->segs[i];
		const uint32_t hop = w->toward > 0 ? s->softer_ahead :
						     s->softer_behind;

		if (n > 0 && is_beyond(c, w, i)) {
			ret.stand_mm = w->goal_mm;
			break;
		}
		if (n == SOFTER_MAX || (n > 0 && is_stand(c, w->toward, i))) {
			ret.stand_mm = begin_mm(c, w->toward, i);
			break;
		}
		law_soften(&ret.l, s);
		if (hop == 0 || (w->toward > 0 ? hop >= p->head->nsegs - i :
						 hop > i))
			break;
		i = w->toward > 0 ? i + hop : i - hop;
	}
	return ret;
}

/* A move that goes on to another goal stands at the first one, if beyond it the
 * axes allow less. */
static void go_on_to(struct cycle *c, const struct ahead_move *w)
{
	struct cycle_ahead *a = &c->ahead;
	const struct soft s = limits_of(c, w);

	if (is_softer(&s.l, &a->l))
		return;
	a->stand_mm = s.stand_mm;
}

/* Does it go the other way, or brake from that?  Up to where it stands, what it
 * set out with holds.  The sign of a speed that is a rounding says nothing. */
static bool is_turning(const struct cycle *c, const struct ahead_move *w)
{
	const struct cycle_ahead *a = &c->ahead;

	return !mover_is_standing(&c->mover) &&
	       (w->toward * c->mover.v_mm_s < 0 ||
		(a->turns && a->state == c->state &&
		 a->toward == w->toward));
}

/*
 * A move begins: with another state, another way, or another override.  One
 * that was held up by too many points is where no plan had it: it begins anew.
 */
static void begin(struct cycle *c, const struct ahead_move *w)
{
	const double by = lookahead_override(c, w);
	const double acc = w->toward * c->mover.a_mm_s2;
	struct cycle_ahead *a = &c->ahead;
	const bool short_of = c->cut_short;
	bool turns;

	c->cut_short = false;
	if (!short_of && a->state == c->state && a->toward == w->toward &&
	    a->override == by && a->goal_mm == w->goal_mm &&
	    !mover_is_standing(&c->mover))
		return;
	turns = is_turning(c, w);
	if (a->state != c->state || mover_is_standing(&c->mover)) {
		const struct soft s = limits_of(c, w);

		a->l = s.l;
		a->stand_mm = s.stand_mm;
	} else if (!turns) {
		go_on_to(c, w);
	}
	a->turns = turns;
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

/* Is what was planned for still to come, and what is left of the plan no faster
 * than that?  The ceilings of short lines change from line to line. */
static bool plan_holds(struct cycle *c, double v_mm_s)
{
	const struct cycle_ahead *a = &c->ahead;
	const double left = a->place_mm - place_mm(c);
	struct mover *m = &c->mover;

	if (!a->to_place || m->kind != MOVER_TO_PLACE ||
	    (a->v_max_mm_s > v_mm_s && mover_most_mm_s(m) > v_mm_s) ||
	    (a->toward * left < MOVER_ONTO_MM &&
	     (m->pass_mm_s != 0 || mover_is_standing(&c->mover))) ||
	    fabs(m->goal - m->gone_mm - left) > MOVER_ONTO_MM)
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
static void plan_place(struct cycle *c, const struct lookahead *k,
		       double v_mm_s)
{
	const int toward = c->ahead.toward;
	const double now = toward * c->mover.v_mm_s;
	const double a = toward * c->mover.a_mm_s2;
	const double let_go = now + a * fabs(a) / (2 * k->l.j_max_mm_s3);
	const double v = k->worst.v_mm_s;
	const double left = k->worst.left_mm - (v > 0 ? LOOKAHEAD_EARLY_MM : 0);
	struct mover_limits l = c->ahead.l;

	l.v_max_mm_s = fmax(v_mm_s, v) > 0 ? fmax(v_mm_s, v) : now;
	if (l.v_max_mm_s <= 0 ||
	    (v > 0 && left < interp_scurve_way_mm(&k->l, now, a, v))) {
		plan_speed(c, let_go <= v && now <= v ? fmin(v, v_mm_s) : 0);
		return;
	}
	mover_aim_place(&c->mover, &l, toward * left, toward * v);
	c->ahead.to_place = true;
	c->ahead.place_mm = place_mm(c) + toward * left;
	c->ahead.v_max_mm_s = l.v_max_mm_s;
}

static bool is_braking(const struct cycle *c)
{
	return c->mover.kind == MOVER_TO_SPEED && c->mover.goal == 0;
}

static void look_after_plan(struct cycle *c, struct lookahead *k)
{
	const int toward = c->ahead.toward;
	struct interp_scurve_state s = mover_peek(&c->mover, k->w->l.period_s);

	s.x_mm *= toward;
	s.v_mm_s *= toward;
	s.a_mm_s2 *= toward;
	k->plan_mm_s = c->ahead.to_place ? fabs(c->mover.pass_mm_s) : INFINITY;
	lookahead_from(k, s);
}

/* It was promised that everything can be met, whatever it set out with. */
static bool is_lie(const struct cycle *c, const struct lookahead *k)
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

/* Onward at @v_mm_s, or as the places ahead let it; false: it has to brake. */
static bool try_plans(struct cycle *c, struct lookahead *k, double v_mm_s)
{
	for (int n = 0; n < PLANS_MAX; n++) {
		look_after_plan(c, k);
		if (k->missed_mm <= 0)
			return true;
		if (n == 0 && is_lie(c, k)) {
			fault_latch(&c->fault, FAULT_PROGRAM);
			return true;
		}
		plan_place(c, k, v_mm_s);
		if (is_braking(c))
			return false;
	}
	look_after_plan(c, k);
	return k->missed_mm <= 0;
}

/* To a stand at the next place: nothing lies between. */
static void plan_next(struct cycle *c, const struct lookahead *k, double v_mm_s)
{
	struct mover_limits l = c->ahead.l;

	l.v_max_mm_s = v_mm_s;
	mover_aim_place(&c->mover, &l, c->ahead.toward * k->next_mm, 0);
	c->ahead.to_place = true;
	c->ahead.place_mm = place_mm(c) + c->ahead.toward * k->next_mm;
	c->ahead.v_max_mm_s = v_mm_s;
}

/*
 * Braking meets everything, but who stands already would stand for ever.  At
 * the lowest of all ceilings seen only a stop can be missed, and one plan meets
 * that.  If even so something is missed, from a stand the next place is gone
 * to: every move comes on by a place at least.
 */
static void choose(struct cycle *c, struct lookahead *k, double v_mm_s)
{
	double low;

	if (!plan_holds(c, v_mm_s))
		plan_speed(c, v_mm_s);
	if (try_plans(c, k, v_mm_s))
		return;
	low = fmin(v_mm_s, k->lowest_mm_s);
	if (low > 0) {
		plan_speed(c, low);
		if (try_plans(c, k, low))
			return;
	}
	low = fmin(low, k->lowest_mm_s);
	if (low > 0 && mover_is_standing(&c->mover) && isfinite(k->next_mm))
		plan_next(c, k, low);
	else
		plan_speed(c, 0);
}

static struct lookahead look_of(const struct cycle *c,
				const struct ahead_move *w)
{
	const struct interp_scurve_limits l = mover_curve(&c->ahead.l);
	const double by = lookahead_override(c, w);
	struct lookahead k = { .c = c, .w = w, .l = l, .scale = by < 1 ? by : 1,
			  .lowest_mm_s = INFINITY, .next_mm = INFINITY };

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
			  !(fabs(c->ahead.place_mm - w->goal_mm) <=
			    MOVER_ONTO_MM);
	const double left = c->mover.left_mm;
	const double ds = mover_go(&c->mover, w->l.period_s);

	return onto && mover_is_standing(&c->mover) &&
	       fabs(ds - left) <= MOVER_ONTO_MM ?
	       left + w->toward * MOVER_ONTO_MM : ds;
}

double ahead_distance(struct cycle *c, const struct ahead_move *w)
{
	struct lookahead k;
	double v, most, step;

	begin(c, w);
	v = speed_here(c, w, &most);
	/* First to a stand: what lies between here and there is not seen. */
	if (c->ahead.turns)
		v = 0;
	step = v * w->l.period_s;
	if (c->mover.v_mm_s == w->toward * v && c->mover.a_mm_s2 == 0 &&
	    c->ahead.room_mm > step) {
		c->ahead.room_mm -= step;
		c->mover.mean_mm_s = c->mover.v_mm_s;
		return w->toward * step;
	}
	if (w->toward * c->mover.v_mm_s >
	    fmax(most, c->ahead.entered_mm_s) * (1 + 1e-6) + 1e-9) {
		fault_latch(&c->fault, FAULT_PROGRAM);
		return 0;
	}
	k = look_of(c, w);
	choose(c, &k, v);
	c->ahead.room_mm = k.missed_mm > 0 ? 0 : k.room_mm;
	return fault_is_latched(&c->fault, FAULT_PROGRAM) ? 0 : go(c, w);
}
