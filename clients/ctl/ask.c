/* SPDX-License-Identifier: Apache-2.0 */
/*
 * ask.c - verbs that are one question and its answer
 */
#include "ctl.h"
#include "heard.h"
#include "history.h"
#include "standard.h"
#include "talk_stop.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <time.h>
#include <unistd.h>

#define HEARD_MS	400

/* Then it does not come with the service. */
static bool key_is_named(const struct ctl *c)
{
	const char *key = c->key ? c->key : getenv("EDM_KEY");

	return key && *key;
}

/*
 * The name may be wrong: name those that are there.  Return: how many other
 * machines there are.
 */
static int print_heard(const struct ctl *c)
{
	struct heard heard;
	int n = 0;

	if (heard_listen(&heard, c->url, HEARD_MS) < 0)
		return 0;
	for (int i = 0; i < heard.n; i++) {
		if (strcmp(heard.name[i], c->machine) == 0)
			continue;
		fprintf(stderr, "%s%s", n++ ? ", " : "edmctl: heard machine ",
			heard.name[i]);
	}
	if (n)
		fprintf(stderr, "; --machine NAME or EDM_MACHINE=NAME chooses "
			"one\n");
	return n;
}

int ctl_unanswered(const struct ctl *c, int err)
{
	if (err == -EINTR) {
		fprintf(stderr, "edmctl: interrupted before an answer came\n");
		return EX_TEMPFAIL;
	}
	/* Somebody may have to stop the machine now: that comes first. */
	ctl_ways_print(c);
	if (!c->talk && (c->talk_err != -ENOENT || key_is_named(c))) {
		fprintf(stderr, "edmctl: %s\n", c->said);
		if (c->talk_err == -ENETUNREACH)
			print_heard(c);
		return c->talk_err == -ENETUNREACH ? EX_UNAVAILABLE :
		       c->talk_err == -EDESTADDRREQ ? EX_USAGE : EX_NOPERM;
	}
	if (c->talk && *talk_why(c->talk)) {
		fprintf(stderr, "edmctl: %s\n", talk_why(c->talk));
		return EX_NOPERM;
	}
	fprintf(stderr, "edmctl: no answer from edmd-jobs of machine %s; is it "
		"running? systemctl start edmd-jobs\n", c->machine);
	if (print_heard(c) == 0 && !c->talk)
		fprintf(stderr, "edmctl: %s\n", c->said);
	return EX_UNAVAILABLE;
}

/* The verb as it was typed: `electrode add` asks electrode-add, and `history
 * JOB` asks show. */
static void typed(char to[64], const struct ctl *c,
		  const struct talk_question *q)
{
	const size_t n = strlen(c->verb);
	const bool part = strncmp(q->verb, c->verb, n) == 0 &&
			  q->verb[n] == '-';

	snprintf(to, 64, "%s%s%s", c->verb, part ? " " : "",
		 part ? q->verb + n + 1 : "");
}

/* @err: of asking; @ret: the answer, if it is 0. */
static int answered(const struct ctl *c, const struct talk_question *q, int err,
		    struct talk_answer *ret)
{
	char verb[64];
	int code;

	if (err < 0)
		return ctl_unanswered(c, err);
	if (ret->code == 0)
		return 0;
	typed(verb, c, q);
	fprintf(stderr, "edmctl: %s%s%s: %s\n", verb, q->job ? " " : "",
		q->job ? q->job : "", ret->reason);
	code = ret->code;
	talk_answer_free(ret);
	return code;
}

int ctl_ask(struct ctl *c, const struct talk_question *q,
	    struct talk_answer *ret)
{
	int err = -ETIMEDOUT;

	if (c->talk)
		err = talk_ask(c->talk, q, c->timeout_s, ret);
	else if (!c->url && talk_stop_is(q->verb))
		err = talk_stop_ask(c->machine, q->verb, c->timeout_s, ret);
	return answered(c, q, err, ret);
}

/* For a verb whose answer is one word of success. */
int ctl_say(struct ctl *c, const struct talk_question *q)
{
	struct talk_answer a;
	char verb[64];
	int err = ctl_ask(c, q, &a);

	if (err)
		return err;
	typed(verb, c, q);
	if (c->json && c->wait)
		;			/* the end is printed */
	else if (c->json)
		printf("{\"verb\": \"%s\", \"code\": 0}\n", q->verb);
	else
		printf("%s: %s\n", verb, a.reason);
	talk_answer_free(&a);
	return 0;
}

