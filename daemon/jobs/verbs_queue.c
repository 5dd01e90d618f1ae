/* SPDX-License-Identifier: Apache-2.0 */
/* verbs_queue.c - verbs that the service answers from its store */
#include "act.h"
#include "interrupt.h"
#include "store_trust.h"
#include "store_turn.h"
#include "verb.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define ALARMS		20		/* if nobody says how many */
#define MOVE_ALL	2.0		/* - or +: before or behind all */

/* On a disk that takes nothing a job is removed from memory only. */
static void answer_removed(struct jobs *j, const struct jobs_lcm_command *c)
{
	char reason[240] = "removed";

	act_answered(j, c->act, 0, reason);
	if (*store_why(j->store)) {
		snprintf(reason, sizeof(reason), "removed in memory only: %s; "
			 "if the power goes or edmd-jobs ends before that is "
			 "mended, the job is there again",
			 store_why(j->store));
		store_act_end(j->store, c->act, 0, reason);
	}
	jobs_answer(j, &(struct jobs_lcm_ack) {
		.key = c->key, .client = c->client, .seq = c->seq,
		.reason = reason,
	});
}

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
		answer_removed(j, c);
	} else if (job.state == JOB_INTERRUPTED) {
		store_give_up(j->store, job.n, "interrupted, then removed",
			      e.now_us);
		interrupt_init(j);
		answer_removed(j, c);
	} else if (job.state == JOB_QUEUED && job.loaded) {
		verbs_answer(j, c, REFUSED,
			     "it is just being loaded; try again when it is "
			     "ready");
	} else if (job.state != JOB_QUEUED) {
		verbs_answer(j, c, REFUSED,
			     "it has begun or ended; stop ends a job "
			     "that runs");
	} else {
		store_end(j->store, job.n, &e);
		queue_recount(j);
		answer_removed(j, c);
	}
}

void verbs_move(struct jobs *j, const struct verb *v,
		const struct jobs_lcm_command *c)
{
	struct store_job job;
	int err;

	(void)v;
	if (fabs(c->arg) != 1 && fabs(c->arg) != MOVE_ALL) {
		verbs_answer(j, c, EX_DATAERR, "no such way; -1 is ahead, 1 "
			     "is back, -2 before and 2 behind all that wait");
	} else if (store_find(j->store, c->job, &job) < 0) {
		verbs_answer(j, c, EX_NOINPUT,
			     "no such job; edmctl queue lists them");
	} else if (job.state != JOB_QUEUED || job.loaded) {
		verbs_answer(j, c, REFUSED,
			     "only a job that waits in the queue can be moved");
	} else {
		err = fabs(c->arg) == MOVE_ALL ?
		      store_move_all(j->store, job.n, c->arg < 0) :
		      store_move(j->store, job.n, c->arg < 0);
		verbs_answer(j, c, err == 0 ? 0 : err == -ENOENT ? REFUSED :
			     EX_IOERR, err == 0 ? "moved" : err != -ENOENT ?
			     "the store failed" : c->arg < 0 ?
			     "it is the first that waits already" :
			     "it is the last that waits already");
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
		a.reason = "no such line of such a job; 1 is the first";
	}
	jobs_answer(j, &a);
	free(body);
}

/*
 * The store has the sums of a job from its end on, or from its last fault.  Of
 * the job in the machine they are those of this moment.  Return: @body, or a
 * new one in its place.
 */
static char *body_now(struct jobs *j, const char *id, char *body)
{
	const struct queue *q = &j->queue;
	struct shm_snapshot s;
	double period_s;
	json_t *now, *o;

	if (!body || !q->job.n || strcmp(id, q->job.id) != 0 ||
	    queue_is_leaving(q) || q->job.state == JOB_FAULT ||
	    q->snap.program != q->job.n)
		return body;
	queue_totals(j, &s);
	period_s = (double)s.period_ns / 1e9;
	o = json_loads(body, 0, NULL);
	now = json_pack("{s:s,s:i,s:f,s:f,s:f,s:f,s:f,s:I,s:I,s:I,s:I}",
			"reason", "", "ended_us", 0, "path_mm", s.far_mm,
			"length_mm", s.length_mm, "depth_mm", q->depth_mm,
			"job_s", (double)s.job_cycles * period_s,
			"erode_s", (double)s.erode_cycles * period_s,
			"jumps", (json_int_t)s.jumps,
			"retracts", (json_int_t)s.retracts,
			"shorts", (json_int_t)s.shorts,
			"arcs", (json_int_t)s.arcs);
	if (o && now && json_object_update(o, now) == 0) {
		free(body);
		body = json_dumps(o, JSON_COMPACT | JSON_REAL_PRECISION(15));
	}
	json_decref(now);
	json_decref(o);
	return body;
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
	char *body = !known ? NULL : one ?
		     store_json(j->store, what, c->job, rows) :
		     store_look(j->store, &(struct store_asked) {
			what, c->job, c->text, rows });
	struct jobs_lcm_ack a = {
		.key = c->key, .client = c->client, .seq = c->seq,
		.reason = "done",
	};

	calls_write(j);
	if (what == STORE_SHOW)
		body = body_now(j, c->job, body);
	a.body = body;
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
	struct jobs_lcm_command some = *c;

	(void)v;
	if (!(some.arg > 0))
		some.arg = ALARMS;
	answer_list(j, &some, STORE_ALARMS);
}

void verbs_events(struct jobs *j, const struct verb *v,
		  const struct jobs_lcm_command *c)
{
	(void)v;
	answer_list(j, c, STORE_EVENTS);
}

void verbs_totals(struct jobs *j, const struct verb *v,
		  const struct jobs_lcm_command *c)
{
	struct jobs_lcm_command all = *c;

	(void)v;
	all.arg = 0;
	all.job = "";
	answer_list(j, &all, c->arg > 0 ? STORE_MONTHS : STORE_DAYS);
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
