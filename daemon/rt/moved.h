/* SPDX-License-Identifier: Apache-2.0 */
/*
 * moved.h - how the motion ended that was asked for last
 *
 * A jog, homing, a retract or a step is answered when it begins.  Who asked may
 * want to know whether it came to where it was sent.
 *
 * Threads: RT-safe.
 */
#ifndef RT_MOVED_H
#define RT_MOVED_H

#include <stdbool.h>

enum moved_how {
	MOVED_NOT,			/* nothing was asked for yet */
	MOVED_GOES_ON,
	MOVED_THERE,			/* it came to where it was sent */
	MOVED_SHORT,			/* it was ended, or met something */
	MOVED_FAULT
};

struct moved {
	enum moved_how how;
	bool there;
};

struct cycle;

/** moved_begin() - a motion was asked for, and begins. */
void moved_begin(struct cycle *c);

/** moved_watch() - at the end of a period: is it over, and how? */
void moved_watch(struct cycle *c);

#endif /* RT_MOVED_H */
