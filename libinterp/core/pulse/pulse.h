/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pulse.h - the walks: each turns one kind of segment into lattice points
 *
 * The cursor owns the place; a walk owns the points.  A walk counts how far it
 * is in its own measure, which is 0 at the segment's start and c->whole at its
 * end, and grows with every tick.  For most walks the measure is the number of
 * ticks.  For a circle by point-by-point comparison it is the swept area, so
 * that its place follows the length of the arc.
 *
 * Threads: RT-safe.
 */
#ifndef PULSE_PULSE_H
#define PULSE_PULSE_H

#include "interp/cursor.h"

#include <string.h>

/* For products of two measures. */
__extension__ typedef __int128 pulse_wide;
__extension__ typedef unsigned __int128 pulse_uwide;

#define PULSE_BAD	UINT32_MAX	/* instead of pulses, or of points */

#define INLINE	static inline __attribute__((always_inline))

typedef uint32_t pulse_run_fn(struct interp_cursor *c, uint32_t ticks,
			      uint16_t *ret);

struct interp_walk {
	/* Stand at the start or the end of the segment; set whole and
	 * measure. */
	bool (*enter)(struct interp_cursor *c, bool at_end);
	/* Walk @ticks of them; update pos, tick and measure.  One that has
	 * last() walks fewer if it meets the aim.  Return: the number of points
	 * that were met, with their pulses in @ret. */
	pulse_run_fn *forward, *back;
	/* From the start to @tick at once, as forward would: at most a few
	 * operations for each pulse in a quadrant, and mostly a few in all.
	 * Return: false if the block is damaged.  Actions have none. */
	bool (*seek)(struct interp_cursor *c, uint32_t tick);
	/* What the last tick added to the measure; NULL: always one. */
	int64_t (*last)(const struct interp_cursor *c);
};

/* Lines, all axes at once: line.c. */
extern const struct interp_walk pulse_line;
/* Arcs, all axes at once: arc.c. */
extern const struct interp_walk pulse_arc;
/* Lines of three or more axes as a star: flat.c. */
extern const struct interp_walk pulse_flat;
/* Lines and helices, one axis at a time: tree.c. */
extern const struct interp_walk pulse_tree;
extern const struct interp_walk pulse_helix;
/* Circles, one axis at a time: circle.c. */
extern const struct interp_walk pulse_circle;
/* Two contours together: sides.c, one axis at a time; all at once:
 * sides_at_once.c. */
extern const struct interp_walk pulse_pair;
extern const struct interp_walk pulse_pair_at_once;
/* Parts of NURBS: curve.c. */
extern const struct interp_walk pulse_curve;
/* Actions: no points at all: cursor.c. */

/**
 * pulse_ticks() - make @ticks times @tick, which returns its pulses.
 *
 * It is inline, so that every walk has its own loop without a call.  A tick
 * without a pulse is not a point.
 */
INLINE uint32_t
pulse_ticks(struct interp_cursor *c, uint32_t (*tick)(struct interp_cursor *c),
	    uint32_t ticks, uint16_t *ret)
{
	uint32_t points = 0;

	while (ticks-- > 0) {
		const uint32_t pulses = tick(c);

		if (pulses == PULSE_BAD)
			return PULSE_BAD;
		ret[points] = (uint16_t)pulses;
		points += pulses != 0;
	}
	return points;
}

/** pulse_may_go_on() - is another tick of any measure wanted? */
static inline bool pulse_may_go_on(const struct interp_cursor *c)
{
	if (!c->backward)
		return c->measure < c->want;
	return c->measure > c->want &&
	       (!c->walk->last || c->measure - c->walk->last(c) >= c->want);
}

/** pulse_uneven() - as pulse_ticks(), of any measure: not beyond the aim. */
INLINE uint32_t
pulse_uneven(struct interp_cursor *c, uint32_t (*tick)(struct interp_cursor *c),
	     uint32_t ticks, uint16_t *ret)
{
	uint32_t points = 0;

	while (ticks-- > 0 && pulse_may_go_on(c)) {
		const uint32_t n = pulse_ticks(c, tick, 1, ret + points);

		if (n == PULSE_BAD)
			return PULSE_BAD;
		points += n;
	}
	return points;
}

