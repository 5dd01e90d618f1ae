/* SPDX-License-Identifier: Apache-2.0 */
/*
 * lcm.c - generated LCM messages to our structs and back
 */
#include "lcm.h"

#include "edm_ack_t.h"
#include "edm_command_t.h"
#include "edm_event_t.h"
#include "edm_job_chunk_t.h"
#include "edm_status_t.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#define CHANNEL_MAX	64
#define QUEUE_MESSAGES	256		/* LCM's default, 30, is one window */

struct jobs_lcm {
	lcm_t *lcm;
	char machine[32];
	struct jobs_lcm_handlers handlers;
	uint64_t refused;
};

static int64_t now_us(void)
{
	struct timespec t;

	clock_gettime(CLOCK_REALTIME, &t);
	return (int64_t)t.tv_sec * 1000000 + t.tv_nsec / 1000;
}

/* LCM strings are char *, though it only reads them. */
static char *lent(const char *s)
{
	return (char *)(uintptr_t)(s ? s : "");
}

/*
 * The generated decoder trusts every length it reads: a negative one is
 * copied as a huge one, and a string need not end.  So each packet is walked
 * along its type's shape first:
 *
 *	q 8 bytes, i 4 bytes, b 1 byte, H 32 bytes, s string,
 *	a as many bytes as the i before it says
 */
static bool shape_step(char what, const uint8_t **at, size_t *left,
		       uint32_t *count)
{
	size_t n;

	switch (what) {
	case 'q':
		n = 8;
		break;
	case 'b':
		n = 1;
		break;
	case 'H':
		n = 32;
		break;
	case 'a':
		n = *count;
		break;
	default:			/* i, s: four bytes, big-endian */
		if (*left < 4)
			return false;
		*count = (uint32_t)(*at)[0] << 24 | (uint32_t)(*at)[1] << 16 |
			 (uint32_t)(*at)[2] << 8 | (*at)[3];
		n = what == 's' ? 4 + (size_t)*count : 4;
		break;
	}
	if (n > *left)
		return false;
	if (what == 's' && (*count == 0 || memchr(*at + 4, '\0', *count) !=
			    *at + n - 1))
		return false;
	*at += n;
	*left -= n;
	return true;
}

/* @ret_count: what the last i or s said. */
static bool shape_fits(const lcm_recv_buf_t *buf, const char *shape,
		       uint32_t *ret_count)
{
	const uint8_t *at = buf->data;
	size_t left = buf->data_size;

	for (; *shape; shape++)
		if (!shape_step(*shape, &at, &left, ret_count))
			return false;
	return left == 0;
}

/* The first q of a shape is the type's fingerprint. */
#define SHAPE_COMMAND	"qqsqssqs"
#define SHAPE_CHUNK	"qqsqssqHiiqbia"

static void on_command(const lcm_recv_buf_t *buf, const char *channel,
		       void *arg)
{
	struct jobs_lcm *w = arg;
	edm_command_t m;
	struct jobs_lcm_command c;
	uint32_t count = 0;

	(void)channel;
	if (!shape_fits(buf, SHAPE_COMMAND, &count) ||
	    edm_command_t_decode(buf->data, 0, (int)buf->data_size, &m) < 0) {
		w->refused++;
		return;
	}
	c = (struct jobs_lcm_command) {
		.client = m.client, .seq = m.seq, .verb = m.verb,
		.job = m.job, .text = m.text, .arg = m.arg,
	};
	w->handlers.command(w->handlers.arg, &c);
	edm_command_t_decode_cleanup(&m);
}

/*
 * The generated decoder copies no bytes to NULL, which C does not allow: a
 * chunk without data, as of an empty file, is decoded as one with a byte.
 */
static int chunk_decode(const lcm_recv_buf_t *buf, uint32_t size,
			edm_job_chunk_t *ret)
{
	uint32_t n = buf->data_size;
	uint8_t *padded;
	int got;

	if (size > 0)
		return edm_job_chunk_t_decode(buf->data, 0, (int)n, ret);
	padded = calloc(n + 1, 1);
	if (!padded)
		return -1;
	/* size is what the packet ends with, big-endian. */
	memcpy(padded, buf->data, n);
	padded[n - 1] = 1;
	got = edm_job_chunk_t_decode(padded, 0, (int)n + 1, ret);
	free(padded);
	if (got >= 0)
		ret->size = 0;
	return got;
}

static void on_chunk(const lcm_recv_buf_t *buf, const char *channel, void *arg)
{
	struct jobs_lcm *w = arg;
	edm_job_chunk_t m;
	struct jobs_lcm_chunk c;
	uint32_t size = 0;

	(void)channel;
	if (!shape_fits(buf, SHAPE_CHUNK, &size) ||
	    chunk_decode(buf, size, &m) < 0) {
		w->refused++;
		return;
	}
	c = (struct jobs_lcm_chunk) {
		.client = m.client, .seq = m.seq, .job = m.job, .name = m.name,
		.bytes = m.bytes, .sha256 = m.sha256, .chunk = m.chunk,
		.chunks = m.chunks, .offset = m.offset, .hold = m.hold != 0,
		.size = (uint32_t)m.size, .data = m.data,
	};
	w->handlers.chunk(w->handlers.arg, &c);
	edm_job_chunk_t_decode_cleanup(&m);
}

