/* SPDX-License-Identifier: Apache-2.0 */
/*
 * forecaster.h - the job in the machine is run in virtual time, in a thread of
 * its own
 *
 * It begins when the job is loaded, and takes as long as the processor needs
 * for the periods of the job: a second for some ten minutes of machine time.
 * Until it is done there is no estimate.  When another job is loaded, or this
 * service ends, it gives up.
 *
 * Threads: one, that of the event loop, which also gets the result.
 */
#ifndef JOBS_FORECASTER_H
#define JOBS_FORECASTER_H

#include <stdint.h>

struct forecasting;
struct jobs;

/* Private; all 0 at first. */
struct forecaster {
	struct forecasting *now;	/* NULL: none is under way */
	uint32_t of;			/* the job that was run last, or is */
	char electrode[64], work[64];	/* materials of that job; "" */
};

/** forecaster_step() - to be called every 20 ms, after the queue was looked
 *  at: begin, give up, and follow the job. */
void forecaster_step(struct jobs *j);

/** forecaster_learn() - the job in the machine is over: the next one of its
 *  conditions and materials will be forecast by what it took. */
void forecaster_learn(struct jobs *j);

void forecaster_fini(struct jobs *j);

#endif /* JOBS_FORECASTER_H */
