/* SPDX-License-Identifier: Apache-2.0 */
/* waits.c - what a job waits for, and what ends the waiting */
#include "waits.h"

#include "faults.h"
#include "interrupt.h"
#include "verb.h"

#include <errno.h>
#include <jansson.h>
#include <stdio.h>
#include <sysexits.h>

/* What keeps every job from beginning; NULL: nothing does. */
static const char *why_none(const struct jobs *j)
{
	if (j->link.state == LINK_ABSENT)
		return "edmd is not there; systemctl start edmd, then edmctl "
		       "start";
	if (j->link.state != LINK_OK)
		return "edmd is lost: its cycle stands still; systemctl status "
		       "edmd says why";
	if (j->link.snap.state == SHM_FAULT)
		return "a fault is latched; edmctl alarms says what clears it; "
		       "edmctl reset, then edmctl start";
	if (*store_why(j->store))
		return "the store cannot write; edmctl doctor says why; it "
		       "goes on when there is room";
	if (*j->interrupted)
		return "a job was interrupted, and its work may still be "
		       "there; edmctl resume JOB or edmctl remove JOB, then "
		       "edmctl start";
	if (j->config->require_home && j->link.snap.unhomed)
		return "an axis is not homed; edmctl home, then edmctl start";
	if (j->link.snap.unplaced)
		return "a drive has lost its place; edmctl home, then edmctl "
		       "start";
	if (*j->electrode.why)
		return j->electrode.why;
	if (j->link.snap.state == SHM_JOG || j->link.snap.state == SHM_HOME)
		return "an axis is being moved by command; it begins when that "
		       "has ended";
	return NULL;
}

/* The job in the machine. */
static const char *why_loaded(struct jobs *j)
{
	switch (j->queue.job.state) {
	case JOB_READY:
		if (j->unseen)
			return interrupt_unseen(j);
		return j->queue.job.hold || j->queue.waiting ?
		       "it is ready; edmctl start begins it" : "";
	case JOB_HELD:
	case JOB_RUNNING:
		return asks_text(j);
	case JOB_FAULT:
		return "a fault is latched; edmctl alarms says what clears it";
	default:
		return "";
	}
}

static const char *does(enum job_state state)
{
	return state == JOB_READY ? "is ready; edmctl start begins it" :
	       state == JOB_HELD ? "is held; edmctl start goes on with it, "
				   "edmctl stop ends it" :
	       state == JOB_FAULT ? "has a fault; edmctl alarms says what "
				    "clears it" :
	       "is being done; it begins when that one has ended";
}

static bool is_waited_for(const struct queue *q, const struct store_job *job)
{
	return q->job.n && q->job.n != job->n && !queue_is_leaving(q);
}

const char *waits_why(struct jobs *j, const struct store_job *job,
		      char *to, size_t size)
{
	const struct queue *q = &j->queue;
	const char *all = why_none(j);

	*to = '\0';
	if (job->state == JOB_INTERRUPTED)
		snprintf(to, size, "it was interrupted; edmctl resume %s goes "
			 "on with it, edmctl remove %s gives it up", job->id,
			 job->id);
	else if (all)
		snprintf(to, size, "%s", all);
	else if (q->job.n == job->n)
		snprintf(to, size, "%s", why_loaded(j));
	else if (is_waited_for(q, job))
		snprintf(to, size, "job %s, %s, is before it and %s",
			 q->job.id, q->job.name, does(q->job.state));
	else if (j->unseen)
		snprintf(to, size, "%s", interrupt_unseen(j));
	else if (q->waiting)
		snprintf(to, size, "the queue waits, because a job ended early "
			 "or edmd was started anew; edmctl start");
	return to;
}

/* The job that is asked about; else the one in the machine, or the next. */
static int find(struct jobs *j, const struct jobs_lcm_command *c,
		struct store_job *ret)
{
	if (*c->job)
		return store_find(j->store, c->job, ret);
	if (j->queue.job.n && !queue_is_leaving(&j->queue)) {
		*ret = j->queue.job;
		return 0;
	}
	return store_head(j->store, ret);
}

void verbs_why(struct jobs *j, const struct verb *v,
	       const struct jobs_lcm_command *c)
{
	struct store_job job;
	const int err = find(j, c, &job);
	char why[400] = "";

	(void)v;
	if (err < 0 && *c->job) {
		verbs_answer(j, c, EX_NOINPUT,
			     "no such job; edmctl queue lists them");
		return;
	}
	if (err == 0)
		waits_why(j, &job, why, sizeof(why));
	verbs_answer_json(j, c, json_pack("{s:s,s:s,s:I}", "job",
					  err == 0 ? job.id : "", "why", why,
					  "stand",
					  (json_int_t)j->link.snap.stand_n));
}
