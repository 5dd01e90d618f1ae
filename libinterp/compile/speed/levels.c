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

#define STEP	(1 + 1.0f / 32)

/* From segment @from on. */
struct run {
	uint32_t from;
	float least, most;
};

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

static struct run begin(uint32_t from)
{
	return (struct run) { from, INFINITY, 0 };
}

static void level_a(struct interp_seg *segs, const struct run *k, uint32_t to)
{
	for (uint32_t i = k->from; i < to && k->most > k->least; i++)
		if (segs[i].kind < INTERP_BEGIN)
			segs[i].a_mm_s2 = k->least;
}

static void level_node(struct interp_seg *segs, const struct run *k,
		       uint32_t to)
{
	for (uint32_t i = k->from; i < to && k->most > k->least; i++)
		segs[i].node_mm_s = k->least;
}

static void level_j(struct interp_seg *segs, const struct run *k, uint32_t to)
{
	for (uint32_t i = k->from; i < to && k->most > k->least; i++)
		if (segs[i].kind < INTERP_BEGIN)
			segs[i].j_mm_s3 = k->least;
}

/* Does segment @i go on with these?  Nodes go on over what does not move. */
static inline void node_on(struct interp_seg *segs, uint32_t i, struct run *k)
{
	const float v = segs[i].node_mm_s;

	/* Nodes without a limit, INFINITY, are a run of their own. */
	if (run_on(k, v))
		return;
	level_node(segs, k, i);
	*k = (struct run) { i, v, v };
}

static inline void a_on(struct interp_seg *segs, uint32_t i, struct run *k)
{
	const float a = segs[i].a_mm_s2;

	if (run_on(k, a))
		return;
	level_a(segs, k, i);
	*k = (struct run) { i, a, a };
}

static inline void j_on(struct interp_seg *segs, uint32_t i, struct run *k)
{
	const float j = segs[i].j_mm_s3;

	if (run_on(k, j))
		return;
	level_j(segs, k, i);
	*k = (struct run) { i, j, j };
}

void pass_levels(struct pass *w)
{
	struct interp_seg *segs = w->segs;
	const uint32_t end = w->end + 1;
	struct run a = begin(0), j = begin(0), v = begin(0);

	for (uint32_t i = 0; i < end; i++) {
		node_on(segs, i, &v);
		if (segs[i].kind >= INTERP_BEGIN)
			continue;
		a_on(segs, i, &a);
		j_on(segs, i, &j);
	}
	level_a(segs, &a, end);
	level_j(segs, &j, end);
	level_node(segs, &v, end);
}
