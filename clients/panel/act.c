/* SPDX-License-Identifier: Apache-2.0 */
/*
 * act.c - ask edmd-jobs, and send it jobs, without waiting
 */
#include "act.h"

#include "edm_ack_t.h"
#include "edm_command_t.h"
#include "edm_event_t.h"
#include "edm_job_chunk_t.h"
#include "edm_status_t.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <time.h>
#include <unistd.h>

#define CHANNEL_MAX	64
#define QUESTIONS	64		/* under way at once */
#define SENDINGS	2
#define REPEAT_S	0.3
#define GIVE_UP_S	6.0
#define HEARD_S		2.0
#define CHUNK_BYTES	32768
#define WINDOW		6		/* chunks on their way at once */
#define COMPILE_S	120.0		/* a text of 64 MiB takes its time */
#define SILENCE_S	8.0		/* without any answer to a chunk */

struct question {
	int64_t seq;			/* 0: free */
	char verb[24], job[ACT_WORD_MAX], text[ACT_WORD_MAX];
	double arg;
	unsigned int flags;
	double begun_s, sent_s;
	act_done_fn done;		/* NULL: forgotten */
	void *done_arg;
};

struct sending {
	bool busy;
	struct act_job job;
	char id[ACT_WORD_MAX], name[ACT_WORD_MAX];
	uint8_t sha256[32];
	int chunks, acked, first;
	int64_t seq0;			/* of chunk 0 */
	double *sent_s;			/* 0 not yet, < 0 answered */
	double heard_s, whole_s, asked_s;
	act_done_fn done;
	void *done_arg;
};

struct act {
	lcm_t *lcm;
	edm_ack_t_subscription_t *acks;
	edm_status_t_subscription_t *statuses;
	edm_event_t_subscription_t *events;
	char machine[32], client[ACT_WORD_MAX];
	int64_t seq;
	struct question question[QUESTIONS];
	struct sending sending[SENDINGS];
	struct act_status status;
	double status_s;
	act_event_fn on_event;
	void *on_event_arg;
};

static double now_s(void)
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

static void copy_word(char to[ACT_WORD_MAX], const char *from)
{
	snprintf(to, ACT_WORD_MAX, "%s", from ? from : "");
}

static void on_status(const lcm_recv_buf_t *buf, const char *channel,
		      const edm_status_t *m, void *arg)
{
	struct act *a = arg;
	struct act_status *s = &a->status;

	(void)buf, (void)channel;
	copy_word(s->job, m->job);
	copy_word(s->job_name, m->job_name);
	copy_word(s->job_state, m->job_state);
	s->lines = m->lines;
	s->queue_len = m->queue_len;
	s->left_s = m->left_s;
	a->status_s = now_s();
}

static void on_event(const lcm_recv_buf_t *buf, const char *channel,
		     const edm_event_t *m, void *arg)
{
	struct act *a = arg;

	(void)buf, (void)channel;
	if (a->on_event)
		a->on_event(a->on_event_arg, m->kind, m->text);
}

static void end_question(struct question *q, const struct act_answer *answer)
{
	act_done_fn done = q->done;

	q->seq = 0;
	q->done = NULL;
	if (done)
		done(q->done_arg, answer);
}

static void end_sending(struct sending *s, const struct act_answer *answer)
{
	act_done_fn done = s->done;

	free(s->sent_s);
	s->sent_s = NULL;
	s->busy = false;
	s->done = NULL;
	if (done)
		done(s->done_arg, answer);
}

static void take_chunk_ack(struct sending *s, const edm_ack_t *m)
{
	const int64_t i = m->seq - s->seq0;

	if (!s->busy || i < 0 || i >= s->chunks)
		return;
	s->heard_s = now_s();
	if (s->sent_s[i] >= 0) {
		s->sent_s[i] = -1;
		s->acked++;
	}
	if (m->code || *m->body)
		end_sending(s, &(struct act_answer) {
			.code = m->code, .reason = m->reason, .body = m->body,
		});
}

static void on_ack(const lcm_recv_buf_t *buf, const char *channel,
		   const edm_ack_t *m, void *arg)
{
	struct act *a = arg;

	(void)buf, (void)channel;
	if (strcmp(m->client, a->client) != 0 || m->seq <= 0)
		return;
	for (int i = 0; i < QUESTIONS; i++) {
		if (a->question[i].seq != m->seq)
			continue;
		end_question(&a->question[i], &(struct act_answer) {
			.code = m->code, .reason = m->reason, .body = m->body,
		});
		return;
	}
	for (int i = 0; i < SENDINGS; i++)
		take_chunk_ack(&a->sending[i], m);
}

