/* SPDX-License-Identifier: Apache-2.0 */
/*
 * options.h - edmd's command line
 */
#ifndef EDMD_OPTIONS_H
#define EDMD_OPTIONS_H

#include "config.h"

struct options {
	const char *config;		/* NULL: the built-in machine */
	const char *name;		/* NULL: as the machine file says */
	bool check;
	bool print_config;
};

/**
 * options_read() - read the command line.
 *
 * Return: -1 to go on, or the exit code: after help, version, or a usage error.
 */
int options_read(struct options *o, int argc, char **argv);

/**
 * options_config() - read the machine file that the options name. Return: -1 or
 * the exit code.
 */
int options_config(const struct options *o, struct machine_config *c);

/**
 * options_check() - the machine file is correct: is what it names, too?
 * Return: the exit code, if it returns.
 */
int options_check(const struct options *o);

#endif /* EDMD_OPTIONS_H */
