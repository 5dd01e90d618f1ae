/* SPDX-License-Identifier: Apache-2.0 */
/* load.c - takes a job from the store and loads it into edmd */
#include "jobs.h"

#include "inside.h"
#include "compiler.h"
#include "faults.h"
#include "jobs_log.h"
#include "offset.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define AGAIN_US	1000000
#define DAMAGED		"its text in the store is not the one that was sent: " \
			"the disk damaged it; send it again"

static const char *answer_text(int code)
{
	switch (code) {
	case SHM_DONE:
		return "done";
	case SHM_NO_PROGRAM:
		return "it has no such program";
	case SHM_WRONG_STATE:
		return "not in its present state";
	case SHM_BAD_ARGUMENT:
		return "a segment failed its check";
	case SHM_NOT_HOMED:
		return "an axis is not homed; home it, when the job is stopped";
	case SHM_AT_LIMIT:
		return "an axis is on its limit switch";
	case SHM_ELSEWHERE:
		return "the axes moved since it was compiled";
	case SHM_NOT_UP:
		return "its drives are not up yet";
	case SHM_PLC_HOLDS:
		return "the PLC holds";
	case -ETIMEDOUT:
	case SHM_LATE:
		return "it did not take it in time";
	case SHM_TAKEN:
		return "no answer";
	default:
		return code > SHM_SEEN && code < SHM_SEEN + CYCLE_NFAULTS ?
		       fault_table[code - SHM_SEEN].what : "it went away";
	}
}

static void on_asked(void *arg, int code)
{
	struct jobs *j = arg;

	j->queue.asked = false;
	if (code == SHM_DONE)
		j->queue.again_us = 0;
	if (code != SHM_DONE && code != -ENOTCONN && code != -ESHUTDOWN) {
		j->queue.again_us = jobs_now_us() + AGAIN_US;
		log_warning("load: edmd refused to unload program %u: %s",
			    j->queue.job.n, answer_text(code));
	}
}

/* A start is one act: if it is refused, the job waits for the next start. */
static void on_started(void *arg, int code)
{
	struct jobs *j = arg;

	j->queue.asked = false;
	if (code == -ESHUTDOWN)
		return;
	queue_started(j, code);
	if (code == SHM_DONE || !j->queue.job.n)
		return;
	queue_wait(j);
	jobs_note(j, &(struct jobs_note) {
		.kind = "waits", .job = j->queue.job.id,
	}, "job %s did not start: %s; it waits for start", j->queue.job.name,
		  answer_text(code));
}

int load_send(struct jobs *j, uint32_t verb, uint32_t n, int64_t now_us)
{
	struct link_command c = {
		.verb = verb, .arg = n, .answer_arg = j,
		.answer = verb == SHM_DO_START ? on_started : on_asked,
	};
	int err = link_send(&j->link, &c, now_us);

	j->queue.asked = err == 0;
	return err;
}

/* The job did not reach edmd. */
static void load_refuse(struct jobs *j, struct store_job job,
			const char *reason)
{
	static struct inside a;

	j->queue.job = job;
	j->queue.snap = (struct shm_snapshot) { .program = 0 };
	j->queue.depth_mm = 0;
	/* What was cut of an interrupted job is not thrown away. */
	if (inside_read(j, job.n, &a) == 0 && !inside_is_named(&a))
		inside_refuse(j, &job, reason);
	else
		queue_end(j, JOB_FAULT, reason);
	queue_drop(j, false);
}

static void on_loaded(void *arg, int code)
{
	struct jobs *j = arg;
	char reason[128];

	/* A large program takes its time. */
	if (code == SHM_TAKEN && j->link.state == LINK_OK &&
	    link_await(&j->link, &(struct link_command) {
			.id = j->queue.load_id, .answer = on_loaded,
			.answer_arg = j }, jobs_now_us()) == 0)
		return;
	j->queue.loading = false;
	if (code == SHM_DONE || code == -ESHUTDOWN || !j->queue.job.n)
		return;
	snprintf(reason, sizeof(reason), "edmd did not load it: %s",
		 answer_text(code));
	log_warning("load: job %s: %s", j->queue.job.id, reason);
	if (code < 0 || code == SHM_WRONG_STATE ||
	    code == SHM_LATE || code == SHM_CUT_SHORT ||
	    code == SHM_ELSEWHERE) {
		j->queue.again_us = jobs_now_us() + AGAIN_US;
		queue_drop(j, true);
	} else {
		load_refuse(j, j->queue.job, reason);
	}
}

static int load_name(struct jobs *j, const struct compiler_result *r)
{
	const uint32_t n = j->queue.job.n;
	int err;

	/* This is written before the object has its name, so that a service
	 * that is started after a kill finds the object and removes it. */
	if (store_set_loaded(j->store, n, true) != 0)
		return -EAGAIN;
	err = shm_program_name(r->block, j->machine, n);
	shm_program_remove(j->machine, SHM_PROGRAM_AHEAD);
	return err;
}

/* Does it wait for an electrode?  Nothing is lost: it stays in the queue, or
 * interrupted. */
static bool refused_electrode(struct jobs *j, struct interp_wear *wear)
{
	const struct store_job job = j->queue.job;
	const char *why = electrode_load(j, wear);
	static struct inside a;

	if (!why)
		return false;
	if (inside_read(j, job.n, &a) == 0 && !inside_is_named(&a)) {
		load_refuse(j, job, why);
		return true;
	}
	electrode_wait(j, job.n, why);
	queue_drop(j, true);
	queue_wait(j);
	jobs_note(j, &(struct jobs_note) { .kind = "waits", .job = job.id },
		  "job %s does not begin: %s; then start", job.name, why);
	return true;
}

