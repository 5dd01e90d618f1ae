/* SPDX-License-Identifier: Apache-2.0 */
/*
 * trials.h - the progress of a search, on stderr: one line that is rewritten on
 * a terminal; elsewhere a line for every twentieth trial
 */
#ifndef SIM_TRIALS_H
#define SIM_TRIALS_H

#include <stdbool.h>

struct trials {
	bool quiet, terminal;
	unsigned int budget;
	double from_s;
};

/** trials_begin() - the search begins now. */
struct trials trials_begin(bool quiet, unsigned int budget);

/**
 * trials_tell() - after trial number @used, counted from 1; @best: the best so
 * far, in words.
 */
void trials_tell(const struct trials *t, unsigned int used, const char *best);

void trials_end(const struct trials *t);

#endif /* SIM_TRIALS_H */
