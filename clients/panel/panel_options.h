/* SPDX-License-Identifier: Apache-2.0 */
/*
 * panel_options.h - the command line of edm-panel
 */
#ifndef PANEL_PANEL_OPTIONS_H
#define PANEL_PANEL_OPTIONS_H

#include "work.h"

#include <stdbool.h>
#include <stdint.h>

struct panel_options {
	const char *config, *machine, *assets;
	double port;			/* 0: the one of the machine file */
	const char *add_user, *role;
	bool print_words;
	struct work work;		/* work.what is set: do this instead */
};

/**
 * panel_options_take() - read the command line. Return: -1 to go on, or the
 * exit code.
 */
int panel_options_take(struct panel_options *ret, int argc, char **argv);

#endif /* PANEL_PANEL_OPTIONS_H */
