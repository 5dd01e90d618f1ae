/* SPDX-License-Identifier: Apache-2.0 */
/* upload.c - puts the text of a job together from chunks */
#include "upload.h"

#include "plain.h"
#include "store_text.h"

#include <math.h>
#include <pthread.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define ID_CHARS	"ABCDEFGHIJKLMNOPQRSTUVWXYZ" \
			"abcdefghijklmnopqrstuvwxyz0123456789._-"

static void refuse(struct upload_answer *a, int code, const char *reason)
{
	a->code = code;
	snprintf(a->reason, sizeof(a->reason), "%s", reason);
	a->body = NULL;
}

static bool name_is_plain(const char *name)
{
	const size_t n = strlen(name);

	return n > 0 && n < JOBS_LCM_ID_MAX && plain_is(name);
}

static bool place_is_inside(const struct jobs_lcm_chunk *c)
{
	return c->chunks >= 1 && c->chunks <= UPLOAD_CHUNKS_MAX &&
	       c->chunk >= 0 && c->chunk < c->chunks &&
	       c->size <= JOBS_LCM_CHUNK_MAX && c->offset >= 0 &&
	       c->offset <= c->bytes &&
	       (int64_t)c->size <= c->bytes - c->offset;
}

static bool begin_is_fit(const struct jobs_lcm_chunk *c)
{
	return c->from_line >= 0 && isfinite(c->from_mm) && c->from_mm >= 0 &&
	       !(c->from_line > 0 && c->from_mm > 0);
}

bool upload_check(const struct jobs_lcm_chunk *c, struct upload_answer *a)
{
	size_t client = strlen(c->client), id = strlen(c->job);

	if (client == 0 || client >= JOBS_LCM_CLIENT_MAX)
		refuse(a, EX_PROTOCOL, "the client's name is empty or too "
		       "long; 1 to 63 bytes");
	else if (id == 0 || id >= JOBS_LCM_ID_MAX ||
		 strspn(c->job, ID_CHARS) != id)
		refuse(a, EX_DATAERR, "this id of a job cannot be taken; 1 to "
		       "63 of A-Z a-z 0-9 . _ -");
	else if (!name_is_plain(c->name))
		refuse(a, EX_DATAERR, "this name of a job cannot be taken; 1 "
		       "to 63 bytes of UTF-8, without characters that "
		       "control a terminal or turn the direction of writing");
	else if (c->bytes < 0 || c->bytes > UPLOAD_BYTES_MAX)
		refuse(a, EX_DATAERR, "the job is too long; at most 64 MiB");
	else if (!begin_is_fit(c))
		refuse(a, EX_DATAERR,
		       "a job cannot begin at this place; a line from 1 "
		       "on, or mm along the path, not both");
	else if (c->electrode < 0 || c->electrode > 9999)
		refuse(a, EX_DATAERR, "no such electrode; 1 to 9999, or 0: the "
		       "one in the holder");
	else if (strlen(c->setting) >= INTERP_SETTING_MAX ||
		 !plain_is(c->setting))
		refuse(a, EX_DATAERR, "these settings cannot be taken; words "
		       "as taper=3, up to 191 bytes");
	else if (!place_is_inside(c))
		refuse(a, EX_PROTOCOL, "chunk outside its job; at most "
		       "32768 bytes, inside the size given");
	else
		return true;
	return false;
}

static bool upload_is(const struct upload *up, const struct jobs_lcm_chunk *c)
{
	return up->state != UPLOAD_FREE && strcmp(up->client, c->client) == 0 &&
	       memcmp(up->key, c->key, sizeof(up->key)) == 0 &&
	       strcmp(up->id, c->job) == 0;
}

static struct upload *upload_find(struct uploads *u,
				  const struct jobs_lcm_chunk *c)
{
	for (int i = 0; i < UPLOAD_SLOTS; i++)
		if (upload_is(&u->slot[i], c))
			return &u->slot[i];
	return NULL;
}