int ctl_command(struct ctl *c)
{
	return ctl_say(c, &(struct talk_question) { .verb = c->verb });
}

int ctl_remove(struct ctl *c)
{
	return ctl_say(c, &(struct talk_question) {
		.verb = "remove", .job = c->arg,
	});
}

int ctl_set(struct ctl *c)
{
	char *end;
	double value = NAN;

	if (strcmp(c->value, "default") != 0) {
		value = strtod(c->value, &end);
		if (end == c->value || *end || !isfinite(value)) {
			fprintf(stderr, "edmctl: set %s %s: not a number; a "
				"number, or default to take it back\n",
				c->arg, c->value);
			return EX_USAGE;
		}
	}
	return ctl_say(c, &(struct talk_question) {
		.verb = "set", .text = c->arg, .arg = value,
	});
}

int ctl_number(const struct ctl *c, const char *text, const char *wanted,
	       double *ret)
{
	char *end;

	*ret = strtod(text, &end);
	if (end != text && *end == '\0' && isfinite(*ret))
		return 0;
	fprintf(stderr, "edmctl: %s: '%s' is no number; %s\n", c->verb, text,
		wanted);
	return EX_USAGE;
}

int ctl_move(struct ctl *c)
{
	const bool front = strcmp(c->value, "front") == 0;
	double way = front ? -2 : 2;
	int rc = front || strcmp(c->value, "back") == 0 ? 0 :
		 ctl_number(c, c->value, "-1, +1, front or back", &way);

	return rc ? rc : ctl_say(c, &(struct talk_question) {
		.verb = "move", .job = c->arg, .arg = way,
	});
}

int ctl_done(struct ctl *c)
{
	double n = 0;
	int err = c->arg ? ctl_number(c, c->arg, "an electrode's number", &n) :
			   0;

	return err ? err : ctl_say(c, &(struct talk_question) {
		.verb = "done", .arg = n,
	});
}

int ctl_override(struct ctl *c)
{
	double percent;
	int err = ctl_number(c, c->arg, "percent, 0 to 200", &percent);

	return err ? err : ctl_say(c, &(struct talk_question) {
		.verb = "override", .arg = percent / 100,
	});
}

/* -- Lists ---------------------------------------------------------------- */

const char *ctl_text_of(json_t *job, const char *key)
{
	const char *s = json_string_value(json_object_get(job, key));

	return s ? s : "";
}

double ctl_number_of(json_t *job, const char *key)
{
	return json_number_value(json_object_get(job, key));
}

void ctl_when(char to[32], json_t *job, const char *key)
{
	int64_t us = json_integer_value(json_object_get(job, key));
	time_t t = us / 1000000;
	struct tm tm;

	snprintf(to, 32, "-");
	if (us > 0 && localtime_r(&t, &tm))
		strftime(to, 32, "%Y-%m-%d %H:%M:%S", &tm);
}

/* Of the two first columns of a list. */
struct wide {
	int job, name;
};

static int characters(const char *utf8)
{
	int n = 0;

	for (; *utf8; utf8++)
		n += (*utf8 & 0xc0) != 0x80;
	return n;
}

static void print_names(const char *job, const char *name, struct wide w)
{
	printf("%s%*s%s%*s", job, w.job + 1 - characters(job), "", name,
	       w.name + 1 - characters(name), "");
}

/* "-": nobody has looked yet, or it is put off; "?": that cannot be told. */
static void forecast_text(char *to, size_t size, json_t *job)
{
	const double s = ctl_number_of(job, "forecast_s");

	if (!json_is_number(json_object_get(job, "forecast_s")) || s < -1)
		snprintf(to, size, "-");
	else if (s < 0)
		snprintf(to, size, "?");
	else
		ctl_duration(to, size, s);
}