static void channel_name(const struct act *a, const char *name,
			 char ret[CHANNEL_MAX])
{
	snprintf(ret, CHANNEL_MAX, "EDM.%s.%s", a->machine, name);
}

/* A channel to subscribe to is a pattern to LCM: the dots are meant. */
static void pattern(const struct act *a, const char *name,
		    char ret[CHANNEL_MAX])
{
	snprintf(ret, CHANNEL_MAX, "EDM\\.%s\\.%s", a->machine, name);
}

static int subscribe(struct act *a)
{
	char channel[CHANNEL_MAX];

	pattern(a, "ACK", channel);
	a->acks = edm_ack_t_subscribe(a->lcm, channel, on_ack, a);
	pattern(a, "STATUS", channel);
	a->statuses = edm_status_t_subscribe(a->lcm, channel, on_status, a);
	pattern(a, "EVENT", channel);
	a->events = edm_event_t_subscribe(a->lcm, channel, on_event, a);
	if (!a->acks || !a->statuses || !a->events)
		return -ENETUNREACH;
	edm_ack_t_subscription_set_queue_capacity(a->acks, 256);
	return 0;
}

int act_open(struct act **ret, const char *url, const char *machine)
{
	struct act *a = calloc(1, sizeof(*a));

	if (!a)
		return -ENOMEM;
	snprintf(a->machine, sizeof(a->machine), "%s", machine);
	snprintf(a->client, sizeof(a->client), "panel-%d-%08x", (int)getpid(),
		 randombytes_random());
	a->status.left_s = -1;
	a->lcm = lcm_create(url);
	if (!a->lcm || subscribe(a) < 0) {
		act_close(a);
		return -ENETUNREACH;
	}
	*ret = a;
	return 0;
}

void act_close(struct act *a)
{
	if (!a)
		return;
	for (int i = 0; i < SENDINGS; i++)
		free(a->sending[i].sent_s);
	if (a->acks)
		edm_ack_t_unsubscribe(a->lcm, a->acks);
	if (a->statuses)
		edm_status_t_unsubscribe(a->lcm, a->statuses);
	if (a->events)
		edm_event_t_unsubscribe(a->lcm, a->events);
	if (a->lcm)
		lcm_destroy(a->lcm);
	free(a);
}

void act_on_event(struct act *a, act_event_fn fn, void *arg)
{
	a->on_event = fn;
	a->on_event_arg = arg;
}

static void publish_question(struct act *a, struct question *q)
{
	char channel[CHANNEL_MAX];
	edm_command_t m = {
		.utime = utime(), .client = a->client, .seq = q->seq,
		.verb = q->verb, .job = q->job, .arg = q->arg, .text = q->text,
	};

	channel_name(a, "COMMAND", channel);
	edm_command_t_publish(a->lcm, channel, &m);
	q->sent_s = now_s();
}

int act_ask(struct act *a, const struct act_question *ask, act_done_fn done,
	    void *arg)
{
	struct question *q = NULL;

	for (int i = 0; i < QUESTIONS && !q; i++)
		if (a->question[i].seq == 0)
			q = &a->question[i];
	if (!q)
		return -EBUSY;
	q->seq = ++a->seq;
	snprintf(q->verb, sizeof(q->verb), "%s", ask->verb);
	copy_word(q->job, ask->job);
	copy_word(q->text, ask->text);
	q->arg = ask->arg;
	q->flags = ask->flags;
	q->begun_s = now_s();
	q->done = done;
	q->done_arg = arg;
	publish_question(a, q);
	return 0;
}

static void repeat_question(struct act *a, struct question *q, double at_s)
{
	if (q->seq == 0)
		return;
	if (at_s - q->begun_s > GIVE_UP_S)
		end_question(q, &(struct act_answer) {
			.code = EX_UNAVAILABLE, .body = "",
			.reason = "edmd-jobs does not answer; systemctl "
				  "status edmd-jobs",
		});
	else if (!(q->flags & ACT_ONCE) && at_s - q->sent_s > REPEAT_S)
		publish_question(a, q);
}

static int hash_file(int fd, size_t bytes, uint8_t ret[32])
{
	crypto_hash_sha256_state h;
	uint8_t part[16384];
	size_t at = 0;

	crypto_hash_sha256_init(&h);
	while (at < bytes) {
		const ssize_t n = pread(fd, part, sizeof(part), (off_t)at);

		if (n <= 0)
			return -EIO;
		crypto_hash_sha256_update(&h, part, (size_t)n);
		at += (size_t)n;
	}
	crypto_hash_sha256_final(&h, ret);
	return 0;
}

