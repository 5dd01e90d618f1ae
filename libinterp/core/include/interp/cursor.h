/* SPDX-License-Identifier: Apache-2.0 */
/*
 * cursor.h - a place on a program's path, walked by a signed distance
 *
 * The one idea of this library: a machine's state on its path is one number,
 * and every motion is a walk to another place.  A segment is a row of lattice
 * points, numbered by ticks 0 ... seg.ticks; which points they are depends on
 * the segment and the strategy alone, never on feed, period or direction.
 * Walking back n points visits exactly the last n, over any number of
 * segments, with no history kept.
 *
 *	interp_cursor_aim(&c, ds_mm);
 *	while ((what = interp_cursor_step(&c)) == INTERP_MOVED)
 *		output c.pos;
 *
 * Units: places in mm along the path from its start, positions in pulses.
 * Sign: + toward the end of the program.
 * Threads: RT-safe unless marked.  No call allocates, blocks or touches a
 * global.  One object belongs to one thread.
 */
#ifndef INTERP_CURSOR_H
#define INTERP_CURSOR_H

#include "interp/program.h"

enum interp_step {
	INTERP_MOVED,		/* one lattice point on; pos is the new one */
	INTERP_ARRIVED,		/* at the place aimed at */
	INTERP_AT_ACTION,	/* forward, in front of an action: do it, then
				 * interp_cursor_pass() */
	INTERP_AT_START,	/* backward, at the start of the program */
	INTERP_AT_END,		/* forward, in front of INTERP_END */
	INTERP_BAD_SEGMENT,	/* the next segment failed its check */
};

/* One axis of a straight walk: see pulse/line.c. */
struct interp_dda {
	int64_t err;			/* to the next pulse: -full ... -1 */
	int64_t step;			/* of it in a tick, 0 < step <= full */
	uint32_t axis;
	int32_t dir;			/* +1 or -1 */
	int32_t given;			/* pulses in a run of ticks */
	uint32_t pulse, pulse_back;	/* INTERP_PULSE bits of one */
};

/* Two inputs and the rule between them: see pulse/pair.h. */
struct interp_pair {
	int64_t a, b;			/* pulses of main and secondary */
	int64_t m, s;			/* of them, given */
	int64_t limit;			/* the secondary is due above it */
	int64_t dev;			/* deviation e = b*m - a*s; not next to
					 * s, or gcc adds to both in one go and
					 * waits for the two stores before */
	int64_t bursts;			/* of the secondary; 0: none, by
					 * limit */
	int64_t burst;			/* the one being sent, or next */
	int64_t from, to;		/* s where it begins and ends */
	int64_t due, done;		/* m where it is, where the last was */
	int64_t prior_from;		/* where the one sent last began */
	const uint64_t *bits;		/* which input gives each pulse; NULL:
					 * by bursts or by limit */
	int8_t in_a, in_b;		/* an axis, or ~another pair */
};

/* A circle by point-by-point comparison: see pulse/circle.c. */
struct interp_circle {
	int64_t x, y;			/* from the centre, pulses */
	int64_t xe, ye;			/* the end */
	int64_t dev;			/* deviation F = x*x + y*y - R*R */
	int64_t meet;			/* where the circle meets an axis */
	int64_t xt, yt;			/* where the tail begins */
	uint32_t tick, ticks, tail;
	uint32_t left;			/* axis crossings still to come */
	uint32_t crossings;		/* in the whole arc */
	int8_t ccw;			/* +1 counter-clockwise, -1 clockwise */
	int8_t quad;			/* quadrant 0 ... 3 being walked */
	const int32_t *places;		/* by comparison: the measure at some
					 * places */
	uint32_t nplaces;
	/* Along stored runs: */
	const int32_t *runs;		/* NULL: by comparison */
	uint32_t nruns, run;		/* run being walked */
	int64_t sent;			/* pulses of it; 0 only at the start */
	uint8_t run_first;		/* axis of run 0: 0 a, 1 b */
};

/* One contour of a pair: see pulse/sides.c. */
struct interp_side {
	struct interp_circle circle;	/* if it is an arc */
	int64_t a, b, dev;		/* if it is a line: pulses of the longer
					 * and the shorter axis; b*m_a -
					 * a*m_b */
	int64_t gone, gone_before;	/* in its own measure; where it was
					 * before its last pulse */
	int64_t share, share_before;	/* the same in the pair's measure */
	uint32_t tick, ticks;
	int8_t longer;			/* 0 or 1 */
	int8_t sign[2];			/* of the line's axes */
	bool arc;
};

