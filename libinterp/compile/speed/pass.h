/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pass.h - one pass over a program, node by node: how fast each node may be
 * passed
 *
 * Private to compile/speed.
 */
#ifndef SPEED_PASS_H
#define SPEED_PASS_H

#include "interp/bends.h"
#include "interp/limits.h"
#include "interp/smaller.h"
#include "speed/heading.h"

#include <math.h>
#include <string.h>

/*
 * A curve of short lines is looked at over windows of so many corners to each
 * side, and no less than PASS_FAR tolerances.  Each window is twice as wide as
 * the one before.
 */
#define PASS_WINDOW	20
#define PASS_WINDOWS	6

/* A line that is so many tolerances long is turned only a little by a
 * rounding. */
#define PASS_NEAR	20
#define PASS_FAR	100

/* The straight line from one node to another. */
struct chord {
	uint32_t from, to;
	double mm, per_mm;		/* in the columns of h.along, and its
					 * inverse; 0: there is no way */
	double way_mm;			/* along the path, for what is beside
					 * it */
	struct heading h;
};

/* The first nodes behind and ahead that are at least this far from here along
 * the path. */
struct around {
	double mm;
	uint32_t behind, ahead;
	uint32_t before, beyond;	/* the same from there on */
	/* To here and on from here.  The next node often has the second one
	 * behind it. */
	struct chord chord[2];
	uint8_t on;
};

/* What the axes can do, each value once, in the order of the columns. */
struct levels {
	double at[INTERP_NAXES];
	uint32_t n;
	double above;			/* more than this is none of them */
};

/* The least and the most of what the segments allow along the path. */
struct pass_soft {
	double a_least, a_most, j_least, j_most;
};

/* The chords to both sides of a node, over one window. */
struct bow {
	const struct heading *a, *b;
	double mm, way_mm;		/* half of both chords */
	double per_mm;			/* as change has it */
};

/* A limit of a node, how far around the node it shows, and what it were if
 * another rounding were none of it. */
struct shown {
	float mm_s, near_mm, most_mm_s;
};

#define SHOWN_NONE	((struct shown) { INFINITY, 0, INFINITY })

/* A node, as one window shows it. */
struct look {
	uint32_t node, along;
	struct around *window;
	struct bow bow;
	uint32_t beside_corner;		/* columns that this window sees bend
					 * more than narrower ones let them */
	bool certain;			/* what a rounding can be does not
					 * count */
	double most_mm_s;		/* more is not asked for */
	/* Found of the columns beside the path: */
	struct shown round;		/* by the change of a bend */
	struct shown firm;		/* by all else */
};

/* How an axis beside the path bends at a node. */
struct bent {
	double bend;			/* change of its rate in a mm, less
					 * another rounding; then what nodes
					 * near to it show of it */
	double shown, near_mm;		/* as this node shows it, and how far
					 * around it */
	double change, change_mm;	/* of its bend in a mm, and how far
					 * around the node it shows */
	double sure;			/* of that, what nodes near to it
					 * show */
	double rate;
};

/* That of one column, at the node between two segments that move.  What it
 * leaves is known when all nodes are (reach.c). */
struct bent_node {
	struct bent is;
	uint32_t column, before, behind;
	float own_mm_s2, own_mm_s3;	/* as if nothing bent */
	float peak_mm_s;		/* no faster, or it is a peak of the
					 * speed */
	float all;			/* the bend of all columns, if the path
					 * itself bends; square to it */
};

struct bent_nodes {
	struct bent_node *at;
	size_t n, room;
	bool lost;			/* there was no memory for one */
};

/* The acceleration and jerk that bends leave for motion along the path. */
struct leave {
	double a_mm_s2, j_mm_s3;
};

/* Where the path itself bends, a column that does: at the nodes between the
 * segments @before and @behind. */
struct bent_way {
	uint32_t before, behind;
	uint32_t column;
	float bend, change, rate;	/* as struct bent */
	float all;			/* the bend of all columns */
};

