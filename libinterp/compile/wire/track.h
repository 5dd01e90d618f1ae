/* SPDX-License-Identifier: Apache-2.0 */
/*
 * track.h - the way of the wire's axis along an outline
 *
 *	track.c		the parallels of all pieces, joined at their corners
 *	clear.c		how near to the outline a part of it comes
 *	lost.c		what it may leave out
 *	way.c		the way along it that is nowhere too near
 *
 * The parallels of neighbours are joined without regard to anything else, so
 * the raw track crosses itself where there is no room for all of it.  The way
 * goes along it, and where it would come too near to the outline it changes to
 * the later part that crosses it there; what lies between is left out.  It is
 * allowed to leave out what the wire cannot reach in an inner corner.  Anything
 * more is a part of the outline that would be missing.
 *
 * Units: mm.  Threads: allocates.  Never in the cycle.
 */
#ifndef WIRE_TRACK_H
#define WIRE_TRACK_H

#include "wire/face.h"
#include "wire/grid.h"

/* A lead; the other end is where the track begins or ends. */
struct track_lead {
	bool there;
	uint32_t owner;
	struct vec far;			/* its end off the outline */
	bool arc;			/* it touches the track in a tangent */
	bool through;			/* it comes through the outline */
};

struct track_elem {
	struct curve c;
	uint32_t owner;
	int64_t piece;			/* of the outline; -1: a lead */
	bool fill;			/* leads to the next motion */
	bool round;			/* goes round the corner behind its
					 * piece; a piece may lead to the next
					 * motion by itself */
	bool dead;			/* no way goes along it */
	bool fitted;			/* a fillet that keeps its radius */
	bool mitre;			/* prolonged at its end, as the next one
					 * is at its start */
	uint32_t hit;			/* its first crossing */
};

/* A crossing as one of the two sees it. */
struct track_hit {
	uint32_t elem, other;
	double t, t_other;
	struct vec at;
};

/* A stretch of the way: a share of an element. */
struct track_run {
	uint32_t elem;
	double t[2];
	bool jump;			/* behind a part that is left out */
};

enum track_fault_kind {
	TRACK_STUCK,			/* it cannot go on behind motion a */
	TRACK_LOST,			/* what lies from a to b is left out */
	TRACK_POINT,			/* found_mm of the point between a and b
					 * are left: no fault, but told */
	TRACK_LEAD,			/* lead a comes too near to b */
	TRACK_CROWDED,			/* more crossings than are looked at */
};

struct track_fault {
	enum track_fault_kind kind;
	uint32_t a, b;			/* owners */
	double found_mm, wanted_mm;	/* between them; found < 0: not known */
};

struct track_job {
	const struct face *face;
	int side;			/* +1: the wire is on the left, -1; 0 */
	struct track_lead lead[2];	/* in, out */
	double pulse_mm;
	bool skip;			/* leave out what has no room */
};

struct track {
	struct curve *c;		/* the way, in its order */
	uint32_t *owner;
	bool *fill;
	uint32_t n;
	struct track_fault *left;	/* what is left out, in its order */
	uint32_t nleft;
};

/**
 * track_make() - fill @t, which is all zero.
 * Return: 0, -ENOMEM, or -EINVAL with @fault filled.
 */
int track_make(struct track *t, const struct track_job *j,
	       struct track_fault *fault);

void track_free(struct track *t);

/* -- Between the files of the track --------------------------------------- */

struct track_work {
	const struct track_job *job;
	struct track_elem *elem;
	uint32_t n;
	struct track_hit *hit;
	uint32_t nhits;
	struct track_run *run;
	uint32_t nruns;
	struct track_fault *left;
	uint32_t nleft;
	size_t room, hits_room, runs_room, left_room;
	struct grid near;		/* pieces of the outline */
	uint32_t *stamp, stamp_now;	/* pieces asked about already */
	double reach_mm;		/* the largest distance of a piece */
	double total_mm;		/* along the outline */
	double slack_mm;		/* nearer by this is no fault */
	double same_mm;			/* crossings so near are one place */
	bool round;			/* no corner is prolonged */
	bool *no_mitre;			/* not that in front of a piece */
	uint32_t blocker;		/* the piece found too near last */
	const struct face_side *sides;	/* NULL, or the pieces themselves are
					 * moved: face_move.h */
};

/** track_add() - one more element, not filled. Return: NULL: no memory. */
struct track_elem *track_add(struct track_work *w);

/** track_shift() - piece @i's parallel is so far to its left. */
double track_shift(const struct track_work *w, uint32_t i);

/** track_forget() - free what @w owns. */
void track_forget(struct track_work *w);

/** track_lay() - the raw track. Return: 0 or -ENOMEM. */
int track_lay(struct track_work *w);

/** clear_init() - find crossings, make the outline ready for questions.
 *  Return: 0, -ENOMEM or -E2BIG: too many crossings. */
int clear_init(struct track_work *w);

/** clear_find_crossings() - of the elements with each other, into w->hit.
 *  Return: 0, -ENOMEM or -E2BIG. */
int clear_find_crossings(struct track_work *w);

/** clear_is() - is share @t0 to @t1 of element @e far enough from all pieces?
 *  If not, w->blocker is one that is too near. */
bool clear_is(struct track_work *w, uint32_t e, double t0, double t1);

/** clear_is_nearly() - if it is not: may the way go on along it, as there is no
 *  other?  Moved pieces that nearly lie on each other cross each other to and
 *  fro, and the way does not go back to an earlier one. */
bool clear_is_nearly(const struct track_work *w, uint32_t e, double t0,
		     double t1);

/* A change of the way from one element to another; what lies between them is
 * left out. */
struct track_jump {
	uint32_t e, f;
	double te, tf;			/* shares of them */
	uint32_t run;			/* the first run behind it; 0: none */
};

/** track_piece() - the piece of the outline that element @e goes along. */
const struct face_piece *track_piece(const struct track_work *w, uint32_t e);

/** lost_is() - would a part of the outline be missing by @j? */
bool lost_is(const struct track_work *w, const struct track_jump *j);

/** lost_point() - how much is left of the point of the corner of two
 *  neighbours, if that is more than a corner may hide; otherwise 0. */
double lost_point(const struct track_work *w, const struct track_jump *j);

/** way_find() - fill w->run. Return: 0, -ENOMEM, -EINVAL with @fault. */
int way_find(struct track_work *w, struct track_fault *fault);

#endif /* WIRE_TRACK_H */
