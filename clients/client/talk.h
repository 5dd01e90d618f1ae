/* SPDX-License-Identifier: Apache-2.0 */
/*
 * talk.h - speak with edmd-jobs: commands, jobs, status
 *
 * What is sent is signed with a key file. What is received counts only if the
 * machine has signed it, just now. LCM may lose packets, so a question is sent
 * again, with the same number, until it is answered.
 *
 * There are two ways to use it. A program that does one thing asks and waits:
 *
 * 	talk_open(&t, &(struct talk_options) { .machine = "edm" }, said);
 * 	talk_ask(t, &(struct talk_question) { .verb = "hold" }, 3, &answer);
 *
 * A program with an event loop of its own polls talk_fd(), and calls
 * talk_step() when it is readable and at least every 50 ms. It gets answers
 * through the function given to talk_send(), and the state by talk_status().
 *
 * Text that is handed out is plain (plain.h), except the body of an answer,
 * which is JSON.
 *
 * Units: in every name. Threads: one object belongs to one thread.
 */
#ifndef CLIENT_TALK_H
#define CLIENT_TALK_H

#include "keyfile.h"
#include "status_fields.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define TALK_URL	"udpm://239.255.76.67:7667?ttl=0"
#define TALK_NAXES	8
#define TALK_CHUNK_MAX	32768
#define TALK_WORD_MAX	64
#define TALK_TEXT_MAX	512		/* a text of STATUS */
#define TALK_SAID_MAX	(KEYFILE_SAID_MAX + 64)
#define TALK_QUESTIONS	16		/* under way at once */
#define TALK_TURN_MS	10		/* wait no longer between two turns
					 * while an act is under way */

struct talk;
struct udpm_packet;

/* Another way to a machine than those of this host, such as the fleet's; lent
 * until talk_close(). */
struct talk_carrier {
	int fd;				/* readable when take() has something */
	void (*send)(void *arg, const char *channel, const void *data,
		     size_t size);
	bool (*take)(void *arg, struct udpm_packet *ret);
	void *arg;
};

struct talk_options {
	const char *machine;		/* NULL: "edm" */
	const char *url;		/* of LCM; NULL: the socket of this
					 * host; if there is none,
					 * talk_default_url() */
	const struct talk_carrier *carrier;	/* NULL: none */
	const char *key;		/* key file; NULL: that of $EDM_KEY,
					 * else the host's own */
	const char *program;		/* our name; NULL: "client" */
};

#define TALK_WORD(name)		char name[TALK_WORD_MAX];
#define TALK_TEXT(name)		char name[TALK_TEXT_MAX];
#define TALK_COUNT(name)	int name;
#define TALK_NUMBER(name)	double name;

/* The last STATUS; fields as in edm.status_t: words/status_fields.h. */
struct talk_status {
	int64_t utime;
	char machine[TALK_WORD_MAX];
	STATUS_FIELDS(TALK_WORD, TALK_TEXT, TALK_COUNT, TALK_NUMBER)
	char faults[TALK_TEXT_MAX];	/* all that are latched */
	double pos_mm[TALK_NAXES], work_mm[TALK_NAXES];
	double contour_mm, contour_predicted_mm;	/* -1: not known */
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
	int from_line;
	double from_mm;
	int electrode;
	const char *setting;		/* NULL is "" */
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

/** talk_default_url() - that of $LCM_DEFAULT_URL, or TALK_URL. */
const char *talk_default_url(void);

/**
 * talk_open() - read the key and join the channels of the machine.
 *
 * @said: on failure, what is wrong and how to mend it, in words.
 *
 * Return: 0; -ENETUNREACH: neither socket nor multicast; for the key the values
 * of keyfile_read(); else -errno.
 */
int talk_open(struct talk **ret, const struct talk_options *o,
	      char said[TALK_SAID_MAX]);

/**
 * talk_close() - @t may be NULL. Questions under way stay without an answer.
 */
void talk_close(struct talk *t);

/** talk_key() - the key in use. */
const struct keyfile *talk_key(const struct talk *t);

/**
 * talk_why() - why nothing is received: what the service said, or that somebody
 * signs with another key, whoever that is; else "".
 */
const char *talk_why(const struct talk *t);

/* -- Waiting for the answer ----------------------------------------------- */

/**
 * talk_ask() - ask until there is an answer, for at most @timeout_s.
 *
 * Return: 0, -ETIMEDOUT, -EAGAIN, -ENOMEM, or -EINTR if talk_interrupted().
 */
int talk_ask(struct talk *t, const struct talk_question *q, double timeout_s,
	     struct talk_answer *ret);
void talk_answer_free(struct talk_answer *a);

/** talk_wait() - take what comes, for at most @ms. */
void talk_wait(struct talk *t, int ms);

/* -- In an event loop ----------------------------------------------------- */

/** talk_fd() - readable when talk_step() has something to take. */
int talk_fd(const struct talk *t);

/**
 * talk_step() - take what has come and send again what is due. It never waits.
 */
void talk_step(struct talk *t);

/* @err: 0; -ETIMEDOUT not answered: it may have been done, or not. */
typedef void (*talk_answer_fn)(void *arg, int err, const struct talk_ack *a);

/** talk_answer_copy() - keep it beyond the call.  Return: 0, -ENOMEM. */
int talk_answer_copy(struct talk_answer *ret, const struct talk_ack *a);

/**
 * talk_send() - ask; talk_step() or talk_wait() will call @fn once.
 *
 * Return: 0; -EAGAIN if TALK_QUESTIONS are under way; -ENOMEM.
 */
int talk_send(struct talk *t, const struct talk_question *q, double timeout_s,
	      talk_answer_fn fn, void *arg);

/** talk_forget() - drop what was asked with @arg; nothing is called back. */
void talk_forget(struct talk *t, const void *arg);

/** talk_on_event() - set the function that gets every EVENT; NULL: none. */
void talk_on_event(struct talk *t,
		   void (*fn)(void *arg, const struct talk_event *e),
		   void *arg);

/* -- Either way ----------------------------------------------------------- */

/**
 * talk_status() - the last one; NULL before the first. @ret_count: how many
 * came.
 */
const struct talk_status *talk_status(const struct talk *t,
				      uint64_t *ret_count);

/** talk_events() - how many EVENTs came. */
uint64_t talk_events(const struct talk *t);

/** talk_now_s() - the time of a monotonic clock. */
double talk_now_s(void);

/** talk_catch_signals() - SIGINT and SIGTERM only set a flag from now on. */
void talk_catch_signals(void);
bool talk_interrupted(void);

/* -- For submission.c ----------------------------------------------------- */

/** talk_numbers() - reserve @n seqs. Return: the first of them. */
int64_t talk_numbers(struct talk *t, int n);

/**
 * talk_on_acks() - set the function that gets the @n acks from @first on.
 * Return: 0, or -EAGAIN: there are too many such functions.
 */
int talk_on_acks(struct talk *t, int64_t first, int n,
		 void (*fn)(void *arg, const struct talk_ack *a), void *arg);
/** talk_off_acks() - nobody gets them any more. */
void talk_off_acks(struct talk *t, int64_t first);

/**
 * talk_boot() - the service's start that is spoken with; 0: none yet.  A new
 * one has forgotten what was not sent whole.
 */
int64_t talk_boot(const struct talk *t);

/**
 * talk_send_chunk() - Return: false: not yet, because the service has not
 * answered once.
 */
bool talk_send_chunk(struct talk *t, const struct talk_chunk *c);

#endif /* CLIENT_TALK_H */