static const struct upload_verdict *verdict_find(const struct uploads *u,
						 const struct jobs_lcm_chunk *c)
{
	for (int i = 0; i < UPLOAD_VERDICTS; i++) {
		const struct upload_verdict *v = &u->verdict[i];

		if (v->reason && strcmp(v->client, c->client) == 0 &&
		    memcmp(v->key, c->key, sizeof(v->key)) == 0 &&
		    strcmp(v->id, c->job) == 0 && c->seq >= v->seq_min &&
		    c->seq <= v->seq_max)
			return v;
	}
	return NULL;
}

static void *free_main(void *text)
{
	free(text);
	return NULL;
}

/* To give 64 MiB back takes the kernel longer than all else that is done here,
 * so a thread waits for it. */
static void free_text(struct upload *up)
{
	pthread_t thread;

	if (up->bytes > STORE_TEXT_INSIDE &&
	    pthread_create(&thread, NULL, free_main, up->text) == 0)
		pthread_detach(thread);
	else
		free(up->text);
}

static void upload_clear(struct upload *up)
{
	free(up->seen);
	free_text(up);
	*up = (struct upload) { .state = UPLOAD_FREE };
}

static int uploads_of(const struct uploads *u, const struct jobs_lcm_chunk *c)
{
	int n = 0;

	for (int i = 0; i < UPLOAD_SLOTS; i++)
		n += u->slot[i].state != UPLOAD_FREE &&
		     strcmp(u->slot[i].client, c->client) == 0 &&
		     memcmp(u->slot[i].key, c->key, SEAL_KEY_BYTES) == 0;
	return n;
}

/* Take a free slot.  Otherwise take the one that has stood still the longest,
 * if that is long enough for its client to be gone.  So a client that begins
 * eight uploads and continues none does not lock the others out. */
static struct upload *upload_room(struct uploads *u, int64_t now_us)
{
	struct upload *oldest = NULL;

	for (int i = 0; i < UPLOAD_SLOTS; i++) {
		struct upload *up = &u->slot[i];

		if (up->state == UPLOAD_FREE)
			return up;
		if (up->state == UPLOAD_FILLING &&
		    now_us - up->last_us > UPLOAD_STALE_US &&
		    (!oldest || up->last_us < oldest->last_us))
			oldest = up;
	}
	if (oldest)
		upload_clear(oldest);
	return oldest;
}

static struct upload *upload_begin(struct uploads *u,
				   const struct jobs_lcm_chunk *c,
				   int64_t now_us, struct upload_answer *a)
{
	struct upload *up;

	if (uploads_of(u, c) >= UPLOADS_A_CLIENT) {
		refuse(a, EX_TEMPFAIL, "2 uploads of this client are under "
		       "way; try again when one is done");
		return NULL;
	}
	up = upload_room(u, now_us);
	if (!up) {
		refuse(a, EX_TEMPFAIL, "8 uploads are under way; try again "
		       "when one is done");
		return NULL;
	}
	up->seen = calloc(((size_t)c->chunks + 7) / 8, 1);
	up->text = calloc((size_t)c->bytes + 1, 1);
	if (!up->seen || !up->text) {
		upload_clear(up);
		refuse(a, EX_TEMPFAIL, "no memory for the job; try again");
		return NULL;
	}
	up->state = UPLOAD_FILLING;
	memcpy(up->key, c->key, sizeof(up->key));
	snprintf(up->client, sizeof(up->client), "%s", c->client);
	snprintf(up->id, sizeof(up->id), "%s", c->job);
	snprintf(up->name, sizeof(up->name), "%s", c->name);
	memcpy(up->sha256, c->sha256, sizeof(up->sha256));
	up->bytes = (size_t)c->bytes;
	up->chunks = (uint32_t)c->chunks;
	up->from_line = (uint32_t)c->from_line;
	up->from_mm = c->from_mm;
	up->electrode = (uint32_t)c->electrode;
	snprintf(up->setting, sizeof(up->setting), "%s", c->setting);
	/* An operator looks at the way in before it moves. */
	up->hold = c->hold || up->from_line > 0 || up->from_mm > 0;
	up->seq_min = up->seq_max = c->seq;
	return up;
}

