/* SPDX-License-Identifier: Apache-2.0 */
/*
 * limit.c - hard limit switches
 */
#include "axes/limit.h"
#include "cycle.h"

#include <math.h>

#define BOUNCE_MM	1.0		/* degrees of A B C */

void limit_recount(struct limit *l, uint32_t axis, uint32_t more)
{
	l->at[axis] = (int32_t)((uint32_t)l->at[axis] + more);
}

bool limit_bars(const struct limit *l, uint32_t axis, int toward)
{
	if ((l->low | l->high) >> axis & 1)
		return (l->wrong | (toward < 0 ? l->low : l->high)) >> axis & 1;
	return l->on >> axis & 1 && l->side[axis] == toward;
}

/* Does it come on again where it was on before? */
static bool bounces(const struct cycle *c, int axis, int32_t at)
{
	const struct limit *l = &c->limit;
	const double off = ((double)at - l->at[axis]) *
			   c->config.axis[axis].pulse_mm;

	return l->met >> axis & 1 && fabs(off) < BOUNCE_MM;
}

/* Which end it is at: the machine tells, or the direction of the last pulses
 * does.  Before the first period this edmd has made no pulses. */
static int side_of(const struct cycle *c, const struct io_inputs *in, int axis)
{
	const int high = in->limit_high >> axis & 1;
	const int low = in->limit_low >> axis & 1;

	return high || low ? high - low :
	       c->comp.begun ? c->comp.axis[axis].toward : 0;
}

void limit_guard(struct cycle *c, const struct io_inputs *in)
{
	struct limit *l = &c->limit;
	const uint32_t came = in->limit & ~l->on;
	const uint32_t told = in->limit_low | in->limit_high;

	l->low = in->limit_low;
	l->high = in->limit_high;
	l->wrong &= told;
	for (uint32_t m = in->limit; m; m &= m - 1) {
		const int i = __builtin_ctz(m);
		const int32_t at = comp_pulses(&c->comp.axis[i]);
		const bool fresh = came >> i & 1 && !bounces(c, i, at);

		if (fresh || told >> i & 1)
			l->side[i] = (int8_t)side_of(c, in, i);
		if (fresh && told >> i & 1 && cycle_moves(c) &&
		    l->side[i] * c->comp.axis[i].toward < 0)
			l->wrong |= 1u << i;
		l->at[i] = at;
	}
	l->on = in->limit;
	l->met |= in->limit;
	/* A drive that homes may look for its limit switch. */
	if ((came & ~manual_in_phase(c, HOME_BY_DRIVE) && cycle_moves(c)) ||
	    (in->limit & ~told && state_duty[c->state].running))
		fault_latch(&c->fault, FAULT_LIMIT_SWITCH);
}

void limit_watch(struct cycle *c)
{
	for (uint32_t m = c->limit.on; m; m &= m - 1) {
		const uint32_t i = (uint32_t)__builtin_ctz(m);
		const int32_t was = c->comp.axis[i].place;
		const int32_t is = c->out.target[i];

		if (is != was && limit_bars(&c->limit, i, is < was ? -1 : 1))
			fault_latch(&c->fault, FAULT_LIMIT_SWITCH);
	}
}
