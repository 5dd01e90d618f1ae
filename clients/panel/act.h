/* SPDX-License-Identifier: Apache-2.0 */
/*
 * act.h - ask edmd-jobs, and send it jobs, without waiting
 *
 * Over the client library, signed with the host's own key.  A panel that is
 * started before edmd-jobs has made that key, or may not read it, says so to
 * whoever asks, and tries again by itself.
 *
 * Units: in every name.  Threads: one, that of the event loop.
 */
#ifndef PANEL_ACT_H
#define PANEL_ACT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define ACT_WORD_MAX	64
#define ACT_FAULTS_MAX	512
#define ACT_ONCE	0x01u		/* send it once: what is late is no use */

struct act;

/* The job, as the last STATUS had it.  heard: no longer than 2 s ago. */
struct act_status {
	bool heard;
	char job[ACT_WORD_MAX], job_name[ACT_WORD_MAX];
	char job_state[ACT_WORD_MAX];
	char store[ACT_WORD_MAX];	/* "ok", or "degraded: " and why */
	char interrupted[ACT_WORD_MAX];	/* id of such a job, or "" */
	char lost[ACT_WORD_MAX];	/* axes whose place is not certain */
	char faults[ACT_FAULTS_MAX];	/* all that are latched */
	int lines, queue_len, hunts;
	double eta_s;			/* -1: there is no estimate */
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

/** act_create() - NULL: no memory.  @url, @machine stay the caller's. */
struct act *act_create(const char *url, const char *machine);
/** act_destroy() - NULL is fine; what is under way is never answered. */
void act_destroy(struct act *a);

/** act_on_event() - who hears EVENTs. */
void act_on_event(struct act *a, act_event_fn fn, void *arg);

/** act_look() - take what came, repeat what is late; every 10 to 20 ms. */
void act_look(struct act *a);

/** act_ask() - @done is called once, from act_look(), unless forgotten.
 *  Return: 0; -EAGAIN: too many are under way; -ENOTCONN: act_why(). */
int act_ask(struct act *a, const struct act_question *q, act_done_fn done,
	    void *arg);

/** act_send() - the same for a job.  Return: also -ENOMEM. */
int act_send(struct act *a, const struct act_job *j, act_done_fn done,
	     void *arg);

/** act_forget() - never call back for @arg. */
void act_forget(struct act *a, void *arg);

/** act_why() - why nothing can be asked, and what mends it; "" if it can. */
const char *act_why(const struct act *a);

/** act_status() - never NULL. */
const struct act_status *act_status(const struct act *a);

#endif /* PANEL_ACT_H */
