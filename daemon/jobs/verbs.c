/* SPDX-License-Identifier: Apache-2.0 */
/*
 * verbs.c - what a COMMAND may ask for: one table
 *
 * A verb of the machine goes to edmd and is answered when edmd has answered;
 * the others are answered at once.
 */
#include "jobs.h"

#include "log.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define RETRACT_MAX_MM	10000.0
#define REFUSED		1		/* understood, and the answer is no */

struct verb {
	const char *name;
	void (*run)(struct jobs *j, const struct verb *v,
		    const struct wire_command *c);
	uint32_t machine;		/* enum shm_verb, for verb_machine() */
	const char *wants;		/* the state it wants */
};

/* A command on its way to edmd. */
struct asked {
	struct jobs *jobs;
	char client[WIRE_CLIENT_MAX];
	int64_t seq;
	const struct verb *verb;
};

static void answer(struct jobs *j, const struct wire_command *c, int code,
		   const char *reason)
{
	jobs_answer(j, &(struct wire_ack) {
		.client = c->client, .seq = c->seq, .code = code,
		.reason = reason,
	});
}

static void on_answer(void *arg, int code)
{
	struct asked *a = arg;
	struct jobs *j = a->jobs;
	struct wire_command c = { .client = a->client, .seq = a->seq };
	char reason[160];

	if (code == SHM_DONE)
		answer(j, &c, 0, "done");
	else if (code == -ETIMEDOUT)
		answer(j, &c, EX_UNAVAILABLE, "edmd did not answer in 2 s");
	else if (code < 0)
		answer(j, &c, EX_UNAVAILABLE, "edmd went away");
	else if (code == SHM_NO_PROGRAM)
		answer(j, &c, REFUSED, "no job is loaded; submit one");
	else if (code == SHM_BAD_ARGUMENT)
		answer(j, &c, EX_DATAERR, "edmd refused the value; it must "
		       "be finite and in range");
	else {
		snprintf(reason, sizeof(reason), "not in state %s; %s wants %s",
			 shm_state_name(j->link.snap.state), a->verb->name,
			 a->verb->wants);
		answer(j, &c, REFUSED, reason);
	}
	free(a);
}

static void verb_machine(struct jobs *j, const struct verb *v,
			 const struct wire_command *c)
{
	struct asked *a = calloc(1, sizeof(*a));
	struct link_command m = {
		.verb = v->machine, .arg_mm = c->arg,
		.answer = on_answer, .answer_arg = a,
	};
	int err;

	if (!a) {
		answer(j, c, EX_SOFTWARE, "no memory");
		return;
	}
	a->jobs = j;
	a->seq = c->seq;
	a->verb = v;
	snprintf(a->client, sizeof(a->client), "%s", c->client);
	err = link_send(&j->link, &m, jobs_now_us());
	if (err == 0)
		return;
	free(a);
	if (err == -EAGAIN)
		answer(j, c, EX_TEMPFAIL, "too many commands under way; try "
		       "again");
	else
		answer(j, c, EX_UNAVAILABLE, j->link.state == LINK_ABSENT ?
		       "edmd is not there; systemctl start edmd" :
		       "edmd is lost; systemctl status edmd");
}

static void verb_retract(struct jobs *j, const struct verb *v,
			 const struct wire_command *c)
{
	if (isfinite(c->arg) && c->arg > 0 && c->arg <= RETRACT_MAX_MM)
		verb_machine(j, v, c);
	else
		answer(j, c, EX_DATAERR, "retract by no such length; a number "
		       "of mm above 0, at most 10000");
}

/* A refused start must not set the queue going. */
static bool refused_by_fault(struct jobs *j, const struct wire_command *c)
{
	if (!queue_is_faulted(j))
		return false;
	answer(j, c, REFUSED, "a fault is latched; reset first");
	return true;
}

static void verb_resume(struct jobs *j, const struct verb *v,
			const struct wire_command *c)
{
	if (refused_by_fault(j, c))
		return;
	queue_go(j);
	verb_machine(j, v, c);
}

/* A job that waits: it is started when its turn comes. */
static void start_behind(struct jobs *j, const struct wire_command *c,
			 const struct store_job *job)
{
	if (job->state != JOB_QUEUED) {
		answer(j, c, REFUSED, "this job has ended; submit it again");
		return;
	}
	queue_go(j);
	store_set_hold(j->store, job->n, false);
	answer(j, c, 0, "starts when its turn comes");
}

static void verb_start(struct jobs *j, const struct verb *v,
		       const struct wire_command *c)
{
	struct queue *q = &j->queue;
	bool here = q->job.n && !queue_is_leaving(q);
	struct store_job job;

	if (refused_by_fault(j, c))
		return;
	if (*c->job && store_find(j->store, c->job, &job) < 0) {
		answer(j, c, EX_NOINPUT, "no such job; edmctl queue lists "
		       "them");
	} else if (*c->job && (!here || job.n != q->job.n)) {
		start_behind(j, c, &job);
	} else if (here) {
		queue_go(j);
		q->job.hold = false;
		store_set_hold(j->store, q->job.n, false);
		verb_machine(j, v, c);
	} else if (store_head(j->store, &job) == 0) {
		start_behind(j, c, &job);
	} else {
		answer(j, c, REFUSED, "no job in the queue; submit one");
	}
}