static void print_queued(json_t *job)
{
	const char *why = ctl_text_of(job, "forecast_why");
	char at[32], takes[32];

	ctl_when(at, job, "submitted_us");
	forecast_text(takes, sizeof(takes), job);
	printf("%-8s %9.0f  %s  %16s%s%s%s\n", ctl_text_of(job, "state"),
	       ctl_number_of(job, "lines"), at, takes,
	       json_is_true(json_object_get(job, "hold")) ?
	       "  waits for start" : "", *why ? "  no forecast: " : "", why);
}

static void print_ended(json_t *job)
{
	char at[32], took[32];

	ctl_when(at, job, "ended_us");
	ctl_duration(took, sizeof(took), ctl_number_of(job, "job_s"));
	printf("%-8s %s  %10.3f mm  %s%s%s\n", ctl_text_of(job, "state"), at,
	       ctl_number_of(job, "depth_mm"), took,
	       *ctl_text_of(job, "reason") ? "  " : "",
	       ctl_text_of(job, "reason"));
}

/* A condition's name, a number, or the generator's own setting. */
static void print_value(json_t *v)
{
	if (json_is_string(v))
		printf("%s", json_string_value(v));
	else if (json_is_number(v))
		printf("%g", json_number_value(v));
	else
		printf("-");
}

static void print_changes(json_t *rows)
{
	json_t *row;
	size_t i;
	char at[32];

	json_array_foreach(rows, i, row) {
		ctl_when(at, row, "utime");
		printf("%-10s %s %10.3f mm  %s ", i ? "" : "changes", at,
		       ctl_number_of(row, "place_mm"),
		       ctl_text_of(row, "what"));
		print_value(json_object_get(row, "was"));
		printf(" -> ");
		print_value(json_object_get(row, "now"));
		putchar('\n');
	}
}

static void print_electrodes(json_t *rows)
{
	json_t *row;
	size_t i;

	json_array_foreach(rows, i, row)
		printf("%-10s %.0f shifts Z by %+.4f mm; wear %.4f -> %.4f "
		       "mm%s, %.1f min of sparks\n", i ? "" : "electrode",
		       ctl_number_of(row, "electrode"),
		       ctl_number_of(row, "shift_mm"),
		       ctl_number_of(row, "wear_before_mm"),
		       ctl_number_of(row, "wear_after_mm"),
		       json_is_true(json_object_get(row, "known")) ? "" :
		       " and more",
		       ctl_number_of(row, "sparked_s") / 60);
}

static void print_said(json_t *rows)
{
	char at[32];
	json_t *row;
	size_t i;

	json_array_foreach(rows, i, row) {
		ctl_when(at, row, "utime");
		printf("%-10s %s  %s\n", i ? "" : "said", at,
		       ctl_text_of(row, "text"));
	}
}

static void print_one(json_t *job)
{
	static const struct {
		const char *label, *key;
	} times[] = {
		{ "submitted", "submitted_us" }, { "begun", "begun_us" },
		{ "ended", "ended_us" },
	};
	char text[32];
	json_t *note;
	size_t i;

	printf("job        %s\nname       %s\nstate      %s\n",
	       ctl_text_of(job, "job"), ctl_text_of(job, "name"),
	       ctl_text_of(job, "state"));
	if (*ctl_text_of(job, "reason"))
		printf("reason     %s\n", ctl_text_of(job, "reason"));
	printf("lines      %.0f\n", ctl_number_of(job, "lines"));
	for (i = 0; i < sizeof(times) / sizeof(times[0]); i++) {
		ctl_when(text, job, times[i].key);
		printf("%-10s %s\n", times[i].label, text);
	}
	ctl_duration(text, sizeof(text), ctl_number_of(job, "job_s"));
	printf("path       %.3f mm of %.3f mm\ndepth      %.3f mm\n"
	       "time       %s\njumps      %.0f\nretracts   %.0f\n"
	       "shorts     %.0f\nsha256     %s\n",
	       ctl_number_of(job, "path_mm"), ctl_number_of(job, "length_mm"),
	       ctl_number_of(job, "depth_mm"), text,
	       ctl_number_of(job, "jumps"), ctl_number_of(job, "retracts"),
	       ctl_number_of(job, "shorts"), ctl_text_of(job, "sha256"));
	history_print(job);
	if (*ctl_text_of(job, "setting"))
		printf("set        %s\n", ctl_text_of(job, "setting"));
	if (*ctl_text_of(job, "tech_sha256"))
		printf("table      %s\n", ctl_text_of(job, "tech_sha256"));
	json_array_foreach(json_object_get(job, "notes"), i, note)
		printf("%-10s %s\n", i ? "" : "notes",
		       json_string_value(note));
	print_electrodes(json_object_get(job, "electrodes"));
	print_changes(json_object_get(job, "changes"));
	print_said(json_object_get(job, "said"));
}

