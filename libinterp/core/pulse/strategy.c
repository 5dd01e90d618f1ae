/* SPDX-License-Identifier: Apache-2.0 */
/*
 * strategy.c - the table of strategies, and their names
 */
#include "pulse/strategy.h"

#include <errno.h>
#include <string.h>

#define ROW(number, ...)	[INTERP_##number] = { __VA_ARGS__ },

static const struct pulse_strategy table[INTERP_NSTRATEGIES] = {
	INTERP_STRATEGIES(ROW)
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
