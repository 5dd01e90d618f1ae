/* SPDX-License-Identifier: Apache-2.0 */
/*
 * progress.c - does a motion that is under way go on?
 */
#include "path/progress.h"

#include "path/laws.h"
#include "path/lookahead.h"
#include "path/place.h"

#include <math.h>

#define STILL_S		1.0		/* at any speed */
#define STILL_POINTS	8.0		/* at a low one */

/*
 * A number that differs between a lattice point and those near it.  It differs
 * too if the gap servo was at work: a narrow gap at the begin of a cut lets the
 * machine go to and fro between travel and erode.
 */
static uint64_t stamp(const struct cycle *c)
{
	return (uint64_t)c->cursor.tick + ((uint64_t)c->cursor.index << 40) +
	       ((uint64_t)c->escape.tick << 20) +
	       (c->totals.erode_cycles << 56);
}

/* The gap says how fast to go, and it may say to stand. */
static bool gap_stands(const struct cycle *c)
{
	if (!state_duty[c->state].power && c->state != STATE_RETRACT &&
	    c->state != STATE_PROBE)
		return false;
	/* A distance of a cycle that is lost in a rounding counts as a
	 * stand. */
	return place_mm(c) != c->progress.place_mm ||
	       fabs(c->mover.v_mm_s) * law_period_s(c) < MOVER_ONTO_MM;
}

/* A wait that had begun is forgotten on the way back, and begins again. */
static bool dwells(const struct cycle *c)
{
	return c->job.dwelling && (state_duty[c->state].power ||
			       c->state == STATE_TRAVEL);
}

/*
 * Where the axes have little jerk, an S-curve takes seconds for its first and
 * its last pulse.  A plan that is made anew all the time gets no older, and one
 * that nobody walks leaves the place where it is.
 */
static bool follows_plan(const struct cycle *c)
{
	const struct progress *p = &c->progress;

	return c->mover.kind != MOVER_NO_PLAN &&
	       c->mover.t_s > PROGRESS_EVERY * law_period_s(c) &&
	       place_mm(c) != p->place_mm;
}

static bool has_a_name(const struct cycle *c)
{
	return gap_stands(c) || follows_plan(c) || !cycle_moves(c) ||
	       c->busy || dwells(c) || c->mcode.waits || c->axes.phase ||
	       (c->state == STATE_TRAVEL && c->ground.answer == GROUND_ASKED) ||
	       !contouring_rests(&c->contouring) ||
	       (c->override == 0 && (c->state == STATE_TRAVEL ||
				     c->state == STATE_PROBE));
}

static bool brakes(const struct cycle *c)
{
	return c->mover.kind == MOVER_TO_SPEED && c->mover.goal == 0 &&
	       !mover_is_standing(&c->mover);
}

/* What the plan comes to, where it is not to stand; a slower place ahead may be
 * a thousandth as fast as this one, and is slowed down to long before. */
static double planned_mm_s(const struct cycle *c)
{
	const struct mover *m = &c->mover;
	const double v = m->kind == MOVER_TO_SPEED ? fabs(m->goal) :
			 m->kind == MOVER_TO_PLACE ? fabs(m->pass_mm_s) : 0;

	return v > 0 ? v : INFINITY;
}

/*
 * In points a second, of what it has to do; 0: on nothing that has a length.  A
 * line shorter than a pulse may have no point, but it has an end.  What brakes
 * goes as slowly as it goes, and comes to an end.
 */
static double points_s(const struct cycle *c)
{
	const struct interp_seg *s =
		lookahead_toward(c, c->mover.v_mm_s < 0 ? -1 : 1);
	double v;

	if (!s || !(s->length_mm > 0))
		return 0;
	if (brakes(c))
		v = fabs(c->mover.v_mm_s);
	else if (c->state == STATE_TRAVEL)
		v = law_seg_speed(s) * (c->override < 1 ? c->override : 1);
	else
		v = fmin((double)s->feed_max_mm_s,
			 c->state == STATE_HOLD ? c->gap.retract_mm_s :
						  c->jump.v_max_mm_s);
	return fmin(v, planned_mm_s(c)) * fmax((double)s->ticks, 1) /
	       s->length_mm;
}

/* A time after which some points should have come. */
static bool is_long(const struct cycle *c)
{
	const double still_s = (double)c->progress.still * law_period_s(c);
	const double by_s = c->progress.points_s;

	return still_s >= STILL_S &&
	       (by_s == 0 || still_s * by_s > STILL_POINTS);
}

void progress_look(struct cycle *c)
{
	struct progress *p = &c->progress;
	const uint64_t at = stamp(c);
	const double by_s = points_s(c);

	/* A fast move may follow a slow one between two points. */
	if (at != p->at || by_s != p->points_s || has_a_name(c))
		p->still = 0;
	else if ((p->still += PROGRESS_EVERY) && is_long(c))
		fault_latch(&c->fault, FAULT_STUCK);
	p->at = at;
	p->points_s = by_s;
	p->place_mm = place_mm(c);
}