struct bent_ways {
	struct bent_way *at;
	size_t n, room;
	uint32_t last;			/* columns of the last place */
	uint32_t behind;		/* where that ends; in the rows it is
					 * written later */
	bool lost;			/* there was no memory for one */
};

/*
 * What limits a node: in how the bend of an axis beside the path changes, a
 * rounding shows most (dip.c).
 */
struct dip {
	uint32_t node;
	struct shown round, bow;	/* by that; by all else of the curve */
	float firm_mm_s;		/* by its own turn */
};

/* The narrowest window in which a change of a bend is more than roundings. */
#define PASS_CHANGE_FIRST	1

/* What it may take of the jerk. */
#define PASS_CHANGE_SHARE	0.7

/* How the bend of the path changes, as one window shows it; that is moved on by
 * its own length. */
struct changing {
	bool known;
	uint32_t node[3];		/* where it is, and what is one and two
					 * windows ahead */
	struct chord chord[4];		/* from @first on: two to the node, and
					 * two from there; 0 mm: none */
	uint32_t first;
	double most_mm_s;		/* no more was asked for */
	double v_mm_s;			/* by that, and by the next */
	double arc_mm_s;		/* by the bend itself */
	double per_mm[INTERP_NAXES];	/* of a bend, in a mm; at most */
	bool clear;			/* wider windows show no more */
	/* A bend that goes on before the node and behind it: */
	struct bent bent[INTERP_NAXES];
	double bend_most;		/* of all columns; a rounding hides no
					 * more */
	double on_most;			/* nor does more of it go on */
};

/* The bend of the path that was noted last.  It is the same as far as @to_mm
 * along the path, unless a node shows more of it. */
struct way_on {
	double to_mm;			/* -INFINITY: there is none */
	double same_mm;			/* so far it is noted as it is */
	double bend, off;		/* in a mm */
	double bend2[2];		/* squared, a line shows so much of it:
					 * the least and the most */
	double most_mm_s;		/* what was asked for */
	double v_mm_s;			/* no faster than this */
};

/* Where it goes on bending, the path may turn by so much until it is noted in
 * its new direction, and until that is looked at again. */
#define PASS_SAME_WAY	0.2
#define PASS_SAME_BEND	2.0

/* Of its acceleration, what a bend of the path may take and is not looked
 * for. */
#define PASS_HARDLY	0.1
/* The same of the jerk, of an axis beside the path. */
#define PASS_HARDLY_JERK	0.1

/* When that has to be asked, and what is known until then. */
struct change_gate {
	uint32_t next;			/* the first node that is not known */
	double most_mm_s, v_mm_s;
	double a_mm_s2, jerk_mm_s3;	/* of the weakest axis */
	struct way_on way;
	double bend[2][INTERP_NAXES];	/* between long lines, from node @first
					 * up to @node, of the last two */
	uint32_t first, node;
};

/* Nodes to each side of one, and how much of a window: there half of a corner
 * shows. */
#define DIP_NODES	8
#define DIP_NEAR	0.5
#define DIP_RING	32

/* Limits of segments of late that are near to each other. */
struct plateau {
	float low_mm_s;
	uint32_t near, far;		/* that many of late */
	uint32_t below;			/* far below: 2 for each, less 1 for
					 * each other one */
};

