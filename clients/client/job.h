/* SPDX-License-Identifier: Apache-2.0 */
/*
 * job.h - send a job: a few chunks at a time, each repeated until it is
 * answered
 *
 * Call job_step() after every talk_step() or talk_wait().
 *
 * Threads: that of its struct talk.
 */
#ifndef CLIENT_JOB_H
#define CLIENT_JOB_H

#include "talk.h"

#include <stddef.h>

#define JOB_BYTES_MAX	(64 << 20)
#define JOB_ID_MAX	64		/* with its NUL */

struct job;

struct job_text {
	const char *id;			/* NULL: drawn */
	const char *name;		/* for people; its end is the dialect */
	const char *text;		/* lent until job_end() */
	size_t bytes;			/* at most JOB_BYTES_MAX */
	bool hold;			/* load it, but wait for "start" */
	int electrode;			/* it begins with; 0: the one in the
					 * holder */
	double silent_s;		/* give up without an ack; 0: 10 s; when
					 * all was sent 15 s at least */
};

/** job_begin() - Return: 0; -ENOMEM; -EFBIG; -EAGAIN: too many jobs at once. */
int job_begin(struct job **ret, struct talk *t, const struct job_text *x);

/**
 * job_step() - send what is due.
 *
 * Return: 1: it is answered, see job_verdict(); 0: it goes on; -ETIMEDOUT:
 * nothing was heard for so long that the service must be gone.
 */
int job_step(struct job *j);

/** job_verdict() - code 0: the job is in the queue, and body is its JSON. */
const struct talk_ack *job_verdict(const struct job *j);

/** job_id() - the id of the job, given by the caller or drawn. */
const char *job_id(const struct job *j);
/**
 * job_name() - the name as it was sent, cut to the length that a name may have.
 */
const char *job_name(const struct job *j);

/**
 * job_progress() - how many chunks have arrived. Return: how many there are.
 */
int job_progress(const struct job *j, int *ret_arrived);

/** job_end() - @s may be NULL. A job that was not sent whole is forgotten. */
void job_end(struct job *j);

#endif /* CLIENT_JOB_H */
