/* SPDX-License-Identifier: Apache-2.0 */
/*
 * settle.c - jobs that edmd knows to have ended, and the store does not
 *
 * If a service cannot write to the disk and is killed, the store has jobs as
 * queued, ready or running that ended long ago.  edmd remembers the last of
 * them by number and text.
 */
#include "jobs.h"

#include "jobs_log.h"

#include <sodium.h>
#include <string.h>

static bool is_over(const struct store_job *job)
{
	return job->state == JOB_DONE || job->state == JOB_STOPPED;
}

/* A job that was unloaded before it began still has to be cut.  So does one
 * with the same number and text that was sent later, to a new store. */
static bool is_of(const struct shm_ended *e, const struct store_job *job)
{
	char hex[65];

	sodium_bin2hex(hex, sizeof(hex), e->hash, sizeof(e->hash));
	return strcmp(hex, job->sha256) == 0 &&
	       e->time_ns / 1000 > job->submitted_us &&
	       (e->outcome == SHM_OUTCOME_DONE || e->job_cycles > 0);
}

/* What it felt for is gone from edmd with it. */
static const char *why_ended(const struct shm_ended *e, uint32_t measures)
{
	return e->outcome == SHM_OUTCOME_DONE ? measures ?
	       "what it found was not written down; touch off once more" : "" :
	       e->outcome == SHM_OUTCOME_FAULT ? "after a fault" :
	       "by command";
}

static void record(struct jobs *j, const struct store_job *job,
		   enum job_state state, const struct shm_ended *e)
{
	const double period_s = (double)e->period_ns / 1e9;

	store_end(j->store, job->n, &(struct store_end) {
		.state = state, .reason = why_ended(e, job->measures),
		.now_us = e->time_ns / 1000, .place_mm = e->far_mm,
		.length_mm = e->length_mm, .depth_mm = e->depth_mm,
		.job_s = (double)e->job_cycles * period_s,
		.jumps = e->jumps, .retracts = e->retracts,
		.shorts = e->shorts, .arcs = e->arcs,
		.erode_s = (double)e->erode_cycles * period_s,
		.energy_j = e->energy_j,
	});
	tally_settle(j, job->n, e);
	electrode_settle(j, job->n, e);
	store_set_loaded(j->store, job->n, false);
}

static void settle_one(void *arg, const struct shm_ended *e)
{
	struct jobs *j = arg;
	const enum job_state state = e->outcome == SHM_OUTCOME_DONE ?
				     JOB_DONE : JOB_STOPPED;
	struct store_job job;
	const char *why;

	/* The program that is in edmd now is followed by its snapshot. */
	if (e->program == j->link.snap.program ||
	    store_find_number(j->store, e->program, &job) < 0 ||
	    is_over(&job) || !is_of(e, &job))
		return;
	log_notice("queue: edmd says that job %s, which is %s in the store, "
		   "has ended", job.id, store_state_name(job.state));
	why = why_ended(e, job.measures);
	jobs_with_note(j);
	record(j, &job, state, e);
	/* Who told it before could not store that it did. */
	jobs_note(j, &(struct jobs_note) {
		.kind = "ended", .job = job.id, .place_mm = e->far_mm,
		.outcome = store_state_name(state),
	}, "job %s %s%s%s", job.name, store_state_name(state),
		  *why ? ": " : "", why);
	if (j->queue.job.n == job.n) {
		j->queue.job.state = state;
		queue_drop(j, false);
	}
	queue_recount(j);
}

void settle_ended(struct jobs *j)
{
	link_ended(&j->link, settle_one, j);
}
