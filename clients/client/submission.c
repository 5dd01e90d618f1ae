/* SPDX-License-Identifier: Apache-2.0 */
/*
 * submission.c - sends the chunks of a job, and repeats them until they are
 * answered
 */
#include "submission.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WINDOW		6		/* so that they fit a socket's default
					 * buffer */
#define REPEAT_S	0.3
#define REMIND_S	1.0
#define SILENT_S	10.0		/* by then the service was started
					 * again */
#define STORE_S		15.0		/* it may be writing 64 MiB to a busy
					 * disk */
#define COMPILE_S	120.0		/* compiling 64 MiB of text takes its
					 * time */

struct submission {
	struct talk *talk;
	struct submission_text text;
	char id[SUBMISSION_ID_MAX], name[SUBMISSION_ID_MAX];
	uint8_t sha256[32];
	int chunks, acked;
	int64_t seq0;			/* of chunk 0; the others follow */
	double *sent_s;			/* when it was sent; 0: not yet, < 0:
					 * acked */
	int first;			/* all chunks before it are acked */
	int64_t boot;			/* of the service they were sent to */
	bool out;			/* the last one was sent */
	double silent_s, heard_s, whole_s, reminded_s;
	struct talk_ack verdict;
	char *reason, *body;
	bool over;
};

static void on_ack(void *arg, const struct talk_ack *a)
{
	struct submission *j = arg;
	int64_t i = a->seq - j->seq0;

	if (i < 0 || i >= j->chunks || j->over)
		return;
	j->heard_s = talk_now_s();
	if (j->sent_s[i] >= 0 && a->code == 0) {
		j->sent_s[i] = -1;
		j->acked++;
	}
	if (a->code == 0 && !*a->body)
		return;
	j->over = true;
	j->reason = strdup(a->reason);
	j->body = strdup(a->body);
	j->verdict = (struct talk_ack) {
		.seq = a->seq, .code = a->code, .reason = j->reason,
		.body = j->body,
	};
}

static bool send_chunk(struct submission *j, int i)
{
	size_t at = (size_t)i * TALK_CHUNK_MAX;
	size_t left = j->text.bytes - at;
	struct talk_chunk c = {
		.seq = j->seq0 + i, .job = j->id, .name = j->name,
		.bytes = (int64_t)j->text.bytes, .sha256 = j->sha256,
		.chunk = i, .chunks = j->chunks, .offset = (int64_t)at,
		.hold = j->text.hold, .from_line = j->text.from_line,
		.from_mm = j->text.from_mm, .electrode = j->text.electrode,
		.setting = j->text.setting, .data = j->text.text + at,
		.size = left < TALK_CHUNK_MAX ? (int)left : TALK_CHUNK_MAX,
	};

	if (!talk_send_chunk(j->talk, &c))
		return false;
	j->out |= i == j->chunks - 1;
	return true;
}

/* Send all chunks of the window that are not acked; it has WINDOW chunks from
 * the first such chunk on. */
static void send_window(struct submission *j, double now_s)
{
	while (j->first < j->chunks && j->sent_s[j->first] < 0)
		j->first++;
	for (int i = j->first; i < j->chunks && i < j->first + WINDOW; i++) {
		if (j->sent_s[i] < 0 || now_s - j->sent_s[i] < REPEAT_S)
			continue;
		if (!send_chunk(j, i))
			return;
		j->sent_s[i] = now_s;
	}
}

/* One that was started anew has not heard of any chunk. */
static void look_for_new_start(struct submission *j)
{
	const int64_t boot = talk_boot(j->talk);

	if (!boot || boot == j->boot)
		return;
	j->boot = boot;
	memset(j->sent_s, 0, (size_t)j->chunks * sizeof(*j->sent_s));
	j->acked = j->first = 0;
	j->whole_s = 0;
}

/* All chunks have arrived.  Ask what happened to the job, in case the answer
 * was lost. */
static void send_reminder(struct submission *j, double now_s)
{
	if (j->whole_s == 0)
		j->whole_s = j->reminded_s = now_s;
	if (now_s - j->reminded_s < REMIND_S)
		return;
	j->reminded_s = now_s;
	send_chunk(j, 0);
}

/* While it writes a job, the service does not listen. */
static bool waited_enough(const struct submission *j, double now_s)
{
	const double silent_s = now_s - j->heard_s;

	if (j->whole_s == 0)
		return silent_s > j->silent_s;
	return (silent_s > j->silent_s && silent_s > STORE_S) ||
	       now_s - j->whole_s > COMPILE_S;
}

int submission_step(struct submission *j)
{
	double now_s = talk_now_s();

	if (j->over)
		return 1;
	if (waited_enough(j, now_s))
		return -ETIMEDOUT;
	look_for_new_start(j);
	if (j->acked < j->chunks)
		send_window(j, now_s);
	else
		send_reminder(j, now_s);
	return 0;
}

/* Shorten it to the length of a name, but not in the middle of a character. */
static void name_take(struct submission *j, const char *name)
{
	size_t n;

	snprintf(j->name, sizeof(j->name), "%s", name);
	n = strlen(j->name);
	if (n == strlen(name))
		return;
	while (n > 0 && ((unsigned char)name[n] & 0xc0) == 0x80)
		j->name[--n] = '\0';
}

static void id_take(struct submission *j, const char *id)
{
	uint8_t drawn[6];

	if (id) {
		snprintf(j->id, sizeof(j->id), "%s", id);
		return;
	}
	randombytes_buf(drawn, sizeof(drawn));
	sodium_bin2hex(j->id, sizeof(j->id), drawn, sizeof(drawn));
}

int submission_begin(struct submission **ret, struct talk *t,
		     const struct submission_text *x)
{
	struct submission *j;
	int err;

	if (x->bytes > SUBMISSION_BYTES_MAX)
		return -EFBIG;
	j = calloc(1, sizeof(*j));
	if (!j)
		return -ENOMEM;
	j->talk = t;
	j->text = *x;
	name_take(j, x->name);
	id_take(j, x->id);
	crypto_hash_sha256(j->sha256, (const unsigned char *)x->text,
			   x->bytes);
	j->chunks = x->bytes ? (int)((x->bytes + TALK_CHUNK_MAX - 1) /
				     TALK_CHUNK_MAX) : 1;
	j->sent_s = calloc((size_t)j->chunks, sizeof(*j->sent_s));
	j->seq0 = talk_numbers(t, j->chunks);
	j->heard_s = talk_now_s();
	j->silent_s = x->silent_s > 0 ? x->silent_s : SILENT_S;
	err = j->sent_s ? talk_on_acks(t, j->seq0, j->chunks, on_ack, j) :
			  -ENOMEM;
	if (err < 0) {
		submission_end(j);
		return err;
	}
	*ret = j;
	return 0;
}

const struct talk_ack *submission_verdict(const struct submission *j)
{
	return &j->verdict;
}

const char *submission_id(const struct submission *j)
{
	return j->id;
}

const char *submission_name(const struct submission *j)
{
	return j->name;
}

int submission_progress(const struct submission *j, int *ret_arrived)
{
	*ret_arrived = j->acked;
	return j->chunks;
}

bool submission_is_out(const struct submission *j)
{
	return j->out;
}

void submission_end(struct submission *j)
{
	if (!j)
		return;
	talk_off_acks(j->talk, j->seq0);
	free(j->sent_s);
	free(j->reason);
	free(j->body);
	free(j);
}
