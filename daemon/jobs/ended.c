/* SPDX-License-Identifier: Apache-2.0 */
/* ended.c - a job is over: what is written of it, and told */
#include "inside.h"
#include "jobs.h"
#include "offset.h"

/*
 * A service that has come reads all of edmd's events again.  A job that was put
 * back has the end of an earlier loading among them: it was unloaded, and did
 * not end.  That lies in front of the event of its last loading, and in front
 * of edmd's answer to a loading that is under way.
 */
void queue_ended_event(struct queue *q, const struct shm_event *e)
{
	if (!q->job.n || q->loading)
		return;
	if (e->kind == SHM_EV_LOADED && (uint32_t)e->code == q->job.n)
		q->ended = SHM_OUTCOME_NONE;
	if (e->kind != SHM_EV_ENDED || e->program != q->job.n)
		return;
	if (e->code == SHM_OUTCOME_DONE || e->code == SHM_OUTCOME_STOPPED)
		q->ended = (uint32_t)e->code;
}

void queue_totals(struct jobs *j, struct shm_snapshot *ret)
{
	static struct inside a;

	*ret = j->queue.snap;
	if (inside_read(j, j->queue.job.n, &a) == 0)
		inside_whole(&a, ret);
}

/* With its totals, as far as they are known. */
void queue_record(struct jobs *j, enum job_state state, const char *reason)
{
	struct shm_snapshot whole = j->queue.snap;
	const struct shm_snapshot *s = &whole;
	const double period_s = (double)s->period_ns / 1e9;

	/* Of an interrupted one interrupt.c has put them together. */
	if (state != JOB_INTERRUPTED)
		queue_totals(j, &whole);
	tally_end(j, s, state != JOB_INTERRUPTED);
	j->queue.job.state = state;
	store_end(j->store, j->queue.job.n, &(struct store_end) {
		.state = state,
		.reason = reason,
		.now_us = jobs_utime(),
		.place_mm = s->far_mm,
		.length_mm = s->length_mm,
		.depth_mm = j->queue.depth_mm,
		.job_s = (double)s->job_cycles * period_s,
		.erode_s = (double)s->erode_cycles * period_s,
		.energy_j = s->energy_j,
		.jumps = s->jumps,
		.retracts = s->retracts,
		.shorts = s->shorts,
		.arcs = s->arcs,
	});
}

void queue_end(struct jobs *j, enum job_state state, const char *reason)
{
	struct queue *q = &j->queue;

	/* What interrupted it has booked it: interrupt.c. */
	if (state != JOB_INTERRUPTED)
		electrode_book(j);
	if (state == JOB_DONE)
		reason = offset_touched(j);
	jobs_with_note(j);
	queue_record(j, state, reason);
	forecaster_learn(j);
	queue_recount(j);
	q->ended = SHM_OUTCOME_NONE;
	jobs_note(j, &(struct jobs_note) {
		.kind = state == JOB_INTERRUPTED ? "interrupted" : "ended",
		.job = q->job.id,
		.outcome = store_state_name(state),
		.place_mm = q->snap.place_mm,
	}, "job %s %s%s%s", q->job.name, store_state_name(state),
		  *reason ? ": " : "", reason);
	electrode_tell(j);
	if (state == JOB_DONE)
		return;
	if (q->behind > 0)
		queue_wait(j);
	else
		queue_go(j);
}