static inline uint32_t pulse_fewer(uint32_t a, uint32_t b)
{
	return a < b ? a : b;
}

/** pulse_turned() - the pulses that undo @pulses. */
static inline uint16_t pulse_turned(uint32_t pulses)
{
	return (uint16_t)(pulses ^ (pulses & 0xff) << 8);
}

/**
 * pulse_move() - the pulse of one axis, in the form of struct interp_cursor.
 */
static inline uint32_t pulse_move(uint32_t axis, bool down)
{
	return (down ? 0x101u : 1u) << axis;
}

/*
 * Rows of points are short, and each has another length.  A loop over the
 * points of a row ends at another place each time, and the processor guesses
 * wrong.  So a row is written eight points at a time, beyond its end too, and
 * the next one begins where this one ends.
 */
#define PULSE_AT_ONCE	8

/** pulse_copy() - @n points; PULSE_AT_ONCE - 1 more may be read and written. */
INLINE void pulse_copy(uint16_t *ret, const uint16_t *from, uint32_t n)
{
	uint32_t k = 0;

	do {
		memcpy(ret + k, from + k, PULSE_AT_ONCE * sizeof(*ret));
		k += PULSE_AT_ONCE;
	} while (k < n);
}

/** pulse_row() - @n points of @pulse; not more than @room are written. */
INLINE void pulse_row(uint16_t *ret, uint32_t room, uint16_t pulse, uint32_t n)
{
	const uint16_t some[PULSE_AT_ONCE] = {
		pulse, pulse, pulse, pulse, pulse, pulse, pulse, pulse,
	};
	uint32_t k = 0;

	for (; room - k >= PULSE_AT_ONCE; k += PULSE_AT_ONCE) {
		memcpy(ret + k, some, sizeof(some));
		if (k + PULSE_AT_ONCE >= n)
			return;
	}
	for (; k < n; k++)
		ret[k] = pulse;
}

/** pulse_step() - the pulse of an axis that goes by @d: 0, +1, or -1, which has
 *  all bits set. */
static inline uint32_t pulse_step(uint32_t d, uint32_t axis)
{
	return (d & 0x101) << axis;
}

/**
 * pulse_plane_move() - the same of both axes of an arc's plane; each goes by
 * -1, 0 or +1.
 */
static inline uint32_t pulse_plane_move(const struct interp_cursor *c,
					int32_t da, int32_t db)
{
	return pulse_step((uint32_t)da, c->arc.axis_a) |
	       pulse_step((uint32_t)db, c->arc.axis_b);
}

/** pulse_node() - node column @j at the start or end of c->seg, subpulses. */
static inline int64_t pulse_node(const struct interp_cursor *c, uint32_t j,
				 bool at_end)
{
	return c->p.nodes[((uint64_t)c->index + at_end) * c->p.head->naxes + j];
}

/** pulse_in_range() - no correct builder exceeds this. */
static inline bool pulse_in_range(int64_t sub)
{
	const int64_t max = (int64_t)INTERP_PULSES_MAX << INTERP_SUB_BITS;

	return sub >= -max && sub <= max;
}

/**
 * pulse_stand() - take the place of the node on every axis; false: there is
 * none.
 */
bool pulse_stand(struct interp_cursor *c, bool at_end);

/* The dda of every axis except those in the mask @except: line.c. */
bool pulse_dda_enter(struct interp_cursor *c, bool at_end, uint32_t except);
/** pulse_longest() - pulses of the longest axis, rounded up. */
int64_t pulse_longest(const struct interp_cursor *c, uint32_t except);
pulse_run_fn pulse_dda_forward, pulse_dda_back;
/** pulse_dda_all_forward() - the same, with a place in @ret for each tick,
 *  also for one without a pulse. */
void pulse_dda_all_forward(struct interp_cursor *c, uint32_t ticks,
			   uint16_t *ret);
