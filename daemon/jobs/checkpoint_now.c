/* SPDX-License-Identifier: Apache-2.0 */
/* checkpoint_now.c - collects what has to be written in a checkpoint */
#include "interrupt.h"

#include "jobs.h"
#include "jobs_log.h"

#include <sodium.h>
#include <string.h>

#define AGAIN_US	5000000

static void fill_job(struct checkpoint_job *to, const struct jobs *j)
{
	const struct store_job *job = &j->queue.job;
	const struct electrode *e = &j->electrode;

	to->n = job->n;
	to->run = j->queue.run;
	to->begun = job->begun_us != 0;
	memcpy(to->id, job->id, sizeof(to->id));
	sodium_hex2bin(to->sha256, sizeof(to->sha256), job->sha256,
		       strlen(job->sha256), NULL, NULL, NULL);
	sodium_hex2bin(to->tech, sizeof(to->tech), job->tech_sha256,
		       strlen(job->tech_sha256), NULL, NULL, NULL);
	memcpy(to->config, j->config_hash, sizeof(to->config));
	memcpy(to->start, j->queue.start_pulses, sizeof(to->start));
	if (e->n == job->n && e->now >= 0) {
		to->electrode = e->worn[e->now].electrode;
		to->part = e->worn[e->now].part;
		to->first_part = e->worn[0].part;
		memcpy(to->by, e->worn[e->now].by, sizeof(to->by));
	}
}

/* How late single wakes were does not belong to the place of the machine. */
static void forget_timing(struct shm_snapshot *s)
{
	s->wake_late_ns = s->took_ns = 0;
}

/* The disk did not accept the file before: try again. */
static void try_open(struct jobs *j, int64_t now_us)
{
	static struct checkpoint ignored;
	int err;

	if (j->checkpoint || now_us < j->checkpoint_again_us)
		return;
	j->checkpoint_again_us = now_us + AGAIN_US;
	err = checkpoint_open(&j->checkpoint, j->store_dir, j->machine,
			      &ignored);
	if (err != j->checkpoint_err && err)
		log_error("checkpoint: %s/%s.place: %s; until it can be "
			  "written a job is not found again after a power cut",
			  j->store_dir, j->machine, strerror(-err));
	j->checkpoint_err = err;
}

void checkpoint_tick(struct jobs *j, int64_t now_us)
{
	static struct checkpoint_base now;
	const struct queue *q = &j->queue;

	try_open(j, now_us);
	/* The last checkpoint stays until it is known what happened to the
	 * job. */
	if (!j->checkpoint || j->link.state != LINK_OK ||
	    (q->job.n && j->link.snap.program != q->job.n))
		return;
	memset(&now, 0, sizeof(now));
	now.utime = jobs_utime();
	now.snap = j->link.snap;
	forget_timing(&now.snap);
	if (q->job.n)
		fill_job(&now.job, j);
	now.wear_mm = electrode_used_mm(j);
	if (j->link.status)
		shm_sets(j->link.status, &now.sets);
	checkpoint_look(j->checkpoint, &now, now_us);
	/* As long as this service lives, it knows more than its disk. */
	j->last.there = true;
	j->last.base = now;
	j->last.utime = now.utime;
}
