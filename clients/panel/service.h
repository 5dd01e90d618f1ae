/* SPDX-License-Identifier: Apache-2.0 */
/*
 * service.h - the panel's connection to edmd-jobs: questions, verbs and jobs,
 * without waiting
 *
 * It uses the client library and signs with the host's own key.  If the panel
 * is started before edmd-jobs has made that key, or may not read the key, it
 * says so to whoever asks, and tries again by itself.
 *
 * Units: in every name.  Threads: one, that of the event loop.
 */
#ifndef PANEL_SERVICE_H
#define PANEL_SERVICE_H

#include "share.h"

#include "interp/axis.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define SERVICE_WORD_MAX	64
#define SERVICE_TEXT_MAX	512
#define SERVICE_ONCE	0x01u	/* send it once: a late one would be useless */

struct service;

/* What the last STATUS message said. */
struct service_status {
	bool heard;			/* it came within the last 2 s */
	char job[SERVICE_WORD_MAX], job_name[SERVICE_WORD_MAX];
	char job_state[SERVICE_WORD_MAX];
	char store[SERVICE_WORD_MAX];	/* "ok", or "degraded: " and why */
	char asks[SERVICE_TEXT_MAX];	/* why it stands, in words */
	char interrupted[SERVICE_WORD_MAX];	/* id of such a job, or "" */
	char lost[SERVICE_WORD_MAX];	/* axes whose place is not certain */
	char faults[SERVICE_TEXT_MAX];	/* all that are latched */
	int lines, queue_len, hunts;
	int electrode;			/* in the holder; 0: none */
	char work[SERVICE_WORD_MAX];	/* system in force: "G54", or "" */
	int pass, passes;		/* of a wire; 0: none */
	double wire_offset_mm;
	double work_turn_deg, work_mm[INTERP_NAXES];
	double lean_deg;		/* of a wire */
	double eta_s;			/* -1: there is no estimate */
	double eta_min_s, eta_max_s, eta_factor, end_s, progress;
	double queue_s, queue_end_s;
	int queue_untold;
	char eta_by[SERVICE_WORD_MAX], eta_condition[SERVICE_WORD_MAX];
};

struct service_question {
	const char *verb, *job, *text;	/* job and text: NULL means "" */
	double arg;
	unsigned int flags;
	const struct share_who *who;	/* for whom it counts */
};

/* The code is one of messages/README.md.  Lent until the callback returns. */
struct service_answer {
	int code;
	const char *reason, *body;
};

/* The text of a job is in a file.  The file belongs to the caller, who keeps it
 * open until the job is answered. */
struct service_job {
	int fd;
	size_t bytes;
	const char *id, *name;
	bool hold;
	int from_line;
	const char *setting;		/* interp/setting.h */
};

typedef void (*service_done_fn)(void *arg, const struct service_answer *a);
typedef void (*service_event_fn)(void *arg, const char *kind, const char *text);

/**
 * service_create() - @machine must live as long as the object.
 *
 * Return: NULL if there is no memory.
 */
struct service *service_create(const char *machine, struct shares *shares);
/**
 * service_destroy() - @a may be NULL.  The callback of a question that is still
 * open is never called.
 */
void service_destroy(struct service *a);

/** service_on_event() - call @fn for each EVENT message. */
void service_on_event(struct service *a, service_event_fn fn, void *arg);

/**
 * service_look() - take the messages that came, and repeat what has had no
 * answer for too long.  To be called every 10 to 20 ms.
 */
void service_look(struct service *a);

/**
 * service_ask() - send a question or a verb.  @done is called once, from
 * service_look(), or at once if only edmd itself can be asked; never after
 * service_forget() was called for @arg.  If the question has to make room for
 * another one, it is called with code 75.
 *
 * Return: 0; -EAGAIN: too many questions are open; -ENOTCONN: see
 * service_why().
 */
int service_ask(struct service *a, const struct service_question *q,
		service_done_fn done, void *arg);

/** service_send() - the same for a job.  Return: also -ENOMEM. */
int service_send(struct service *a, const struct service_job *j,
		 service_done_fn done, void *arg);

/** service_forget() - never call back for @arg. */
void service_forget(struct service *a, void *arg);

/**
 * service_why() - why nothing can be asked, and what mends it; "" if questions
 * can be asked.
 */
const char *service_why(const struct service *a);

/** service_status() - never NULL. */
const struct service_status *service_status(const struct service *a);

#endif /* PANEL_SERVICE_H */
