/* SPDX-License-Identifier: Apache-2.0 */
/*
 * program.h - a compiled program: one flat block of segments, nodes and arcs
 *
 * A program is a path.  Segment i leads from node i to node i+1.  A segment
 * without length (a dwell, a stop, a switched output) has two equal nodes.  It
 * is called an *action*, and is done when the walk comes to it for the first
 * time.  The block holds offsets and no pointers: the job service writes it
 * into shared memory once, and the real-time process maps it read-only.
 *
 *	head | segments[nsegs] | nodes[nsegs + 1][naxes] | arcs[narcs]
 *	     | conditions[nconds] | escapes[nescapes] | couples[ncouples]
 *	     | bits[nbits] | curves[ncurves] | pieces[npieces]
 *	     | stops[nstops] | numbers[nnumbers]
 *	     | runs[nruns] | origins[norigins]
 *
 * Bits are strings of whole words, with one bit for each pulse.  A line by
 * min-switch has one string for each of its pairs of axes, in the order of
 * pulse/couple.h.  A bit says whether the secondary input gives the pulse.
 * Behind its bits each string has counts of them (pulse/bit_string.h), at which
 * a seek begins.
 *
 * Nodes are in fixed-point numbers: 1 pulse = INTERP_SUB subpulses.  So a
 * programmed point between two pulses is kept, and the way there and back is
 * exact.  A node has one column for each axis that the program moves.  The
 * other axes stand.
 *
 * Units: mm, mm/s along the path; rotary axes in degrees.  The length of a path
 * is the length in X Y Z; if none of these moves, in U V; else in A B C
 * (degrees).  Axes of a line that move less than a 10000th as far as one of
 * those behind them in this order do not count as moving: a place on it would
 * not say where the others are.
 * Threads: a mapped program is never written; any thread may read it.
 */
#ifndef INTERP_PROGRAM_H
#define INTERP_PROGRAM_H

#include "interp/axis.h"
#include "interp/mcode_arg.h"
#include "interp/nurbs_length.h"
#include "interp/strategies.h"
#include "interp/tech.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define INTERP_SUB_BITS		16
#define INTERP_SUB		(1 << INTERP_SUB_BITS)

/* Axes that move so many times as far as those before them make the length. */
#define INTERP_FAR_BESIDE	1e4

#define INTERP_PROGRAM_MAGIC	"edmprog"	/* 8 bytes with its NUL */
#define INTERP_PROGRAM_VERSION	19

/*
 * How three and more axes make a line when they move one at a time.
 * Point-by-point is always a tree.  With two axes there is no difference.
 * Simultaneous does not need it.
 */
enum interp_coupling {
	INTERP_STAR,			/* each axis against the longest one */
	INTERP_TREE,			/* pairs of pairs,
					 * (((X,Y),(Z,A)),(B,C)) */
	INTERP_NCOUPLINGS
};

/* The widest tolerance: keeps every product of a line inside int64_t. */
#define INTERP_TOLERANCE_MAX	1000000		/* 1/1000 pulse */

enum interp_kind {
	INTERP_LINE,			/* arg: 0, or 1 + the first word of its
					 * bits */
	INTERP_ARC,			/* circular or helical; arg: arc
					 * index */
	INTERP_PAIR,			/* X Y and U V, each a line or an arc;
					 * arg: couple index */
	INTERP_CURVE,			/* part of a NURBS; arg: piece index */
	/* From here on: actions, of no length. */
	INTERP_BEGIN,			/* always the first, does nothing */
	INTERP_DWELL,			/* arg: milliseconds */
	INTERP_STOP,			/* M0: hold until resumed */
	INTERP_OPTIONAL_STOP,		/* M1 */
	INTERP_AUX,			/* arg: INTERP_AUX_OF() and _WAS() */
	INTERP_MCODE,			/* the PLC's; arg: interp/mcode_arg.h */
	INTERP_ELECTRODE,		/* this one cuts from here on; arg: its
					 * number, and INTERP_ELECTRODE_STOP */
	INTERP_TIMED,			/* the part from here to segment arg has
					 * a time; when it is over, the rest of
					 * the part is left out.  It ends where
					 * it begins */
	INTERP_TIMED_END,		/* the end of the part; the time is arg
					 * milliseconds */
	INTERP_END,			/* always the last: M2, M30, end of
					 * text */
	INTERP_NKINDS
};

/* It holds, so that a person puts the electrode in.  A retract does not go back
 * over it. */
#define INTERP_ELECTRODE_STOP	0x80000000u
#define INTERP_ELECTRODE_MAX	9999u		/* 0: the holder is empty */
#define INTERP_ELECTRODES_MAX	64u		/* changes in a program */

