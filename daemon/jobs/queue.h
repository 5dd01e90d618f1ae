/* SPDX-License-Identifier: Apache-2.0 */
/*
 * queue.h - the job at the machine, and which comes next
 *
 * At most one job is loaded.  Where it stands is read from edmd's snapshot
 * and written to the store, never the other way round, so that this service
 * may be killed at any time and finds its job again.
 *
 *	queued -> ready -> running <-> held -> done, stopped
 *	                      |  ^
 *	                      v  |
 *	                      fault
 *
 * Nothing starts by itself after a fault, a stop, or a new start of edmd: the
 * queue waits for "start".
 *
 * Threads: one, that of the event loop.
 */
#ifndef JOBS_QUEUE_H
#define JOBS_QUEUE_H

#include "shm.h"
#include "store.h"

struct compiler;
struct compiler_request;
struct jobs;

/* Read, do not write. */
struct queue {
	struct store_job job;		/* loaded; n 0: none */
	struct shm_snapshot snap;	/* the last snapshot of that job */
	double depth_mm;		/* greatest depth of that job */
	uint32_t run;			/* ... as in struct checkpoint_job */
	int32_t start_pulses[SHM_NAXES];	/* where its program begins */
	uint32_t behind;		/* jobs that wait, ... */
	uint32_t untold;		/* ... those without a forecast, */
	double behind_s;		/* and what the others will take */
	bool waiting;			/* for "start" */
	uint32_t promised;		/* the job that was started, or 0 */
	/* Private. */
	uint32_t ended;			/* enum shm_outcome, by its event */
	bool loading;			/* LOAD is under way, ... */
	uint64_t load_id;		/* ... of this id */
	bool asked;			/* START or UNLOAD is under way */
	int64_t missing_us;		/* since when edmd does not have it */
	bool anew;			/* edmd is, and never had it */
	uint32_t fault_told;		/* a fault without a job that was
					 * reported */
	int64_t again_us;		/* not before this time: it was
					 * refused */
	struct compiler *compile;	/* the text of `next`, to be loaded */
	struct store_job next;
	char *next_text;
};

/** queue_init() - find the job that was loaded. Startup only. */
int queue_init(struct jobs *j);

/** queue_fini() - leave running jobs alone, take the others back. */
void queue_fini(struct jobs *j);

/** queue_attach() - edmd has come, or has come back. */
void queue_attach(struct jobs *j);

/** queue_event() - take one of edmd's events. */
void queue_event(struct jobs *j, const struct shm_event *e);

/** queue_step() - to be called every 20 ms while edmd is there. */
void queue_step(struct jobs *j, int64_t now_us);

/** queue_recount() - jobs were added or removed. */
void queue_recount(struct jobs *j);

/** queue_go() - "start" was given: the queue does not wait any more. */
void queue_go(struct jobs *j);
/**
 * queue_promise() - the loaded job is about to be started.  Return: 0; -errno:
 * that it begins cannot be stored, so it must not begin.
 */
int queue_promise(struct jobs *j);
/** queue_unpromise() - it was not started after all. */
void queue_unpromise(struct jobs *j);
/** queue_has_begun() - has the loaded job begun, and is that known? */
bool queue_has_begun(const struct jobs *j);
/**
 * queue_started() - edmd has answered a start with @code, one of struct link's.
 */
void queue_started(struct jobs *j, int code);
/**
 * queue_unready() - why no job could begin now, in words; NULL: a job could
 * begin.
 */
const char *queue_unready(const struct jobs *j);
/** queue_wait() - nothing starts until queue_go() is called. */
void queue_wait(struct jobs *j);
/** queue_keep() - if a job would begin next, it waits for a start. */
void queue_keep(struct jobs *j);
/** queue_is_kept() - is there such a job, and does it wait? */
bool queue_is_kept(const struct jobs *j);
/** queue_is_faulted() - is edmd in fault at this moment? */
bool queue_is_faulted(const struct jobs *j);

/** queue_is_leaving() - has the job ended, and is it still to be unloaded? */
bool queue_is_leaving(const struct queue *q);

/** queue_end() - the job is over: record it, tell; ended.c. */
void queue_end(struct jobs *j, enum job_state state, const char *reason);

/** queue_drop() - edmd has no program of ours any more. */
void queue_drop(struct jobs *j, bool again);

/* -- ended.c -------------------------------------------------------------- */

/** queue_totals() - the snapshot of the loaded job, with what was cut of it
 *  before it was interrupted. */
void queue_totals(struct jobs *j, struct shm_snapshot *ret);

/** queue_ended_event() - note that the loaded job has ended, for when edmd does
 *  not have it any more. */
void queue_ended_event(struct queue *q, const struct shm_event *e);

/** queue_record() - the job is over, or in a fault for now: write that. */
void queue_record(struct jobs *j, enum job_state state, const char *reason);

/* -- settle.c ------------------------------------------------------------- */

/** settle_ended() - end the jobs that edmd knows to have ended. */
void settle_ended(struct jobs *j);

/* -- load.c: from the store into edmd ------------------------------------- */

/**
 * load_begin() - compile the first job that waits, if there is one, and load
 * it.
 */
void load_begin(struct jobs *j, int64_t now_us);

/** load_request() - what @job is compiled by, if it is loaded as the machine
 *  stands now; but for a text in the database.  Return: 0 or -errno. */
int load_request(struct jobs *j, const struct store_job *job,
		 struct compiler_request *ret);

/** load_send() - send a command about program @n; its answer ends `asked`. */
int load_send(struct jobs *j, uint32_t verb, uint32_t n, int64_t now_us);

/** load_fini() - forget what is being compiled. */
void load_fini(struct jobs *j);

#endif /* JOBS_QUEUE_H */
