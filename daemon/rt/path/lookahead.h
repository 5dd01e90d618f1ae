/* SPDX-License-Identifier: Apache-2.0 */
/*
 * lookahead.h - can what lies ahead still be met?
 *
 * A place is met if the speed there is no higher than it may be.  From where a
 * plan leads within one cycle, this looks along the path, forward or back, as
 * far as the braking distance, and finds the place that would be missed by
 * most.
 *
 * "Way", "left" and the sign of every speed count in the direction of the move.
 * Private to ahead.c and lookahead.c.  Threads: RT-safe.
 */
#ifndef RT_LOOKAHEAD_H
#define RT_LOOKAHEAD_H

#include "path/ahead.h"

/* A plan reaches the speed of a slow place LOOKAHEAD_EARLY_MM before it, and it
 * counts as met MOVER_ONTO_MM before it.  A stop is met exactly, but for a
 * rounding. */
#define LOOKAHEAD_EARLY_MM	(2 * MOVER_ONTO_MM)

/* A place ahead, and how fast it may be come to. */
struct lookahead_place {
	double left_mm, v_mm_s;
	bool guessed;			/* the search ended here: it may be
					 * faster */
};

struct lookahead {
	const struct cycle *c;
	const struct ahead_move *w;
	struct interp_scurve_limits l;	/* in the direction of the move */
	struct interp_scurve_state s;	/* after the cycle */
	double let_go_mm_s;		/* without acceleration, after that */
	double plan_mm_s;		/* of the plan's place; INFINITY:
					 * none */
	struct interp_scurve brake;	/* to a stand at once, if there is
					 * one */
	double need_mm;			/* the look ends here: the move can
					 * brake for all that lies beyond */
	double scale;			/* of ceilings: the override, up to 1 */
	bool guessing;			/* what follows was not looked at */
	/* Found: */
	double room_mm;			/* the smallest distance that remains to
					 * a place for which it can brake */
	double missed_mm;		/* > 0: it cannot brake for a place; by
					 * how much too short its way is, for
					 * the worst of these places: */
	struct lookahead_place worst;
	/* Of every look in this cycle: */
	double lowest_mm_s;		/* ceiling ahead, but for stops */
	double next_mm;			/* to the nearest place ahead */
};

/* What the operator's override makes of this move's speeds. */
static inline double lookahead_override(const struct cycle *c,
				   const struct ahead_move *w)
{
	return w->positions ? c->override : 1;
}

#define LOOKAHEAD_NONE	UINT32_MAX

/**
 * lookahead_index() - the segment it is on or, from its very end, about to be
 * on.  LOOKAHEAD_NONE: none.
 */
uint32_t lookahead_index(const struct cycle *c, int toward);

/** lookahead_toward() - that segment.  NULL: none. */
const struct interp_seg *lookahead_toward(const struct cycle *c, int toward);

/**
 * lookahead_from() - fill in what is found, from @s, where the plan leads to.
 */
void lookahead_from(struct lookahead *k, struct interp_scurve_state s);

#endif /* RT_LOOKAHEAD_H */