static void verb_remove(struct jobs *j, const struct verb *v,
			const struct wire_command *c)
{
	struct store_end e = {
		.state = JOB_STOPPED, .reason = "removed from the queue",
		.now_us = jobs_utime(),
	};
	bool waiting = j->queue.waiting;
	struct store_job job;

	(void)v;
	if (store_find(j->store, c->job, &job) < 0) {
		answer(j, c, EX_NOINPUT, "no such job; edmctl queue lists "
		       "them");
	} else if (job.n == j->queue.job.n && job.state == JOB_READY) {
		queue_end(j, JOB_STOPPED, e.reason);
		if (!waiting)
			queue_go(j);
		answer(j, c, 0, "removed");
	} else if (job.state != JOB_QUEUED || job.loaded) {
		answer(j, c, REFUSED, "it has begun or ended; stop ends a job "
		       "that runs");
	} else {
		store_end(j->store, job.n, &e);
		queue_recount(j);
		answer(j, c, 0, "removed");
	}
}

static void answer_list(struct jobs *j, const struct wire_command *c,
			enum store_list what)
{
	char *body = store_json(j->store, what, c->job, (int)c->arg);
	struct wire_ack a = {
		.client = c->client, .seq = c->seq, .body = body,
		.reason = "done",
	};

	if (!body) {
		a.code = what == STORE_SHOW ? EX_NOINPUT : EX_IOERR;
		a.reason = what == STORE_SHOW ?
			   "no such job; edmctl queue and edmctl history list "
			   "them" : "the store failed";
	}
	jobs_answer(j, &a);
	free(body);
}

static void verb_queue(struct jobs *j, const struct verb *v,
		       const struct wire_command *c)
{
	(void)v;
	answer_list(j, c, STORE_QUEUE);
}

static void verb_show(struct jobs *j, const struct verb *v,
		      const struct wire_command *c)
{
	(void)v;
	answer_list(j, c, STORE_SHOW);
}

static void verb_history(struct jobs *j, const struct verb *v,
			 const struct wire_command *c)
{
	(void)v;
	if (c->arg >= 0 && c->arg <= 1000)
		answer_list(j, c, STORE_HISTORY);
	else
		answer(j, c, EX_DATAERR, "no such number of rows; 0 to 1000, "
		       "0 is all that are kept");
}

/* clang-format off */
static const struct verb verbs[] = {
	{ "start",   verb_start,   SHM_DO_START,   "a job that is ready or "
						   "held" },
	{ "hold",    verb_machine, SHM_DO_HOLD,    "a job that runs" },
	{ "resume",  verb_resume,  SHM_DO_RESUME,  "a job that is held" },
	{ "stop",    verb_machine, SHM_DO_STOP,    "a job, and no fault; reset "
						   "first" },
	{ "retract", verb_retract, SHM_DO_RETRACT, "a job, and no fault; reset "
						   "first" },
	{ "estop",   verb_machine, SHM_DO_ESTOP,   "nothing" },
	{ "reset",   verb_machine, SHM_DO_RESET,   "a fault" },
	{ "remove",  verb_remove,  0, "" },
	{ "queue",   verb_queue,   0, "" },
	{ "show",    verb_show,    0, "" },
	{ "history", verb_history, 0, "" },
};
/* clang-format on */

#define NVERBS	(sizeof(verbs) / sizeof(verbs[0]))

static void refuse_verb(struct jobs *j, const struct wire_command *c)
{
	char reason[256];
	size_t n = (size_t)snprintf(reason, sizeof(reason),
				    "no such verb; one of");

	for (size_t i = 0; i < NVERBS; i++)
		n += (size_t)snprintf(reason + n, sizeof(reason) - n, " %s",
				      verbs[i].name);
	answer(j, c, EX_USAGE, reason);
}

/* Answered before, or under way: not done again. */
static bool is_repeat(struct jobs *j, const struct wire_command *c)
{
	const struct reply *r = reply_find(&j->replies, c->client, c->seq);

	if (r && r->done)
		wire_ack(j->wire, &(struct wire_ack) {
			.client = c->client, .seq = c->seq, .code = r->code,
			.reason = r->reason, .body = r->body,
		});
	return r != NULL;
}

void verb_take(void *arg, const struct wire_command *c)
{
	struct jobs *j = arg;
	size_t n = strlen(c->client);

	/* A client without a name could not be told from another. */
	if (n == 0 || n >= WIRE_CLIENT_MAX) {
		answer(j, c, EX_PROTOCOL, "client name of no or too many "
		       "bytes; 1 to 63");
		return;
	}
	if (is_repeat(j, c))
		return;
	reply_expect(&j->replies, c->client, c->seq);
	for (size_t i = 0; i < NVERBS; i++) {
		if (strcmp(verbs[i].name, c->verb) == 0) {
			verbs[i].run(j, &verbs[i], c);
			return;
		}
	}
	refuse_verb(j, c);
}
