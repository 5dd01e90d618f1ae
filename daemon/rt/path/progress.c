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

/* A number that differs between a lattice point and those near it. */
static uint64_t stamp(const struct cycle *c)
{
	return (uint64_t)c->cursor.tick + ((uint64_t)c->cursor.index << 40) +
	       ((uint64_t)c->escape.tick << 20);
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

static bool has_a_name(const struct cycle *c)
{
	return gap_stands(c) || !cycle_moves(c) || c->busy || dwells(c) ||
	       c->mcode.waits || c->axes.awaited ||
	       !contouring_rests(&c->contouring) ||
	       (c->override == 0 && (c->state == STATE_TRAVEL ||
				     c->state == STATE_PROBE));
}

static bool brakes(const struct cycle *c)
{
	return c->mover.kind == MOVER_TO_SPEED && c->mover.goal == 0 &&
	       !mover_is_standing(&c->mover);
}

/* The speed of what it has to do; jumps and moves by command are fast.  What
 * brakes goes as slowly as it goes, and comes to an end. */
static double speed_mm_s(const struct cycle *c, const struct interp_seg *s)
{
	if (brakes(c))
		return fabs(c->mover.v_mm_s);
	return c->state == STATE_TRAVEL ?
	       law_seg_speed(s) * (c->override < 1 ? c->override : 1) :
	       c->state == STATE_HOLD ? c->gap.retract_mm_s :
					c->jump.v_max_mm_s;
}

/* A time after which some points should have come. */
static bool is_long(const struct cycle *c)
{
	const double still_s = (double)c->progress.still * law_period_s(c);
	const struct interp_seg *s;
	double point_mm;

	if (still_s < STILL_S)
		return false;
	s = lookahead_toward(c, c->mover.v_mm_s < 0 ? -1 : 1);
	if (!s || s->ticks == 0)
		return true;
	point_mm = s->length_mm / (double)s->ticks;
	return still_s * speed_mm_s(c, s) > STILL_POINTS * point_mm;
}

void progress_look(struct cycle *c)
{
	struct progress *p = &c->progress;
	const uint64_t at = stamp(c);

	if (at != p->at) {
		p->at = at;
		p->still = 0;
		return;
	}
	if (has_a_name(c))
		p->still = 0;
	else if ((p->still += PROGRESS_EVERY) && is_long(c))
		fault_latch(&c->fault, FAULT_STUCK);
	p->place_mm = place_mm(c);
}
