/* SPDX-License-Identifier: Apache-2.0 */
/*
 * talk.c - speak with edmd-jobs over LCM
 */
#include "talk.h"

#include "edm_ack_t.h"
#include "edm_command_t.h"
#include "edm_event_t.h"
#include "edm_job_chunk_t.h"
#include "edm_status_t.h"

#include <errno.h>
#include <signal.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define CHANNEL_MAX	64
#define QUEUE_MESSAGES	256
#define REPEAT_S	0.3

struct talk {
	lcm_t *lcm;
	edm_ack_t_subscription_t *acks;
	edm_status_t_subscription_t *statuses;
	edm_event_t_subscription_t *events;
	char machine[32];
	char client[TALK_WORD_MAX];
	int64_t seq;
	struct talk_status status;
	uint64_t nstatus, nevents;
	void (*on_ack)(void *arg, const struct talk_ack *a);
	void *on_ack_arg;
	int64_t asked;			/* seq of the question; 0 none */
	struct talk_answer *answer;
};

static volatile sig_atomic_t interrupted;

static void on_signal(int number)
{
	(void)number;
	interrupted = 1;
}

void talk_catch_signals(void)
{
	struct sigaction sa = { .sa_handler = on_signal };

	sigaction(SIGINT, &sa, NULL);
	sigaction(SIGTERM, &sa, NULL);
}

bool talk_interrupted(void)
{
	return interrupted;
}

