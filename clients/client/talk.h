/* SPDX-License-Identifier: Apache-2.0 */
/*
 * talk.h - speak with edmd-jobs: commands, jobs, status
 *
 * What is sent is signed with a key file; what is heard counts only if the
 * machine has signed it, just now.  LCM may lose what is sent, so a question
 * is asked again, with the same number, until it is answered.
 *
 * Two ways to use it.  A program that does one thing asks and waits:
 *
 *	talk_open(&t, &(struct talk_options) { .machine = "edm" }, said);
 *	talk_ask(t, &(struct talk_question) { .verb = "hold" }, 3, &answer);
 *
 * One with an event loop of its own polls talk_fd(), calls talk_step() when it
 * is readable and at least every 50 ms, and gets answers by talk_send()'s
 * function, statuses by talk_status().
 *
 * Text that is handed out is plain (plain.h), but for the body of an answer,
 * which is JSON.
 *
 * Units: in every name.  Threads: one object belongs to one thread.
 */
#ifndef CLIENT_TALK_H
#define CLIENT_TALK_H

#include "keyfile.h"

#include <stdbool.h>
#include <stdint.h>

#define TALK_URL	"udpm://239.255.76.67:7667?ttl=0"
#define TALK_NAXES	8
#define TALK_CHUNK_MAX	32768
#define TALK_WORD_MAX	64
#define TALK_FAULTS_MAX	512		/* all of them at once */
#define TALK_SAID_MAX	(KEYFILE_SAID_MAX + 64)
#define TALK_QUESTIONS	16		/* under way at once */

struct talk;

struct talk_options {
	const char *machine;		/* NULL: "edm" */
	const char *url;		/* of LCM; NULL: TALK_URL */
	const char *key;		/* key file; NULL: that of $EDM_KEY,
					 * else the host's own */
	const char *program;		/* our name; NULL: "client" */
};

/* The last STATUS; fields as in edm.status_t. */
struct talk_status {
	int64_t utime;
	char machine[TALK_WORD_MAX], daemon[TALK_WORD_MAX];
	char state[TALK_WORD_MAX], fault[TALK_WORD_MAX];
	char faults[TALK_FAULTS_MAX];	/* all that are latched */
	char job[TALK_WORD_MAX], job_name[TALK_WORD_MAX];
	char job_state[TALK_WORD_MAX];
	int line, lines;
	double place_mm, length_mm, progress;
	double pos_mm[TALK_NAXES];
	double gap_v, feed_mm_s, depth_mm;
	double contour_mm, contour_predicted_mm;	/* -1: not known */
	int jumps, retracts, shorts;
	double job_s, eta_s;
	int queue_len, overruns, wake_late_max_us;
	char condition[TALK_WORD_MAX];
};

/* An EVENT; lent to who hears it. */
struct talk_event {
	int64_t utime;
	const char *kind, *job, *outcome, *text;
	double place_mm;
};

struct talk_ack {
	int64_t seq;
	int code;			/* messages/README.md */
	const char *reason, *body;
};

struct talk_chunk {
	int64_t seq;
	const char *job, *name;
	int64_t bytes;
	const uint8_t *sha256;
	int chunk, chunks;
	int64_t offset;
	bool hold;
	int size;
	const char *data;
};

struct talk_question {
	const char *verb, *job, *text;	/* job, text: NULL is "" */
	double arg;
};

struct talk_answer {
	int code;
	char *reason, *body;		/* to be freed by talk_answer_free() */
};

/**
 * talk_open() - read the key and join the channels of the machine.
 *
 * @said: on failure what is wrong and what mends it, in words.
 * Return: 0; -ENETUNREACH no multicast; as keyfile_read() for the key; else
 * -errno.
 */
int talk_open(struct talk **ret, const struct talk_options *o,
	      char said[TALK_SAID_MAX]);

/** talk_close() - NULL is fine.  Questions under way are not answered. */
void talk_close(struct talk *t);

/** talk_key() - the key in use. */
const struct keyfile *talk_key(const struct talk *t);

/** talk_why() - why nothing is heard, if the service said so; else "". */
const char *talk_why(const struct talk *t);

/* -- Waiting for the answer ------------------------------------------------- */

/**
 * talk_ask() - ask until answered, @timeout_s at most.
 * Return: 0, -ETIMEDOUT, -EAGAIN, -EINTR if talk_interrupted().
 */
int talk_ask(struct talk *t, const struct talk_question *q, double timeout_s,
	     struct talk_answer *ret);
void talk_answer_free(struct talk_answer *a);

/** talk_wait() - take what comes, for @ms at most. */
void talk_wait(struct talk *t, int ms);

/* -- In an event loop ------------------------------------------------------- */

/** talk_fd() - readable when talk_step() has something to take. */
int talk_fd(const struct talk *t);

/** talk_step() - take what has come, send again what is due.  Never waits. */
void talk_step(struct talk *t);

/* @err: 0; -ETIMEDOUT not answered: it may have been done, or not. */
typedef void (*talk_answer_fn)(void *arg, int err, const struct talk_ack *a);

/**
 * talk_send() - ask; @fn is called once, by talk_step() or talk_wait().
 * Return: 0; -EAGAIN if TALK_QUESTIONS are under way; -ENOMEM.
 */
int talk_send(struct talk *t, const struct talk_question *q, double timeout_s,
	      talk_answer_fn fn, void *arg);

/** talk_on_event() - who hears EVENTs; NULL: no one. */
void talk_on_event(struct talk *t,
		   void (*fn)(void *arg, const struct talk_event *e),
		   void *arg);

/* -- Either way ------------------------------------------------------------- */

/** talk_status() - the last; NULL before the first.  @ret_count: how many. */
const struct talk_status *talk_status(const struct talk *t,
				      uint64_t *ret_count);

/** talk_events() - how many EVENTs were heard. */
uint64_t talk_events(const struct talk *t);

/** talk_now_s() - monotonic. */
double talk_now_s(void);

/** talk_catch_signals() - SIGINT and SIGTERM only set a flag from now on. */
void talk_catch_signals(void);
bool talk_interrupted(void);

/* -- For job.c -------------------------------------------------------------- */

/** talk_numbers() - the next @n seqs; the first of them. */
int64_t talk_numbers(struct talk *t, int n);

/** talk_on_acks() - who gets the acks from @first on, @n of them.
 *  Return: 0, or -EAGAIN: too many already. */
int talk_on_acks(struct talk *t, int64_t first, int n,
		 void (*fn)(void *arg, const struct talk_ack *a), void *arg);
/** talk_off_acks() - no one any more. */
void talk_off_acks(struct talk *t, int64_t first);

/** talk_send_chunk() - false: not yet, the service has not answered once. */
bool talk_send_chunk(struct talk *t, const struct talk_chunk *c);

#endif /* CLIENT_TALK_H */
