/* SPDX-License-Identifier: Apache-2.0 */
/*
 * forecaster.h - jobs are run in virtual time, one after the other, in a thread
 * of its own
 *
 * The job in the machine goes first, and begins when it is loaded.  Those that
 * wait follow in their order; each is compiled for it, as the machine stands,
 * and what it will take is kept in the store.  One takes as long as the
 * processor needs for the periods of the job: a second for some ten minutes of
 * machine time.  Until it is done there is no estimate.  For a job that is
 * loaded, or if this service ends, it gives up.
 *
 * One that takes longer than FORECASTER_FIRST_S of machine time is put off,
 * also the one in the machine: those that have none yet come first.
 *
 * Threads: one, that of the event loop, which also gets the result.
 */
#ifndef JOBS_FORECASTER_H
#define JOBS_FORECASTER_H

#include <stdint.h>

#include "store.h"

#define FORECASTER_FIRST_S	20000.0

struct compiler;
struct forecasting;
struct jobs;

/* Private; all 0 at first. */
struct forecaster {
	struct forecasting *now;	/* NULL: none is under way */
	uint32_t of;			/* the job in the machine that was run
					 * last, or is */
	bool put_off;			/* ... and takes long */
	bool looks;			/* there may be jobs that wait and have
					 * no forecast */
	bool looks_later;		/* ... or were put off */
	double most_s;			/* of the next one */
	struct compiler *compile;	/* of one of these; NULL: none */
	struct store_job next;		/* that one ... */
	char *text;			/* ... and its text, if it is short */
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
