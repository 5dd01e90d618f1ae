/* SPDX-License-Identifier: Apache-2.0 */
/*
 * walk.h - walk the cursor, count the pulses, meet the actions
 *
 * Threads: RT-safe.
 */
#ifndef RT_WALK_H
#define RT_WALK_H

#include "cycle.h"

/* What the segment ahead is to the machine. */
enum walk_ahead {
	AHEAD_ACTION,			/* neither: something done on the
					 * spot */
	AHEAD_FREE,			/* positioned */
	AHEAD_CUT,			/* eroded */
	AHEAD_PROBE,			/* it ends where the machine says */
};

enum walk_result {
	WALK_ON,
	WALK_ACTION,			/* it stands in front of an action */
	WALK_START,			/* at the start of the program */
	WALK_BEYOND,			/* the next point is outside the
					 * travel */
	WALK_BROKEN,			/* a segment failed its check */
};

enum walk_deed {
	ACTION_PASSED,			/* done, or being done */
	ACTION_WAIT,			/* the PLC has to do something */
	ACTION_HOLD,			/* a programmed stop */
	ACTION_OPTIONAL,		/* M1, and the machine heeds it */
	ACTION_ELECTRODE,		/* another electrode is to be put in */
	ACTION_END,			/* the program is over */
};

/**
 * walk_rejoins() - is the machine on its way forward from a wire's break to the
 * place where the cut goes on?
 */
bool walk_rejoins(const struct cycle *c);

/** walk_needs_wire() - is what is ahead a cut, even if it is only positioned on
 *  the way forward from a break? */
bool walk_needs_wire(const struct cycle *c);

bool walk_is_cut(const struct cycle *c, const struct interp_seg *s);

/** walk_is_due() - is action @i still, or again, to be done? */
bool walk_is_due(const struct cycle *c, uint32_t i, const struct interp_seg *s);
enum walk_ahead walk_ahead(const struct cycle *c);

/**
 * walk_positions() - is no cut ahead, nor an action that a cut has led to?
 * There is no power then, beside the path neither.
 */
bool walk_positions(const struct cycle *c);

/**
 * walk_cut_mm() - the first place of the cut that is ahead or under way; if it
 * begins before @least_mm, any place before that.
 */
double walk_cut_mm(const struct cycle *c, double least_mm);

/** walk_by() - @ds_mm along the path; updates out.target, feed and sums. */
enum walk_result walk_by(struct cycle *c, double ds_mm);

/** walk_pass_change() - @s may say which electrode cuts from here on.  If a
 *  person puts it in, the way back ends at it: another electrode would go where
 *  the last one has cut. */
void walk_pass_change(struct cycle *c, const struct interp_seg *s);

/** walk_meet_change() - if the M code of segment @mcode is that of a changer,
 *  the electrode behind it is the one that is asked for. */
void walk_meet_change(struct cycle *c, uint32_t mcode);

/** walk_action() - do the action in front, once. */
enum walk_deed walk_action(struct cycle *c);

#endif /* RT_WALK_H */
