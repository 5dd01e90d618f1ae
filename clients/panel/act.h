/* SPDX-License-Identifier: Apache-2.0 */
/*
 * act.h - ask edmd-jobs, and send it jobs, without waiting
 *
 * The only place of the panel that knows the messages.  LCM may lose what is
 * sent, so a question is asked again, with the same number, until it is
 * answered or its time is over.
 *
 * Units: in every name.  Threads: one, that of the event loop.
 */
#ifndef PANEL_ACT_H
#define PANEL_ACT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define ACT_WORD_MAX	64
#define ACT_ONCE	0x01u		/* send it once: what is late is no use */

struct act;

/* The job, as the last STATUS had it.  heard: no longer than 2 s ago. */
struct act_status {
	bool heard;
	char job[ACT_WORD_MAX], job_name[ACT_WORD_MAX];
	char job_state[ACT_WORD_MAX];
	int lines, queue_len;
	double left_s;			/* -1: there is no estimate */
};

struct act_question {
	const char *verb, *job, *text;	/* job, text: NULL is "" */
	double arg;
	unsigned int flags;
};

/* code: as in messages/README.md; lent until the callback returns. */
struct act_answer {
	int code;
	const char *reason, *body;
};

/* A job's text, in a file that stays the caller's until it is answered. */
struct act_job {
	int fd;
	size_t bytes;
	const char *id, *name;
	bool hold;
};

typedef void (*act_done_fn)(void *arg, const struct act_answer *a);
typedef void (*act_event_fn)(void *arg, const char *kind, const char *text);

/** act_open() - join the channels. Return: 0, -ENETUNREACH, -ENOMEM. */
int act_open(struct act **ret, const char *url, const char *machine);
/** act_close() - NULL is fine; what is under way is never answered. */
void act_close(struct act *a);

/** act_on_event() - who hears EVENTs. */
void act_on_event(struct act *a, act_event_fn fn, void *arg);

/** act_look() - take what came, repeat what is late; every 10 to 20 ms. */
void act_look(struct act *a);

/** act_ask() - @done is called once, from act_look(), unless forgotten.
 *  Return: 0; -EBUSY: too many are under way. */
int act_ask(struct act *a, const struct act_question *q, act_done_fn done,
	    void *arg);

/** act_send() - the same for a job. Return: 0, -EBUSY, -ENOMEM, -EIO. */
int act_send(struct act *a, const struct act_job *j, act_done_fn done,
	     void *arg);

/** act_forget() - never call back for @arg. */
void act_forget(struct act *a, void *arg);

/** act_status() - never NULL. */
const struct act_status *act_status(const struct act *a);

#endif /* PANEL_ACT_H */