static int larger(int a, int b)
{
	return a > b ? a : b;
}

static void print_rows(json_t *rows, const char *head,
		       void (*print)(json_t *job))
{
	struct wide w = { 14, 24 };
	json_t *row;
	size_t i;

	if (json_array_size(rows) == 0) {
		puts("none");
		return;
	}
	json_array_foreach(rows, i, row) {
		w.job = larger(w.job, characters(ctl_text_of(row, "job")));
		w.name = larger(w.name, characters(ctl_text_of(row, "name")));
	}
	print_names("JOB", "NAME", w);
	puts(head);
	json_array_foreach(rows, i, row) {
		print_names(ctl_text_of(row, "job"), ctl_text_of(row, "name"),
			    w);
		print(row);
	}
}

int ctl_ask_json(struct ctl *c, const struct talk_question *q, json_t **ret)
{
	struct talk_answer a;
	const int err = ctl_ask(c, q, &a);

	if (err)
		return err;
	*ret = json_loads(a.body, 0, NULL);
	talk_answer_free(&a);
	return *ret ? 0 : EX_PROTOCOL;
}

int ctl_put_json(json_t *o)
{
	const int err = json_dumpf(o, stdout, JSON_ENCODE_ANY |
				   JSON_REAL_PRECISION(15));

	putchar('\n');
	return err ? EX_IOERR : 0;
}

/* The first pages come at once, and most lists are no longer. */
static void tell_progress(double since_s, size_t jobs, bool end)
{
	if (talk_now_s() - since_s < 1 || !isatty(STDERR_FILENO))
		return;
	standard_control(stderr, end ? "\r\033[K" : "\r");
	if (!end)
		fprintf(stderr, "%zu jobs", jobs);
}

/*
 * The next page is asked for before this one is read, so that both sides work
 * at the same time.  It begins after the last job of this one; which one that
 * is, is guessed from its text and compared when it has been read.
 */
struct ahead {
	char job[TALK_WORD_MAX];	/* "": nothing was asked */
	bool over;
	int err;
	struct talk_answer answer;
};

static void on_ahead(void *arg, int err, const struct talk_ack *a)
{
	struct ahead *h = arg;

	h->over = true;
	h->err = err < 0 ? err : talk_answer_copy(&h->answer, a);
}

static void guess_last(const char *body, char ret[TALK_WORD_MAX])
{
	static const char key[] = "\"job\":\"";
	const char *last = NULL;
	size_t n;

	for (const char *at = body; (at = strstr(at, key)); last = at)
		at += sizeof(key) - 1;
	n = last ? strcspn(last, "\"\\") : 0;
	snprintf(ret, TALK_WORD_MAX, "%.*s", (int)n, last ? last : "");
}

static void ahead_ask(struct ahead *h, struct ctl *c, const char *verb,
		      const char *body)
{
	*h = (struct ahead) { .over = false };
	guess_last(body, h->job);
	if (*h->job && talk_send(c->talk, &(struct talk_question) {
			.verb = verb, .job = h->job,
		}, c->timeout_s, on_ahead, h) < 0)
		*h->job = '\0';
}

/* Its answer, if it was the question. */
static int ahead_answer(struct ahead *h, struct ctl *c,
			const struct talk_question *q, struct talk_answer *ret)
{
	while (*h->job && !h->over && !talk_interrupted())
		talk_wait(c->talk, 50);
	if (!*h->job || !q || strcmp(h->job, q->job) != 0) {
		talk_answer_free(&h->answer);
		return q ? ctl_ask(c, q, ret) : 0;
	}
	*ret = h->answer;
	h->answer = (struct talk_answer) { .code = 0 };
	return answered(c, q, h->over ? h->err : -EINTR, ret);
}