const char *jobs_lcm_url_check(const char *url)
{
	const char *at = url;

	if (strncmp(url, "memq://", 7) == 0)
		return NULL;
	if (strncmp(url, "udpm://", 7) != 0)
		return "not a udpm:// URL";
	while ((at = strstr(at, "ttl")) != NULL) {
		at += 3;
		if (at[0] != '=' || at[1] != '0' || !strchr("&,", at[2]))
			return "its ttl is not 0";
	}
	return NULL;
}

static void channel_name(const struct jobs_lcm *w, const char *name,
			 char ret[CHANNEL_MAX])
{
	snprintf(ret, CHANNEL_MAX, "EDM.%s.%s", w->machine, name);
}

/* A channel to subscribe to is a pattern to LCM: the dots are meant. */
static int subscribe(struct jobs_lcm *w, const char *name,
		     lcm_msg_handler_t handler)
{
	char pattern[CHANNEL_MAX + 4];
	lcm_subscription_t *s;

	snprintf(pattern, sizeof(pattern), "EDM\\.%s\\.%s", w->machine, name);
	s = lcm_subscribe(w->lcm, pattern, handler, w);
	if (!s)
		return -ENETUNREACH;
	lcm_subscription_set_queue_capacity(s, QUEUE_MESSAGES);
	return 0;
}

int jobs_lcm_open(struct jobs_lcm **ret, const char *url, const char *machine,
		  const struct jobs_lcm_handlers *h)
{
	struct jobs_lcm *w = calloc(1, sizeof(*w));

	if (!w)
		return -ENOMEM;
	snprintf(w->machine, sizeof(w->machine), "%s", machine);
	w->handlers = *h;
	w->lcm = lcm_create(url);
	if (!w->lcm || subscribe(w, "COMMAND", on_command) < 0 ||
	    subscribe(w, "JOB", on_chunk) < 0) {
		jobs_lcm_close(w);
		return -ENETUNREACH;
	}
	*ret = w;
	return 0;
}

void jobs_lcm_close(struct jobs_lcm *w)
{
	if (!w)
		return;
	if (w->lcm)
		lcm_destroy(w->lcm);
	free(w);
}

int jobs_lcm_fd(const struct jobs_lcm *w)
{
	return lcm_get_fileno(w->lcm);
}

int jobs_lcm_handle(struct jobs_lcm *w)
{
	return lcm_handle(w->lcm) < 0 ? -EIO : 0;
}

void jobs_lcm_ack(struct jobs_lcm *w, const struct jobs_lcm_ack *a)
{
	char channel[CHANNEL_MAX];
	edm_ack_t m = {
		.utime = now_us(),
		.client = lent(a->client),
		.seq = a->seq,
		.code = a->code,
		.reason = lent(a->reason),
		.body = lent(a->body),
	};

	channel_name(w, "ACK", channel);
	edm_ack_t_publish(w->lcm, channel, &m);
}

void jobs_lcm_event(struct jobs_lcm *w, const struct jobs_lcm_event *e)
{
	char channel[CHANNEL_MAX];
	edm_event_t m = {
		.utime = now_us(),
		.machine = w->machine,
		.kind = lent(e->kind),
		.job = lent(e->job),
		.outcome = lent(e->outcome),
		.place_mm = e->place_mm,
		.text = lent(e->text),
	};

	channel_name(w, "EVENT", channel);
	edm_event_t_publish(w->lcm, channel, &m);
}

void jobs_lcm_status(struct jobs_lcm *w, const struct jobs_lcm_status *s)
{
	char channel[CHANNEL_MAX];
	edm_status_t m = {
		.utime = now_us(),
		.machine = w->machine,
		.daemon = lent(s->daemon),
		.state = lent(s->state),
		.fault = lent(s->fault),
		.job = lent(s->job),
		.job_name = lent(s->job_name),
		.job_state = lent(s->job_state),
		.line = (int32_t)s->line,
		.lines = (int32_t)s->lines,
		.place_mm = s->place_mm,
		.length_mm = s->length_mm,
		.progress = s->progress,
		.gap_v = s->gap_v,
		.feed_mm_s = s->feed_mm_s,
		.depth_mm = s->depth_mm,
		.contour_mm = s->contour_mm,
		.contour_predicted_mm = s->contour_predicted_mm,
		.jumps = (int32_t)s->jumps,
		.retracts = (int32_t)s->retracts,
		.shorts = (int32_t)s->shorts,
		.job_s = s->job_s,
		.eta_s = s->eta_s,
		.queue_len = (int32_t)s->queue_len,
		.overruns = (int32_t)s->overruns,
		.wake_late_max_us = (int32_t)s->wake_late_max_us,
		.condition = lent(s->condition),
	};

	memcpy(m.pos_mm, s->pos_mm, sizeof(m.pos_mm));
	channel_name(w, "STATUS", channel);
	edm_status_t_publish(w->lcm, channel, &m);
}

uint64_t jobs_lcm_refused(const struct jobs_lcm *w)
{
	return w->refused;
}
