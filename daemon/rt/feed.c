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
	c->mover.v_mm_s = v_mm_s;
	return v_mm_s * period_s(c);
}

static struct mover_limits limits(const struct cycle *c, double v_max_mm_s,
				  double a_max_mm_s2)
{
	return (struct mover_limits) { v_max_mm_s, a_max_mm_s2, period_s(c) };
}

/* -- Positioning ------------------------------------------------------------ */

static double seg_speed(const struct interp_seg *s)
{
	return fmin(s->feed_mm_s, s->feed_max_mm_s);
}

struct view {
	double left_mm;			/* to the next stop, or far off */
	double v_mm_s;			/* allowed by what lies ahead */
};

/* Look as far ahead as it takes to brake, at most AHEAD_MAX segments. */
static struct view look_ahead(const struct cycle *c)
{
	const double a = c->config.travel_a_mm_s2, v = c->mover.v_mm_s;
	const double need = v * v / (2 * a) + 2 * v * period_s(c) +
			    2 * a * period_s(c) * period_s(c);
	const struct interp_cursor *at = &c->cursor;
	struct view w = { at->seg.length_mm - at->s_mm, 1e9 };
	uint32_t i = at->index;

	if (at->seg.kind < INTERP_BEGIN && w.left_mm > ONTO_MM)
		w.v_mm_s = seg_speed(&at->seg);
	for (int n = 0; n < AHEAD_MAX && w.left_mm <= need; n++) {
		const struct interp_seg *s = &at->p.segs[++i];

		if (!interp_program_seg_ok(&at->p, i, s))
			return w;
		if (s->kind >= INTERP_BEGIN) {
			if (i <= c->action_done && s->kind != INTERP_END)
				continue;
			return w;
		}
		if (walk_is_cut(c, s))
			return w;
		w.v_mm_s = fmin(w.v_mm_s, sqrt(seg_speed(s) * seg_speed(s) +
					       2 * a * w.left_mm));
		w.left_mm += s->length_mm;
	}
	if (w.left_mm > need)
		w.left_mm = 1e9;
	return w;
}

static double travel(struct cycle *c)
{
	const struct view w = look_ahead(c);
	const struct mover_limits l = limits(c, w.v_mm_s,
					     c->config.travel_a_mm_s2);
	const double ds = mover_step(&c->mover, &l, w.left_mm);

	return ds >= w.left_mm ? w.left_mm + ONTO_MM : ds;
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
	const struct mover_limits l = limits(c, j->v_max_mm_s, j->a_max_mm_s2);

	return mover_step(&c->mover, &l, c->jump_to_mm - place(c));
}

static double hold(struct cycle *c)
{
	const double v = c->cursor.seg.kind < INTERP_BEGIN ?
			 fmin(c->config.gap.retract_mm_s,
			      c->cursor.seg.feed_max_mm_s) :
			 c->config.gap.retract_mm_s;
	const struct mover_limits l = limits(c, v, c->config.travel_a_mm_s2);

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
