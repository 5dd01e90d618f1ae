/* SPDX-License-Identifier: Apache-2.0 */
/* service.c - the panel's connection to edmd-jobs */
#include "service.h"

#include "submission.h"
#include "talk.h"
#include "talk_stop.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sysexits.h>

#define GIVE_UP_S	6.0
#define ONCE_S		0.25		/* shorter than the time after which
					 * talk.c repeats */
#define HEARD_S		2.0
#define OPEN_S		1.0		/* between two tries to open the
					 * channel */
#define SENDINGS	2
#define EDMD_S		0.2		/* edmd answers in a period */

/* A question that is under way; the library calls back with it. */
struct asking {
	struct asking *next;
	struct share share;
	struct service *service;
	service_done_fn done;		/* NULL: nobody waits for it any more */
	void *arg;
};

struct sending {
	struct submission *job;		/* NULL: free */
	void *text;
	size_t bytes;
	service_done_fn done;
	void *arg;
};

struct service {
	const char *machine;
	struct shares *shares;
	struct talk *talk;		/* NULL: not yet */
	char why[TALK_SAID_MAX];
	double tried_s;
	struct asking *askings;
	struct sending sending[SENDINGS];
	struct service_status status;
	uint64_t heard;
	double heard_s;
	service_event_fn on_event;
	void *on_event_arg;
};

static void on_event(void *arg, const struct talk_event *e)
{
	struct service *a = arg;

	if (a->on_event)
		a->on_event(a->on_event_arg, e->kind, e->text);
}

static void try_open(struct service *a)
{
	const struct talk_options o = {
		.machine = a->machine, .program = "panel",
	};

	a->tried_s = talk_now_s();
	if (talk_open(&a->talk, &o, a->why) < 0) {
		a->talk = NULL;
		return;
	}
	a->why[0] = '\0';
	talk_on_event(a->talk, on_event, a);
}

struct service *service_create(const char *machine, struct shares *shares)
{
	struct service *a = calloc(1, sizeof(*a));

	if (!a)
		return NULL;
	a->machine = machine;
	a->shares = shares;
	a->status.eta_s = -1;
	try_open(a);
	return a;
}

static void free_sending(struct sending *s)
{
	submission_end(s->job);
	if (s->text)
		munmap(s->text, s->bytes);
	*s = (struct sending) { .job = NULL };
}

void service_destroy(struct service *a)
{
	if (!a)
		return;
	for (int i = 0; i < SENDINGS; i++)
		free_sending(&a->sending[i]);
	talk_close(a->talk);
	while (a->askings) {
		struct asking *q = a->askings;

		share_give(&q->share);
		a->askings = q->next;
		free(q);
	}
	free(a);
}

void service_on_event(struct service *a, service_event_fn fn, void *arg)
{
	a->on_event = fn;
	a->on_event_arg = arg;
}

const char *service_why(const struct service *a)
{
	return a->talk ? talk_why(a->talk) : a->why;
}

static void asking_free(struct asking *q)
{
	struct asking **at = &q->service->askings;

	share_give(&q->share);
	while (*at != q)
		at = &(*at)->next;
	*at = q->next;
	free(q);
}

static void on_taken(void *arg, const char *why)
{
	struct asking *q = arg;

	talk_forget(q->service->talk, q);
	if (q->done)
		q->done(q->arg, &(struct service_answer) {
			.code = EX_TEMPFAIL, .reason = why, .body = "",
		});
	asking_free(q);
}

static void on_answer(void *arg, int err, const struct talk_ack *ack)
{
	struct asking *q = arg;
	const struct service_answer late = {
		.code = EX_UNAVAILABLE, .body = "",
		.reason = "edmd-jobs did not answer: it may have been done, or "
			  "not; systemctl status edmd-jobs",
	};

	share_give(&q->share);
	if (q->done && err < 0)
		q->done(q->arg, &late);
	else if (q->done)
		q->done(q->arg, &(struct service_answer) {
			.code = ack->code, .reason = ack->reason,
			.body = ack->body,
		});
	asking_free(q);
}

/* There is no edmd-jobs, nor a key of it: edmd itself can still end motion. */
static int ask_edmd(const struct service *a, const struct talk_question *q,
		    service_done_fn done, void *arg)
{
	struct talk_answer got;

	if (!talk_stop_is(q->verb) ||
	    talk_stop_ask(a->machine, q->verb, EDMD_S, &got) < 0)
		return -ENOTCONN;
	if (done)
		done(arg, &(struct service_answer) {
			.code = got.code, .reason = got.reason, .body = "",
		});
	talk_answer_free(&got);
	return 0;
}

int service_ask(struct service *a, const struct service_question *ask,
		service_done_fn done, void *arg)
{
	const struct talk_question q = {
		.verb = ask->verb, .job = ask->job, .text = ask->text,
		.arg = ask->arg,
	};
	struct asking *n;
	int err;

	if (!a->talk)
		return ask_edmd(a, &q, done, arg);
	n = calloc(1, sizeof(*n));
	if (!n)
		return -EAGAIN;
	*n = (struct asking) { .next = a->askings, .service = a, .done = done,
			       .arg = arg,
			       .share = { .kind = SHARE_QUESTION,
					  .end = on_taken, .arg = n } };
	err = share_take(a->shares, &n->share, ask->who);
	if (err) {
		free(n);
		return -EAGAIN;
	}
	n->next = a->askings;
	a->askings = n;
	err = talk_send(a->talk, &q, ask->flags & SERVICE_ONCE ? ONCE_S :
			GIVE_UP_S, on_answer, n);
	if (err)
		asking_free(n);
	return err ? -EAGAIN : 0;
}

