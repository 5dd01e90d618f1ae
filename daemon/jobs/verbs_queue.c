/* SPDX-License-Identifier: Apache-2.0 */
/* verbs_queue.c - verbs that the service answers from its store */
#include "interrupt.h"
#include "store_turn.h"
#include "verb.h"

#include <errno.h>
#include <stdlib.h>
#include <sysexits.h>

void verbs_remove(struct jobs *j, const struct verb *v,
		  const struct jobs_lcm_command *c)
{
	struct store_end e = {
		.state = JOB_STOPPED, .reason = "removed from the queue",
		.now_us = jobs_utime(),
	};
	bool waiting = j->queue.waiting;
	struct store_job job;

	(void)v;
	if (store_find(j->store, c->job, &job) < 0) {
		verbs_answer(j, c, EX_NOINPUT,
			     "no such job; edmctl queue lists them");
	} else if (job.n == j->queue.job.n && job.state == JOB_READY) {
		queue_end(j, JOB_STOPPED, e.reason);
		if (!waiting)
			queue_go(j);
		verbs_answer(j, c, 0, "removed");
	} else if (job.state == JOB_INTERRUPTED) {
		store_give_up(j->store, job.n, "interrupted, then removed",
			      e.now_us);
		interrupt_init(j);
		verbs_answer(j, c, 0, "removed");
	} else if (job.state != JOB_QUEUED || job.loaded) {
		verbs_answer(j, c, REFUSED,
			     "it has begun or ended; stop ends a job "
			     "that runs");
	} else {
		store_end(j->store, job.n, &e);
		queue_recount(j);
		verbs_answer(j, c, 0, "removed");
	}
}

void verbs_move(struct jobs *j, const struct verb *v,
		const struct jobs_lcm_command *c)
{
	struct store_job job;
	int err;

	(void)v;
	if (c->arg != 1 && c->arg != -1) {
		verbs_answer(j, c, EX_DATAERR, "no such way; -1 is ahead, 1 "
			     "is back");
	} else if (store_find(j->store, c->job, &job) < 0) {
		verbs_answer(j, c, EX_NOINPUT,
			     "no such job; edmctl queue lists them");
	} else if (job.state != JOB_QUEUED || job.loaded) {
		verbs_answer(j, c, REFUSED,
			     "only a job that waits in the queue can be moved");
	} else {
		err = store_move(j->store, job.n, c->arg < 0);
		verbs_answer(j, c, err == 0 ? 0 : err == -ENOENT ? REFUSED :
			     EX_IOERR, err == 0 ? "moved" : err == -ENOENT ?
			     "it is at the end of the queue already" :
			     "the store failed");
	}
}

void verbs_text(struct jobs *j, const struct verb *v,
		const struct jobs_lcm_command *c)
{
	struct jobs_lcm_ack a = {
		.key = c->key, .client = c->client, .seq = c->seq,
		.reason = "done",
	};
	struct store_job job;
	char *body = NULL;

	(void)v;
	if (c->arg >= 1 && c->arg <= UINT32_MAX &&
	    store_find(j->store, c->job, &job) == 0)
		body = store_lines(j->store, job.n, (uint32_t)c->arg);
	a.body = body;
	if (!body) {
		a.code = EX_NOINPUT;
		a.reason = "no such line of such a job, or its "
			   "text is longer than 4 MiB; 1 is the first";
	}
	jobs_answer(j, &a);
	free(body);
}

static void answer_list(struct jobs *j, const struct jobs_lcm_command *c,
			enum store_list what)
{
	/* Without a sensible argument, as many rows as fit. */
	const int rows = c->arg > 0 && c->arg < 1000 ? (int)c->arg : 0;
	struct store_job before;
	const bool one = what == STORE_SHOW || what == STORE_TRAIL;
	const bool known = what == STORE_ALARMS || what == STORE_EVENTS ||
			   (!*c->job && !one) ||
			   store_find(j->store, c->job, &before) != -ENOENT;
	char *body = known ? store_json(j->store, what, c->job, rows) : NULL;
	struct jobs_lcm_ack a = {
		.key = c->key, .client = c->client, .seq = c->seq, .body = body,
		.reason = "done",
	};

	if (!known) {
		a.code = EX_NOINPUT;
		a.reason = "no such job; edmctl queue and edmctl history list "
			   "them";
	} else if (!body) {
		a.code = EX_IOERR;
		a.reason = "the store failed";
	}
	jobs_answer(j, &a);
	free(body);
}

void verbs_queue(struct jobs *j, const struct verb *v,
		 const struct jobs_lcm_command *c)
{
	(void)v;
	answer_list(j, c, STORE_QUEUE);
}

void verbs_show(struct jobs *j, const struct verb *v,
		const struct jobs_lcm_command *c)
{
	(void)v;
	answer_list(j, c, STORE_SHOW);
}

void verbs_trail(struct jobs *j, const struct verb *v,
		 const struct jobs_lcm_command *c)
{
	(void)v;
	answer_list(j, c, STORE_TRAIL);
}

void verbs_alarms(struct jobs *j, const struct verb *v,
		  const struct jobs_lcm_command *c)
{
	(void)v;
	answer_list(j, c, STORE_ALARMS);
}

void verbs_events(struct jobs *j, const struct verb *v,
		  const struct jobs_lcm_command *c)
{
	(void)v;
	answer_list(j, c, STORE_EVENTS);
}

void verbs_history(struct jobs *j, const struct verb *v,
		   const struct jobs_lcm_command *c)
{
	(void)v;
	if (c->arg >= 0 && c->arg <= 1000)
		answer_list(j, c, STORE_HISTORY);
	else
		verbs_answer(j, c, EX_DATAERR,
			     "no such number of rows; 0 to 1000, 0 is all that "
			     "are kept");
}
