/* SPDX-License-Identifier: Apache-2.0 */
/*
 * track.h - the way of the wire's axis along an outline
 *
 *	track.c		the parallels of all pieces, joined at their corners
 *	lead.c		the leads in front of them and behind them
 *	clear.c		how near to the outline a part of it comes
 *	lost.c		what it may leave out
 *	way.c		the way along it that is nowhere too near
 *
 * The parallels of neighbours are joined without regard to all others.  So the
 * raw track crosses itself where there is no room for all of it.  The way goes
 * along the raw track.  Where it would come too near to the outline, it changes
 * to the later part that crosses it there, and leaves out what lies between. It
 * may leave out what the wire cannot reach in an inner corner.  If more were
 * left out, a part of the outline would be missing.
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
	struct curve c;			/* as it is written */
	struct vec far;			/* where the wire is at its end off the
					 * outline */
	bool round;			/* an arc, on this plane or the other */
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
					 * are left; this is reported, and is no
					 * fault */
	TRACK_LEAD,			/* lead a comes too near to b */
	TRACK_ROUND,			/* lead a is an arc of radius found_mm;
					 * beside b the wire is wanted_mm off
					 * its end, and beyond its centre */
	TRACK_CROWDED,			/* more crossings than are looked at */
};

struct track_fault {
	enum track_fault_kind kind;
	uint32_t a, b;			/* owners */
	double found_mm, wanted_mm;	/* distance between them; found < 0: not
					 * known */
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

#define LEAD_PARTS	2u

/** lead_size() - how many curves a lead is made of: 0, 1 or LEAD_PARTS. */
uint32_t lead_size(const struct track_lead *l);

/**
 * lead_lay() - the way of the wire from the far end of a lead to @at on the
 * track, or, @out, from @at to the far end.
 * A straight lead goes straight.  An arc goes about the centre that is written
 * at the radius of @at, with a straight step at the far end.
 * Return: false if the wire cannot go so: @at is beyond the centre, or nothing
 * is left of the arc.
 */
bool lead_lay(const struct track_lead *l, struct vec at, bool out,
	      struct curve ret[LEAD_PARTS]);

/** track_lead_of() - 0: element @e leads in, 1: out, -1: it is no lead. */
static inline int track_lead_of(const struct track_work *w, uint32_t e)
{
	if (e < lead_size(&w->job->lead[0]))
		return 0;
	return w->elem[e].piece < 0 ? 1 : -1;
}

/** track_lead_first() - the first element of the lead in (0) or out (1). */
static inline uint32_t track_lead_first(const struct track_work *w, int i)
{
	return i ? w->n - lead_size(&w->job->lead[1]) : 0;
}

/** track_lay_leads() - to the ends of the raw track. */
void track_lay_leads(struct track_work *w);

/** track_put_lead() - let lead @i (0: in) end, or begin, at @at.
 *  Return: false, and the lead is as it was, if it cannot. */
bool track_put_lead(struct track_work *w, int i, struct vec at);

/** track_add() - one more element, not filled. Return: NULL: no memory. */
struct track_elem *track_add(struct track_work *w);

/** track_shift() - how far the parallel of piece @i is to its left. */
double track_shift(const struct track_work *w, uint32_t i);

/** track_forget() - free what @w owns. */
void track_forget(struct track_work *w);

/** clear_init() - find crossings, make the outline ready for questions.
 *  Return: 0, -ENOMEM or -E2BIG: too many crossings. */
int clear_init(struct track_work *w);

/** clear_find_crossings() - of the elements with each other, into w->hit.
 *  Return: 0, -ENOMEM or -E2BIG. */
int clear_find_crossings(struct track_work *w);

/** clear_is() - is share @t0 to @t1 of element @e far enough from all pieces?
 *  If not, w->blocker is one that is too near. */
bool clear_is(struct track_work *w, uint32_t e, double t0, double t1);

/** clear_is_nearly() - if it is not far enough: may the way still go on along
 *  it, because there is no other way?  Moved pieces that nearly lie on each
 *  other cross each other many times, and the way never goes back to an earlier
 *  one. */
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

/** lost_is() - would a part of the outline be missing after @j? */
bool lost_is(const struct track_work *w, const struct track_jump *j);

/** lost_point() - how much is left of the point of the corner of two
 *  neighbours, if that is more than a corner may hide; otherwise 0. */
double lost_point(const struct track_work *w, const struct track_jump *j);

/** way_find() - fill w->run. Return: 0, -ENOMEM, -EINVAL with @fault. */
int way_find(struct track_work *w, struct track_fault *fault);

#endif /* WIRE_TRACK_H */
