/* SPDX-License-Identifier: Apache-2.0 */
/*
 * strategies.h - the table of strategies: how a path becomes pulses
 *
 * A row has the number of the strategy, INTERP_..., and then the members of its
 * struct pulse_strategy.  Their meanings, and what a new strategy needs, are in
 * libinterp/core/pulse/strategy.h.  The order of the rows is part of the format
 * of a program: add new rows at the end.
 */
#ifndef INTERP_STRATEGIES_H
#define INTERP_STRATEGIES_H

/* clang-format off */
#define INTERP_STRATEGIES(X)						\
	/* Every axis may pulse in the same tick. */			\
	X(SIMULTANEOUS, .name = "simultaneous",				\
	  .line = &pulse_line, .flat = &pulse_line, .arc = &pulse_arc,	\
	  .pair = &pulse_pair_at_once, .at_once = true)			\
	/* One axis at a time, toward the line; within a pulse. */	\
	X(POINT_BY_POINT, .name = "point-by-point",			\
	  .line = &pulse_tree, .flat = &pulse_tree, .pair = &pulse_pair) \
	/* One axis at a time, as near to the line as that allows. */	\
	X(CENTRED, .name = "centred",					\
	  .line = &pulse_tree, .flat = &pulse_flat, .pair = &pulse_pair, \
	  .set = pair_set_centred, .couples = true)			\
	/* One axis at a time; the main axis goes as far as mu allows. */ \
	X(MAIN_DIRECTION, .name = "main-direction",			\
	  .line = &pulse_tree, .flat = &pulse_flat, .pair = &pulse_pair, \
	  .set = pair_set_main_direction, .least_milli = 500,		\
	  .takes_tolerance = true, .couples = true)			\
	/* One axis at a time, with few changes of axis, within mu. */	\
	X(MIN_SWITCH, .name = "min-switch",				\
	  .line = &pulse_tree, .flat = &pulse_flat, .pair = &pulse_pair, \
	  .set = pair_set_min_switch, .takes_tolerance = true,		\
	  .couples = true, .runs = true)
/* clang-format on */

enum interp_strategy {
#define INTERP_STRATEGY_NUMBER(number, ...)	INTERP_##number,
	INTERP_STRATEGIES(INTERP_STRATEGY_NUMBER)
#undef INTERP_STRATEGY_NUMBER
	INTERP_NSTRATEGIES
};

#endif /* INTERP_STRATEGIES_H */