/* Outputs a program may switch. */
enum interp_aux {
	INTERP_AUX_POWER_OFF,		/* M5: cut without power from here on */
	INTERP_AUX_POWER_POSITIVE,	/* M3: electrode positive */
	INTERP_AUX_POWER_NEGATIVE,	/* M4: electrode negative */
	INTERP_AUX_PUMP_ON,		/* T84: dielectric on */
	INTERP_AUX_PUMP_OFF,		/* T85 */
	INTERP_NAUX
};

/* Which output; and of M3, M4 and M5 the M3 or M4 before it, which a way back
 * over it comes to; 0: none. */
#define INTERP_AUX_OF(arg)	((arg) & 0xffu)
#define INTERP_AUX_WAS(arg)	((arg) >> 8)

#define INTERP_SEG_RAPID	0x01	/* G0: positioned, not eroded */

/* Straight lines that end where the machine says, and not at their end node.
 * The rest of such a line is not walked, and everything after it is shifted by
 * that rest.  The power is off. */
#define INTERP_SEG_PROBE	0x02	/* at contact */
#define INTERP_SEG_HALF		0x04	/* between the last two contacts along
					 * its axis */
#define INTERP_SEG_LIMIT	0x08	/* at the end of its axis's travel */
#define INTERP_SEG_SENSED	0x0e	/* any of them */

/* Planned moves stand at its last node, either way, because the axes allow much
 * less on one side of it than on the other.  The gap servo does not. */
#define INTERP_SEG_STAND	0x10

/* Positioned out of what a cycle has cut: a short there is no collision. */
#define INTERP_SEG_OUT		0x20

/* Behind M5: written as a cut, and positioned. */
#define INTERP_SEG_OFF		0x40

/* Any of these: nothing is cut on it. */
#define INTERP_SEG_UNCUT	(INTERP_SEG_RAPID | INTERP_SEG_SENSED | \
				 INTERP_SEG_OFF)

struct interp_seg {
	double s_mm;			/* place of its first node on the
					 * path */
	double length_mm;		/* 0 for an action */
	float feed_mm_s;		/* as programmed; for a rapid, the
					 * ceiling */
	float feed_max_mm_s;		/* the fastest any of its axes allows */
	uint32_t line;			/* of the source text, from 1 */
	uint32_t ticks;			/* lattice points after the first */
	uint32_t arg;			/* by kind */
	uint16_t cond;			/* conditions[cond]; 0 is "none
					 * called" */
	uint8_t kind;			/* enum interp_kind */
	uint8_t flags;			/* INTERP_SEG_* */
	/* Written by compile/speed when the program is whole: limits.h */
	float node_mm_s;		/* the fastest over its last node */
	uint16_t slower_ahead;		/* how many segments ahead is the next
					 * one that is entered slower, or an
					 * action, or where cutting begins or
					 * ends */
	uint16_t slower_behind;		/* the same, going back; 0: none */
	uint16_t slower_feed;		/* how many segments ahead is one with a
					 * smaller F; 0: none */
	uint16_t escape;		/* escapes[escape]; 0 is "along the
					 * path" */
	uint16_t softer_ahead;		/* how many segments ahead is an action,
					 * a segment with less a_mm_s2 or
					 * j_mm_s3, or one behind a stand */
	uint16_t softer_behind;		/* the same, going back; 0: none */
	float a_mm_s2, j_mm_s3;		/* along the path, that its axes allow;
					 * INFINITY for an action */
};

/*
 * A circular arc in the plane (a, b).  Every other axis moves linearly at the
 * same time.  The radius changes linearly from r_mm to r_mm + dr_mm, so that
 * the end is met exactly even if rounding put it beside the circle.
 */
struct interp_arc {
	double a_mm, b_mm;		/* centre */
	double r_mm, dr_mm;
	double theta;			/* radian, from a toward b, at the
					 * start */
	double sweep;			/* radian, signed; + is
					 * counter-clockwise */
	/* Not for simultaneous; see pulse/circle.c: */
	int64_t measure;		/* of the whole circle: area and
					 * ticks */
	uint32_t circle_ticks;		/* pulses in the plane */
	uint32_t tail;			/* ticks before the first forced
					 * pulse */
	int32_t tail_a, tail_b;		/* forced pulses from there to the
					 * end */
	uint32_t crossings;		/* of the axes through the centre */
	uint32_t run_at, nruns;		/* runs[run_at ...]: of min-switch its
					 * runs; else what a seek begins at */
	uint8_t axis_a, axis_b;		/* enum interp_axis */
	uint8_t run_first;		/* axis of the first run: 0 a, 1 b */
	uint8_t pad;
};

