/* SPDX-License-Identifier: Apache-2.0 */
/*
 * packet.c - converts our structs to LCM's generated messages and back
 *
 * A message is decoded only after its signature was found to be the machine's.
 */
#include "packet.h"

#include "clocks.h"
#include "plain.h"

#include "edm_ack_t.h"
#include "edm_command_t.h"
#include "edm_event_t.h"
#include "edm_job_chunk_t.h"
#include "edm_status_t.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

/* LCM declares strings as char *, but only reads them. */
static char *lent(const char *s)
{
	return (char *)(uintptr_t)(s ? s : "");
}

/* Encode message @m of @type into new memory. */
#define ENCODE(type, m, ret_bytes) \
	__extension__ ({ \
		const int room_ = type ## _encoded_size(m); \
		uint8_t *to_ = malloc((size_t)room_); \
		const int n_ = to_ ? type ## _encode(to_, 0, room_, m) : -1; \
		if (n_ < 0) { \
			free(to_); \
			to_ = NULL; \
		} \
		*(ret_bytes) = to_ ? (size_t)n_ : 0; \
		to_; \
	})

uint8_t *packet_command(const struct packet_from *f,
			const struct talk_question *q, size_t *ret_bytes)
{
	edm_command_t m = {
		.utime = clock_us(CLOCK_REALTIME),
		.client = lent(f->client), .seq = f->seq,
		.verb = lent(q->verb), .job = lent(q->job), .arg = q->arg,
		.text = lent(q->text),
	};

	return ENCODE(edm_command_t, &m, ret_bytes);
}

uint8_t *packet_chunk(const struct packet_from *f, const struct talk_chunk *c,
		      size_t *ret_bytes)
{
	edm_job_chunk_t m = {
		.utime = clock_us(CLOCK_REALTIME),
		.client = lent(f->client), .seq = f->seq,
		.job = lent(c->job), .name = lent(c->name),
		.bytes = c->bytes, .chunk = c->chunk, .chunks = c->chunks,
		.offset = c->offset, .hold = c->hold,
		.electrode = c->electrode,
		.from_line = c->from_line, .from_mm = c->from_mm,
		.setting = lent(c->setting ? c->setting : ""),
		.size = c->size, .data = (uint8_t *)(uintptr_t)c->data,
	};

	memcpy(m.sha256, c->sha256, sizeof(m.sha256));
	return ENCODE(edm_job_chunk_t, &m, ret_bytes);
}

static void clean(char *text)
{
	plain_copy(text, strlen(text) + 1, text);
}

bool packet_ack(const struct seal *s, packet_ack_fn fn, void *arg)
{
	edm_ack_t m;

	if (edm_ack_t_decode(s->data, 0, (int)s->size, &m) < 0)
		return false;
	clean(m.reason);
	fn(arg, s, m.key, m.client, &(struct talk_ack) {
		.seq = m.seq, .code = m.code, .reason = m.reason,
		.body = m.body,
	});
	edm_ack_t_decode_cleanup(&m);
	return true;
}

static void word(char to[TALK_WORD_MAX], const char *from)
{
	plain_copy(to, TALK_WORD_MAX, from);
}

static void text(char to[TALK_TEXT_MAX], const char *from)
{
	plain_copy(to, TALK_TEXT_MAX, from);
}

#define TAKE_WORD(name)		word(s->name, m->name);
#define TAKE_TEXT(name)		text(s->name, m->name);
#define TAKE_NUMBER(name)	s->name = m->name;

static void status_take(struct talk_status *s, const edm_status_t *m)
{
	STATUS_FIELDS(TAKE_WORD, TAKE_TEXT, TAKE_NUMBER, TAKE_NUMBER)
	word(s->machine, m->machine);
	text(s->faults, m->faults);
	memcpy(s->pos_mm, m->pos_mm, sizeof(s->pos_mm));
	memcpy(s->work_mm, m->work_mm, sizeof(s->work_mm));
	s->utime = m->utime;
	s->contour_mm = m->contour_mm;
	s->contour_predicted_mm = m->contour_predicted_mm;
}

bool packet_status(const struct seal *s, struct talk_status *ret)
{
	edm_status_t m;

	if (edm_status_t_decode(s->data, 0, (int)s->size, &m) < 0)
		return false;
	status_take(ret, &m);
	edm_status_t_decode_cleanup(&m);
	return true;
}

bool packet_event(const struct seal *s,
		  void (*fn)(void *arg, const struct talk_event *e), void *arg)
{
	edm_event_t m;

	if (edm_event_t_decode(s->data, 0, (int)s->size, &m) < 0)
		return false;
	clean(m.kind);
	clean(m.job);
	clean(m.outcome);
	clean(m.text);
	if (fn)
		fn(arg, &(struct talk_event) {
			.utime = m.utime, .kind = m.kind, .job = m.job,
			.outcome = m.outcome, .text = m.text,
			.place_mm = m.place_mm,
		});
	edm_event_t_decode_cleanup(&m);
	return true;
}
