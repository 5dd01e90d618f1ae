/* SPDX-License-Identifier: Apache-2.0 */
/*
 * place.h - where the machine is: its place on the path, and its axes
 *
 * A place is a signed length along the path, in mm.  Beside the path, on an
 * escape, it is the place where the machine left the path, less the way gone
 * since.
 *
 * Threads: RT-safe.
 */
#ifndef RT_PLACE_H
#define RT_PLACE_H

#include "cycle.h"

/** place_mm() - of the machine. */
static inline double place_mm(const struct cycle *c)
{
	return interp_cursor_place_mm(&c->cursor) - c->escape.way_mm;
}

/** place_outer_mm() - the farthest back that the machine may go now. */
static inline double place_outer_mm(const struct cycle *c)
{
	return c->escape.nlegs > 0 ? interp_cursor_place_mm(&c->cursor) -
				     c->escape.length_mm : c->back_mm;
}

/**
 * place_pos() - the lattice point that it stands on, as programmed, pulses.
 * The axes are at probe.shift from it.
 */
static inline const int32_t *place_pos(const struct cycle *c)
{
	return escape_is_out(&c->escape) ? c->escape.pos : c->cursor.pos;
}

/** place_axis() - where axis @i is, pulses. */
static inline int32_t place_axis(const struct cycle *c, int i)
{
	return place_pos(c)[i] + c->probe.shift[i];
}

/** place_moved() - bit per axis that moved to this lattice point. */
static inline uint32_t place_moved(const struct cycle *c)
{
	return escape_is_out(&c->escape) ? c->escape.moved : c->cursor.moved;
}

/** place_in_travel() - may the axis be where the program's @pos is? */
static inline bool place_in_travel(const struct cycle *c, int axis, int64_t pos)
{
	pos += c->probe.shift[axis];
	return pos >= c->config.travel_min[axis] &&
	       pos <= c->config.travel_max[axis];
}

/** place_target() - send the axes to where the program's @pos is. */
static inline void place_target(struct cycle *c,
				const int32_t pos[INTERP_NAXES])
{
	for (int i = 0; i < INTERP_NAXES; i++)
		c->out.target[i] = pos[i] + c->probe.shift[i];
}

#endif /* RT_PLACE_H */