struct pass {
	const struct interp_program *p;
	struct interp_seg *segs;
	double corner_mm, points_per_s;
	double short_mm;		/* shorter lines: pass_is_short() */
	uint32_t n;			/* columns */
	uint32_t threads;
	uint32_t end;			/* the last segment; 0: not known */
	uint32_t at, last;		/* the next segment, and the last one
					 * that moves; 0: none yet */
	struct headings headings[2];	/* of the last one */
	struct ways ways;
	struct around windows[PASS_WINDOWS], near;
	struct changing changing[PASS_WINDOWS];
	struct change_gate gate;
	uint32_t run, run_end;		/* nodes that windows look between;
					 * UINT32_MAX: it is farther than any
					 * window */
	uint32_t known;			/* segments that are whole */
	struct heading_run ahead;	/* how far that was looked for */
	uint32_t slow;			/* the slowest node of late; 0: none */
	/* Of each column: */
	double tol[INTERP_NAXES];	/* mm or degrees that do not count as a
					 * change */
	double v_mm_s[INTERP_NAXES], a_mm_s2[INTERP_NAXES];
	double j_mm_s3[INTERP_NAXES];
	double step_mm_s[INTERP_NAXES];	/* at a node */
	double curl_mm_s2[INTERP_NAXES]; /* step of the acceleration there */
	struct levels v_levels, a_levels, j_levels;
	bool alike;			/* all can do the same */
	struct plateau plateau;
	double turn_least[2];		/* near_turns_faster() */
	double a_linear_mm_s2;		/* the least of X Y Z */
	double travel_a_mm_s2;		/* of any positioning, at most */
	double travel_j_mm_s3;
	double a_own_mm_s2[2];		/* of the segments before and behind the
					 * node, as if nothing bent */
	double top_mm_s[2];		/* by narrow peaks of rates on them */
	uint32_t bends;			/* the columns that have this at the
					 * node: */
	struct bent bent[INTERP_NAXES];
	struct bent_nodes bent_nodes;	/* beside the path */
	struct bent_ways bent_ways;	/* of the path itself */
	struct dip dip, dips[DIP_RING];	/* at the node, and of the last ones */
	uint32_t tol_of;		/* columns whose tol was asked for
					 * last */
	double tol_most;
	struct pass_soft soft;		/* known after the last segment */
	bool parts;			/* the length passes to other axes */
};

/**
 * pass_cube_root() - of a number above 0, 1e-14 of it off at most.
 *
 * A third of the exponent is 3 % off, and a step by Halley makes a cube of what
 * was off.  cbrt() takes five times as long, and limits become levels anyway.
 */
static inline double pass_cube_root(double d)
{
	uint64_t bits;
	double r;

	memcpy(&bits, &d, sizeof(bits));
	bits = bits / 3 + UINT64_C(0x2a9f7893782da1ce);
	memcpy(&r, &bits, sizeof(r));
	for (int i = 0; i < 2; i++) {
		const double cube = r * r * r;

		r *= (cube + 2 * d) / (2 * cube + d);
	}
	return r;
}

/**
 * pass_round_mm_s() - the greatest speed around a bend, if the axes have so
 * much acceleration.
 */
static inline double pass_round_mm_s(double r_mm, double a_mm_s2,
				     double j_mm_s3)
{
	const double v = sqrt(a_mm_s2 * r_mm), jrr = j_mm_s3 * r_mm * r_mm;

	return v * v * v <= jrr ? v : pass_cube_root(jrr);
}

/* Longer lines have no curve beside the one that their corners show. */
#define PASS_LONG	5

/**
 * pass_is_short() - is segment @i so short that its curve does not show in its
 * ends?
 */
static inline bool pass_is_short(const struct pass *w, uint32_t i)
{
	return w->segs[i].length_mm < w->short_mm;
}

/* Neither is a NAN. */
static inline float pass_least(float a, float b)
{
	return a < b ? a : b;
}

/** pass_along_tol() - the rounding of the path: that of all @columns may go one
 *  way. */
static inline double pass_along_tol(struct pass *w, uint32_t columns)
{
	if (columns == w->tol_of)
		return w->tol_most;
	w->tol_of = columns;
	w->tol_most = 0;
	for (uint32_t j = 0; j < w->n; j++)
		if (columns >> j & 1)
			w->tol_most += w->tol[j] * w->tol[j];
	w->tol_most = sqrt(w->tol_most);
	return w->tol_most;
}

/* Of its own roundings, that an axis beside the path has from that of the
 * path. */
#define PASS_MOST_BESIDE	20

