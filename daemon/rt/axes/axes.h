/* SPDX-License-Identifier: Apache-2.0 */
/*
 * axes.h - the power of the axes
 *
 * The operator's start or retract gives the axes power.  Faults in which the
 * axes may be wrong take it away.  If other axes still follow, they first brake
 * on the path.  The axes may need time until they have power, and then they may
 * stand beside the path (path/resync.h).  Meanwhile the state is hold;
 * afterwards what was asked for is done.
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

enum axes_phase {
	AXES_FREE,			/* nothing is asked for */
	AXES_SEARCH,			/* for the way back to the path */
	AXES_POWER,			/* asked for, and has not come */
	AXES_BACK,			/* on the way back to the path */
};

typedef void axes_then_fn(struct cycle *c, double arg_mm);

struct axes {
	bool starting, off, steers, powerless;	/* as the machine says */
	enum axes_phase phase;
	axes_then_fn *then;		/* what was asked for; NULL: the state
					 * says it */
	double then_mm;
	uint64_t waited;		/* cycles */
};

/** axes_awaits() - is power asked for, so that nothing may move yet? */
static inline bool axes_awaits(const struct axes *a)
{
	return a->phase == AXES_SEARCH || a->phase == AXES_POWER;
}

/** axes_guard() - note the troubles of the axes as faults. */
void axes_guard(struct cycle *c, const struct io_inputs *in);

/** axes_faults() - the faults that drives report and a reset may clear. */
uint64_t axes_faults(void);

/**
 * axes_want() - do @then when the axes have power and stand on the path; now,
 * if they do.  @then may be NULL.
 */
void axes_want(struct cycle *c, axes_then_fn *then, double arg_mm);

/** axes_forget() - stop waiting; axes that have power keep it. */
void axes_forget(struct cycle *c);

/** axes_await() - may anything move?  To be called once a cycle. */
bool axes_await(struct cycle *c);

#endif /* RT_AXES_H */
