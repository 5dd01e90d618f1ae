/* SPDX-License-Identifier: Apache-2.0 */
/*
 * feed.c - feed laws: a table of one per state
 *
 * Every law leaves the speed it asked for in the mover, so that the next state
 * takes over from there.
 */
#include "feed.h"
#include "cycle.h"
#include "walk.h"

#include <math.h>
#include <stddef.h>

/* Segments looked at ahead in one cycle; beyond them the walk could stop. */
#define AHEAD_MAX	256

/* A stop is met, not missed by a rounding. */
#define ONTO_MM		1e-9

/* No stop is near enough to plan for it. */
#define FAR_MM		1e9

static double period_s(const struct cycle *c)
{
	return (double)c->config.period_ns * 1e-9;
}

static double place(const struct cycle *c)
{
	return interp_cursor_place_mm(&c->cursor);
}

static double go_at(struct cycle *c, double v_mm_s)
{
	mover_set(&c->mover, v_mm_s);
	return v_mm_s * period_s(c);
}

static struct mover_limits travel_limits(const struct cycle *c,
					 double v_max_mm_s)
{
	return (struct mover_limits) {
		v_max_mm_s, c->config.travel_a_mm_s2, c->config.travel_j_mm_s3,
		period_s(c)
	};
}

/* -- Positioning ------------------------------------------------------------ */

static double seg_speed(const struct interp_seg *s)
{
	return s->feed_mm_s < s->feed_max_mm_s ? s->feed_mm_s :
						 s->feed_max_mm_s;
}

/*
 * The fastest it can be after this cycle, and where.  What can still be met
 * from there needs no braking yet: so it can always be met.
 */
static struct interp_scurve_state one_more(const struct cycle *c)
{
	const double t = period_s(c), v = c->mover.v_mm_s;
	const double a = fmax(fmin(c->mover.a_mm_s2 +
				   c->config.travel_j_mm_s3 * t,
				   c->config.travel_a_mm_s2),
			      c->mover.a_mm_s2);
	const double v1 = fmax(v, v + a * t);

	return (struct interp_scurve_state) { v1 * t, v1, a };
}

/* The place where it is at a speed, braking at once from @s. */
static double slowed_mm(const struct cycle *c,
			const struct interp_scurve_state *s, double v_mm_s)
{
	const struct mover_limits m = travel_limits(c, s->v_mm_s);
	const struct interp_scurve_limits l = mover_curve(&m);

	return s->x_mm + interp_scurve_way_mm(&l, s->v_mm_s, s->a_mm_s2,
					      v_mm_s);
}

/*
 * How far to look.  From v, at no acceleration, it is farthest not to a stand
 * but to v/3, where the brake is let go earlier: by sqrt(32/27) without a hold
 * at a_max, by less with one.  Already braking, it is less far.
 */
static void look_from(struct cycle *c)
{
	const struct mover *m = &c->mover;
	struct interp_scurve_state s;

	if (m->v_mm_s == c->ahead.v_mm_s && m->a_mm_s2 == c->ahead.a_mm_s2 &&
	    c->ahead.need_mm > 0)
		return;
	s = one_more(c);
	c->ahead.next = s;
	s.a_mm_s2 = fmax(s.a_mm_s2, 0);
	c->ahead.need_mm = 1.1 * slowed_mm(c, &s, 0);
	c->ahead.v_mm_s = m->v_mm_s;
	c->ahead.a_mm_s2 = m->a_mm_s2;
}

/* A slower segment @left_mm ahead: brake for it, if it is time to. */
static void slow_down(struct cycle *c, uint32_t index, double left_mm)
{
	const double v = seg_speed(&c->cursor.p.segs[index]);
	const struct interp_scurve_state *s = &c->ahead.next;
	const double let_go = s->v_mm_s + s->a_mm_s2 * fabs(s->a_mm_s2) /
					  (2 * c->config.travel_j_mm_s3);

	if (v >= fmax(let_go, s->v_mm_s) ||
	    (c->ahead.slow_for && v >= c->ahead.slow_mm_s))
		return;
	if (slowed_mm(c, s, fmin(v, let_go)) <= left_mm)
		return;
	c->ahead.slow_for = index;
	c->ahead.slow_mm_s = v;
}

/* The way to the next stop, if it is time to plan for it. */
static double look_ahead(struct cycle *c)
{
	const struct interp_cursor *at = &c->cursor;
	double left = at->seg.length_mm - at->s_mm;
	uint32_t i = at->index;

	look_from(c);
	for (int n = 0; n < AHEAD_MAX && left <= c->ahead.need_mm; n++) {
		const struct interp_seg *g = &at->p.segs[++i];

		if (!interp_program_seg_ok(&at->p, i, g))
			return left;
		if (g->kind >= INTERP_BEGIN) {
			if (i <= c->action_done && g->kind != INTERP_END)
				continue;
			return left;
		}
		if (walk_is_cut(c, g))
			return left;
		slow_down(c, i, left);
		left += g->length_mm;
	}
	return left > c->ahead.need_mm ? FAR_MM : left;
}