static struct sending *room_to_send(struct service *a)
{
	for (int i = 0; i < SENDINGS; i++)
		if (!a->sending[i].job)
			return &a->sending[i];
	return NULL;
}

int service_send(struct service *a, const struct service_job *j,
		 service_done_fn done, void *arg)
{
	struct sending *s = room_to_send(a);
	struct submission_text x = { .id = j->id, .name = j->name, .text = "",
			      .bytes = j->bytes, .hold = j->hold,
			      .from_line = j->from_line,
			      .setting = j->setting };
	int err;

	if (!a->talk)
		return -ENOTCONN;
	if (!s)
		return -EAGAIN;
	if (j->bytes) {
		s->text = mmap(NULL, j->bytes, PROT_READ, MAP_PRIVATE, j->fd,
			       0);
		if (s->text == MAP_FAILED) {
			s->text = NULL;
			return -ENOMEM;
		}
		s->bytes = j->bytes;
		x.text = s->text;
	}
	err = submission_begin(&s->job, a->talk, &x);
	if (err) {
		s->job = NULL;
		free_sending(s);
		return err;
	}
	s->done = done;
	s->arg = arg;
	return 0;
}

static void go_on_sending(struct sending *s)
{
	const int r = s->job ? submission_step(s->job) : 0;
	struct service_answer answer = {
		.code = EX_UNAVAILABLE, .body = "",
		.reason = "edmd-jobs does not answer; the job was not sent",
	};

	if (r == 0)
		return;
	if (r > 0) {
		const struct talk_ack *ack = submission_verdict(s->job);

		answer = (struct service_answer) { .code = ack->code,
					       .reason = ack->reason,
					       .body = ack->body };
	}
	if (s->done)
		s->done(s->arg, &answer);
	free_sending(s);
}

static void take_time(struct service_status *s, const struct talk_status *t)
{
	s->progress = t->progress;
	s->eta_s = t->eta_s;
	s->eta_min_s = t->eta_min_s;
	s->eta_max_s = t->eta_max_s;
	s->eta_factor = t->eta_factor;
	s->end_s = t->end_s;
	s->queue_s = t->queue_s;
	s->queue_end_s = t->queue_end_s;
	s->queue_untold = t->queue_untold;
	snprintf(s->eta_by, sizeof(s->eta_by), "%s", t->eta_by);
	snprintf(s->eta_condition, sizeof(s->eta_condition), "%s",
		 t->eta_condition);
}

static void take_status(struct service *a)
{
	struct service_status *s = &a->status;
	uint64_t count;
	const struct talk_status *t = talk_status(a->talk, &count);

	if (t && count != a->heard) {
		a->heard = count;
		a->heard_s = talk_now_s();
		snprintf(s->job, sizeof(s->job), "%s", t->job);
		snprintf(s->job_name, sizeof(s->job_name), "%s", t->job_name);
		snprintf(s->job_state, sizeof(s->job_state), "%s",
			 t->job_state);
		snprintf(s->store, sizeof(s->store), "%s", t->store);
		snprintf(s->interrupted, sizeof(s->interrupted), "%s",
			 t->interrupted);
		snprintf(s->lost, sizeof(s->lost), "%s", t->lost);
		snprintf(s->asks, sizeof(s->asks), "%s", t->asks);
		snprintf(s->faults, sizeof(s->faults), "%s", t->faults);
		s->hunts = t->hunts;
		s->lines = t->lines;
		s->electrode = t->electrode;
		snprintf(s->work, sizeof(s->work), "%s", t->work);
		s->work_turn_deg = t->work_turn_deg;
		s->pass = t->wire_pass;
		s->passes = t->wire_passes;
		s->wire_offset_mm = t->wire_offset_mm;
		memcpy(s->work_mm, t->work_mm, sizeof(s->work_mm));
		s->lean_deg = t->lean_deg;
		s->queue_len = t->queue_len;
		take_time(s, t);
	}
	s->heard = a->heard && talk_now_s() - a->heard_s < HEARD_S;
}

void service_look(struct service *a)
{
	if (!a->talk) {
		if (talk_now_s() - a->tried_s > OPEN_S)
			try_open(a);
		return;
	}
	talk_step(a->talk);
	for (int i = 0; i < SENDINGS; i++)
		go_on_sending(&a->sending[i]);
	take_status(a);
	/* If the keys were made anew, read them again. */
	if (!a->status.heard && talk_why(a->talk)[0] && !a->askings &&
	    talk_now_s() - a->tried_s > OPEN_S) {
		for (int i = 0; i < SENDINGS; i++)
			if (a->sending[i].job)
				return;
		talk_close(a->talk);
		a->talk = NULL;
		try_open(a);
	}
}

void service_forget(struct service *a, void *arg)
{
	for (struct asking *q = a->askings; q; q = q->next)
		if (q->arg == arg)
			q->done = NULL;
	/* The text of the job belongs to the caller, who is gone; so the
	 * sending ends here. */
	for (int i = 0; i < SENDINGS; i++)
		if (a->sending[i].job && a->sending[i].arg == arg)
			free_sending(&a->sending[i]);
}

const struct service_status *service_status(const struct service *a)
{
	return &a->status;
}