/* Part of a curve: see pulse/curve.c. */
struct interp_curve_walk {
	struct interp_nurbs_eval eval;
	struct interp_nurbs_between between;
	const struct interp_nurbs_stop *stops;
	uint32_t nstops;
	uint32_t places;		/* from the first to the last */
	double place_mm;		/* from one to the next */
	uint32_t turns;			/* ticks of a place: 1, or one for each
					 * axis */
	uint32_t at;			/* the place that pos[] is of */
	int32_t pos[INTERP_NAXES];	/* pulses, by column */
	uint8_t axis[INTERP_NAXES];
};

struct interp_walk;

/* So many ticks of an arc are computed together. */
#define INTERP_ARC_BLOCK	64

/* The last pulse of a helix's circle and the others due behind it: see
 * pulse/tree.c. */
struct interp_group {
	int64_t at, sent;		/* measure and others before it */
	int64_t measure;		/* of all of it */
	int64_t tree;			/* the others */
	bool circle;			/* not if the circle has made none */
};

/* Placed by the caller, filled by interp_cursor_init(); read, do not write. */
struct interp_cursor {
	struct interp_program p;
	struct interp_seg seg;		/* checked copy of segment `index` */
	struct interp_arc arc;		/* checked copy, if seg is an arc */
	struct interp_couple couple;	/* the same, if seg is a pair */
	uint32_t index;
	uint32_t tick;			/* 0 ... seg.ticks */
	int32_t pos[INTERP_NAXES];	/* pulses */
	uint32_t moved;			/* bit per axis moved by the last
					 * step */
	double s_mm;			/* place in the segment */
	double want_mm;			/* place aimed at, from seg's start */
	bool backward;			/* direction of the walk aimed at */

	/* Private: the strategy's state. */
	const struct interp_walk *walk;
	int64_t measure, want, whole;	/* place, aim and end of the segment in
					 * the strategy's own measure */
	struct interp_dda dda[INTERP_NAXES];
	int64_t dda_full;		/* ticks of a segment, subpulses */
	uint32_t ndda;
	struct interp_pair pair[INTERP_NAXES];
	uint32_t npairs;
	bool by_limit;			/* no pair of a star has bursts or
					 * bits */
	int8_t root;			/* of a tree; main axis of a star */
	int8_t sign[INTERP_NAXES];
	uint16_t pulse[INTERP_NAXES];	/* of a tree or star, going forward */
	uint16_t pulse_back[INTERP_NAXES];
	struct interp_circle circle;
	struct interp_side side[2];
	struct interp_curve_walk curve;
	int64_t others, circle_at;	/* a helix's other pulses; measure of
					 * its circle alone */
	struct interp_group group;	/* of a helix */
	double pulses_mm[INTERP_NAXES];	/* pulses per mm */
	double arc_turn, arc_grow_mm;	/* angle, radius gained per tick */
	uint32_t arc_block;		/* ticks whose places are known */
	bool arc_alone;			/* each tick is computed for itself */
	bool arc_broken;		/* a node is over a pulse off */
	double arc_sine[INTERP_ARC_BLOCK];	/* from the middle of a block */
	double arc_cosine[INTERP_ARC_BLOCK];
	int32_t arc_at[2][INTERP_ARC_BLOCK + 1];	/* pulses of axis_a,
						 * axis_b */
	uint16_t arc_pulse[INTERP_ARC_BLOCK];	/* from each to the next */
};

/**
 * interp_cursor_init() - stand at the start of @p.
 *
 * Return: 0, or -EBADMSG if the first segment fails its check.
 */
int interp_cursor_init(struct interp_cursor *c, const struct interp_program *p);

/**
 * interp_cursor_seek() - stand at tick @tick of segment @index.
 *
 * A circle by one axis at a time takes as long as its radius, and stored bits
 * and runs are counted: startup only.  Everything else takes no longer if @tick
 * is large.
 * Return: 0, -ERANGE if there is no such place, -EBADMSG.
 */
int interp_cursor_seek(struct interp_cursor *c, uint32_t index, uint32_t tick);