int ctl_pages(struct ctl *c, const char *verb,
	      int (*take)(void *arg, json_t *page), void *arg)
{
	struct talk_question q = { .verb = verb };
	const double since_s = talk_now_s();
	json_t *page = NULL;		/* q.job is a word of it */
	static struct ahead ahead;	/* interrupted, its answer may come
					 * when this has returned */
	struct talk_answer a;
	size_t n = 0, all = 0;
	int err = ctl_ask(c, &q, &a);

	while (err == 0) {
		ahead_ask(&ahead, c, verb, a.body);
		json_decref(page);
		page = json_loads(a.body, 0, NULL);
		talk_answer_free(&a);
		err = page ? take(arg, page) : EX_PROTOCOL;
		n = json_array_size(page);
		tell_progress(since_s, all += n, n == 0);
		if (err || n == 0)
			break;
		q.job = ctl_text_of(json_array_get(page, n - 1), "job");
		err = ahead_answer(&ahead, c, &q, &a);
		ahead.job[0] = '\0';
	}
	ahead_answer(&ahead, c, NULL, NULL);
	json_decref(page);
	return err;
}

static int add_page(void *arg, json_t *page)
{
	return json_array_extend(arg, page) ? EX_SOFTWARE : 0;
}

/*
 * A list of thousands of jobs is read and printed, and then the program ends.
 * To give its pieces back one by one costs a fifth of its time.  So they come
 * from rooms that stay until the end; each begins with the address of the one
 * before, which is still known by that.
 */
#define LIST_ROOM	(1 << 20)
#define LIST_ALIGN	16

static void *list_take(size_t bytes)
{
	static char *room;
	static size_t at, size;
	const size_t n = (bytes + LIST_ALIGN - 1) / LIST_ALIGN * LIST_ALIGN;

	if (n > size - at) {
		const size_t more = n > LIST_ROOM ? n : LIST_ROOM;
		char *next = malloc(LIST_ALIGN + more);

		if (!next)
			return NULL;
		memcpy(next, &room, sizeof(room));
		room = next;
		at = LIST_ALIGN;
		size = LIST_ALIGN + more;
	}
	at += n;
	return room + at - n;
}

static void list_leave(void *taken)
{
	(void)taken;
}

/* What all of it will take, and when that would be over. */
static void print_total(struct ctl *c)
{
	const struct talk_status *t = ctl_first_status(c);
	const time_t end = t ? (time_t)t->queue_end_s : 0;
	char text[32], at[32] = "";
	struct tm tm;

	if (!t || !(t->queue_s > 0))
		return;
	ctl_duration(text, sizeof(text), t->queue_s + fmax(0, t->eta_s));
	if (localtime_r(&end, &tm))
		strftime(at, sizeof(at), "%d %b %H:%M", &tm);
	printf("all of it takes %s; if nothing is held, it ends %s", text, at);
	printf(t->queue_untold > 0 ? "; of %d more that is not known\n" : "\n",
	       t->queue_untold);
}

static int list(struct ctl *c, const char *verb, const char *head,
		void (*print)(json_t *job))
{
	json_t *all;
	int err;

	json_set_alloc_funcs(list_take, list_leave);
	all = json_array();
	err = ctl_pages(c, verb, add_page, all);

	if (err == 0 && c->json)
		err = ctl_put_json(all);
	else if (err == 0)
		print_rows(all, head, print);
	json_decref(all);
	return err;
}

int ctl_queue(struct ctl *c)
{
	const int err = list(c, "queue", "STATE        LINES  SUBMITTED     "
			     "               TAKES", print_queued);

	if (err == 0 && !c->json)
		print_total(c);
	return err;
}

int ctl_ended(struct ctl *c)
{
	return list(c, "history", "STATE    ENDED                       DEPTH"
		    "  TIME", print_ended);
}

int ctl_show(struct ctl *c)
{
	json_t *job = NULL;
	int err = ctl_ask_json(c, &(struct talk_question) {
		.verb = "show", .job = c->arg,
	}, &job);

	if (err == 0 && c->json)
		err = ctl_put_json(job);
	else if (err == 0)
		print_one(job);
	json_decref(job);
	return err;
}
