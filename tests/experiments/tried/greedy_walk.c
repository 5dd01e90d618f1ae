/* SPDX-License-Identifier: Apache-2.0 */
/* greedy_walk.c - walk a list of runs in both directions */
#include "tried/greedy_walk.h"

static bool run_main(const struct greedy_walk *w)
{
	return w->r->main_first == (w->i % 2 == 0);
}

bool greedy_forward(struct greedy_walk *w)
{
	if (w->sent == w->r->run[w->i]) {
		w->i++;
		w->sent = 0;
	}
	w->sent++;
	return run_main(w);
}

bool greedy_back(struct greedy_walk *w)
{
	const bool main = run_main(w);

	w->sent--;
	if (w->sent == 0 && w->i > 0) {
		w->i--;
		w->sent = w->r->run[w->i];
	}
	return main;
}
