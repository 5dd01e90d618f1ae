/* SPDX-License-Identifier: Apache-2.0 */
/*
 * axes.h - axes under power
 *
 * An operator's start or retract puts them under power; faults in which they
 * are not good take it from them.  They may take their time to be on their
 * places: the state is hold as long, then the start goes on by itself.
 *
 * A machine whose axes always have power never says starting or axes_off, and
 * none of this is seen.
 *
 * Threads: RT-safe.
 */
#ifndef RT_AXES_H
#define RT_AXES_H

#include "io.h"

struct cycle;

struct axes {
	bool starting, off;		/* as the machine says */
	bool awaited;			/* power was asked for; no motion yet */
	bool start;			/* ... and then start */
	uint64_t waited;		/* cycles */
};

/** axes_guard() - their troubles as faults. */
void axes_guard(struct cycle *c, const struct io_inputs *in);

/** axes_faults() - those that drives report, and may end by a reset. */
uint64_t axes_faults(void);

/**
 * axes_want() - power, for a @start or for a motion while held.
 * Return: true if motion may begin now; false: it is awaited.
 */
bool axes_want(struct cycle *c, bool start);

/** axes_forget() - nothing is awaited any more; what has power keeps it. */
void axes_forget(struct cycle *c);

enum axes_await { AXES_READY, AXES_START, AXES_AWAITED };

/**
 * axes_await() - a cycle: may there be motion?  AXES_START: yes, and the start
 * they were awaited for is due; said once.
 */
enum axes_await axes_await(struct cycle *c);

#endif /* RT_AXES_H */
