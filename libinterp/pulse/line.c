/* SPDX-License-Identifier: Apache-2.0 */
/*
 * line.c - straight lines, every axis at once
 *
 * A line of N ticks is at d*k/N on each axis after k of them; N is the
 * longest axis's pulses, rounded up, so no axis moves more than one pulse a
 * tick and each is within half a pulse of the true line.  With
 *
 *	d = quot*N + rem,  0 <= rem < N
 *
 * one tick adds quot, and one more whenever the sum of the remainders passes
 * N.  Both sums are integers, so back is the exact inverse of forward and the
 * end is met exactly, wherever in a pulse the two nodes lie.
 */
#include "pulse/walk.h"

#include <stdlib.h>

static void dda_set(struct interp_dda *d, int64_t from, int64_t to,
		    int64_t ticks)
{
	const int64_t len = to - from;

	d->quot = len / ticks;
	d->rem = len % ticks;
	if (d->rem < 0) {
		d->rem += ticks;
		d->quot--;
	}
	d->err = 0;
}

bool walk_stand(struct interp_cursor *c, bool at_end)
{
	for (uint32_t j = 0; j < c->p.head->naxes; j++) {
		const int64_t at = walk_node(c, j, at_end);

		if (!walk_in_range(at) ||
		    !walk_in_range(walk_node(c, j, !at_end)))
			return false;
		c->pos[c->p.head->column[j]] = interp_round_sub(at);
	}
	c->tick = at_end ? c->seg.ticks : 0;
	c->whole = c->seg.ticks;
	c->measure = c->tick;
	return true;
}

bool walk_dda_enter(struct interp_cursor *c, bool at_end, uint32_t except)
{
	const int64_t ticks = c->seg.ticks;

	if (!walk_stand(c, at_end))
		return false;
	c->ndda = 0;
	for (uint32_t j = 0; j < c->p.head->naxes; j++) {
		const uint32_t axis = c->p.head->column[j];
		const int64_t from = walk_node(c, j, false);
		const int64_t to = walk_node(c, j, true);
		struct interp_dda *d = &c->dda[c->ndda];

		if (from == to || except & 1u << axis)
			continue;
		if (llabs(to - from) > ticks << INTERP_SUB_BITS)
			return false;
		dda_set(d, from, to, ticks);
		d->sub = at_end ? to : from;
		d->axis = axis;
		c->ndda++;
	}
	return true;
}

/* Move an axis to its dda's nearest pulse; its bit if it moved. */
static uint32_t dda_settle(struct interp_cursor *c, const struct interp_dda *d)
{
	const int32_t to = interp_round_sub(d->sub);
	const uint32_t moved = (uint32_t)(to != c->pos[d->axis]) << d->axis;

	c->pos[d->axis] = to;
	return moved;
}

uint32_t walk_dda_forward(struct interp_cursor *c)
{
	const int64_t ticks = c->seg.ticks;
	uint32_t moved = 0;

	for (uint32_t i = 0; i < c->ndda; i++) {
		struct interp_dda *d = &c->dda[i];

		d->sub += d->quot;
		d->err += d->rem;
		if (d->err >= ticks) {
			d->err -= ticks;
			d->sub++;
		}
		moved |= dda_settle(c, d);
	}
	c->tick++;
	c->measure++;
	return moved;
}

uint32_t walk_dda_back(struct interp_cursor *c)
{
	const int64_t ticks = c->seg.ticks;
	uint32_t moved = 0;

	for (uint32_t i = 0; i < c->ndda; i++) {
		struct interp_dda *d = &c->dda[i];

		d->sub -= d->quot;
		d->err -= d->rem;
		if (d->err < 0) {
			d->err += ticks;
			d->sub--;
		}
		moved |= dda_settle(c, d);
	}
	c->tick--;
	c->measure--;
	return moved;
}

int64_t walk_last_tick(const struct interp_cursor *c)
{
	(void)c;
	return 1;
}

int64_t walk_longest(const struct interp_cursor *c, uint32_t except)
{
	int64_t longest = 0;

	for (uint32_t j = 0; j < c->p.head->naxes; j++) {
		const int64_t d = llabs(walk_node(c, j, true) -
					walk_node(c, j, false));

		if (!(except & 1u << c->p.head->column[j]) && d > longest)
			longest = d;
	}
	return (longest + INTERP_SUB - 1) >> INTERP_SUB_BITS;
}

/* More ticks than pulses would be a walk on the spot. */
static bool line_enter(struct interp_cursor *c, bool at_end)
{
	return walk_dda_enter(c, at_end, 0) &&
	       c->seg.ticks == walk_longest(c, 0);
}

const struct interp_walk walk_line = {
	.enter = line_enter,
	.forward = walk_dda_forward,
	.back = walk_dda_back,
	.last = walk_last_tick,
};