/**
 * pass_off() - what @along, the rounding of the path, makes of column @j beside
 * it that has this rate.
 *
 * Never more than PASS_MOST_BESIDE roundings of its own: an axis that turns far
 * on a tiny line really turns there.
 */
static inline double pass_off(const struct pass *w, uint32_t j, double along,
			      double rate)
{
	return smaller(along * rate, PASS_MOST_BESIDE * w->tol[j]);
}

/** pass_rate() - how far column @j goes in a mm of segment @i, in the mean. */
static inline double pass_rate(const struct pass *w, uint32_t i, uint32_t j)
{
	const int64_t *from = w->p->nodes + (uint64_t)i * w->n + j;

	return (double)(from[w->n] - from[0]) * w->ways.sub_mm[j] /
	       w->segs[i].length_mm;
}

/** pass_begin() - before the first segment.  @p and @segs are lent. */
void pass_begin(struct pass *w, const struct interp_limits *l,
		const struct interp_program *p, struct interp_seg *segs);

/**
 * pass_walk() - limit segments and nodes up to, but not with, segment @to.
 *
 * @known: segments that are whole; @to is no more than pass_seen() of it, or
 *	   all are known
 */
void pass_walk(struct pass *w, uint32_t known, uint32_t to);

/** pass_seen() - the segments for which no limit looks at more than the first
 *  @known. */
uint32_t pass_seen(const struct pass *w, uint32_t known);

/** pass_move() - the program is now there. */
void pass_move(struct pass *w, const struct interp_program *p,
	       struct interp_seg *segs);

/** pass_finish() - all is known: limit the rest, and find what needs the
 *  end; fill @bends. */
void pass_finish(struct pass *w, struct interp_bends *bends);

/** pass_chord() - find the straight line from node @from to node @to.  Its
 *  length is that of the columns @along. */
void pass_chord(const struct pass *w, uint32_t from, uint32_t to,
		uint32_t along, struct chord *ret);

/**
 * pass_beside() - how fast column @j, which does not count in the length, can
 * follow the bow of @l; @d is the change of its rate, @less the same less
 * another rounding.
 */
void pass_beside(struct pass *w, struct look *l, uint32_t j, double d,
		 double less);

/** pass_own_mm_s2() - the acceleration along the path, of which a bend at the
 *  node may take a share. */
static inline double pass_own_mm_s2(const struct pass *w)
{
	return smaller(w->a_linear_mm_s2, smaller(w->a_own_mm_s2[0],
						  w->a_own_mm_s2[1]));
}

/** pass_is_known() - are both of these segments parts of one known way? */
static inline bool pass_is_known(const struct pass *w, uint32_t a, uint32_t b)
{
	const struct interp_seg *s = w->segs;

	return s[a].flags & s[b].flags & INTERP_SEG_KNOWN &&
	       s[a].line == s[b].line;
}

/** pass_known() - note how the columns that are not @along bend at the node in
 *  front of segment @i, between two parts of a known way. */
void pass_known(struct pass *w, uint32_t i, uint32_t along);

/** pass_known_own() - the acceleration along the path that a move can have
 *  between these parts of a known way: from a stand to their speed none comes
 *  to more. */
double pass_known_own(const struct pass *w, uint32_t before,
		      uint32_t behind);

/** pass_leave() - what a bend leaves, if its node is passed at @v_mm_s at
 *  most. */
void pass_leave(const struct pass *w, const struct bent_node *b, double v_mm_s,
		struct leave *ret);

/** pass_soften_segs() - segments @from to @to have no more than that. */
void pass_soften_segs(struct pass *w, uint32_t from, uint32_t to,
		      const struct leave *left);

/** pass_note_bends() - soften the segments @before and @behind a node by its
 *  bends, when pass_soften() is called. */
void pass_note_bends(struct pass *w, uint32_t before, uint32_t behind);

/** pass_forget_bends() - what was noted of the node in front of segment
 *  @behind: it is looked at once more. */
void pass_forget_bends(struct pass *w, uint32_t behind);