static struct sending *free_sending(struct act *a)
{
	for (int i = 0; i < SENDINGS; i++)
		if (!a->sending[i].busy)
			return &a->sending[i];
	return NULL;
}

int act_send(struct act *a, const struct act_job *j, act_done_fn done,
	     void *arg)
{
	struct sending *s = free_sending(a);

	if (!s)
		return -EBUSY;
	*s = (struct sending) { .job = *j, .done = done, .done_arg = arg };
	if (hash_file(j->fd, j->bytes, s->sha256) < 0)
		return -EIO;
	s->chunks = j->bytes ? (int)((j->bytes + CHUNK_BYTES - 1) /
				     CHUNK_BYTES) : 1;
	s->sent_s = calloc((size_t)s->chunks, sizeof(*s->sent_s));
	if (!s->sent_s)
		return -ENOMEM;
	copy_word(s->id, j->id);
	copy_word(s->name, j->name);
	s->seq0 = a->seq + 1;
	a->seq += s->chunks;
	s->heard_s = now_s();
	s->busy = true;
	return 0;
}

static void publish_chunk(struct act *a, struct sending *s, int i)
{
	const off_t at = (off_t)i * CHUNK_BYTES;
	uint8_t data[CHUNK_BYTES];
	char channel[CHANNEL_MAX];
	edm_job_chunk_t m = {
		.utime = utime(), .client = a->client, .seq = s->seq0 + i,
		.job = s->id, .name = s->name,
		.bytes = (int64_t)s->job.bytes, .chunk = i,
		.chunks = s->chunks, .offset = at, .hold = s->job.hold,
		.data = data,
	};
	const ssize_t n = pread(s->job.fd, data, sizeof(data), at);

	m.size = n > 0 ? (int32_t)n : 0;
	memcpy(m.sha256, s->sha256, sizeof(m.sha256));
	channel_name(a, "JOB", channel);
	edm_job_chunk_t_publish(a->lcm, channel, &m);
}

static void send_window(struct act *a, struct sending *s, double at_s)
{
	while (s->first < s->chunks && s->sent_s[s->first] < 0)
		s->first++;
	for (int i = s->first; i < s->chunks && i < s->first + WINDOW; i++) {
		if (s->sent_s[i] < 0 || at_s - s->sent_s[i] < REPEAT_S)
			continue;
		publish_chunk(a, s, i);
		s->sent_s[i] = at_s;
	}
}

/* All chunks are there: ask again what became of them, should the answer have
 * been lost. */
static void send_reminder(struct act *a, struct sending *s, double at_s)
{
	if (s->whole_s == 0)
		s->whole_s = s->asked_s = at_s;
	if (at_s - s->asked_s < 1)
		return;
	s->asked_s = at_s;
	publish_chunk(a, s, 0);
}

static void go_on_sending(struct act *a, struct sending *s, double at_s)
{
	if (!s->busy)
		return;
	if (at_s - s->heard_s > SILENCE_S ||
	    (s->whole_s > 0 && at_s - s->whole_s > COMPILE_S)) {
		end_sending(s, &(struct act_answer) {
			.code = EX_UNAVAILABLE, .body = "",
			.reason = "edmd-jobs does not answer; the job was not "
				  "sent",
		});
		return;
	}
	if (s->acked < s->chunks)
		send_window(a, s, at_s);
	else
		send_reminder(a, s, at_s);
}

void act_look(struct act *a)
{
	double at_s;

	for (int i = 0; i < 256 && lcm_handle_timeout(a->lcm, 0) > 0; i++)
		;
	at_s = now_s();
	a->status.heard = a->status_s > 0 && at_s - a->status_s < HEARD_S;
	for (int i = 0; i < QUESTIONS; i++)
		repeat_question(a, &a->question[i], at_s);
	for (int i = 0; i < SENDINGS; i++)
		go_on_sending(a, &a->sending[i], at_s);
}

void act_forget(struct act *a, void *arg)
{
	for (int i = 0; i < QUESTIONS; i++)
		if (a->question[i].done_arg == arg)
			a->question[i].done = NULL;
	/* Its text goes with who sent it, so the sending ends here. */
	for (int i = 0; i < SENDINGS; i++) {
		struct sending *s = &a->sending[i];

		if (!s->busy || s->done_arg != arg)
			continue;
		s->done = NULL;
		end_sending(s, NULL);
	}
}

const struct act_status *act_status(const struct act *a)
{
	return &a->status;
}
