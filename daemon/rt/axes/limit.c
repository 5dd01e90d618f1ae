/* SPDX-License-Identifier: Apache-2.0 */
/*
 * limit.c - hard limit switches
 */
#include "axes/limit.h"
#include "cycle.h"

#include <math.h>

#define BOUNCE_MM	1.0		/* degrees of A B C */

bool limit_bars(const struct limit *l, uint32_t axis, int toward)
{
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

void limit_guard(struct cycle *c, const struct io_inputs *in)
{
	const uint32_t came = in->limit & ~c->limit.on;

	/*
	 * The direction of the last pulses tells on which side of the axis the
	 * switch lies. Before the first period this edmd has made no pulses.
	 */
	for (uint32_t m = in->limit; m; m &= m - 1) {
		const int i = __builtin_ctz(m);
		const int32_t at = comp_pulses(&c->comp.axis[i]);

		if (came >> i & 1 && !bounces(c, i, at))
			c->limit.side[i] = c->comp.begun ?
					   c->comp.axis[i].toward : 0;
		c->limit.at[i] = at;
	}
	c->limit.on = in->limit;
	c->limit.met |= in->limit;
	if ((came && cycle_moves(c)) ||
	    (in->limit && state_duty[c->state].running))
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