static void load_ask(struct jobs *j, struct compiler_result *r)
{
	struct link_command c = {
		.verb = SHM_LOAD, .arg = j->queue.job.n,
		.answer = on_loaded, .answer_arg = j,
	};
	char reason[128];
	int err = load_name(j, r);

	randombytes_buf(&c.id, sizeof(c.id));
	j->queue.load_id = c.id |= 1;

	/* The store failed.  The job waits in the queue as before. */
	if (err == -EAGAIN) {
		queue_drop(j, true);
		return;
	}
	if (err < 0) {
		snprintf(reason, sizeof(reason), "its program cannot be given "
			 "to edmd: %s", strerror(-err));
		load_refuse(j, j->queue.job, reason);
		return;
	}
	if (refused_electrode(j, &r->wear))
		return;
	memcpy(j->queue.start_pulses, r->start_pulses,
	       sizeof(j->queue.start_pulses));
	j->queue.loading = true;
	if (link_send(&j->link, &c, jobs_now_us()) < 0) {
		j->queue.loading = false;
		queue_drop(j, true);
	}
}

static void on_compiled(void *arg, struct compiler_result *r)
{
	struct jobs *j = arg;
	struct queue *q = &j->queue;
	struct store_job job = q->next, found;
	const char *why;
	char reason[640];

	q->compile = NULL;
	free(q->next_text);
	q->next_text = NULL;
	/* Meanwhile the job may have been removed, and edmd may have ended. */
	if (q->job.n || store_find(j->store, job.id, &found) < 0 ||
	    found.state != JOB_QUEUED || j->link.state != LINK_OK)
		return;
	if (r->err == 0) {
		q->job = found;
		why = inside_loaded(j, r);
		if (why) {
			load_refuse(j, found, why);
		} else {
			store_set_tech(j->store, found.n, r->tech_sha256);
			load_ask(j, r);
		}
		queue_recount(j);
		return;
	}
	if (r->err == -EINVAL)
		interp_diag_full(&r->diag, job.name, reason, sizeof(reason));
	else
		snprintf(reason, sizeof(reason), "its program cannot be made: "
			 "%s", strerror(-r->err));
	load_refuse(j, job, r->tech_refusal[0] ? r->tech_refusal :
		    r->err == -EILSEQ ? DAMAGED : reason);
}

int load_request(struct jobs *j, const struct store_job *job,
		 struct compiler_request *ret)
{
	const struct shm_snapshot *s = &j->link.snap;
	int err;

	/* All of its bytes: early.c compares them. */
	memset(ret, 0, sizeof(*ret));
	ret->config = j->config;
	ret->name = job->name;
	snprintf(ret->setting, sizeof(ret->setting), "%s", job->setting);
	/* What the service itself has written. */
	ret->dialect = job->measures ? "generic" : NULL;
	for (int i = 0; i < INTERP_NAXES; i++)
		ret->start_mm[i] = s->pos[i] * s->pulse_mm[i];
	/* A short one is in the database. */
	err = store_text_file(j->store, job->n, ret->text_file);
	if (err == 0 || err == -ENOENT)
		err = inside_request(j, job, ret);
	if (err < 0)
		return err;
	electrode_request(j, job, 0, ret);
	ret->wants_wear = true;
	ret->wants_block = j->machine;
	ret->has_sha256 = sodium_hex2bin(ret->sha256, sizeof(ret->sha256),
					 job->sha256, strlen(job->sha256),
					 NULL, NULL, NULL) == 0;
	return offset_request(j, job, ret);
}

static int find_text(struct jobs *j, struct compiler_request *ret)
{
	struct queue *q = &j->queue;
	int err = 0;

	if (!*ret->text_file)
		err = store_text(j->store, q->next.n, &q->next_text,
				 &ret->bytes);
	ret->text = q->next_text;
	return err;
}

static int compile(struct jobs *j)
{
	struct queue *q = &j->queue;
	struct compiler_request request;
	int err = inside_check(j, &q->next);

	if (err == 0)
		err = load_request(j, &q->next, &request);
	if (err == 0)
		err = early_take(j, &q->next, &request);
	if (err == 0)
		err = find_text(j, &request);
	return err ? err : compiler_start(&q->compile, j->event, &request,
					  on_compiled, j);
}

void load_begin(struct jobs *j, int64_t now_us)
{
	struct queue *q = &j->queue;
	int err;

	if (!q->behind || store_head(j->store, &q->next) < 0)
		return;
	q->next_text = NULL;
	err = compile(j);
	if (err == 0)
		return;
	free(q->next_text);
	q->next_text = NULL;
	if (err == -EILSEQ) {
		load_refuse(j, q->next, DAMAGED);
	} else if (err != -ESTALE && err != -EAGAIN) {
		q->again_us = now_us + AGAIN_US;
		log_error("load: job %s: %s", q->next.id, strerror(-err));
	}
}

void load_fini(struct jobs *j)
{
	const bool over = compiler_destroy(j->queue.compile) ||
			  !j->queue.compile;

	j->queue.compile = NULL;
	if (over)
		free(j->queue.next_text);
	j->queue.next_text = NULL;
}
