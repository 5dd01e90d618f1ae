/* SPDX-License-Identifier: Apache-2.0 */
/*
 * retract.c - the bounds of a retract
 */
#include "gap/retract.h"
#include "hunting.h"
#include "path/laws.h"
#include "path/place.h"

#include <math.h>

double retract_limit_mm(const struct cycle *c)
{
	return c->gap.process == PROCESS_WIRE ? c->gap.wire_retract_mm :
						c->gap.retract_limit_mm;
}

double retract_motion_mm(const struct cycle *c)
{
	/* Beside the path only the way out has begun. */
	return escape_is_out(&c->escape) ? place_outer_mm(c) :
	       fmax(c->back_mm, c->cursor.seg.s_mm);
}

static double floor_of(const struct cycle *c)
{
	const double outer = place_outer_mm(c);

	switch (c->gap.retract_to) {
	case RETRACT_START:
		return outer;
	case RETRACT_MOTION:
		return fmax(outer, retract_motion_mm(c));
	default:
		return fmax(outer, place_mm(c) - retract_limit_mm(c));
	}
}

/* Retracts are in a row if it came no farther between them.  A kerf that is cut
 * again is not new, and yet it goes on in it. */
static void count(struct cycle *c)
{
	struct retract *r = &c->retract;

	if (r->in_row == 0 || r->from_mm > r->row_mm + c->gap.progress_mm) {
		r->in_row = 0;
		r->row_mm = r->from_mm;
	}
	r->in_row++;
	c->totals.hunts += r->in_row == HUNTING_ROW;
	if (r->in_row > c->totals.in_row_max)
		c->totals.in_row_max = r->in_row;
}

void retract_begin(struct cycle *c)
{
	struct retract *r = &c->retract;

	c->totals.retracts++;
	r->from_mm = place_mm(c);
	r->floor_mm = floor_of(c);
	r->least_mm = arcing_retract_mm(c);
	r->waited = 0;
	r->cycles = 0;
	r->leaves = c->gap.retract_escape && !escape_is_out(&c->escape);
	count(c);
}

bool retract_leave(struct cycle *c)
{
	if (c->mover.v_mm_s != 0)
		return false;
	c->retract.leaves = false;
	if (escape_begin(c))
		c->retract.floor_mm = floor_of(c);
	return true;
}

static double back_mm(const struct cycle *c)
{
	return c->retract.from_mm - place_mm(c);
}

static bool at_floor(const struct cycle *c)
{
	return c->at_start ||
	       place_mm(c) <= c->retract.floor_mm + MOVER_ONTO_MM;
}

bool retract_is_clear(const struct cycle *c)
{
	return c->sensed.signal_v >= c->gap.servo_v &&
	       (back_mm(c) >= c->retract.least_mm || at_floor(c));
}

/* Is the whole distance used, or the end of the way back reached? */
static enum cycle_fault blame(const struct cycle *c)
{
	return c->at_start || c->gap.retract_to != RETRACT_LIMIT ||
	       place_mm(c) <= place_outer_mm(c) + MOVER_ONTO_MM ?
	       FAULT_RETRACT_AT_START : FAULT_SHORT_NOT_CLEARED;
}

void retract_watch(struct cycle *c)
{
	const struct cycle_gap_config *g = &c->gap;
	struct retract *r = &c->retract;

	if (c->state != STATE_RETRACT)
		return;
	c->totals.retract_mm_max = fmax(c->totals.retract_mm_max, back_mm(c));
	if (g->abort_count > 0 && r->in_row >= g->abort_count) {
		fault_latch(&c->fault, FAULT_RETRACT_COUNT);
		return;
	}
	if (g->retract_max.cycles && ++r->cycles > g->retract_max.cycles) {
		fault_latch(&c->fault, FAULT_RETRACT_TIME);
		return;
	}
	if (!r->waited && !at_floor(c))
		return;
	/* It is as far back as it may go: stand there and give the short a
	 * little time. */
	if (r->waited++ >= g->retract_wait.cycles)
		fault_latch(&c->fault, blame(c));
}
