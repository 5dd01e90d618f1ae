/* SPDX-License-Identifier: Apache-2.0 */
/*
 * submit.c - from the first chunk of a job to its place in the queue
 *
 * Each chunk is answered.  When the text is complete, it is compiled.  Then the
 * chunk that completed it is answered once more: accepted, with the job as
 * JSON, or refused, with line and column.
 */
#include "jobs.h"

#include "inside.h"
#include "compiler.h"
#include "entry.h"
#include "interrupt.h"
#include "jobs_log.h"
#include "offset.h"
#include "verb.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

/* The upload to which a compilation belongs. */
struct check {
	struct jobs *jobs;
	struct upload *upload;
};

static void hash_hex(char ret[65], const uint8_t hash[32])
{
	sodium_bin2hex(ret, 65, hash, 32);
}

/* It may be a file already, and no job came of it. */
static void drop_text(struct jobs *j, const struct upload *up)
{
	char hex[65];

	hash_hex(hex, up->sha256);
	if (up->bytes > STORE_TEXT_INSIDE)
		store_text_drop(j->store, hex);
}

static void answer_end(struct jobs *j, struct upload *up, int code,
		       const char *reason, const char *body)
{
	struct jobs_lcm_ack a = {
		.key = up->key, .client = up->client, .seq = up->seq,
		.code = code,
		.reason = reason, .body = body,
	};

	jobs_lcm_ack(j->lcm, &a);
	if (code != 0)
		drop_text(j, up);
	upload_forget(&j->uploads, up, code, reason, body);
}

/* Write the inside of a JSON string.  A character that would end it, or that is
 * not text, becomes \\u00xx. */
static void json_put(char *to, size_t size, const char *from)
{
	size_t n = 0;

	for (; *from && n + 7 < size; from++) {
		unsigned char c = (unsigned char)*from;

		if (c < ' ' || c >= 0x7f || c == '"' || c == '\\')
			n += (size_t)snprintf(to + n, size - n, "\\u%04x", c);
		else
			to[n++] = (char)c;
	}
	to[n] = '\0';
}

static void refuse_text(struct jobs *j, struct upload *up,
			const struct interp_diag *d)
{
	char reason[480], body[2600];
	char found[6 * sizeof(d->found)], wanted[6 * sizeof(d->wanted)];

	interp_diag_full(d, up->name, reason, sizeof(reason));
	json_put(found, sizeof(found), d->found);
	json_put(wanted, sizeof(wanted), d->wanted);
	snprintf(body, sizeof(body), "{\"line\":%u,\"column\":%u,"
		 "\"found\":\"%s\",\"wanted\":\"%s\"}", d->line, d->column,
		 found, wanted);
	log_info("submit: refused %s", reason);
	answer_end(j, up, EX_DATAERR, reason, body);
}

static const char *what_next(const struct jobs *j, bool hold)
{
	if (j->link.state != LINK_OK)
		return "edmd is not there: the job waits for a start";
	if (j->link.snap.state == SHM_FAULT)
		return "a fault is latched: the job waits for a reset, then a "
		       "start";
	if (*j->interrupted)
		return "a job was interrupted: resume it or remove it, then start";
	if (*j->electrode.why)
		return "a job before it waits for an electrode";
	if (queue_unready(j))
		return "an axis is not homed: the job waits for a home, then a "
		       "start";
	if (j->unseen)
		return interrupt_unseen(j);
	if (j->queue.waiting)
		return "the queue waits for start";
	if (hold)
		return "it will wait for start";
	return j->queue.job.n || j->queue.behind > 1 ?
	       "it starts when those before it are done" : "it starts now";
}

/* Notes are events of the job: every client gets them, and `show` lists
 * them. */
static void tell_notes(struct jobs *j, const struct upload *up,
		       const struct compiler_result *r)
{
	const struct jobs_note n = { .kind = "note", .job = up->id };

	for (uint32_t i = 0; i < r->nnotes && i < COMPILER_NOTES_MAX; i++)
		jobs_note(j, &n, "%s:%u: note: %s", up->name, r->note[i].line,
			  r->note[i].text);
	if (r->nnotes > COMPILER_NOTES_MAX)
		jobs_note(j, &n, "%s: note: %u notes more; edmsim --check "
			  "prints all", up->name,
			  r->nnotes - COMPILER_NOTES_MAX);
}

