/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_rule.c - what a strategy makes of a line, and which it refuses
 */
#include "path/build_rule.h"
#include "pulse/couple.h"
#include "pulse/pulse.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

static uint64_t pulses_of(const struct build_way *w)
{
	uint64_t n = 0;

	for (int i = 0; i < INTERP_NAXES; i++) {
		if (!(w->except & 1u << i))
			n += (uint64_t)llabs((int64_t)w->to[i] - w->from[i]);
	}
	return n;
}

uint64_t build_rule_ticks(enum interp_strategy s, const struct build_way *w)
{
	const int64_t longest = (w->longest_sub + INTERP_SUB - 1) >>
				INTERP_SUB_BITS;

	if (s == INTERP_SIMULTANEOUS)
		return (uint64_t)longest;
	if (s != INTERP_DDA)
		return pulses_of(w);
	return longest > INTERP_PULSES_MAX ? UINT64_MAX :
					     (uint64_t)pulse_dda_ticks(longest);
}

int build_refuse_tolerance(const struct interp_build_options *o,
			   const char *what, uint32_t smallest,
			   struct interp_diag *diag)
{
	snprintf(diag->found, sizeof(diag->found),
		 "a tolerance of %g pulses%s is too narrow for %s under %s",
		 o->tolerance_milli / 1000.0,
		 o->perpendicular ? ", square to the path," : "", what,
		 interp_strategy_name(o->strategy));
	snprintf(diag->wanted, sizeof(diag->wanted),
		 "%g pulses or more, or strategy centred or simultaneous",
		 smallest / 1000.0);
	return -EINVAL;
}

static int refuse_tube(const struct interp_build_options *o,
		       struct interp_diag *diag)
{
	snprintf(diag->found, sizeof(diag->found),
		 "coupling tube with strategy %s",
		 interp_strategy_name(o->strategy));
	snprintf(diag->wanted, sizeof(diag->wanted),
		 "strategy min-switch, or coupling star or tree");
	return -EINVAL;
}

static uint32_t inputs_of(const struct build_way *w, struct couple_input *in)
{
	uint32_t n = 0;

	for (int i = 0; i < INTERP_NAXES; i++) {
		const int64_t d = (int64_t)w->to[i] - w->from[i];

		if (d != 0 && !(w->except & 1u << i))
			in[n++] = (struct couple_input) { (int8_t)i, llabs(d) };
	}
	return n;
}

int build_rule_check(const struct interp_build_options *o,
		     const struct build_way *w, struct interp_diag *diag)
{
	/* Beside a circle the other axes are always a tree. */
	const struct couple_rule rule = {
		.strategy = o->strategy,
		.coupling = w->except ? INTERP_TREE : o->coupling,
		.tube = { o->tolerance_milli, o->perpendicular },
	};
	struct couple_input in[INTERP_NAXES];
	uint32_t n, smallest;

	if (o->strategy < INTERP_CENTRED || o->strategy == INTERP_DDA)
		return 0;
	n = inputs_of(w, in);
	if (n < 2)
		return 0;
	if (n > 2 && rule.coupling == INTERP_TUBE &&
	    o->strategy != INTERP_MIN_SWITCH)
		return refuse_tube(o, diag);
	if (o->strategy == INTERP_CENTRED)
		return 0;
	smallest = couple_smallest_milli(&rule, in, n);
	if (smallest == o->tolerance_milli)
		return 0;
	return build_refuse_tolerance(o, "this line", smallest, diag);
}
