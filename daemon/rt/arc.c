/* SPDX-License-Identifier: Apache-2.0 */
/*
 * arc.c - the ladder against arcs
 */
#include "arc.h"
#include "walk.h"

#include <math.h>

#define LASTING_MEANS	5		/* in a row after a retract: a fault */

static double own_off_us(const struct cycle *c)
{
	return c->out.pulse.off_us > 0 ? c->out.pulse.off_us : c->gap.off_us;
}

/* Is there anything on it, on this machine? */
static bool has(const struct cycle *c, uint32_t rung)
{
	if (rung <= ARC_OFF_LAST)
		return own_off_us(c) > 0 && c->gap.arc_off_max > 1;
	if (rung == ARC_JUMP)
		return flush_jumps(c);
	return true;
}

static void climb(struct cycle *c)
{
	struct arc *a = &c->arc;

	c->totals.arcs++;
	a->calm = 0;
	if (a->rung == ARC_RETRACT && ++a->lasting < LASTING_MEANS)
		return;
	a->lasting = 0;
	do {
		a->rung++;
	} while (a->rung < ARC_FAULT && !has(c, a->rung));
	a->due = a->rung == ARC_JUMP || a->rung == ARC_RETRACT;
	if (a->rung < ARC_FAULT)
		return;
	a->rung = ARC_NONE;
	cycle_fail(c, FAULT_ARCING);
}

/* What a jump or a retract ended: should arcs come again, so will they. */
static void end_deeds(struct cycle *c)
{
	struct arc *a = &c->arc;

	a->lasting = 0;
	a->due = false;
	if (a->rung > ARC_OFF_LAST)
		a->rung = has(c, ARC_OFF_LAST) ? ARC_OFF_LAST : ARC_NONE;
}

/* Slowly: arcs come back to the place they burned. */
static void descend(struct cycle *c)
{
	struct arc *a = &c->arc;

	a->calm += c->gap.arc_cycles;
	if (a->rung == ARC_NONE || a->calm < c->gap.arc_recover_cycles)
		return;
	a->calm = 0;
	a->rung--;
}

void arc_watch(struct cycle *c)
{
	struct arc *a = &c->arc;
	double mean;

	if (c->gap.arc_share <= 0)
		return;
	a->sum += c->sensed.arc;
	if (++a->cycles < c->gap.arc_cycles)
		return;
	mean = a->sum / a->cycles;
	a->sum = 0;
	a->cycles = 0;
	if (mean > c->gap.arc_share) {
		climb(c);
		return;
	}
	end_deeds(c);
	if (mean < c->gap.arc_share / 2)
		descend(c);
	else
		a->calm = 0;
}

bool arc_jump_due(const struct cycle *c)
{
	return c->arc.due && c->arc.rung == ARC_JUMP;
}

bool arc_retract_due(const struct cycle *c)
{
	return c->arc.due && c->arc.rung == ARC_RETRACT;
}

double arc_retract_mm(const struct cycle *c)
{
	return arc_retract_due(c) ? c->gap.arc_retract_mm : 0;
}

/* The mean begins anew: power was off. */
void arc_met(struct cycle *c)
{
	c->arc.due = false;
	c->arc.sum = 0;
	c->arc.cycles = 0;
}

double arc_off_us(const struct cycle *c)
{
	const uint32_t step = c->arc.rung < ARC_OFF_LAST ? c->arc.rung :
							   ARC_OFF_LAST;

	if (step == ARC_NONE || !has(c, ARC_OFF_FIRST))
		return c->out.pulse.off_us;
	return own_off_us(c) *
	       (1 + step * (c->gap.arc_off_max - 1) / ARC_OFF_LAST);
}