static void refuse_degraded(struct jobs *j, struct upload *up)
{
	char reason[240];

	snprintf(reason, sizeof(reason), "the store is degraded: %s; no job is "
		 "taken until it can be stored; make room, then send it again",
		 store_why(j->store));
	answer_end(j, up, EX_IOERR, reason, NULL);
}

static void refuse_unkept(struct jobs *j, struct upload *up, int err)
{
	char reason[240];

	snprintf(reason, sizeof(reason), "its text cannot be stored: %s; make "
		 "room, then send it again", strerror(-err));
	answer_end(j, up, EX_IOERR, reason, NULL);
}

static void accept_text(struct jobs *j, struct upload *up,
			const struct compiler_result *r)
{
	const uint32_t lines = r->lines;
	struct queue *q = &j->queue;
	char hex[65], reason[640], told[512], way[480] = "", *body;
	struct store_new n = {
		.id = up->id, .name = up->name, .sha256 = hex,
		.text = up->text, .bytes = up->bytes, .lines = lines,
		.tech_sha256 = r->tech_sha256,
		.hold = up->hold, .now_us = jobs_utime(),
		.begin_at = inside_named(up->from_line, up->from_mm),
		.electrode = up->electrode, .told = told,
		.setting = up->setting,
	};

	hash_hex(hex, up->sha256);
	snprintf(told, sizeof(told), "job %s queued, %u lines, %zu bytes",
		 n.name, lines, n.bytes);
	if (jobs_add(j, &n) != 0) {
		refuse_degraded(j, up);
		return;
	}
	/* If the queue is empty, it does not wait for anything any more. */
	if (queue_unready(j))
		queue_wait(j);
	else if (q->behind == 0 && (q->job.n == 0 || queue_is_leaving(q)))
		queue_go(j);
	queue_recount(j);
	tell_notes(j, up, r);
	if (n.begin_at)
		config_entry_words(j->config, &r->entry, way, sizeof(way));
	snprintf(reason, sizeof(reason), "accepted; %s%s%s",
		 what_next(j, up->hold), *way ? "; start " : "", way);
	body = store_json(j->store, STORE_SHOW, n.id, 0);
	answer_end(j, up, 0, reason, body);
	free(body);
}

/* The id is known.  Return: 0 if the text is the same; otherwise it is
 * refused. */
static bool answer_known(struct jobs *j, const struct jobs_lcm_chunk *c)
{
	struct jobs_lcm_ack a = {
		.key = c->key, .client = c->client, .seq = c->seq,
	};
	struct store_job job;
	char hex[65], *body = NULL;

	if (store_find(j->store, c->job, &job) < 0)
		return false;
	hash_hex(hex, c->sha256);
	if (strcmp(hex, job.sha256) == 0 &&
	    strcmp(c->setting, job.setting) == 0) {
		a.reason = "this job is here already";
		a.body = body = store_json(j->store, STORE_SHOW, c->job, 0);
	} else {
		a.code = EX_DATAERR;
		a.reason = "another text has this job id, or other "
			   "settings; draw a new id";
	}
	jobs_lcm_ack(j->lcm, &a);
	free(body);
	return true;
}

static void check_next(struct jobs *j);

static void on_checked(void *arg, struct compiler_result *r)
{
	struct check *c = arg;
	struct jobs *j = c->jobs;
	struct upload *up = c->upload;
	struct store_job job;
	const char *why;

	free(c);
	j->check[up - j->uploads.slot] = NULL;
	if (r->tech_refusal[0])
		answer_end(j, up, EX_CONFIG, r->tech_refusal, NULL);
	else if (r->err == -EINVAL)
		refuse_text(j, up, &r->diag);
	else if (r->err == -EILSEQ)
		answer_end(j, up, EX_PROTOCOL, "the text does not fit its "
			   "SHA-256; send the job again", NULL);
	else if (r->err < 0)
		answer_end(j, up, EX_SOFTWARE, strerror(-r->err), NULL);
	else if ((why = electrode_check(j, r)))
		answer_end(j, up, REFUSED, why, NULL);
	else if (store_find(j->store, up->id, &job) == 0)
		answer_end(j, up, EX_TEMPFAIL, "another client sends this job "
			   "id too; try again", NULL);
	else if (r->keep_err < 0)
		refuse_unkept(j, up, r->keep_err);
	else
		accept_text(j, up, r);
	check_next(j);
}

