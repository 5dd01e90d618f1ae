/* SPDX-License-Identifier: Apache-2.0 */
/*
 * submit.c - send a job: a few chunks at a time, repeated until answered
 */
#include "ctl.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sysexits.h>

#define JOB_BYTES_MAX	(64 << 20)
#define WINDOW		6		/* within a socket's default buffer */
#define REPEAT_S	0.3
#define COMPILE_S	120.0		/* a text of 64 MiB takes its time */
#define SHOW_CHUNKS	64		/* less is gone before it is seen */

struct text {
	char *bytes;
	size_t size;
	uint8_t sha256[32];
};

struct upload {
	struct ctl *ctl;
	const struct text *text;
	char id[TALK_WORD_MAX], name[TALK_WORD_MAX];
	int chunks, acked;
	int64_t seq0;			/* of chunk 0; the others follow */
	double *sent_s;			/* 0 not yet, < 0 acked */
	int first;			/* all before it are acked */
	double heard_s;
	bool over;
	int code;
	char *reason, *body;
};

static int read_all(FILE *f, struct text *t)
{
	size_t room = 1 << 16, n;

	t->bytes = malloc(room);
	while (t->bytes && (n = fread(t->bytes + t->size, 1, room - t->size,
				      f)) > 0) {
		char *more;

		t->size += n;
		if (t->size > JOB_BYTES_MAX)
			return -EFBIG;
		if (t->size < room)
			continue;
		room *= 2;
		more = realloc(t->bytes, room);
		if (!more)
			return -ENOMEM;
		t->bytes = more;
	}
	if (!t->bytes)
		return -ENOMEM;
	return ferror(f) ? -errno : 0;
}

/* Return: what to exit with. */
static int read_text(const char *path, struct text *t)
{
	bool std = strcmp(path, "-") == 0;
	struct stat st;
	FILE *f = std ? stdin : fopen(path, "rbe");
	int err;

	if (!f) {
		fprintf(stderr, "edmctl: %s: %s; a file of NC code, or - for "
			"standard input\n", path, strerror(errno));
		return EX_NOINPUT;
	}
	if (fstat(fileno(f), &st) == 0 && S_ISDIR(st.st_mode))
		err = -EISDIR;
	else
		err = read_all(f, t);
	if (!std)
		fclose(f);
	if (err == 0) {
		crypto_hash_sha256(t->sha256, (unsigned char *)t->bytes,
				   t->size);
		return 0;
	}
	fprintf(stderr, "edmctl: %s: %s; a file of NC code of at most 64 "
		"MiB\n", path, strerror(-err));
	return err == -EISDIR ? EX_NOINPUT :
	       err == -EFBIG ? EX_DATAERR :
	       err == -ENOMEM ? EX_SOFTWARE : EX_IOERR;
}

static void on_ack(void *arg, const struct talk_ack *a)
{
	struct upload *u = arg;
	int64_t i = a->seq - u->seq0;

	if (i < 0 || i >= u->chunks || u->over)
		return;
	u->heard_s = talk_now_s();
	if (u->sent_s[i] >= 0) {
		u->sent_s[i] = -1;
		u->acked++;
	}
	if (a->code == 0 && !*a->body)
		return;
	u->over = true;
	u->code = a->code;
	u->reason = strdup(a->reason);
	u->body = strdup(a->body);
}

static void send_chunk(struct upload *u, int i)
{
	size_t at = (size_t)i * TALK_CHUNK_MAX;
	size_t left = u->text->size - at;
	struct talk_chunk c = {
		.seq = u->seq0 + i, .job = u->id, .name = u->name,
		.bytes = (int64_t)u->text->size, .sha256 = u->text->sha256,
		.chunk = i, .chunks = u->chunks, .offset = (int64_t)at,
		.hold = u->ctl->hold, .data = u->text->bytes + at,
		.size = left < TALK_CHUNK_MAX ? (int)left : TALK_CHUNK_MAX,
	};

	talk_send_chunk(u->ctl->talk, &c);
}

/* All but the acked ones, WINDOW from the first of them on. */
static void send_window(struct upload *u)
{
	double now_s = talk_now_s();

	while (u->first < u->chunks && u->sent_s[u->first] < 0)
		u->first++;
	for (int i = u->first; i < u->chunks && i < u->first + WINDOW; i++) {
		if (u->sent_s[i] < 0 || now_s - u->sent_s[i] < REPEAT_S)
			continue;
		send_chunk(u, i);
		u->sent_s[i] = now_s;
	}
}

/* All chunks are there: what becomes of them?  Ask, in case it was lost. */
static void send_reminder(struct upload *u, double *asked_s)
{
	double now_s = talk_now_s();

	if (*asked_s == 0)
		*asked_s = now_s;
	if (now_s - *asked_s < 1)
		return;
	*asked_s = now_s;
	send_chunk(u, 0);
}

