/* SPDX-License-Identifier: Apache-2.0 */
/*
 * walk.h - a way of turning one segment into lattice points
 *
 * The cursor owns the place; a walk owns the points.  It counts how far it is
 * in a measure of its own, 0 at the segment's start and c->whole at its end,
 * that grows with every tick: ticks for most, swept area for a circle by
 * point-by-point comparison, so that its place follows the arc's length.
 *
 * Threads: RT-safe.
 */
#ifndef PULSE_WALK_H
#define PULSE_WALK_H

#include "interp/cursor.h"

/* For products of two measures. */
__extension__ typedef __int128 walk_wide;

#define WALK_BAD	UINT32_MAX	/* instead of a mask of axes moved */

struct interp_walk {
	/* Stand at the segment's start or end; set whole and measure. */
	bool (*enter)(struct interp_cursor *c, bool at_end);
	/* One tick; update pos, tick and measure; the mask of axes moved. */
	uint32_t (*forward)(struct interp_cursor *c);
	uint32_t (*back)(struct interp_cursor *c);
	/* What the last tick added to the measure. */
	int64_t (*last)(const struct interp_cursor *c);
};

/* Lines, every axis at once: line.c. */
extern const struct interp_walk walk_line;
/* Arcs, every axis at once: arc.c. */
extern const struct interp_walk walk_arc;
/* Lines and helices, one axis at a time: tree.c. */
extern const struct interp_walk walk_tree;
extern const struct interp_walk walk_helix;
/* Circles, one axis at a time: circle.c. */
extern const struct interp_walk walk_circle;
/* Two contours together: sides.c, one axis at a time; all at once:
 * sides_at_once.c. */
extern const struct interp_walk walk_pair;
extern const struct interp_walk walk_pair_at_once;
/* Actions: no points at all: cursor.c. */

/** walk_node() - node column @j at the start or end of c->seg, subpulses. */
static inline int64_t walk_node(const struct interp_cursor *c, uint32_t j,
				bool at_end)
{
	return c->p.nodes[((uint64_t)c->index + at_end) * c->p.head->naxes + j];
}

/** walk_in_range() - a node no honest builder would exceed? */
static inline bool walk_in_range(int64_t sub)
{
	const int64_t max = (int64_t)INTERP_PULSES_MAX << INTERP_SUB_BITS;

	return sub >= -max && sub <= max;
}

/** walk_stand() - take the node's place on every axis; false if it has none. */
bool walk_stand(struct interp_cursor *c, bool at_end);

/* The dda of every axis but those in @except (a mask): line.c. */
bool walk_dda_enter(struct interp_cursor *c, bool at_end, uint32_t except);
/** walk_longest() - pulses of the longest axis, rounded up. */
int64_t walk_longest(const struct interp_cursor *c, uint32_t except);
uint32_t walk_dda_forward(struct interp_cursor *c);
uint32_t walk_dda_back(struct interp_cursor *c);
int64_t walk_last_tick(const struct interp_cursor *c);

/** walk_plane_ok() - are an arc's axes and centre in range? */
bool walk_plane_ok(const struct interp_cursor *c, const struct interp_arc *arc);

/** walk_arc_settle() - the plane's axes to their place at c->tick: arc.c.
 *  Return: the mask of axes moved, or WALK_BAD. */
uint32_t walk_arc_settle(struct interp_cursor *c, const struct interp_arc *arc);

/** walk_arc_ticks_max() - the most ticks an honest builder gives an arc. */
double walk_arc_ticks_max(const struct interp_cursor *c,
			  const struct interp_arc *arc);

/** walk_arc_nodes() - an arc's start and end, from its centre, pulses. */
void walk_arc_nodes(const struct interp_cursor *c, const struct interp_arc *arc,
		    int64_t start[2], int64_t end[2]);

/* The circle alone, used by walk_circle, by trees and by the builder. */
bool circle_enter(struct interp_circle *k, const struct interp_arc *arc,
		  const int64_t start[2], const int64_t end[2], bool at_end);
/** One pulse; ret[0], ret[1] in -1, 0, +1. */
void circle_forward(struct interp_circle *k, int8_t ret[2]);
void circle_back(struct interp_circle *k, int8_t ret[2]);
/** What the last pulse added to the measure: > 0. */
int64_t circle_last(const struct interp_circle *k);
/**
 * circle_measure() - walk the whole arc once and fill @arc's measure, ticks
 * and tail.  Not for the cycle: as long as the arc.
 * Return: false if the end cannot be reached.
 */
bool circle_measure(struct interp_arc *arc, const int64_t start[2],
		    const int64_t end[2]);

/* One contour of a pair, used by the walk and by the builder: sides.c. */
bool side_enter(struct interp_side *s, const struct interp_arc *arc,
		const int64_t start[2], const int64_t end[2], bool at_end);
/** One pulse; ret[0], ret[1] in -1, 0, +1; false: the contour is broken. */
bool side_forward(struct interp_side *s, int8_t ret[2]);
bool side_back(struct interp_side *s, int8_t ret[2]);
/** What the last pulse added to the side's measure: > 0. */
int64_t side_last(const struct interp_side *s);

/** walk_circle_set() - aim c->circle at c->arc; false if it is unsound. */
bool walk_circle_set(struct interp_cursor *c, bool at_end);

/** walk_circle_pulse() - one pulse of c->circle, @dir +1 or -1. */
uint32_t walk_circle_pulse(struct interp_cursor *c, int dir);

#endif /* PULSE_WALK_H */
