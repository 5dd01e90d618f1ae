/* SPDX-License-Identifier: Apache-2.0 */
/* trials.c - shows how far a search has come */
#include "trials.h"
#include "clocks.h"
#include "standard.h"

#include <stdio.h>
#include <time.h>
#include <unistd.h>

struct trials trials_begin(bool quiet, unsigned int budget)
{
	return (struct trials) { quiet, isatty(STDERR_FILENO) == 1, budget,
				 clock_s(CLOCK_MONOTONIC) };
}

void trials_tell(const struct trials *t, unsigned int used, const char *best)
{
	const double left_s = (clock_s(CLOCK_MONOTONIC) - t->from_s) / used *
			      (t->budget - used);

	if (t->quiet || (!t->terminal && used % 20 != 0))
		return;
	if (t->terminal)
		standard_control(stderr, "\r");
	fprintf(stderr, "%4u of %u trials, best %s; %.0f s left%s", used,
		t->budget, best, left_s, t->terminal ? "   " : "\n");
}

void trials_end(const struct trials *t)
{
	if (!t->quiet && t->terminal)
		fputc('\n', stderr);
}