/*
 * Two contours that are walked together, as a tapered wire needs it: side[0] in
 * X Y, side[1] in U V.  A side of radius 0 is a straight line.  Where the axes
 * move one at a time, bit k of the string at bits[bits_at] says to which side
 * tick k + 1 belongs: 0 for side[0], 1 for side[1].  The builder makes the
 * string.  The walk reads it in both directions, so it needs no memory of its
 * own.
 */
struct interp_couple {
	struct interp_arc side[2];
	uint64_t bits_at;		/* first word of its string */
};

/*
 * A NURBS that a program follows, as a whole or in pieces.  Its knots and
 * control points are in numbers[], in the form of interp/nurbs.h.
 */
struct interp_curve {
	uint32_t degree, npoints;
	uint32_t naxes, counted;
	double others;
	uint64_t knots_at, points_at;
	uint8_t axis[INTERP_NAXES];	/* of each column */
};

/* The part of a curve that one segment follows: from its first stop to its
 * last. */
struct interp_piece {
	uint32_t curve;
	uint32_t nstops;
	uint64_t stops_at;
};

/* A technology condition called by the program, such as C120 or E001. */
struct interp_cond {
	uint32_t number;
	char letter;			/* 'C', 'E' or 'S'; 0: none yet */
	char pad[3];
	struct interp_tech tech;	/* from a technology table, if it has
					 * the condition; else nothing given */
};

/*
 * A way out of the cut that does not follow the path.  It has up to three
 * straight legs: rise_mm toward out_mm; then the axes in `home` to home_mm;
 * then those in `out` to out_mm.  While the segment is cut, no material is in
 * the way of any leg.
 */
struct interp_escape {
	uint32_t home, out;		/* bit per axis; 0 and 0: along the
					 * path */
	double home_mm[INTERP_NAXES];	/* machine coordinates */
	double out_mm[INTERP_NAXES];
	double rise_mm;
	/* The most that each of its axes allows: */
	double v_max_mm_s, a_max_mm_s2, j_max_mm_s3;
};

/* Which way out is wanted.  It is taken only where it is known to be free. */
enum interp_escape_mode {
	INTERP_ESCAPE_PATH,		/* back along the path */
	INTERP_ESCAPE_NORMAL,		/* square to the wall of an orbit, then
					 * out */
	INTERP_ESCAPE_CENTRE,		/* to the centre of an orbit, then
					 * out */
	INTERP_ESCAPE_AXIS,		/* straight up where it came straight
					 * down */
	INTERP_NESCAPE_MODES
};

/* Where a program counts from, from segment `seg` to that of the next entry.
 * Turned back by turn_deg about machine zero, and mirrored, a machine place is
 * mm more than the place that is programmed, times the scale of a figure.  It
 * has the work offset, what the program shifts it by, and the electrode.  Only
 * for those who tell people: the cycle does not look at it. */
struct interp_origin {
	uint32_t seg;
	uint16_t work;			/* 0: G54 ...; INTERP_ORIGIN_UNTOLD */
	uint16_t mirrored;		/* Y (V) first changes its sign */
	double turn_deg;		/* + from X toward Y; U V alike */
	double mm[INTERP_NAXES];
	uint32_t pass, npasses;		/* of G152: 2 of 3; 0: none of it */
	double wire_mm;			/* the wire's offset; + is left, and of
					 * a pass the side is its contour's */
};

#define INTERP_ORIGINS_MAX	4096u	/* those behind them are not told */
#define INTERP_ORIGIN_UNTOLD	255u

/* What was felt before a program begins, if it is the rest of one that was
 * interrupted.  All 0: nothing. */
struct interp_probed {
	int32_t shift[INTERP_NAXES];	/* where the axes are, less the
					 * program's own place; pulses */
	int32_t found[2][INTERP_NAXES];	/* where each axis stood at its last
					 * contacts, the last one first */
	uint32_t once, twice;		/* bit per axis: it has one contact, or
					 * two */
};

/* Where the cut began to spark before a program begins, if it is the rest of
 * one.  All 0: it did not. */
struct interp_depth {
	double way[3];			/* unit vector in X Y Z: it goes deeper
					 * so */
	double far_mm;			/* the deepest so far */
	double known_mm;		/* up to this place nothing new
					 * begins */
	int32_t from[3];		/* the first spark, pulses of the
					 * axes */
	uint32_t counts;		/* 1: all of this is known */
};