void pulse_dda_all_back(struct interp_cursor *c, uint32_t ticks,
			uint16_t *ret);
bool pulse_dda_seek(struct interp_cursor *c, uint32_t tick);
/* One tick of it. */
uint32_t pulse_dda_tick(struct interp_cursor *c);
uint32_t pulse_dda_tick_back(struct interp_cursor *c);

struct couple_input;
struct couple_rule;

/**
 * pulse_inputs() - the axes, except @except, that have pulses to give; sets the
 * signs.
 */
uint32_t pulse_inputs(struct interp_cursor *c, uint32_t except,
		      struct couple_input *in);
/**
 * pulse_bits() - set @npairs pairs of a line to the bits of the program, if it
 * has bits for the line.  Return: false if there are fewer than needed.
 */
bool pulse_bits(struct interp_cursor *c, uint32_t npairs);
/** pulse_rule() - strategy, coupling and tolerance of the program. */
struct couple_rule pulse_rule(const struct interp_cursor *c);

/** pulse_arc_near() - are centre and radius INTERP_PULSES_MAX at most?  Others
 *  are walked nowhere. */
bool pulse_arc_near(const struct interp_arc *arc, double a_pulses_mm,
		    double b_pulses_mm);
/** pulse_plane_ok() - are an arc's axes and centre in range? */
bool pulse_plane_ok(const struct interp_cursor *c);

/* The circle alone: used by pulse_circle, by trees, and by the builder. */
bool circle_enter(struct interp_circle *k, const struct interp_arc *arc,
		  const int64_t start[2], const int64_t end[2], bool at_end);
/** One pulse; ret[0], ret[1] in -1, 0, +1. */
void circle_forward(struct interp_circle *k, int8_t ret[2]);
void circle_back(struct interp_circle *k, int8_t ret[2]);
/** What the last pulse added to the measure: > 0. */
int64_t circle_last(const struct interp_circle *k);
/**
 * circle_seek() - from the start, @tick pulses at once: circle_seek.c.
 *
 * Return: what they add to the measure; -1 if the circle is broken.
 */
int64_t circle_seek(struct interp_circle *k, uint32_t tick);
/**
 * circle_stand() - the same without the measure.  By comparison it takes the
 * same time for every radius.
 *
 * Return: false if the circle is broken.
 */
bool circle_stand(struct interp_circle *k, uint32_t tick);
/** circle_rows() - the sum over the rows @from ... @to - 1 of a quadrant of the
 *  greatest `in` inside the circle, in*in + out*out < @r2, which is at least 1
 *  in each.  It takes about R^(2/3) steps. */
int64_t circle_rows(int64_t r2, int64_t from, int64_t to);
/** pulse_plane_set() - the plane stands where c->circle does. */
void pulse_plane_set(struct interp_cursor *c);
/**
 * circle_measure() - walk the whole arc once, and fill @arc's measure, ticks
 * and tail.  Not for the cycle: it takes as long as the arc.
 *
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
/** As circle_seek(). */
int64_t side_seek(struct interp_side *s, uint32_t tick);
/** What the last pulse added to the side's measure: > 0. */
int64_t side_last(const struct interp_side *s);
/** The same, if it is known that the last pulse was @was. */
int64_t side_measure_of(const struct interp_side *s, const int8_t was[2]);
/* One pulse of it, for planning: circle_runs.c. */
int64_t circle_in(const struct interp_circle *k);	/* shrinking, >= 0 */
int64_t circle_out(const struct interp_circle *k);	/* growing, >= 0 */
int8_t circle_inward_axis(const struct interp_circle *k);	/* 0: a, 1: b */
/**
 * circle_toward() - the pulse that goes inward, or the one that goes outward.
 */
void circle_toward(const struct interp_circle *k, bool inward, int8_t ret[2]);
void circle_move(struct interp_circle *k, const int8_t pulse[2]);
/** circle_cross() - go to the next quadrant if the walk is at its border. */
void circle_cross(struct interp_circle *k);
/** circle_home() - in the last quadrant: is an axis at its end, or past it? */
bool circle_home(const struct interp_circle *k);
/** circle_measure_of() - what a pulse that ended here adds to the measure. */
int64_t circle_measure_of(const struct interp_circle *k, const int8_t was[2]);

