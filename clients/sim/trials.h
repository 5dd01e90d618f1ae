/* SPDX-License-Identifier: Apache-2.0 */
/*
 * trials.h - how far a search is, on stderr: a line rewritten on a terminal;
 * elsewhere one in twenty, to keep
 */
#ifndef SIM_TRIALS_H
#define SIM_TRIALS_H

#include <stdbool.h>

struct trials {
	bool quiet, terminal;
	unsigned int budget;
	double from_s;
};

/** trials_now_s() - of a clock that never goes back. */
double trials_now_s(void);

/** trials_begin() - the search begins now. */
struct trials trials_begin(bool quiet, unsigned int budget);

/** trials_tell() - after trial @used, from 1; @best so far, in words. */
void trials_tell(const struct trials *t, unsigned int used, const char *best);

void trials_end(const struct trials *t);

#endif /* SIM_TRIALS_H */
