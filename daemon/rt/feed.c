/* SPDX-License-Identifier: Apache-2.0 */
/* feed.c - the feed laws, a table with one for each state; jumps and holds */
#include "path/ahead.h"
#include "enter.h"
#include "feed.h"
#include "path/hole.h"
#include "path/laws.h"
#include "path/pace.h"
#include "path/place.h"
#include "path/walk.h"

#include <math.h>
#include <stddef.h>

/* -- Positioning, lifts and moves by command ------------------------------- */

/* Brake with the limits of the motion that is under way. */
static double brake(struct cycle *c)
{
	const struct mover_limits l = c->mover.l;

	return mover_stop(&c->mover, &l);
}

static double travel(struct cycle *c)
{
	const struct ahead_move w = {
		.toward = 1, .positions = true,
		.goal_mm = walk_rejoins(c) ? c->job.rejoin_mm : INFINITY,
		.l = law_travel_limits(c, INFINITY),
	};

	/* Started while another move was still braking: that ends first. */
	const bool other = c->ahead.state != STATE_TRAVEL &&
			   !mover_is_standing(&c->mover);
	/* At less than 1e-9 mm in a period it may be there and not stand. */
	const enum walk_ahead on = walk_ahead(c);
	const bool there = on == AHEAD_CUT || on == AHEAD_PROBE;

	return c->withdraws || other || there ? brake(c) :
						ahead_distance(c, &w);
}

static double go_to(struct cycle *c, struct ahead_move *w, double to_mm)
{
	w->goal_mm = to_mm;
	w->toward = to_mm < place_mm(c) ? -1 : 1;
	return ahead_distance(c, w);
}

/* Beside the path, the axes of the escape may allow less. */
static struct mover_limits escape_limits(const struct cycle *c)
{
	const struct cycle_jump_config *j = &c->jump;
	const double v = fmin(j->v_max_mm_s, c->escape.v_max_mm_s);

	return (struct mover_limits) {
		.v_max_mm_s = v,
		.a_max_mm_s2 = fmin(j->a_max_mm_s2, c->escape.a_max_mm_s2),
		.j_max_mm_s3 = fmin(j->j_max_mm_s3, c->escape.j_max_mm_s3),
		.period_s = law_period_s(c),
	};
}

static double escape_to(struct cycle *c, const struct mover_limits *l,
			double to_mm)
{
	return mover_step(&c->mover, l, escape_stop_mm(c, to_mm) -
					place_mm(c));
}

static double jump(struct cycle *c)
{
	const struct cycle_jump_config *j = &c->jump;
	struct mover_limits beside;
	struct ahead_move w = {
		.stops_at_nodes = c->config.stop_at_nodes,
		.l = {
			.v_max_mm_s = j->v_max_mm_s,
			.a_max_mm_s2 = j->a_down_mm_s2 > 0 ? j->a_down_mm_s2 :
							     j->a_max_mm_s2,
			.a_back_mm_s2 = j->a_max_mm_s2,
			.j_max_mm_s3 = j->j_max_mm_s3,
			.period_s = law_period_s(c),
		},
	};

	if (c->lift.waits)
		cycle_lift(c);
	beside = escape_limits(c);
	if (escape_is_out(&c->escape))
		return escape_to(c, &beside, c->lift.to_mm);
	return go_to(c, &w, c->lift.to_mm);
}

static double hold(struct cycle *c)
{
	struct ahead_move w = {
		.l = law_travel_limits(c, c->gap.retract_mm_s),
	};
	struct mover_limits beside;

	c->hold.braked = c->hold.braked || c->mover.v_mm_s == 0;
	if (c->hold.seek > 0)
		hole_follow(c);
	if (!escape_is_out(&c->escape))
		return c->hold.moving && c->hold.braked ?
		       go_to(c, &w, c->hold.to_mm) : brake(c);
	/* Brake by a plan, so that it stops at a corner and before the cut. */
	beside = escape_limits(c);
	if (!c->hold.moving)
		return mover_stop(&c->mover, &beside);
	beside.v_max_mm_s = fmin(c->gap.retract_mm_s, beside.v_max_mm_s);
	return escape_to(c, &beside, c->hold.to_mm);
}

static double none(struct cycle *c)
{
	return law_go_at(c, 0);
}

static double (*const laws[CYCLE_NSTATES])(struct cycle *) = {
	[STATE_STAY]	 = none,
	[STATE_IDLE]	 = none,
	[STATE_TRAVEL]	 = travel,
	[STATE_APPROACH] = law_approach,
	[STATE_ERODE]	 = law_erode,
	[STATE_RETRACT]	 = law_retract,
	[STATE_JUMP]	 = jump,
	[STATE_HOLD]	 = hold,
	[STATE_FAULT]	 = none,
	[STATE_JOG]	 = none,
	[STATE_HOME]	 = none,
	[STATE_PROBE]	 = probe_distance,
};

/* What a law of the gap left is braked as that law would. */
static bool is_unplanned(const struct cycle *c)
{
	return c->mover.kind == MOVER_NO_PLAN && c->mover.v_mm_s != 0 &&
	       (c->state == STATE_TRAVEL || c->state == STATE_JUMP ||
		c->state == STATE_HOLD);
}

double feed_distance(struct cycle *c)
{
	if (is_unplanned(c) || asking_waits(c))
		return pace_go(c, 0, INFINITY);
	return laws[c->state](c);
}

static bool there(const struct cycle *c, double to_mm)
{
	return c->mover.v_mm_s == 0 &&
	       fabs(to_mm - place_mm(c)) < 2 * MOVER_ONTO_MM;
}

/* A jump goes up, and then back until it is just before the cut. */
static bool jump_done(struct cycle *c)
{
	if (c->lift.waits || !there(c, c->lift.to_mm))
		return false;
	if (!c->lift.up || c->lift.leaving)
		return true;
	c->lift.up = false;
	c->lift.to_mm = fmax(c->lift.from_mm - c->jump.short_of_mm,
			     place_mm(c));
	return there(c, c->lift.to_mm);
}

bool feed_done(struct cycle *c)
{
	if (c->state == STATE_JUMP)
		return jump_done(c);
	if (c->state == STATE_PROBE)
		return c->probe.phase == PROBE_DONE;
	if (c->state == STATE_HOLD && c->hold.moving &&
	    there(c, c->hold.to_mm)) {
		c->hold.moving = false;
		c->moved.there = true;
	}
	return false;
}
