/* SPDX-License-Identifier: Apache-2.0 */
/*
 * resync.h - from where the axes stand back to the path
 *
 * Axes without power stand where they were stopped, which may be beside the
 * path: something blocked one of them while the others went on, they ran on in
 * an e-stop, or a person pushed them.  While they have no power, the cycle
 * sends them to where they stand.  So power moves nothing, and every motion
 * begins there.
 *
 * Without a job, where an axis stands becomes its place.  With a job, the
 * machine goes back to the path before it does what it was asked for:
 *
 * 1. An axis that was blocked stays where it stands.  The others go along the
 *    path, the way that they came, to the place where the path has the blocked
 *    axis where it stands.  So it is never sent on toward what blocked it.
 * 2. What is then left to an axis goes off on a straight line, slowly.
 *
 * The place of step 1 is searched for from the place of the path toward
 * sure_mm, the last place where all axes were where they were sent; a path that
 * turns round passes a blocked axis, too, which is no such place.  While an
 * axis was blocked, it did not move, and the path may have turned, even to and
 * fro: so it is looked for from moved_mm on, where it moved last.  It was
 * blocked in the direction in which it moved last.  So the place is one where
 * the path, on its way there, led the axis on in this direction: farther back
 * it leads away from what blocked the axis.  A motor that loses the pulses that
 * it cannot go follows the path back; it was blocked in the direction in which
 * pulses are missing.  What springs back without power is behind sure_mm: on a
 * shallow path, far behind.
 *
 * An axis that was where it was sent until its power went was not blocked, nor
 * was one that went on by itself, that was pushed farther than max, or that the
 * path leads away from by more than max.  It is taken back by step 2, but not
 * farther than max.
 *
 * Units: pulses of the drives; mm along the path.  Threads: RT-safe.
 */
#ifndef RT_RESYNC_H
#define RT_RESYNC_H

#include "interp/cursor.h"
#include "path/escape.h"
#include "path/mover.h"

#include <stdbool.h>
#include <stdint.h>

struct cycle;
struct io_inputs;

struct resync_config {
	int32_t max[INTERP_NAXES];	/* step 2 goes no farther */
	double v_mm_s;			/* ... and no faster */
};

struct resync {
	int32_t off[INTERP_NAXES];	/* from where the path wants it to where
					 * it stands, or is on its way back */
	bool is_off;			/* an axis is */
	int32_t ran_on[INTERP_NAXES];	/* farther than max, by itself */
	double sure_mm;
	uint32_t adrift;		/* bit per axis: it was off, and did not
					 * move since, under power, to where it
					 * was sent */
	bool sure_beside;		/* ... was beside the path */
	int32_t seen[INTERP_NAXES];	/* where each axis stands, to
					 * NEAR_PULSES; */
	bool unseen;			/* ... not known yet */
	double looked_mm;		/* the place of the last look without
					 * power; */
	bool rested;			/* ... and the path did not move */
	double moved_mm[INTERP_NAXES];	/* the place when it came there, toward
					 * where it was sent; */
	int8_t moved_way[INTERP_NAXES];	/* ... its direction, +1, -1; 0: it has
					 * not moved */
	uint32_t moved_beside;		/* bit per axis: ... was beside */
	uint32_t slips;			/* as struct io_inputs has it */
	uint32_t held;			/* bit per axis that stays ... */
	int32_t hold[INTERP_NAXES];	/* ... here */
	double met_mm[INTERP_NAXES];	/* ... until the path is here */
	bool walks;
	/* The search: */
	uint32_t seek, met;		/* bit per axis to be met, and met */
	uint32_t passed;		/* bit per axis: the path has it where
					 * it stands, from met_mm on; in front
					 * of that, beyond what blocked it */
	uint32_t before;		/* ... the path has it before that */
	uint32_t asked;			/* ... looked at behind moved_mm */
	int way[INTERP_NAXES];		/* it was blocked in this direction */
	int64_t left[INTERP_NAXES];	/* from the path to where it stands, as
					 * it was asked first */
	int toward;			/* +1 or -1, along the path */
	struct interp_cursor scout;
	struct escape beside;
	/* The straight line: */
	bool begun;
	int32_t from[INTERP_NAXES];
	double way_mm, gone_mm;
	struct mover mover;
};

enum resync_answer {
	RESYNC_BUSY,			/* nothing else may move */
	RESYNC_WALKS,			/* it moves along the path */
	RESYNC_DONE,
	RESYNC_TOO_FAR,			/* an axis was moved far by hand */
	RESYNC_GIVEN_UP,		/* it was stopped on its way */
};

/** resync_set() - the axes stand @off from where the path wants them. */
void resync_set(struct resync *r, const int32_t off[INTERP_NAXES]);

/** resync_begin() - a job begins at @place_mm, where all axes are. */
void resync_begin(struct resync *r, double place_mm);

/** resync_look() - before anything moves: where do the axes stand? */
void resync_look(struct cycle *c, const struct io_inputs *in);

/** resync_is_off() - is any axis beside the path, or on its way back? */
bool resync_is_off(const struct cycle *c);

/** resync_settle() - without a job: where the axes stand is their place. */
void resync_settle(struct cycle *c);

/** resync_search() - begin to search for the way; no axis moves. */
void resync_search(struct cycle *c);

/** resync_seek() - one period of the search: BUSY, DONE or TOO_FAR. */
enum resync_answer resync_seek(struct cycle *c);

/** resync_leave() - the axes have power: the way begins. */
void resync_leave(struct cycle *c);

/** resync_go() - one period of the way: not TOO_FAR. */
enum resync_answer resync_go(struct cycle *c);

/** resync_apply() - @target of the path becomes what the drives are sent. */
void resync_apply(struct cycle *c, int32_t target[INTERP_NAXES]);

#endif /* RT_RESYNC_H */