/* A path in a tube of +-mu, made of runs: circle_runs.c.  For the builder. */
struct circle_plan {
	int64_t start[2], end[2];	/* from the centre, pulses */
	uint32_t milli;			/* mu, 1/1000 pulse */
	int8_t first;			/* the axis that begins; 0: a, 1: b */
};
/**
 * circle_plan_runs() - fill @arc's measure, ticks and number of runs, and as
 * many of @runs as there is room for.  arc->crossings must be known.
 *
 * Return: false if no path stays in the tube.
 */
bool circle_plan_runs(struct interp_arc *arc, const struct circle_plan *p,
		      int32_t *runs, uint32_t room);
/* Behind every so many runs the program keeps where the walk stands then, in so
 * many numbers: a seek begins there. */
#define CIRCLE_MARK_RUNS	64
#define CIRCLE_MARK		5
/** circle_kept() - numbers that @nruns runs and their marks take. */
static inline uint64_t circle_kept(uint32_t nruns)
{
	return nruns + (uint64_t)(nruns / CIRCLE_MARK_RUNS) * CIRCLE_MARK;
}
/** circle_marks() - walk all runs of @k and write the marks, for the builder.
 *  circle_seek.c. */
void circle_marks(struct interp_circle *k, int32_t *ret);
/* By comparison, the program keeps the measure behind every so many pulses, in
 * so many numbers, the lower half first: a seek begins there. */
#define CIRCLE_PLACE_TICKS	1024
#define CIRCLE_PLACE		2
/** circle_places() - how many of these it keeps of @arc. */
static inline uint32_t circle_places(const struct interp_arc *arc)
{
	return arc->nruns ? 0 : arc->tail / CIRCLE_PLACE_TICKS;
}
/** circle_keep_places() - write them, for the builder.  circle_seek.c. */
void circle_keep_places(const struct interp_arc *arc, const int64_t start[2],
			const int64_t end[2], int32_t *ret);
/**
 * pulse_circle_places() - @k, which walks along @arc, is to know them.
 *
 * Return: false if the program does not have them.
 */
bool pulse_circle_places(const struct interp_cursor *c,
			 const struct interp_arc *arc, struct interp_circle *k);
/** circle_smallest_milli() - @milli, or more if the circle needs more. */
uint32_t circle_smallest_milli(int64_t r2, uint32_t milli);

/** pulse_circle_node() - start or end of c->arc's plane from its centre. */
void pulse_circle_node(const struct interp_cursor *c, bool at_end,
		       int64_t ret[2]);

/**
 * pulse_circle_set() - aim c->circle at c->arc; false if the arc is not valid.
 */
bool pulse_circle_set(struct interp_cursor *c, bool at_end);

/**
 * pulse_circle_move() - one pulse of c->circle, @dir +1 or -1.  Return: its
 * bits.
 */
uint32_t pulse_circle_move(struct interp_cursor *c, int dir);

/**
 * pulse_curve_aim() - prepare a part of the curve for which k->eval is open, in
 * places.
 */
void pulse_curve_aim(struct interp_curve_walk *k,
		     const struct interp_nurbs_stop *stops, uint32_t nstops,
		     uint32_t places, double length_mm);

/**
 * pulse_curve_place() - set k->pos for a place between the ends of a curve; for
 * the walk and the builder.
 */
void pulse_curve_place(struct interp_curve_walk *k, const double *pulses_mm,
		       uint32_t place);

/**
 * pulse_curve_gap2() - the square of the distance of c->pos from its curve,
 * over the axes of @axes, at the place @s_mm.
 */
double pulse_curve_gap2(const struct interp_cursor *c,
			struct interp_curve_walk *k, uint32_t axes,
			double s_mm);

#endif /* PULSE_PULSE_H */
