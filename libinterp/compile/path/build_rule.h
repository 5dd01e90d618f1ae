/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_rule.h - what a strategy makes of a line, and which it refuses
 */
#ifndef PATH_BUILD_RULE_H
#define PATH_BUILD_RULE_H

#include "interp/build.h"
#include "pulse/couple.h"

/* A straight way in all axes, pulses. */
struct build_way {
	int32_t from[INTERP_NAXES], to[INTERP_NAXES];
	int64_t longest_sub;		/* its longest axis, subpulses */
	uint32_t except;		/* a circle leads these axes: a helix */
	uint8_t order[INTERP_NAXES];	/* the axes as the nodes' columns have
					 * them, which couples them */
};

/** build_rule_of() - strategy, coupling and tolerance of a way. */
struct couple_rule build_rule_of(const struct interp_build_options *o,
				 const struct build_way *w);

/** build_rule_inputs() - the axes with pulses to give, in order; how many. */
uint32_t build_rule_inputs(const struct build_way *w, struct couple_input *in);

/** build_rule_ticks() - of a line; more than INTERP_PULSES_MAX: too many. */
uint64_t build_rule_ticks(enum interp_strategy s, const struct build_way *w);

/** build_rule_check() - 0, or -EINVAL with @diag's found and wanted. */
int build_rule_check(const struct interp_build_options *o,
		     const struct build_way *w, struct interp_diag *diag);

/** build_refuse_tolerance() - say that @smallest is the least; -EINVAL. */
int build_refuse_tolerance(const struct interp_build_options *o,
			   const char *what, uint32_t smallest,
			   struct interp_diag *diag);

#endif /* PATH_BUILD_RULE_H */
