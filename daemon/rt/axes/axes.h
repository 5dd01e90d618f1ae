/* SPDX-License-Identifier: Apache-2.0 */
/*
 * axes.h - the power of the axes
 *
 * An operator's start or retract gives the axes power.  Faults in which they
 * may be wrong take it away; where all but one axis still follow, they brake on
 * the path first.  The axes may need time until they have power and
 * stand on their places.  Meanwhile the state is hold, and the start goes on by
 * itself afterwards.
 *
 * A machine whose axes always have power never says `starting` or `axes_off`,
 * and none of this happens.
 *
 * Threads: RT-safe.
 */
#ifndef RT_AXES_H
#define RT_AXES_H

#include "io.h"

struct cycle;

struct axes {
	bool starting, off, steers;	/* as the machine says */
	bool awaited;			/* asked for and not there: no motion */
	bool start;			/* start the job once it is there */
	uint64_t waited;		/* cycles */
};

/** axes_guard() - their troubles as faults. */
void axes_guard(struct cycle *c, const struct io_inputs *in);

/** axes_faults() - those that drives report, and may end by a reset. */
uint64_t axes_faults(void);

/**
 * axes_want() - ask for power, for a @start or for a motion while held.
 * Return: true if motion may begin now; false if the power is awaited.
 */
bool axes_want(struct cycle *c, bool start);

/** axes_forget() - wait no more; axes that have power keep it. */
void axes_forget(struct cycle *c);

enum axes_await { AXES_READY, AXES_START, AXES_AWAITED };

/**
 * axes_await() - once a cycle: may anything move?  AXES_START: yes, and the
 * start that waited for them is due now; it is said once.
 */
enum axes_await axes_await(struct cycle *c);

#endif /* RT_AXES_H */
