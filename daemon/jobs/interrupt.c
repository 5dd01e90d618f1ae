/* SPDX-License-Identifier: Apache-2.0 */
/* interrupt.c - a job that a power cut or the death of edmd ended early */
#include "interrupt.h"

#include "again.h"
#include "jobs.h"
#include "jobs_log.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Does the last checkpoint belong to this job? */
static bool is_of_job(const struct checkpoint *c, const struct store_job *job)
{
	char hex[65];

	sodium_bin2hex(hex, sizeof(hex), c->base.job.sha256,
		       sizeof(c->base.job.sha256));
	return c->there && c->base.job.n == job->n &&
	       strcmp(hex, job->sha256) == 0;
}

/* A PLC can start a job without asking this service. */
bool interrupt_saw_begin(const struct jobs *j)
{
	return is_of_job(&j->last, &j->queue.job) &&
	       j->last.base.snap.job_cycles > 0;
}

void interrupt_init(struct jobs *j)
{
	struct store_job job;

	j->interrupted[0] = '\0';
	if (store_interrupted(j->store, &job) == 0)
		snprintf(j->interrupted, sizeof(j->interrupted), "%s", job.id);
}

/* Take the totals of the job from the checkpoint. */
static void take_sums(struct queue *q, const struct checkpoint_base *b)
{
	q->snap = b->snap;
	q->depth_mm = b->snap.depth_mm;
}

static void say_when(char *to, size_t size, int64_t utime)
{
	const time_t at = (time_t)(utime / 1000000);
	struct tm tm;

	localtime_r(&at, &tm);
	strftime(to, size, "%Y-%m-%d %H:%M:%S", &tm);
}

static void keep(struct jobs *j, const struct checkpoint *c)
{
	static struct again a;
	const struct shm_snapshot *s = &a.base.snap;
	char reason[320], when[32];

	again_interrupted(j, j->queue.job.n, &c->base, &a);
	again_write(j, j->queue.job.n, &a);
	take_sums(&j->queue, &a.base);
	say_when(when, sizeof(when), c->utime);
	snprintf(reason, sizeof(reason), "interrupted in %s, line %u, at %.3f "
		 "mm of %.3f, cut to %.3f mm; last seen %s; if the host did not "
		 "go down, edmd's log says why",
		 shm_state_name(s->state), s->line, s->place_mm, s->length_mm,
		 s->far_mm, when);
	queue_end(j, JOB_INTERRUPTED, reason);
	interrupt_init(j);
}

void interrupt_take(struct jobs *j)
{
	const struct checkpoint *c = &j->last;
	struct queue *q = &j->queue;

	if (!is_of_job(c, &q->job)) {
		queue_end(j, JOB_STOPPED, "the host or edmd went down in it, "
			  "and no checkpoint of it is left: where it was is "
			  "not known");
		return;
	}
	electrode_interrupted(j, &c->base);
	take_sums(q, &c->base);
	/* The checkpoint has the end of the job, but the store did not get
	 * it. */
	if (!c->base.snap.loaded && c->base.snap.outcome == SHM_OUTCOME_DONE)
		queue_end(j, JOB_DONE, "");
	else if (!c->base.snap.loaded && c->base.snap.outcome)
		queue_end(j, JOB_STOPPED, "by command, or after a fault");
	else
		keep(j, c);
}

const char *interrupt_lost(const struct jobs *j)
{
	static char letters[INTERP_NAXES + 1];
	const bool cut_short = *j->interrupted != '\0';
	size_t n = 0;

	for (int i = 0; i < INTERP_NAXES; i++) {
		if (!(j->config->axes.present >> i & 1))
			continue;
		/* An axis that cannot be homed stands where an operator says
		 * that it stands. */
		if (j->link.snap.unhomed >> i & 1 ||
		    (cut_short && j->config->manual[i].method == 0 &&
		     !(j->vouched >> i & 1)))
			letters[n++] = INTERP_AXIS_LETTERS[i];
	}
	letters[n] = '\0';
	return letters;
}
