/* SPDX-License-Identifier: Apache-2.0 */
/*
 * screen.h - what `edmctl watch` shows on a whole terminal
 *
 * State and why, places, the job, the gap in its window, the last minutes.
 * Made for 80x24; a smaller terminal shows the upper part of it.
 *
 * Threads: one.
 */
#ifndef CTL_SCREEN_H
#define CTL_SCREEN_H

#include "ctl.h"
#include "mean.h"

#define SCREEN_SECONDS	512

/* What is drawn. */
struct screen {
	struct ctl *ctl;
	struct mean gap, feed;
	float gap_v[SCREEN_SECONDS];	/* a mean for each second ... */
	float feed_mm_min[SCREEN_SECONDS];
	int seconds;			/* ... of so many, the last kept */
	double second_s;		/* when the last was added */
	/* What was asked. */
	double asked_s;
	int turn;
	double low_v, high_v, open_v;	/* the window; open_v 0: not known */
	char why[400];			/* why the job waits; "": it does not */
};

/**
 * screen_can() - is stdout a terminal that can be drawn on?  Not TERM=dumb, a
 * pipe, or fewer than 20 columns.
 */
bool screen_can(void);

/**
 * screen_watch() - draw until q or a signal.
 * Return: 0; -ETIMEDOUT: no STATUS comes any more; -ENOTTY: this terminal
 * cannot be drawn on.
 */
int screen_watch(struct ctl *c);

/* -- screen_draw.c -------------------------------------------------------- */

/** screen_draw() - the whole of it, with curses; the last line is the keys. */
void screen_draw(const struct screen *s, const struct talk_status *t);

#endif /* CTL_SCREEN_H */
