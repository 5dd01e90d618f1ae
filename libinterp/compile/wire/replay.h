/* SPDX-License-Identifier: Apache-2.0 */
/*
 * replay.h - keep a contour and cut it several times
 *
 * Between contour_record() and contour_recorded() motions are collected and
 * nothing is cut.  The tape has a lead in, the outline and a lead out.  Its
 * parts are then put together again, forward or backward, each with an offset
 * and a condition of its own, and cut by contour_release().
 *
 * Threads: allocates.  Never in the cycle.
 */
#ifndef WIRE_REPLAY_H
#define WIRE_REPLAY_H

#include "wire/contour.h"

struct contour_tape {
	struct contour_motion *m;	/* [0] leads in, [n - 1] out */
	uint32_t n;
	uint32_t tab;			/* its first motion; n - 1: no tab */
};

/* How a part of a tape is cut. */
struct contour_pass {
	double offset_mm;		/* > 0; its side is the tape's */
	const struct interp_build_word *word;	/* feed and condition */
	bool back;			/* from the end to the beginning */
};

/** contour_record() - collect motions from here on; the wire is at @here_mm on
 *  both planes. */
void contour_record(struct contour *k, const double here_mm[2]);

/** contour_recorded() - end that, and get what was collected; the caller frees
 *  ret->m. */
void contour_recorded(struct contour *k, struct contour_tape *ret);

/** contour_tape_is_whole() - does it have a lead in, a closed outline and a
 *  lead out? */
bool contour_tape_is_whole(const struct contour_tape *t, double pulse_mm);

/** contour_tape_split() - the last @tab_mm of the outline become the tab.
 *  Return: 0, -ENOMEM, or -ERANGE: the outline is not longer. */
int contour_tape_split(struct contour_tape *t, double tab_mm);

/** contour_tape_length() - the length of motions @first to @end - 1, mm. */
double contour_tape_length(const struct contour_tape *t, uint32_t first,
			   uint32_t end);

/** contour_play() - put motions @first to @end - 1 of @t behind what is
 *  collected.  Return: 0, -ENOMEM, -EINVAL with @diag. */
int contour_play(struct contour *k, const struct contour_tape *t,
		 const uint32_t range[2], const struct contour_pass *p,
		 struct interp_diag *diag);

/** contour_play_step() - change to another offset, on the spot. */
int contour_play_step(struct contour *k, const struct contour_pass *p,
		      struct interp_diag *diag);

#endif /* WIRE_REPLAY_H */
