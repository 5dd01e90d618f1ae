/* SPDX-License-Identifier: Apache-2.0 */
/*
 * compiling.h - a machine file as the options a job's text is compiled with
 *
 * Threads: any, each with a struct of its own.
 */
#ifndef CONFIG_COMPILING_H
#define CONFIG_COMPILING_H

#include "config.h"

#include "interp/compile.h"

/* The options point into the rest, into the machine file and into the table:
 * it must stay where it was filled, and not outlive them. */
struct config_compiling {
	struct interp_build_options build;
	struct interp_compile_options text;
	struct interp_mcode mcodes[INTERP_NMCODES];
	struct interp_tech tech;
	struct interp_kinematics kinematics;
};

/**
 * config_compiling() - fill @ret.
 *
 * The path begins at start_mm of the axes; who knows better where the machine
 * stands sets build.start_mm after it.
 */
void config_compiling(const struct machine_config *c,
		      const struct config_tech *tech,
		      struct config_compiling *ret);

#endif /* CONFIG_COMPILING_H */