/** pass_bent_node() - the same by one of them. */
void pass_bent_node(struct pass *w, const struct bent_node *b);

/* How the path itself bends. */
struct way_bend {
	struct bent is[INTERP_NAXES];	/* each column; bend 0: it does not */
	double all;			/* of all columns, in a mm */
	double v_mm_s;			/* it is no faster */
};

/**
 * pass_note_way() - between the segments @before and @behind the path bends so:
 * soften them when pass_soften() is called.
 */
void pass_note_way(struct pass *w, uint32_t before, uint32_t behind,
		   const struct way_bend *b);

/** pass_way_begin() - from node @i on the path bends as is noted; @k says by
 *  how much, of which a rounding may hide @k->off, and the speeds. */
static inline void pass_way_begin(struct pass *w, uint32_t i,
				  const struct way_on *k)
{
	const double at = w->segs[i].s_mm, most = k->bend + k->off;
	const double least = larger(k->bend / 2 - k->off, 0);
	struct way_on *way = &w->gate.way;

	*way = *k;
	way->to_mm = k->bend > 0 ? at + PASS_SAME_BEND / k->bend : -INFINITY;
	way->same_mm = at + PASS_SAME_WAY / k->bend;
	way->bend2[0] = least * least;
	way->bend2[1] = most * most;
}

/** pass_way_on() - note at node @i that the bend is as before, between lines in
 *  these directions. */
void pass_way_on(struct pass *w, uint32_t i, const struct heading *a,
		 const struct heading *b);

/** pass_way_known() - no more is noted of the last place: write where it
 *  ends. */
static inline void pass_way_known(struct pass *w)
{
	struct bent_ways *k = &w->bent_ways;

	for (; k->last > 0; k->last--)
		k->at[k->n - k->last].behind = k->behind;
}

/** pass_way_end() - what was noted last says nothing of what is behind segment
 *  @behind. */
static inline void pass_way_end(struct pass *w, uint32_t behind)
{
	struct bent_ways *k = &w->bent_ways;

	if (k->last > 0 && k->behind > behind &&
	    k->at[k->n - 1].before < behind)
		k->behind = behind;
}

/** pass_way_node() - a column of it, as if at one node. */
static inline struct bent_node pass_way_node(const struct bent_way *k)
{
	return (struct bent_node) {
		.is = { .bend = (double)k->bend, .change = (double)k->change,
			.rate = (double)k->rate },
		.column = k->column, .before = k->before, .behind = k->behind,
		.all = k->all,
	};
}

/** pass_forget() - free what pass_soften() has not freed. */
void pass_forget(struct pass *w);

/** pass_bends() - fill the program's @bends, from bends that are noted and from
 *  segments that pass_soften() has not softened. */
void pass_bends(const struct pass *w, struct interp_bends *bends);

/** pass_soften() - the speeds of all nodes are known. */
void pass_soften(struct pass *w);

/** pass_levels() - what segments allow along the path is known: make levels of
 *  it. */
void pass_levels(struct pass *w);

/** pass_note_dip() - remember what limits node @i. */
void pass_note_dip(struct pass *w, uint32_t i);

/** pass_dip_bends() - of what bends are noted, leave out what only a rounding
 *  can be. */
void pass_dip_bends(struct pass *w);

/** pass_dip_firm() - the nodes behind @first up to @i have this limit, too. */
void pass_dip_firm(struct pass *w, uint32_t first, uint32_t i, double v_mm_s);

/** pass_dip_mm_s() - the greatest speed over node @i if what only a rounding
 *  can be does not count; 0: nothing is known of it. */
double pass_dip_mm_s(const struct pass *w, uint32_t i);

static inline double pass_from_to(const struct pass *w, uint32_t a, uint32_t b)
{
	return fabs(w->segs[b].s_mm - w->segs[a].s_mm);
}

/* Of the narrowest window. */
#define PASS_SEES	2

