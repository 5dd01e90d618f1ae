/* SPDX-License-Identifier: Apache-2.0 */
/* build_rule.c - how a strategy walks a line, and which lines it refuses */
#include "path/build_rule.h"
#include "pulse/strategy.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

uint64_t build_rule_pulses(const struct build_way *w)
{
	uint64_t n = 0;

	for (int i = 0; i < INTERP_NAXES; i++) {
		if (!(w->except & 1u << i))
			n += (uint64_t)llabs((int64_t)w->to[i] - w->from[i]);
	}
	return n;
}

int build_refuse_tolerance(const struct interp_build_options *o,
			   const char *what, uint32_t smallest,
			   struct interp_diag *diag)
{
	return interp_diag_say(diag, "a tolerance of %g pulses%s is too "
			       "narrow for %s under %s; %g pulses or more, or "
			       "strategy centred or simultaneous",
			       o->tolerance_milli / 1000.0,
			       o->perpendicular ? ", square to the path," : "",
			       what, interp_strategy_name(o->strategy),
			       smallest / 1000.0);
}

uint32_t build_rule_inputs(const struct build_way *w, struct couple_input *in)
{
	uint32_t n = 0;

	for (int j = 0; j < INTERP_NAXES; j++) {
		const int i = w->order[j];
		const int64_t d = (int64_t)w->to[i] - w->from[i];

		if (d != 0 && !(w->except & 1u << i))
			in[n++] = (struct couple_input) { (int8_t)i, llabs(d) };
	}
	return n;
}

/* Beside a circle the other axes always form a tree. */
struct couple_rule build_rule_of(const struct interp_build_options *o,
				 const struct build_way *w)
{
	return (struct couple_rule) {
		.strategy = o->strategy,
		.coupling = w->except ? INTERP_TREE : o->coupling,
		.tube = { o->tolerance_milli, o->perpendicular },
	};
}

int build_rule_check(const struct interp_build_options *o,
		     const struct build_way *w, struct interp_diag *diag)
{
	const struct pulse_strategy *s = pulse_strategy(o->strategy);
	const struct couple_rule rule = build_rule_of(o, w);
	struct couple_input in[INTERP_NAXES];
	uint32_t n, smallest;

	if (!s->couples)
		return 0;
	n = build_rule_inputs(w, in);
	if (n < 2)
		return 0;
	if (!s->takes_tolerance)
		return 0;
	smallest = couple_smallest_milli(&rule, in, n);
	if (smallest == o->tolerance_milli)
		return 0;
	return build_refuse_tolerance(o, "this line", smallest, diag);
}
