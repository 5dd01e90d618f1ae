/* SPDX-License-Identifier: Apache-2.0 */
/*
 * axes.h - the power of the axes
 *
 * The operator's start or retract gives the axes power.  Faults in which the
 * axes may be wrong take it away.  If other axes still follow, they first brake
 * on the path.  The axes may need time until they have power and stand on their
 * places.  Meanwhile the state is hold; afterwards the start goes on by itself.
 *
 * A machine whose axes always have power never says `starting` or `axes_off`.
 * Then none of this happens.
 *
 * Threads: RT-safe.
 */
#ifndef RT_AXES_H
#define RT_AXES_H

#include "io.h"

struct cycle;

struct axes {
	bool starting, off, steers;	/* as the machine says */
	bool awaited;			/* power was asked for and has not come:
					 * nothing may move */
	bool start;			/* start the job when it comes */
	uint64_t waited;		/* cycles */
};

/** axes_guard() - note the troubles of the axes as faults. */
void axes_guard(struct cycle *c, const struct io_inputs *in);

/** axes_faults() - the faults that drives report and a reset may clear. */
uint64_t axes_faults(void);

/**
 * axes_want() - ask for power, for a @start or for a motion while held.
 * Return: true if motion may begin now; false if the power is awaited.
 */
bool axes_want(struct cycle *c, bool start);

/** axes_forget() - stop waiting; axes that have power keep it. */
void axes_forget(struct cycle *c);

enum axes_await { AXES_READY, AXES_START, AXES_AWAITED };

/**
 * axes_await() - may anything move?  To be called once a cycle.
 *
 * Return: AXES_START, once, when the start that waited for the axes is due now.
 */
enum axes_await axes_await(struct cycle *c);

#endif /* RT_AXES_H */