/** pass_sees_mm() - nodes so near to a corner may see it in there. */
static inline double pass_sees_mm(const struct pass *w)
{
	return PASS_SEES * w->windows[0].mm;
}

/** pass_is_near() - is @node so near to a bend that it shows it, no farther
 *  than @mm? */
static inline bool pass_is_near(const struct pass *w,
				const struct bent_node *b, int64_t node,
				double mm)
{
	return node > 0 && node <= (int64_t)w->end &&
	       pass_from_to(w, b->behind, (uint32_t)node) <= mm;
}

/** pass_away() - the next node at least @mm from node @i in its run, forward if
 *  @way is 1, back if -1. */
static inline uint32_t pass_away(const struct pass *w, uint32_t i, int way,
				 double mm)
{
	uint32_t k = i;

	while (k > w->run && k < w->run_end && pass_from_to(w, i, k) < mm)
		k += (uint32_t)way;
	return k;
}

/* A corner between two lines, each of short ones. */
struct lone {
	uint32_t at;			/* its node */
	double mm_s;
	float beyond_mm_s[2];		/* of the next nodes that do not see it,
					 * behind and ahead */
};

/** pass_lone() - is there one at the slow node @at, or near to it?  Nodes up to
 *  @known are known. */
bool pass_lone(struct pass *w, uint32_t at, uint32_t known, struct lone *ret);

/** pass_corner() - the greatest speed from chord @a to chord @b, which have the
 *  same columns. */
double pass_corner(struct pass *w, const struct chord *a,
		   const struct chord *b);

/** pass_beside_corner() - if the slowest node of late is a corner, the nodes
 *  beside it are no slower by it.  Nodes up to @known are known. */
void pass_beside_corner(struct pass *w, uint32_t known);

/**
 * pass_curve() - the greatest speed over the node in front of segment @i on the
 * curve of its chords; no more than @most_mm_s is asked for.
 */
double pass_curve(struct pass *w, uint32_t i, uint32_t along, double most_mm_s);

/** pass_change() - the greatest speed over node @i of short lines by how the
 *  bend of the path changes around it; no more than @most_mm_s is asked for. */
double pass_change(struct pass *w, uint32_t i, uint32_t along,
		   double most_mm_s);

/** pass_change_anew() - what was seen so far says nothing of the nodes from @i
 *  on; those before it are not asked. */
void pass_change_anew(struct pass *w, uint32_t i);

/** pass_curl() - the greatest speed over the same node by how the bend of arcs
 *  and curves changes there. */
double pass_curl(const struct pass *w, uint32_t last, uint32_t i,
		 const struct heading *a, const struct heading *b);

/** pass_turn_behind() - how much column rates change from segment @i to the
 *  next one; by nothing if they are no lines of this run. */
void pass_turn_behind(const struct pass *w, uint32_t i,
		      double ret[INTERP_NAXES]);

/** pass_arch() - the greatest speed over the node in front of segment @i, if it
 *  is one of several between long lines that turn the same way; note its
 *  bend. */
double pass_arch(struct pass *w, uint32_t i, uint32_t along, double most_mm_s);

/* The weakest of some columns. */
struct weakest {
	double a_mm_s2, j_mm_s3;
};

struct weakest pass_weakest(const struct pass *w, uint32_t columns);

/** pass_arc_mm_s() - the greatest speed where the path goes on bending, by as
 *  much in a mm.  The speed of an arc. */
static inline double pass_arc_mm_s(const struct weakest *k, double bend)
{
	return pass_round_mm_s(1 / bend, INTERP_BEND_ACROSS * k->a_mm_s2,
			       INTERP_ARC_JERK_ROUND * k->j_mm_s3);
}

/** pass_turn() - the greatest speed over the same node by its own turn. */
double pass_turn(struct pass *w, uint32_t last, uint32_t i,
		 const struct heading *a, const struct heading *b);

/**
 * pass_node_mm_s() - the greatest speed over the node in front of segment @i;
 * @last is the segment before it that moves.  INFINITY: any speed.
 */
