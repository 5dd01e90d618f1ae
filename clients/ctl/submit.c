/* SPDX-License-Identifier: Apache-2.0 */
/* submit.c - sends a job, and says what became of it */
#include "ctl.h"

#include "cmdline.h"
#include "plain.h"
#include "submission.h"
#include "submission_file.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <unistd.h>

#define SHOW_CHUNKS	64		/* a smaller job is sent before progress
					 * could be seen */

static void show_progress(const struct ctl *c, const struct submission *j,
			  struct line *l)
{
	char text[96];
	int arrived;
	const int chunks = submission_progress(j, &arrived);

	if (chunks < SHOW_CHUNKS || c->json)
		return;
	if (arrived < chunks)
		snprintf(text, sizeof(text), "sending %s: %d of %d chunks",
			 submission_name(j), arrived, chunks);
	else
		snprintf(text, sizeof(text), "sent %s; edmd-jobs reads it",
			 submission_name(j));
	line_bar(l, (double)arrived / chunks, text);
}

/* Return: 0 if the service has given a final answer, -ETIMEDOUT, -EINTR. */
static int job_run(const struct ctl *c, struct submission *j)
{
	struct line l;
	int err = 0;

	line_init(&l);
	while (err == 0 && !talk_interrupted()) {
		err = submission_step(j);
		if (err == 0)
			talk_wait(c->talk, 20);
		show_progress(c, j, &l);
	}
	line_end(&l);
	return err < 0 ? err : err ? 0 : -EINTR;
}

static int print_outcome(const struct ctl *c, const struct submission *j)
{
	const struct talk_ack *a = submission_verdict(j);

	if (a->code) {
		submission_print_refusal("edmctl", c->arg, a);
		return a->code;
	}
	submission_print_notes(a);
	if (c->wait && c->json)
		return 0;
	if (c->json)
		printf("%s\n", a->body);
	else
		printf("job %s, %s: %s\n", submission_id(j),
		       submission_name(j), a->reason);
	fflush(stdout);
	return 0;
}

/* How long it will take is told when it was run in virtual time. */
struct awaited {
	const char *id;
	char text[256];
};

static void on_event(void *arg, const struct talk_event *e)
{
	struct awaited *a = arg;

	if (strcmp(e->kind, "forecast") == 0 && strcmp(e->job, a->id) == 0)
		plain_copy(a->text, sizeof(a->text), e->text);
}

/* A program that sends jobs does not wait for that. */
static void print_forecast(const struct ctl *c, const struct awaited *a)
{
	const double until_s = talk_now_s() + c->timeout_s;

	if (c->json || c->wait || !isatty(STDOUT_FILENO))
		return;
	while (!*a->text && talk_now_s() < until_s && !talk_interrupted())
		talk_wait(c->talk, 50);
	puts(*a->text ? a->text : "how long it takes is not known yet; edmctl "
				  "queue tells it later");
}

static int send_text(struct ctl *c, const struct submission_file *t,
		     char id[TALK_WORD_MAX])
{
	char setting[INTERP_SETTING_MAX];
	const struct submission_text x = {
		.setting = cmdline_pairs(interp_set_name, c->set, setting,
					 sizeof(setting)),
		.id = c->id, .text = t->bytes, .bytes = t->size,
		.name = c->name ? c->name : submission_file_name(c->arg),
		.hold = c->hold, .from_line = c->from_line,
		.from_mm = c->from_mm, .electrode = (int)c->electrode,
		.silent_s = c->timeout_s,
	};
	struct submission *j;
	struct awaited a;
	int err, rc;

	if (!x.setting)
		return cmdline_refuse("edmctl", "what is set for the job",
				      "is too long", "shorter numbers");
	if (!c->talk)
		return ctl_unanswered(c, -ETIMEDOUT);
	err = submission_begin(&j, c->talk, &x);

	if (err < 0) {
		fprintf(stderr, "edmctl: %s: %s\n", c->arg, strerror(-err));
		return EX_SOFTWARE;
	}
	a = (struct awaited) { .id = submission_id(j) };
	talk_on_event(c->talk, on_event, &a);
	err = job_run(c, j);
	rc = err < 0 ? ctl_unanswered(c, err) : print_outcome(c, j);
	if (rc == 0)
		print_forecast(c, &a);
	talk_on_event(c->talk, NULL, NULL);
	snprintf(id, TALK_WORD_MAX, "%s", submission_id(j));
	submission_end(j);
	return rc;
}

int ctl_submit(struct ctl *c)
{
	struct submission_file t = { .size = 0 };
	char id[TALK_WORD_MAX];
	int err;

	if (c->from_line && c->from_mm > 0)
		return cmdline_refuse("edmctl", "--from-line", "with "
				      "--from-place", "one of them");
	err = submission_read("edmctl", c->arg, &t);

	if (err == 0)
		err = send_text(c, &t, id);
	free(t.bytes);
	if (err == 0 && c->wait)
		err = ctl_wait(c, id);
	return err;
}