static void show_progress(const struct upload *u, struct line *l)
{
	char text[96];

	if (u->chunks < SHOW_CHUNKS || u->ctl->json)
		return;
	if (u->acked < u->chunks)
		snprintf(text, sizeof(text), "sending %s: %d of %d chunks",
			 u->name, u->acked, u->chunks);
	else
		snprintf(text, sizeof(text), "sent %s; edmd-jobs reads it",
			 u->name);
	line_bar(l, (double)u->acked / u->chunks, text);
}

/* Return: 0 if the service has said something final, -ETIMEDOUT, -EINTR. */
static int upload_run(struct upload *u)
{
	struct line l;
	double begun_s = talk_now_s(), whole_s = 0, asked_s = 0;

	line_init(&l);
	u->heard_s = begun_s;
	while (!u->over) {
		double now_s = talk_now_s();

		if (talk_interrupted())
			break;
		if (now_s - u->heard_s > u->ctl->timeout_s ||
		    (whole_s > 0 && now_s - whole_s > COMPILE_S))
			break;
		if (u->acked < u->chunks) {
			send_window(u);
		} else {
			whole_s = whole_s > 0 ? whole_s : now_s;
			send_reminder(u, &asked_s);
		}
		talk_wait(u->ctl->talk, 20);
		show_progress(u, &l);
	}
	line_end(&l);
	if (u->over)
		return 0;
	return talk_interrupted() ? -EINTR : -ETIMEDOUT;
}

/* The service says NAME:LINE:COLUMN; who sent it knows it as FILE. */
static void print_refusal(const struct upload *u)
{
	json_t *j = json_loads(u->body, 0, NULL);
	int line, column;
	const char *found, *wanted;

	if (j && json_unpack(j, "{s:i,s:i,s:s,s:s}", "line", &line, "column",
			     &column, "found", &found, "wanted", &wanted) == 0)
		fprintf(stderr, "%s:%d:%d: error: %s; %s\n", u->ctl->arg, line,
			column, found, wanted);
	else
		fprintf(stderr, "edmctl: %s: %s\n", u->ctl->arg, u->reason);
	json_decref(j);
}

static int print_outcome(struct upload *u)
{
	if (u->code) {
		print_refusal(u);
		return u->code;
	}
	if (u->ctl->wait && u->ctl->json)
		return 0;
	if (u->ctl->json)
		printf("%s\n", u->body);
	else
		printf("job %s, %s: %s\n", u->id, u->name, u->reason);
	fflush(stdout);
	return 0;
}

/* The last part of the path, cut to what a name may be. */
static void name_job(struct upload *u)
{
	const char *path = u->ctl->arg, *slash = strrchr(path, '/');
	const char *name = u->ctl->name;
	size_t n;

	if (!name)
		name = strcmp(path, "-") == 0 ? "stdin" :
		       slash ? slash + 1 : path;
	snprintf(u->name, sizeof(u->name), "%s", name);
	n = strlen(u->name);
	if (n == strlen(name))
		return;
	/* Not in the middle of a character. */
	while (n > 0 && ((unsigned char)name[n] & 0xc0) == 0x80)
		u->name[--n] = '\0';
}

static void name_id(struct upload *u)
{
	uint8_t drawn[6];

	if (u->ctl->id) {
		snprintf(u->id, sizeof(u->id), "%s", u->ctl->id);
		return;
	}
	randombytes_buf(drawn, sizeof(drawn));
	sodium_bin2hex(u->id, sizeof(u->id), drawn, sizeof(drawn));
}

static int upload_init(struct upload *u)
{
	size_t size = u->text->size;

	name_job(u);
	name_id(u);
	u->chunks = size ? (int)((size + TALK_CHUNK_MAX - 1) / TALK_CHUNK_MAX) :
		    1;
	u->sent_s = calloc((size_t)u->chunks, sizeof(*u->sent_s));
	if (!u->sent_s)
		return -ENOMEM;
	u->seq0 = talk_number(u->ctl->talk);
	for (int i = 1; i < u->chunks; i++)
		talk_number(u->ctl->talk);
	return 0;
}

static int send_text(struct ctl *c, const struct text *t,
		     char id[TALK_WORD_MAX])
{
	struct upload u = { .ctl = c, .text = t };
	int err = upload_init(&u), rc;

	if (err < 0) {
		fprintf(stderr, "edmctl: out of memory\n");
		return EX_SOFTWARE;
	}
	talk_on_ack(c->talk, on_ack, &u);
	err = upload_run(&u);
	talk_on_ack(c->talk, NULL, NULL);
	rc = err < 0 ? ctl_unanswered(c, err) : print_outcome(&u);
	memcpy(id, u.id, sizeof(u.id));
	free(u.sent_s);
	free(u.reason);
	free(u.body);
	return rc;
}

int ctl_submit(struct ctl *c)
{
	struct text t = { .size = 0 };
	char id[TALK_WORD_MAX];
	int rc = read_text(c->arg, &t);

	if (rc == 0)
		rc = send_text(c, &t, id);
	free(t.bytes);
	if (rc == 0 && c->wait)
		rc = ctl_wait(c, id);
	return rc;
}