double talk_now_s(void)
{
	struct timespec t;

	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

static int64_t utime(void)
{
	struct timespec t;

	clock_gettime(CLOCK_REALTIME, &t);
	return (int64_t)t.tv_sec * 1000000 + t.tv_nsec / 1000;
}

static void copy_word(char to[TALK_WORD_MAX], const char *from)
{
	snprintf(to, TALK_WORD_MAX, "%s", from);
}

static void on_status(const lcm_recv_buf_t *buf, const char *channel,
		      const edm_status_t *m, void *arg)
{
	struct talk *t = arg;
	struct talk_status *s = &t->status;

	(void)buf, (void)channel;
	copy_word(s->machine, m->machine);
	copy_word(s->daemon, m->daemon);
	copy_word(s->state, m->state);
	copy_word(s->fault, m->fault);
	copy_word(s->job, m->job);
	copy_word(s->job_name, m->job_name);
	copy_word(s->job_state, m->job_state);
	copy_word(s->condition, m->condition);
	memcpy(s->pos_mm, m->pos_mm, sizeof(s->pos_mm));
	s->utime = m->utime;
	s->line = m->line;
	s->lines = m->lines;
	s->place_mm = m->place_mm;
	s->length_mm = m->length_mm;
	s->progress = m->progress;
	s->gap_v = m->gap_v;
	s->feed_mm_s = m->feed_mm_s;
	s->depth_mm = m->depth_mm;
	s->contour_mm = m->contour_mm;
	s->contour_predicted_mm = m->contour_predicted_mm;
	s->jumps = m->jumps;
	s->retracts = m->retracts;
	s->shorts = m->shorts;
	s->job_s = m->job_s;
	s->eta_s = m->eta_s;
	s->queue_len = m->queue_len;
	s->overruns = m->overruns;
	s->wake_late_max_us = m->wake_late_max_us;
	t->nstatus++;
}

static void on_event(const lcm_recv_buf_t *buf, const char *channel,
		     const edm_event_t *m, void *arg)
{
	struct talk *t = arg;

	(void)buf, (void)channel, (void)m;
	t->nevents++;
}

static void on_ack(const lcm_recv_buf_t *buf, const char *channel,
		   const edm_ack_t *m, void *arg)
{
	struct talk *t = arg;

	(void)buf, (void)channel;
	if (strcmp(m->client, t->client) != 0)
		return;
	if (t->asked && m->seq == t->asked) {
		t->answer->code = m->code;
		t->answer->reason = strdup(m->reason);
		t->answer->body = strdup(m->body);
		t->asked = 0;
	} else if (t->on_ack) {
		t->on_ack(t->on_ack_arg, &(struct talk_ack) {
			.seq = m->seq, .code = m->code, .reason = m->reason,
			.body = m->body,
		});
	}
}

static void channel_name(const struct talk *t, const char *name,
			 char ret[CHANNEL_MAX])
{
	snprintf(ret, CHANNEL_MAX, "EDM.%s.%s", t->machine, name);
}

/* A channel to subscribe to is a pattern to LCM: the dots are meant. */
static void pattern(const struct talk *t, const char *name,
		    char ret[CHANNEL_MAX])
{
	snprintf(ret, CHANNEL_MAX, "EDM\\.%s\\.%s", t->machine, name);
}

static int subscribe(struct talk *t)
{
	char channel[CHANNEL_MAX];

	pattern(t, "ACK", channel);
	t->acks = edm_ack_t_subscribe(t->lcm, channel, on_ack, t);
	if (!t->acks)
		return -ENETUNREACH;
	edm_ack_t_subscription_set_queue_capacity(t->acks, QUEUE_MESSAGES);
	pattern(t, "STATUS", channel);
	t->statuses = edm_status_t_subscribe(t->lcm, channel, on_status, t);
	pattern(t, "EVENT", channel);
	t->events = edm_event_t_subscribe(t->lcm, channel, on_event, t);
	return t->statuses && t->events ? 0 : -ENETUNREACH;
}

static void unsubscribe(struct talk *t)
{
	if (t->acks)
		edm_ack_t_unsubscribe(t->lcm, t->acks);
	if (t->statuses)
		edm_status_t_unsubscribe(t->lcm, t->statuses);
	if (t->events)
		edm_event_t_unsubscribe(t->lcm, t->events);
}

int talk_open(struct talk **ret, const char *url, const char *machine)
{
	struct talk *t = calloc(1, sizeof(*t));

	if (!t)
		return -ENOMEM;
	snprintf(t->machine, sizeof(t->machine), "%s", machine);
	snprintf(t->client, sizeof(t->client), "edmctl-%d-%08x", (int)getpid(),
		 randombytes_random());
	t->lcm = lcm_create(url);
	if (!t->lcm || subscribe(t) < 0) {
		talk_close(t);
		return -ENETUNREACH;
	}
	*ret = t;
	return 0;
}

void talk_close(struct talk *t)
{
	if (!t)
		return;
	unsubscribe(t);
	if (t->lcm)
		lcm_destroy(t->lcm);
	free(t);
}

void talk_wait(struct talk *t, int ms)
{
	/* What else is there comes along, without waiting. */
	while (!interrupted && lcm_handle_timeout(t->lcm, ms) > 0)
		ms = 0;
}

int64_t talk_number(struct talk *t)
{
	return ++t->seq;
}

static void ask_once(struct talk *t, const struct talk_question *q)
{
	char channel[CHANNEL_MAX];
	edm_command_t m = {
		.utime = utime(), .client = t->client, .seq = t->asked,
		.verb = (char *)(uintptr_t)q->verb,
		.job = (char *)(uintptr_t)(q->job ? q->job : ""),
		.arg = q->arg,
		.text = (char *)(uintptr_t)(q->text ? q->text : ""),
	};

	channel_name(t, "COMMAND", channel);
	edm_command_t_publish(t->lcm, channel, &m);
}

int talk_ask(struct talk *t, const struct talk_question *q, double timeout_s,
	     struct talk_answer *ret)
{
	double begun_s = talk_now_s(), sent_s = 0;

	t->asked = talk_number(t);
	t->answer = ret;
	while (t->asked) {
		double now_s = talk_now_s();

		if (interrupted || now_s - begun_s > timeout_s) {
			t->asked = 0;
			return interrupted ? -EINTR : -ETIMEDOUT;
		}
		if (now_s - sent_s > REPEAT_S) {
			ask_once(t, q);
			sent_s = now_s;
		}
		talk_wait(t, 50);
	}
	return 0;
}

void talk_answer_free(struct talk_answer *a)
{
	free(a->reason);
	free(a->body);
	*a = (struct talk_answer) { .code = 0 };
}

const struct talk_status *talk_status(const struct talk *t,
				      uint64_t *ret_count)
{
	*ret_count = t->nstatus;
	return t->nstatus ? &t->status : NULL;
}

uint64_t talk_events(const struct talk *t)
{
	return t->nevents;
}

void talk_on_ack(struct talk *t,
		 void (*fn)(void *arg, const struct talk_ack *a), void *arg)
{
	t->on_ack = fn;
	t->on_ack_arg = arg;
}

void talk_send_chunk(struct talk *t, const struct talk_chunk *c)
{
	char channel[CHANNEL_MAX];
	edm_job_chunk_t m = {
		.utime = utime(), .client = t->client, .seq = c->seq,
		.job = (char *)(uintptr_t)c->job,
		.name = (char *)(uintptr_t)c->name,
		.bytes = c->bytes, .chunk = c->chunk, .chunks = c->chunks,
		.offset = c->offset, .hold = c->hold, .size = c->size,
		.data = (uint8_t *)(uintptr_t)c->data,
	};

	memcpy(m.sha256, c->sha256, sizeof(m.sha256));
	channel_name(t, "JOB", channel);
	edm_job_chunk_t_publish(t->lcm, channel, &m);
}