struct interp_program_head {
	char magic[8];
	uint32_t version;
	uint32_t head_bytes;
	uint64_t bytes;			/* of the whole block */
	uint32_t nsegs, narcs, nconds, naxes;
	uint64_t segs_at, nodes_at, arcs_at, conds_at;	/* bytes from the
							 * head */
	uint8_t column[INTERP_NAXES];	/* axis of node column j, j < naxes */
	uint32_t strategy;		/* enum interp_strategy */
	uint32_t lines;			/* of the source text */
	uint32_t tolerance_milli;	/* mu, 1/1000 pulse */
	uint32_t perpendicular;		/* 1: mu is square to the line; 0: along
					 * the secondary axis */
	uint32_t coupling;		/* enum interp_coupling */
	uint32_t nruns;			/* of arcs, one axis at a time */
	uint64_t runs_at;		/* bytes from the head */
	double length_mm;
	uint64_t ncouples, couples_at;
	uint64_t nbits, bits_at;		/* words of 64 bits */
	uint64_t nescapes, escapes_at;	/* at least one: along the path */
	uint64_t ncurves, curves_at, npieces, pieces_at;
	uint64_t nstops, stops_at, nnumbers, numbers_at;
	uint64_t norigins, origins_at;	/* by seg; 0: nobody said */
	double pulse_mm[INTERP_NAXES];
	int32_t start_pulses[INTERP_NAXES];	/* of every axis, at node 0 */
	struct interp_probed probed;
	struct interp_depth depth;
	uint8_t hash[32];		/* SHA-256 of the source text, or
					 * zeros */
	char name[64];			/* of the job; NUL-terminated */
};

/** A view of a block.  The memory belongs to the caller. */
struct interp_program {
	const struct interp_program_head *head;
	const struct interp_seg *segs;
	const int64_t *nodes;
	const struct interp_arc *arcs;
	const struct interp_cond *conds;
	const struct interp_escape *escapes;
	const int32_t *runs;		/* pulses in a row, signed; or
					 * what a seek begins at */
	const struct interp_couple *couples;
	const uint64_t *bits;
	const struct interp_curve *curves;
	const struct interp_piece *pieces;
	const struct interp_nurbs_stop *stops;
	const double *numbers;
	const struct interp_origin *origins;
};

/**
 * interp_program_map() - use @bytes bytes at @block as a program.
 *
 * It checks the head, that every table lies inside the block, and the values of
 * the conditions.  Each segment is checked later, when a cursor enters it.
 *
 * Return: 0, or -EBADMSG.  Any thread.
 */
int interp_program_map(struct interp_program *p, const void *block,
		       size_t bytes);

/**
 * interp_program_origin() - the one of segment @i; NULL: nobody said.  The work
 * grows with their number.  Any thread, not the cycle.
 */
const struct interp_origin *
interp_program_origin(const struct interp_program *p, uint32_t i);

/**
 * interp_program_seg_ok() - is segment @i safe to walk?  @seg is a copy of it.
 *
 * Its numbers must be finite, its kind known, its index of an arc and its nodes
 * in range.  RT-safe.
 */
bool interp_program_seg_ok(const struct interp_program *p, uint32_t i,
			   const struct interp_seg *seg);

/**
 * interp_program_curve() - curve @i in the form of interp/nurbs.h.
 *
 * Its knots and points stay in the program.  Return: false if the curve cannot
 * be followed.  RT-safe.
 */
bool interp_program_curve(const struct interp_program *p, uint32_t i,
			  struct interp_nurbs *ret);

/**
 * interp_strategy_name() - "simultaneous", ...; NULL if unknown. Any thread.
 */
const char *interp_strategy_name(enum interp_strategy s);

/** interp_strategy_parse() - the reverse; -EINVAL if unknown. Any thread. */
int interp_strategy_parse(const char *name);

/** interp_strategy_takes_tolerance() - does mu change what it does? */
bool interp_strategy_takes_tolerance(enum interp_strategy s);

/** interp_strategy_couples() - can it use every coupling of three and more
 *  axes? */
bool interp_strategy_couples(enum interp_strategy s);

/** interp_coupling_name() - "star", ...; NULL if unknown. Any thread. */
const char *interp_coupling_name(enum interp_coupling k);

/** interp_coupling_parse() - the reverse; -EINVAL if unknown. Any thread. */
int interp_coupling_parse(const char *name);

/** interp_escape_mode_name() - "path", ...; NULL if unknown. Any thread. */
const char *interp_escape_mode_name(enum interp_escape_mode m);

/** interp_round_sub() - subpulses to the nearest pulse. RT-safe. */
static inline int32_t interp_round_sub(int64_t sub)
{
	return (int32_t)((sub + INTERP_SUB / 2) >> INTERP_SUB_BITS);
}

#endif /* INTERP_PROGRAM_H */
