/* SPDX-License-Identifier: Apache-2.0 */
/* build_rule.h - how a strategy walks a line, and which lines it refuses */
#ifndef PATH_BUILD_RULE_H
#define PATH_BUILD_RULE_H

#include "interp/build.h"
#include "pulse/couple.h"
#include "pulse/strategy.h"

/* A straight way in all axes, pulses. */
struct build_way {
	int32_t from[INTERP_NAXES], to[INTERP_NAXES];
	int64_t longest_sub;		/* way of its longest axis, subpulses */
	uint32_t except;		/* a circle leads these axes: a helix */
	uint8_t order[INTERP_NAXES];	/* the axes in the order of the nodes'
					 * columns, in which they are coupled */
};

/** build_rule_of() - strategy, coupling and tolerance of a way. */
struct couple_rule build_rule_of(const struct interp_build_options *o,
				 const struct build_way *w);

/**
 * build_rule_inputs() - the axes that have pulses to give, in order.  Return:
 * how many.
 */
uint32_t build_rule_inputs(const struct build_way *w, struct couple_input *in);

/** build_rule_pulses() - the ticks of a line, one axis at a time; also more. */
uint64_t build_rule_pulses(const struct build_way *w);

/** build_rule_check() - 0, or -EINVAL with @diag's found and wanted. */
int build_rule_check(const struct interp_build_options *o,
		     const struct build_way *w, struct interp_diag *diag);

/**
 * build_refuse_tolerance() - refuse, and say that @smallest is possible.
 * Return: -EINVAL.
 */
int build_refuse_tolerance(const struct interp_build_options *o,
			   const char *what, uint32_t smallest,
			   struct interp_diag *diag);

#endif /* PATH_BUILD_RULE_H */