/**
 * interp_cursor_seek_end() - stand at the end of segment @index, at once.
 *
 * Return: 0, -ERANGE if there is no such place, -EBADMSG.
 */
int interp_cursor_seek_end(struct interp_cursor *c, uint32_t index);

/** interp_cursor_place_mm() - where the cursor stands on the path. */
static inline double interp_cursor_place_mm(const struct interp_cursor *c)
{
	return c->seg.s_mm + c->s_mm;
}

/** interp_cursor_aim() - aim at the place that is @ds_mm from here. */
void interp_cursor_aim(struct interp_cursor *c, double ds_mm);

/** interp_cursor_is_due() - does the place aimed at belong to another tick of
 *  this segment? */
static inline bool interp_cursor_is_due(const struct interp_cursor *c)
{
	return c->backward ? c->want < c->measure : c->want > c->measure;
}

/**
 * interp_cursor_creep() - go where it is aimed at, if no lattice point and no
 * end of this segment comes before that.
 *
 * Return: false if one may come; then interp_cursor_step() goes on.
 */
static inline bool interp_cursor_creep(struct interp_cursor *c)
{
	if (!c->walk || interp_cursor_is_due(c) || c->want_mm <= 0 ||
	    c->want_mm >= c->seg.length_mm)
		return false;
	c->s_mm = c->want_mm;
	return true;
}

/**
 * interp_cursor_step() - one lattice point toward the place aimed at.
 *
 * It crosses at most INTERP_CROSS_MAX ends of segments without meeting a new
 * lattice point.  After that it returns INTERP_ARRIVED too early, and the rest
 * of the distance is lost.
 */
enum interp_step interp_cursor_step(struct interp_cursor *c);

#define INTERP_CROSS_MAX	64

/* A point's pulses: a bit per axis moved, and whether it went down. */
#define INTERP_PULSE_MOVED(pulse)	((pulse) & 0xffu)
#define INTERP_PULSE_DOWN(pulse)	((uint32_t)(pulse) >> 8)

/**
 * interp_cursor_run() - up to @max lattice points at once, as steps would.
 *
 * It never leaves the segment.  @ret gets the pulses of each point.
 * Return: how many points; 0 if there was none to take: then
 * interp_cursor_step() goes on, or says why it cannot.
 */
uint32_t interp_cursor_run(struct interp_cursor *c, uint16_t *ret,
			   uint32_t max);

/** interp_cursor_pass() - step over the action in front, forward. */
enum interp_step interp_cursor_pass(struct interp_cursor *c);

/**
 * interp_cursor_slide() - go toward the place aimed at, but stop before the
 * next lattice point.  The rest of the distance is forgotten.
 *
 * A slow walk, with less than one lattice point in each call, loses nothing by
 * sliding in some of its calls.
 * Return: true if it went the whole way; false if a part of it is lost.
 */
bool interp_cursor_slide(struct interp_cursor *c);

/** interp_cursor_stop() - forget the rest of the distance aimed at. */
void interp_cursor_stop(struct interp_cursor *c);

/* What is the same for all points of a segment; begins as { 0 }, and belongs to
 * one cursor. */
struct interp_deviation {
	const int64_t *nodes;		/* of this program, */
	uint32_t index;			/* this segment */
	double (*of)(const struct interp_cursor *c,
		     const struct interp_deviation *d);
	uint32_t axes;			/* its length is counted in */
	uint32_t nways;
	struct interp_deviation_way {
		uint32_t axis;
		double pulse_mm, from_mm, mm;
	} way[INTERP_NAXES];		/* of a line; or a, b of a circle */
	double way2, per_mm;		/* its length squared, and 1 / length */
	struct interp_arc arc;		/* of a circle */
	bool grows;			/* its radius with the place */
};

/** interp_deviation_first() - the same as below, of a segment's first point. */
double interp_deviation_first(const struct interp_cursor *c,
			      struct interp_deviation *d);

/**
 * interp_cursor_deviation_mm() - distance of pos from the programmed path,
 * square to it, over the axes its length is counted in.
 */
static inline double interp_cursor_deviation_mm(const struct interp_cursor *c,
						struct interp_deviation *d)
{
	if (d->nodes != c->p.nodes || d->index != c->index)
		return interp_deviation_first(c, d);
	return d->of(c, d);
}

#endif /* INTERP_CURSOR_H */
