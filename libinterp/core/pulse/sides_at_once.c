/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sides_at_once.c - two contours together, every axis at once
 *
 * Tick k of N stands at the same share k/N of both lengths: arcs by their
 * angle, lines by their dda, each axis at its nearest pulse and so within half
 * a pulse.  N is the longer contour's pulses and a little more, so that no
 * axis moves more than one a tick.  A point is a function of k alone.
 */
#include "pulse/pulse.h"

#include <math.h>

static uint32_t plane_of(const struct interp_arc *arc)
{
	return 1u << arc->axis_a | 1u << arc->axis_b;
}

/* The longest possible arc, in pulses of its finer axis. */
static double arc_pulses(const struct interp_cursor *c,
			 const struct interp_arc *arc)
{
	const double pulses_mm = fmax(c->pulses_mm[arc->axis_a],
				      c->pulses_mm[arc->axis_b]);
	const double r = fmax(arc->r_mm, arc->r_mm + arc->dr_mm);

	return (fabs(arc->sweep) * r + fabs(arc->dr_mm)) * pulses_mm;
}

/* Not more ticks than the builder gives: otherwise it would walk on the
 * spot. */
static bool ticks_ok(const struct interp_cursor *c, uint32_t curved)
{
	double n = (double)pulse_longest(c, curved);

	for (int i = 0; i < 2; i++) {
		const struct interp_arc *arc = &c->couple.side[i];

		if (arc->r_mm > 0)
			n = fmax(n, arc_pulses(c, arc));
	}
	return c->seg.ticks > 0 && c->seg.ticks <= n * 1.00001 + 3;
}

static bool at_once_enter(struct interp_cursor *c, bool at_end)
{
	uint32_t curved = 0;

	for (int i = 0; i < 2; i++) {
		const struct interp_arc *arc = &c->couple.side[i];

		c->arc = *arc;
		if (!pulse_plane_ok(c) || curved & plane_of(arc))
			return false;
		if (arc->r_mm > 0)
			curved |= plane_of(arc);
	}
	return pulse_dda_enter(c, at_end, curved) && ticks_ok(c, curved);
}

/* The place of one axis of an arc at c->tick; at the ends that of the node,
 * whatever sin and cos give. */
static int64_t axis_at(const struct interp_cursor *c, uint32_t axis,
		       double at_mm)
{
	int64_t to = (int64_t)floor(at_mm * c->pulses_mm[axis] + 0.5);

	if (c->tick == 0 || c->tick == c->seg.ticks) {
		for (uint32_t j = 0; j < c->p.head->naxes; j++) {
			if (c->p.head->column[j] == axis)
				to = interp_round_sub(pulse_node(c, j,
							c->tick != 0));
		}
	}
	return to;
}

static bool axis_settle(struct interp_cursor *c, uint32_t axis, int64_t to,
			uint32_t *moved)
{
	const int64_t by = to - c->pos[axis];

	if (by > 1 || by < -1)
		return false;
	c->pos[axis] = (int32_t)to;
	*moved |= by ? pulse_move(axis, by < 0) : 0;
	return true;
}

static void arc_at(const struct interp_cursor *c, const struct interp_arc *arc,
		   int64_t ret[2])
{
	const double t = (double)c->tick / c->seg.ticks;
	const double theta = arc->theta + arc->sweep * t;
	const double r = arc->r_mm + arc->dr_mm * t;

	ret[0] = axis_at(c, arc->axis_a, arc->a_mm + r * cos(theta));
	ret[1] = axis_at(c, arc->axis_b, arc->b_mm + r * sin(theta));
}

static uint32_t arc_settle(struct interp_cursor *c,
			   const struct interp_arc *arc)
{
	uint32_t moved = 0;
	int64_t at[2];

	arc_at(c, arc, at);
	return axis_settle(c, arc->axis_a, at[0], &moved) &&
	       axis_settle(c, arc->axis_b, at[1], &moved) ? moved : PULSE_BAD;
}

static uint32_t at_once_settle(struct interp_cursor *c, uint32_t moved)
{
	for (int i = 0; i < 2; i++) {
		const struct interp_arc *arc = &c->couple.side[i];
		uint32_t plane;

		if (!(arc->r_mm > 0))
			continue;
		plane = arc_settle(c, arc);
		if (plane == PULSE_BAD)
			return PULSE_BAD;
		moved |= plane;
	}
	return moved;
}

static uint32_t at_once_tick(struct interp_cursor *c)
{
	return at_once_settle(c, pulse_dda_tick(c));
}

static uint32_t at_once_tick_back(struct interp_cursor *c)
{
	return at_once_settle(c, pulse_dda_tick_back(c));
}

static uint32_t at_once_forward(struct interp_cursor *c, uint32_t ticks,
				uint16_t *ret)
{
	return pulse_ticks(c, at_once_tick, ticks, ret);
}

static uint32_t at_once_back(struct interp_cursor *c, uint32_t ticks,
			     uint16_t *ret)
{
	return pulse_ticks(c, at_once_tick_back, ticks, ret);
}

static bool at_once_seek(struct interp_cursor *c, uint32_t tick)
{
	pulse_dda_seek(c, tick);
	for (int i = 0; i < 2; i++) {
		const struct interp_arc *arc = &c->couple.side[i];
		int64_t at[2];

		if (!(arc->r_mm > 0))
			continue;
		arc_at(c, arc, at);
		if (at[0] != (int32_t)at[0] || at[1] != (int32_t)at[1])
			return false;
		c->pos[arc->axis_a] = (int32_t)at[0];
		c->pos[arc->axis_b] = (int32_t)at[1];
	}
	return true;
}

const struct interp_walk pulse_pair_at_once = {
	.enter = at_once_enter,
	.forward = at_once_forward,
	.back = at_once_back,
	.seek = at_once_seek,
};
