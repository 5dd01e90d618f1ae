/* SPDX-License-Identifier: Apache-2.0 */
/*
 * entry.h - the way into a program that begins at a place inside it
 *
 * This is for a job that a power cut interrupted, and for one that begins at a
 * line or a place that its sender names: interp/build_from.h.
 *
 * Threads: any.
 */
#ifndef CONFIG_ENTRY_H
#define CONFIG_ENTRY_H

#include "config.h"
#include "interp/build_from.h"

#include <stddef.h>

/** config_way_out() - the axis whose + leads out of the work; -1: a wire
 *  machine, where the wire is cut off and threaded again. */
int config_way_out(const struct machine_config *c);

/**
 * config_entry_words() - tell the way to an operator, as the rest of a sentence
 * that begins with who moves: "positions it to X1.000 ..., off the work; then
 * it comes in along its path, 3.200 mm up to line 8, and cuts on from the first
 * spark".
 */
void config_entry_words(const struct machine_config *c,
			const struct interp_build_entry *e, char *to,
			size_t size);

#endif /* CONFIG_ENTRY_H */