double pass_node_mm_s(struct pass *w, uint32_t last, uint32_t i,
		      const struct heading *a, const struct heading *b);

/** pass_is_tiny() - is segment @i so short that it has no direction? */
static inline bool pass_is_tiny(const struct pass *w, uint32_t i)
{
	return w->segs[i].length_mm < w->near.mm;
}

/**
 * pass_over_mm_s() - the greatest speed over the tiny segments in front of
 * segment @i, which is not tiny.
 *
 * A rounding hides the corners at their nodes.  So the turn from the segment
 * before them to the one behind them is passed as one corner.
 *
 * @first: the segment before @i that moves; ret: that in front of the tiny
 * ones, if it is not tiny and nothing stops behind it.
 */
double pass_over_mm_s(struct pass *w, uint32_t *first, uint32_t i,
		      const struct heading *b);

/* The most that each column moves in a mm of a segment. */
struct rates {
	double by[INTERP_NAXES];
	uint32_t bends;			/* columns that go round a bend */
	double v_mm_s;			/* of a short line: what the speeds of
					 * the axes allow at such rates; 0:
					 * nothing is said */
	double top_mm_s;		/* by the jerk on narrow peaks of them,
					 * the most over its nodes */
};

/* Of what lies beside the path, around a line. */
struct peaks {
	struct chord *around;		/* the way around it; lent */
	double per_mm[INTERP_NAXES];	/* the inverse of the way over which a
					 * rate was found */
	uint32_t from, to;		/* the wider way */
	double v_mm_s;			/* by the jerk on a top */
	double top[INTERP_NAXES];	/* by how much the top of its peak is
					 * above that rate */
};

/** pass_peaks() - what lies beside @ret->around, the way around line @i, takes
 *  the rates of peaks there; fill the rest of @ret. */
void pass_peaks(struct pass *w, uint32_t i, struct peaks *ret);

/** pass_rates() - find the rates of segment @i. */
void pass_rates(struct pass *w, uint32_t i, const struct headings *h,
		struct rates *ret);

/**
 * pass_stretches() - set INTERP_SEG_STAND where a move has to stand.  So far it
 * is set where the length passes to other axes.  a_mm_s2 and j_mm_s3 of all
 * segments are known.
 */
void pass_stretches(struct pass *w);

/**
 * pass_moves_s() - the time of segments @from up to, but not with, @to, by
 * moves that stand in the flagged nodes and at both ends.
 *
 * @fed: they keep to F; otherwise they are jumps or rapids.
 * @v2: room for @to numbers.
 */
double pass_moves_s(const struct pass *w, uint32_t from, uint32_t to,
		    bool fed, float *v2);

/* Stands must save so much of the time. */
#define PASS_WORTH	0.97

/* Those that save so much may cost so much at F. */
#define PASS_WORTH_COST	0.95
#define PASS_COST	1.02

/** pass_most_at_feed() - of the time without stands at F, what they may take
 *  there that take @share of it without F. */
static inline double pass_most_at_feed(double share)
{
	return share < PASS_WORTH_COST ? PASS_COST : 1;
}

/**
 * pass_stand_apart() - flag the corners between sides that are softer and
 * harder, where stands save time: each such side may be as soft as the axes
 * that turn on it, and one move over all of them is as soft as the softest.
 *
 * @room: for 5 * @to numbers
 */
void pass_stand_apart(struct pass *w, uint32_t from, uint32_t to, float *room);

/** pass_set_stand() - at the end of segment @i; false: take it away. */
static inline void pass_set_stand(struct pass *w, uint32_t i, bool stands)
{
	uint8_t *flags = &w->segs[i].flags;

	*flags = (uint8_t)(stands ? *flags | INTERP_SEG_STAND :
				    *flags & ~INTERP_SEG_STAND);
}

/** pass_hops() - write slower_* and softer_* of all segments, when all else is
 *  known. */
void pass_hops(struct pass *w);

#endif /* SPEED_PASS_H */
