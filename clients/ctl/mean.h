/* SPDX-License-Identifier: Apache-2.0 */
/*
 * mean.h - the mean of a value over the last second
 *
 * Feed and gap change from one STATUS to the next: jumps, retracts, sparks.  A
 * person can read the mean of a second.
 *
 * Threads: one.
 */
#ifndef CTL_MEAN_H
#define CTL_MEAN_H

#define MEAN_ROOM	64		/* STATUS comes ten times a second, and
					 * at changes */

struct mean {
	double at_s[MEAN_ROOM], value[MEAN_ROOM];
	int n;				/* all that came; the last MEAN_ROOM are
					 * kept */
};

/** mean_add() - @value holds from @now_s, monotonic, until the next one. */
void mean_add(struct mean *m, double now_s, double value);

/** mean_now() - over the second before @now_s; 0 if nothing came yet. */
double mean_now(const struct mean *m, double now_s);

#endif /* CTL_MEAN_H */