static bool upload_agrees(const struct upload *up,
			  const struct jobs_lcm_chunk *c)
{
	return up->bytes == (size_t)c->bytes &&
	       up->chunks == (uint32_t)c->chunks &&
	       up->from_line == (uint32_t)c->from_line &&
	       up->from_mm == c->from_mm &&
	       strcmp(up->setting, c->setting) == 0 &&
	       memcmp(up->sha256, c->sha256, sizeof(up->sha256)) == 0;
}

static void upload_put(struct upload *up, const struct jobs_lcm_chunk *c,
		       int64_t now_us)
{
	uint8_t bit = (uint8_t)(1 << (c->chunk & 7));

	if (c->seq < up->seq_min)
		up->seq_min = c->seq;
	if (c->seq > up->seq_max)
		up->seq_max = c->seq;
	if (up->state == UPLOAD_WHOLE || (up->seen[c->chunk / 8] & bit))
		return;
	up->seen[c->chunk / 8] |= bit;
	up->have++;
	up->seq = c->seq;
	up->last_us = now_us;
	if (c->size)
		memcpy(up->text + c->offset, c->data, c->size);
}

void upload_take(struct uploads *u, const struct jobs_lcm_chunk *c,
		 int64_t now_us, struct upload **ret, struct upload_answer *a)
{
	const struct upload_verdict *v = verdict_find(u, c);
	struct upload *up = upload_find(u, c);

	*ret = NULL;
	*a = (struct upload_answer) { .code = 0 };
	if (!up && v) {
		refuse(a, v->code, v->reason);
		a->body = v->body;
		return;
	}
	if (!up)
		up = upload_begin(u, c, now_us, a);
	if (!up)
		return;
	if (!upload_agrees(up, c)) {
		refuse(a, EX_PROTOCOL, "chunk of another size or hash than "
		       "those before it; one text for one job id");
		return;
	}
	upload_put(up, c, now_us);
	snprintf(a->reason, sizeof(a->reason), "%u of %u chunks", up->have,
		 up->chunks);
	if (up->state == UPLOAD_FILLING && up->have == up->chunks) {
		up->state = UPLOAD_WHOLE;
		snprintf(a->reason, sizeof(a->reason), "whole; compiling");
		*ret = up;
	}
}

void upload_forget(struct uploads *u, struct upload *up, int code,
		   const char *reason, const char *body)
{
	struct upload_verdict *v = &u->verdict[u->next_verdict];

	u->next_verdict = (u->next_verdict + 1) % UPLOAD_VERDICTS;
	free(v->reason);
	free(v->body);
	memcpy(v->key, up->key, sizeof(v->key));
	memcpy(v->client, up->client, sizeof(v->client));
	memcpy(v->id, up->id, sizeof(v->id));
	v->seq_min = up->seq_min;
	v->seq_max = up->seq_max;
	v->code = code;
	v->reason = strdup(reason);
	v->body = body ? strdup(body) : NULL;
	upload_clear(up);
}

bool upload_hold_all(struct uploads *u)
{
	bool any = false;

	for (int i = 0; i < UPLOAD_SLOTS; i++) {
		struct upload *up = &u->slot[i];

		up->hold = up->hold || up->state != UPLOAD_FREE;
		any = any || up->state != UPLOAD_FREE;
	}
	return any;
}

int upload_expire(struct uploads *u, int64_t now_us)
{
	int dropped = 0;

	for (int i = 0; i < UPLOAD_SLOTS; i++) {
		struct upload *up = &u->slot[i];

		if (up->state != UPLOAD_FILLING ||
		    now_us - up->last_us < UPLOAD_IDLE_US)
			continue;
		upload_clear(up);
		dropped++;
	}
	return dropped;
}

void upload_fini(struct uploads *u)
{
	for (int i = 0; i < UPLOAD_SLOTS; i++)
		upload_clear(&u->slot[i]);
	for (int i = 0; i < UPLOAD_VERDICTS; i++) {
		free(u->verdict[i].reason);
		free(u->verdict[i].body);
		u->verdict[i].reason = u->verdict[i].body = NULL;
	}
}
