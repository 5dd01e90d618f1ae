/* SPDX-License-Identifier: Apache-2.0 */
/*
 * talk.h - speak with edmd-jobs over LCM
 *
 * The only place of edmctl that knows the generated messages.  LCM may lose
 * what is sent, so a question is asked again, with the same number, until it
 * is answered.
 *
 * Units: in every name.  Threads: one.
 */
#ifndef CTL_TALK_H
#define CTL_TALK_H

#include <stdbool.h>
#include <stdint.h>

#define TALK_NAXES	8
#define TALK_CHUNK_MAX	32768
#define TALK_WORD_MAX	64

struct talk;

/* The last STATUS; fields as in edm.status_t. */
struct talk_status {
	int64_t utime;
	char machine[TALK_WORD_MAX], daemon[TALK_WORD_MAX];
	char state[TALK_WORD_MAX], fault[TALK_WORD_MAX];
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

struct talk_ack {
	int64_t seq;
	int code;
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
 * talk_open() - join the channels of @machine.
 * Return: 0, -ENETUNREACH, -ENOMEM.
 */
int talk_open(struct talk **ret, const char *url, const char *machine);

/** talk_close() - NULL is fine. */
void talk_close(struct talk *t);

/**
 * talk_ask() - ask until answered, @timeout_s at most.
 * Return: 0, -ETIMEDOUT, -EINTR if talk_interrupted().
 */
int talk_ask(struct talk *t, const struct talk_question *q, double timeout_s,
	     struct talk_answer *ret);
void talk_answer_free(struct talk_answer *a);

/** talk_wait() - take what comes, for @ms at most. */
void talk_wait(struct talk *t, int ms);

/** talk_status() - the last; NULL before the first.  @ret_count: how many. */
const struct talk_status *talk_status(const struct talk *t,
				      uint64_t *ret_count);

/** talk_events() - how many EVENTs were heard. */
uint64_t talk_events(const struct talk *t);

/** talk_number() - the next seq. */
int64_t talk_number(struct talk *t);

/** talk_on_ack() - who gets the acks to our chunks; NULL: no one. */
void talk_on_ack(struct talk *t,
		 void (*fn)(void *arg, const struct talk_ack *a), void *arg);
void talk_send_chunk(struct talk *t, const struct talk_chunk *c);

/** talk_now_s() - monotonic. */
double talk_now_s(void);

/** talk_catch_signals() - SIGINT and SIGTERM only set a flag from now on. */
void talk_catch_signals(void);
bool talk_interrupted(void);

#endif /* CTL_TALK_H */