/* The place where the machine stands, or where it will stand if there is no
 * edmd yet. */
static void start_place(const struct jobs *j, double ret_mm[INTERP_NAXES])
{
	const struct shm_snapshot *s = &j->link.snap;

	for (int i = 0; i < INTERP_NAXES; i++)
		ret_mm[i] = j->link.state == LINK_OK ?
			    s->pos[i] * s->pulse_mm[i] : j->config->start_mm[i];
}

static void check_begin(struct jobs *j, struct upload *up)
{
	struct compiler_request request = {
		.config = j->config, .name = up->name,
		.text = up->text, .bytes = up->bytes, .has_sha256 = true,
	};
	struct check *c = malloc(sizeof(*c));
	int err = c ? 0 : -ENOMEM;
	char hex[65];

	memcpy(request.sha256, up->sha256, sizeof(request.sha256));
	snprintf(request.setting, sizeof(request.setting), "%s", up->setting);
	hash_hex(hex, up->sha256);
	if (up->bytes > STORE_TEXT_INSIDE && !*store_why(j->store))
		store_text_path(j->store, hex, request.text_file);
	start_place(j, request.start_mm);
	if (up->from_line > 0 || up->from_mm > 0)
		inside_begin_at(j, up->from_line, up->from_mm, &request);
	electrode_request(j, NULL, up->electrode, &request);
	if (offset_request(j, NULL, &request) < 0)
		err = -EIO;
	if (c && err == 0) {
		*c = (struct check) { .jobs = j, .upload = up };
		err = compiler_start(&j->check[up - j->uploads.slot], j->event,
				    &request, on_checked, c);
	}
	if (err < 0) {
		free(c);
		answer_end(j, up, EX_TEMPFAIL, strerror(-err), NULL);
	}
}

/* One check at a time: eight at once would need eight times the memory. */
static void check_next(struct jobs *j)
{
	struct upload *next = NULL;

	for (int i = 0; i < UPLOAD_SLOTS; i++) {
		struct upload *up = &j->uploads.slot[i];

		if (j->check[i])
			return;
		if (up->state == UPLOAD_WHOLE &&
		    (!next || up->last_us < next->last_us))
			next = up;
	}
	if (next)
		check_begin(j, next);
}

void submit_take(void *arg, const struct jobs_lcm_chunk *c)
{
	struct jobs *j = arg;
	struct upload_answer answer;
	struct upload *whole = NULL;
	struct jobs_lcm_ack a = {
		.key = c->key, .client = c->client, .seq = c->seq,
	};

	if (c->by->role < ROLE_OPERATOR) {
		trust_refuse(&j->trust, TRUST_ROLE, c->by->name, c->from,
			     jobs_now_us());
		answer = (struct upload_answer) {
			.code = EX_NOPERM,
			.reason = "a job wants a key of role operator",
		};
	} else if (jobs_lcm_is_late(c->signed_us)) {
		/* The last one may set the job in motion. */
		answer = (struct upload_answer) {
			.code = JOBS_LCM_AGAIN, .reason = JOBS_LCM_LATE_TEXT,
		};
	} else if (upload_check(c, &answer)) {
		if (answer_known(j, c))
			return;
		upload_take(&j->uploads, c, jobs_now_us(), &whole, &answer);
		a.body = answer.body;
	}
	a.code = answer.code;
	a.reason = answer.reason;
	jobs_lcm_ack(j->lcm, &a);
	if (whole)
		check_next(j);
}

void submit_fini(struct jobs *j)
{
	bool over = true;

	for (int i = 0; i < UPLOAD_SLOTS; i++) {
		void *check = compiler_destroy(j->check[i]);

		over = over && (check || !j->check[i]);
		free(check);
		j->check[i] = NULL;
	}
	if (over)
		upload_fini(&j->uploads);
}
