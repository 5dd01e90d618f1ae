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

/* Is the node behind segment @s slower than what is beside it? */
static inline bool limits(const struct interp_seg *s)
{
	return s->node_mm_s < pass_least(s->feed_max_mm_s, s[1].feed_max_mm_s);
}

static void level_node(struct interp_seg *segs, const struct run *k,
		       uint32_t to)
{
	for (uint32_t i = k->from; i < to && k->most > k->least; i++)
		if (limits(&segs[i]))
			segs[i].node_mm_s = k->least;
}

static void level_j(struct interp_seg *segs, const struct run *k, uint32_t to)
{
	for (uint32_t i = k->from; i < to && k->most > k->least; i++)
		if (segs[i].kind < INTERP_BEGIN)
			segs[i].j_mm_s3 = k->least;
}

/* A node without a limit ends a run of them, and so does one that is too fast
 * for it.  One that its segments do not reach is none of the run: a long
 * plateau would sink to where it ends. */
static void level_nodes(struct interp_seg *segs, uint32_t end)
{
	struct run v = begin(0);

	for (uint32_t i = 0; i < end; i++) {
		const float is = segs[i].node_mm_s;
		const bool counts = is < INFINITY && limits(&segs[i]);

		if (counts ? run_on(&v, is) : is <= STEP * v.least)
			continue;
		level_node(segs, &v, i);
		v = begin(i);
		if (counts)
			run_on(&v, is);
	}
	level_node(segs, &v, end);
}

void pass_levels(struct pass *w)
{
	struct interp_seg *segs = w->segs;
	const uint32_t end = w->end + 1;
	struct run a = begin(0), j = begin(0);

	for (uint32_t i = 0; i < end; i++) {
		if (segs[i].kind >= INTERP_BEGIN)
			continue;
		if (!run_on(&a, segs[i].a_mm_s2)) {
			level_a(segs, &a, i);
			a = (struct run) { i, segs[i].a_mm_s2,
					   segs[i].a_mm_s2 };
		}
		if (!run_on(&j, segs[i].j_mm_s3)) {
			level_j(segs, &j, i);
			j = (struct run) { i, segs[i].j_mm_s3,
					   segs[i].j_mm_s3 };
		}
	}
	level_a(segs, &a, end);
	level_j(segs, &j, end);
	level_nodes(segs, end);
}
