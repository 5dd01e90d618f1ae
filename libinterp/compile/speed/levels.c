/* SPDX-License-Identifier: Apache-2.0 */
/*
 * levels.c - segments one behind the other that allow nearly the same
 * acceleration, or jerk, allow the least of it; and so do nodes that allow
 * nearly the same speed
 *
 * So a cycle that looks ahead for less finds no more than a few hundred places.
 * A move has the least of its whole way, which is no less for that.  Between
 * steps that are the same everywhere, a rounding would take what is a little
 * above a step to the next one below.
 */
#include "speed/pass.h"

#include <stddef.h>

#define STEP	(1 + 1.0f / 32)

/* Of one number of the segments, from segment @from on. */
struct run {
	uint32_t from;
	float least, most;
	size_t number;			/* where in a segment it is */
	bool moves;			/* actions have none */
};

static inline float *number_of(const struct run *k, struct interp_seg *s)
{
	return (float *)((char *)s + k->number);
}

/* Does it go on with this value? */
static inline bool run_on(struct run *k, float v)
{
	float least, most;

	/* Mostly it is between those before. */
	if (v >= k->least && v <= k->most)
		return true;
	least = v < k->least ? v : k->least;
	most = v > k->most ? v : k->most;
	if (most > STEP * least)
		return false;
	k->least = least;
	k->most = most;
	return true;
}

static void level(const struct run *k, struct interp_seg *segs, uint32_t to)
{
	for (uint32_t i = k->from; i < to && k->most > k->least; i++)
		if (!k->moves || segs[i].kind < INTERP_BEGIN)
			*number_of(k, &segs[i]) = k->least;
}

/* Nodes without a limit, INFINITY, are a run of their own. */
static inline void go_on(struct run *k, struct interp_seg *segs, uint32_t i)
{
	const float v = *number_of(k, &segs[i]);

	if ((k->moves && segs[i].kind >= INTERP_BEGIN) || run_on(k, v))
		return;
	level(k, segs, i);
	k->from = i;
	k->least = k->most = v;
}

void pass_levels(struct pass *w)
{
	struct run runs[] = {
		{ 0, INFINITY, 0, offsetof(struct interp_seg, node_mm_s),
		  false },
		{ 0, INFINITY, 0, offsetof(struct interp_seg, a_mm_s2), true },
		{ 0, INFINITY, 0, offsetof(struct interp_seg, j_mm_s3), true },
	};

	for (int n = 0; n < 3; n++) {
		for (uint32_t i = 0; i <= w->end; i++)
			go_on(&runs[n], w->segs, i);
		level(&runs[n], w->segs, w->end + 1);
	}
}
