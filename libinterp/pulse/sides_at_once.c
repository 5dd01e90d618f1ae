/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sides_at_once.c - two contours together, every axis at once
 *
 * Tick k of N stands at the same share k/N of both lengths: arcs by their
 * angle, lines by their dda, each axis at its nearest pulse and so within half
 * a pulse.  N is the longer contour's pulses and a little more, so that no
 * axis moves more than one a tick.  A point is a function of k alone.
 */
#include "pulse/walk.h"

#include <math.h>

static uint32_t plane_of(const struct interp_arc *arc)
{
	return 1u << arc->axis_a | 1u << arc->axis_b;
}

/* As many ticks as the builder gives, no more: no walk on the spot. */
static bool ticks_ok(const struct interp_cursor *c, uint32_t curved)
{
	double n = (double)walk_longest(c, curved);

	for (int i = 0; i < 2; i++) {
		const struct interp_arc *arc = &c->couple.side[i];

		if (arc->r_mm > 0)
			n = fmax(n, walk_arc_ticks_max(c, arc));
	}
	return c->seg.ticks > 0 && c->seg.ticks <= n * 1.00001 + 3;
}

static bool at_once_enter(struct interp_cursor *c, bool at_end)
{
	uint32_t curved = 0;

	for (int i = 0; i < 2; i++) {
		const struct interp_arc *arc = &c->couple.side[i];

		if (!walk_plane_ok(c, arc) || curved & plane_of(arc))
			return false;
		if (arc->r_mm > 0)
			curved |= plane_of(arc);
	}
	return walk_dda_enter(c, at_end, curved) && ticks_ok(c, curved);
}

static uint32_t at_once_settle(struct interp_cursor *c, uint32_t moved)
{
	for (int i = 0; i < 2; i++) {
		const struct interp_arc *arc = &c->couple.side[i];
		uint32_t plane;

		if (!(arc->r_mm > 0))
			continue;
		plane = walk_arc_settle(c, arc);
		if (plane == WALK_BAD)
			return WALK_BAD;
		moved |= plane;
	}
	return moved;
}

static uint32_t at_once_forward(struct interp_cursor *c)
{
	return at_once_settle(c, walk_dda_forward(c));
}

static uint32_t at_once_back(struct interp_cursor *c)
{
	return at_once_settle(c, walk_dda_back(c));
}

const struct interp_walk walk_pair_at_once = {
	.enter = at_once_enter,
	.forward = at_once_forward,
	.back = at_once_back,
	.last = walk_last_tick,
};
