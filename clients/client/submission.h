/* SPDX-License-Identifier: Apache-2.0 */
/*
 * submission.h - send a job to edmd-jobs: a few chunks at a time, each repeated
 * until it is answered
 *
 * Call submission_step() after every talk_step() or talk_wait().
 *
 * Threads: that of its struct talk.
 */
#ifndef CLIENT_SUBMISSION_H
#define CLIENT_SUBMISSION_H

#include "talk.h"

#include <stddef.h>

#define SUBMISSION_BYTES_MAX	(64 << 20)
#define SUBMISSION_ID_MAX	64	/* with its NUL */

struct submission;

struct submission_text {
	const char *id;			/* NULL: one is drawn */
	const char *name;		/* for people; its ending is the
					 * dialect */
	const char *text;		/* lent until submission_end() */
	size_t bytes;			/* at most SUBMISSION_BYTES_MAX */
	bool hold;			/* load it, but wait for "start" */
	int electrode;			/* begin with this one; 0: with the one
					 * in the holder */
	const char *setting;		/* interp/setting.h; NULL: nothing; lent
					 * as the text is */
	int from_line;			/* begin at this line; 0: from_mm */
	double from_mm;			/* begin there along the path; 0: at the
					 * beginning */
	double silent_s;		/* give up after so long without an ack;
					 * 0: 10 s.  At least 15 s, when the
					 * whole text has been sent */
};

/**
 * submission_begin() - begin to send @x; the first chunks go out with the next
 * submission_step().
 *
 * Return: 0; -ENOMEM; -EFBIG; -EAGAIN: too many jobs at once.
 */
int submission_begin(struct submission **ret, struct talk *t,
		     const struct submission_text *x);

/**
 * submission_step() - send what is due.
 *
 * Return: 1: the job is answered, see submission_verdict(); 0: it goes on;
 * -ETIMEDOUT: nothing was heard for so long that the service must be gone.
 */
int submission_step(struct submission *j);

/**
 * submission_verdict() - the answer.  Code 0: the job is in the queue, and body
 * is its JSON.
 */
const struct talk_ack *submission_verdict(const struct submission *j);

/** submission_id() - the id of the job, given by the caller or drawn. */
const char *submission_id(const struct submission *j);
/**
 * submission_name() - the name as it was sent, cut to the length that a name
 * may have.
 */
const char *submission_name(const struct submission *j);

/**
 * submission_progress() - how many chunks have arrived.
 *
 * Return: how many chunks there are.
 */
int submission_progress(const struct submission *j, int *ret_arrived);

/**
 * submission_is_out() - every chunk has gone out: from here on the service may
 * have the job, also if nothing is heard of it any more.
 */
bool submission_is_out(const struct submission *j);

/**
 * submission_end() - give back the memory; @j may be NULL.  edmd-jobs forgets a
 * job that was not sent whole.
 */
void submission_end(struct submission *j);

#endif /* CLIENT_SUBMISSION_H */