/* Of the segment it is on, or of the one it is about to enter. */
static double speed_here(const struct cycle *c)
{
	const struct interp_cursor *at = &c->cursor;
	const struct interp_seg *s = &at->seg;
	uint32_t i = at->index;

	if (s->kind < INTERP_BEGIN && s->length_mm - at->s_mm > ONTO_MM)
		return seg_speed(s);
	for (int n = 0; n < AHEAD_MAX; n++) {
		s = &at->p.segs[++i];
		if (!interp_program_seg_ok(&at->p, i, s))
			break;
		if (s->kind < INTERP_BEGIN)
			return seg_speed(s);
		if (s->kind == INTERP_END)
			break;
	}
	return c->config.gap.approach_mm_s;
}

static double travel(struct cycle *c)
{
	const double left = look_ahead(c);
	double v = speed_here(c), ds;
	struct mover_limits l;

	if (c->cursor.index >= c->ahead.slow_for)
		c->ahead.slow_for = 0;
	else if (c->ahead.slow_mm_s < v)
		v = c->ahead.slow_mm_s;
	l = travel_limits(c, v);
	if (left >= FAR_MM)
		return mover_run(&c->mover, &l, v);
	ds = mover_step(&c->mover, &l, left);
	return ds >= left ? left + ONTO_MM : ds;
}

/* -- The gap ------------------------------------------------------------------ */

static double seg_limit(const struct cycle *c, double v_mm_s)
{
	return fmin(v_mm_s, seg_speed(&c->cursor.seg));
}

/* At a BEGIN or an action there is no segment's own speed yet. */
static double cut_limit(const struct cycle *c, double v_mm_s)
{
	return c->cursor.seg.kind < INTERP_BEGIN ? seg_limit(c, v_mm_s) :
						   v_mm_s;
}

static double approach(struct cycle *c)
{
	return go_at(c, c->gap_v >= c->config.gap.servo_v ?
			cut_limit(c, c->config.gap.approach_mm_s) : 0);
}

/*
 * Three zones: above servo_v forward, in proportion; between short_v and
 * servo_v stand; below short_v the state is no longer erode.
 */
static double erode(struct cycle *c)
{
	const struct cycle_gap_config *g = &c->config.gap;
	const double feed = g->gain_mm_s_v * (c->gap_v - g->servo_v);

	return go_at(c, feed > 0 ? cut_limit(c, fmin(feed, g->feed_max_mm_s)) :
				   0);
}

static double retract(struct cycle *c)
{
	return go_at(c, c->retract_waited ? 0 : -c->config.gap.retract_mm_s);
}

/* -- Lifts and moves by command ---------------------------------------------- */

static double jump(struct cycle *c)
{
	const struct cycle_jump_config *j = &c->config.jump;
	const struct mover_limits l = {
		j->v_max_mm_s, j->a_max_mm_s2, j->j_max_mm_s3, period_s(c)
	};

	return mover_step(&c->mover, &l, c->jump_to_mm - place(c));
}

static double hold(struct cycle *c)
{
	const double v = c->cursor.seg.kind < INTERP_BEGIN ?
			 fmin(c->config.gap.retract_mm_s,
			      c->cursor.seg.feed_max_mm_s) :
			 c->config.gap.retract_mm_s;
	const struct mover_limits l = travel_limits(c, v);

	return c->moving ? mover_step(&c->mover, &l, c->move_to_mm - place(c)) :
			   mover_stop(&c->mover, &l);
}

static double none(struct cycle *c)
{
	return go_at(c, 0);
}

static double (*const laws[CYCLE_NSTATES])(struct cycle *) = {
	[STATE_STAY]	 = none,
	[STATE_IDLE]	 = none,
	[STATE_TRAVEL]	 = travel,
	[STATE_APPROACH] = approach,
	[STATE_ERODE]	 = erode,
	[STATE_RETRACT]	 = retract,
	[STATE_JUMP]	 = jump,
	[STATE_HOLD]	 = hold,
	[STATE_FAULT]	 = none,
};

double feed_distance(struct cycle *c)
{
	return laws[c->state](c);
}

static bool there(const struct cycle *c, double to_mm)
{
	return c->mover.v_mm_s == 0 && fabs(to_mm - place(c)) < 2 * ONTO_MM;
}

/* Up, then back to just short of the cut. */
static bool jump_done(struct cycle *c)
{
	if (!there(c, c->jump_to_mm))
		return false;
	if (!c->lifting)
		return true;
	c->lifting = false;
	c->jump_to_mm = fmax(c->jump_from_mm - c->config.jump.short_of_mm,
			     place(c));
	return there(c, c->jump_to_mm);
}

bool feed_done(struct cycle *c)
{
	if (c->state == STATE_JUMP)
		return jump_done(c);
	if (c->state == STATE_HOLD && c->moving && there(c, c->move_to_mm))
		c->moving = false;
	return false;
}
