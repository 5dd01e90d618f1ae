/* SPDX-License-Identifier: Apache-2.0 */
/*
 * strategy.c - the table of strategies, and their names
 */
#include "pulse/strategy.h"

#include <errno.h>
#include <string.h>

static const struct pulse_strategy table[INTERP_NSTRATEGIES] = {
	[INTERP_SIMULTANEOUS] = {
		.name = "simultaneous", .line = &pulse_line,
		.flat = &pulse_line, .arc = &pulse_arc,
		.pair = &pulse_pair_at_once, .at_once = true,
	},
	[INTERP_POINT_BY_POINT] = {
		.name = "point-by-point", .line = &pulse_tree,
		.flat = &pulse_tree, .pair = &pulse_pair,
	},
	[INTERP_CENTRED] = {
		.name = "centred", .line = &pulse_tree, .flat = &pulse_flat,
		.pair = &pulse_pair, .set = pair_set_centred, .couples = true,
	},
	[INTERP_DDA] = {
		.name = "dda", .line = &pulse_dda_line,
		.flat = &pulse_dda_line, .arc = &pulse_dda_arc,
		.pair = &pulse_pair, .accumulates = true,
	},
	[INTERP_MAIN_DIRECTION] = {
		.name = "main-direction", .line = &pulse_tree,
		.flat = &pulse_flat, .pair = &pulse_pair,
		.set = pair_set_main_direction, .least_milli = 500,
		.takes_tolerance = true, .couples = true,
	},
	[INTERP_MIN_SWITCH] = {
		.name = "min-switch", .line = &pulse_tree, .flat = &pulse_flat,
		.pair = &pulse_pair, .set = pair_set_min_switch,
		.takes_tolerance = true, .couples = true, .runs = true,
	},
};

const struct pulse_strategy *pulse_strategy(uint32_t s)
{
	return &table[s];
}

const char *interp_strategy_name(enum interp_strategy s)
{
	return s < INTERP_NSTRATEGIES ? table[s].name : NULL;
}

int interp_strategy_parse(const char *name)
{
	for (int i = 0; i < INTERP_NSTRATEGIES; i++) {
		if (strcmp(table[i].name, name) == 0)
			return i;
	}
	return -EINVAL;
}

bool interp_strategy_takes_tolerance(enum interp_strategy s)
{
	return s < INTERP_NSTRATEGIES && table[s].takes_tolerance;
}

bool interp_strategy_couples(enum interp_strategy s)
{
	return s < INTERP_NSTRATEGIES && table[s].couples;
}
