/* SPDX-License-Identifier: Apache-2.0 */
/* arcing.c - the steps that are taken against arcs */
#include "gap/arcing.h"
#include "cycle.h"

#include <math.h>

#define LASTING_MEANS	5		/* so many in a row after a retract are
					 * a fault */

static double own_off_us(const struct cycle *c)
{
	const double off_us = c->out.pulse[INTERP_TECH_OFF_US];

	return off_us > 0 ? off_us : c->gap.off_us;
}

static double off_us_at(const struct cycle *c, uint32_t rung)
{
	return own_off_us(c) *
	       (1 + rung * (c->gap.arcing_off_max - 1) /
		    (double)ARCING_OFF_LAST);
}

/* Can this machine take this step?  The off time must reach the generator, and
 * be longer there than a step before. */
static bool has(const struct cycle *c, uint32_t rung)
{
	if (rung <= ARCING_OFF_LAST)
		return rung > ARCING_NONE && own_off_us(c) > 0 &&
		       asking_off_us(c, off_us_at(c, rung)) >
		       (rung == ARCING_OFF_FIRST ? own_off_us(c) :
			asking_off_us(c, off_us_at(c, rung - 1)));
	if (rung == ARCING_JUMP)
		return flush_jumps(c);
	return true;
}

static void climb(struct cycle *c)
{
	struct arcing *a = &c->arcing;

	c->totals.arcs++;
	a->calm = 0;
	if (a->rung == ARCING_RETRACT && ++a->lasting < LASTING_MEANS)
		return;
	a->lasting = 0;
	do {
		a->rung++;
	} while (a->rung < ARCING_FAULT && !has(c, a->rung));
	a->due = a->rung == ARCING_JUMP || a->rung == ARCING_RETRACT;
	if (a->rung < ARCING_FAULT)
		return;
	a->rung = ARCING_NONE;
	fault_latch(&c->fault, FAULT_ARCING);
}

/* The last step of the off time up to @rung. */
static uint32_t off_step(const struct cycle *c, uint32_t rung)
{
	uint32_t step = rung < ARCING_OFF_LAST ? rung : ARCING_OFF_LAST;

	while (step > ARCING_NONE && !has(c, step))
		step--;
	return step;
}

/* The arcs have ended. If they come again, the jump and the retract are done
 * again too. */
static void end_deeds(struct cycle *c)
{
	struct arcing *a = &c->arcing;

	a->lasting = 0;
	a->due = false;
	if (a->rung > ARCING_OFF_LAST)
		a->rung = off_step(c, ARCING_OFF_LAST);
}

/* This is slow, because arcs often come back to the place where they burned. */
static void descend(struct cycle *c)
{
	struct arcing *a = &c->arcing;

	a->calm += c->gap.arcing_cycles;
	if (a->rung == ARCING_NONE || a->calm < c->gap.arcing_recover.cycles)
		return;
	a->calm = 0;
	a->rung--;
}

void arcing_watch(struct cycle *c)
{
	struct arcing *a = &c->arcing;
	double mean;

	if (c->gap.arcing_share <= 0)
		return;
	a->sum += c->sensed.arc;
	if (++a->cycles < c->gap.arcing_cycles)
		return;
	mean = a->sum / a->cycles;
	a->sum = 0;
	a->cycles = 0;
	if (mean > c->gap.arcing_share) {
		climb(c);
		return;
	}
	end_deeds(c);
	if (mean < c->gap.arcing_share / 2)
		descend(c);
	else
		a->calm = 0;
}

bool arcing_jump_due(const struct cycle *c)
{
	return c->arcing.due && c->arcing.rung == ARCING_JUMP;
}

bool arcing_retract_due(const struct cycle *c)
{
	return c->arcing.due && c->arcing.rung == ARCING_RETRACT;
}

double arcing_retract_mm(const struct cycle *c)
{
	return arcing_retract_due(c) ? c->gap.arcing_retract_mm : 0;
}

/* The power was off, so the average begins anew. */
void arcing_met(struct cycle *c)
{
	c->arcing.due = false;
	c->arcing.sum = 0;
	c->arcing.cycles = 0;
}

double arcing_off_us(const struct cycle *c)
{
	const uint32_t step = off_step(c, c->arcing.rung);

	return step == ARCING_NONE ? c->out.pulse[INTERP_TECH_OFF_US] :
				     off_us_at(c, step);
}
