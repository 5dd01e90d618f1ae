/* SPDX-License-Identifier: Apache-2.0 */
/*
 * begin.c - verbs that are answered when their motion begins
 */
#include "ctl.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

/* Return: the exit code. */
static int tell_moved(const struct ctl *c, const char *how, const char *fault)
{
	const bool there = strcmp(how, "there") == 0;

	if (c->json)
		printf("{\"verb\": \"%s\", \"moved\": \"%s\"}\n", c->verb,
		       how);
	else if (there)
		printf("%s: done\n", c->verb);
	else if (strcmp(how, "short") == 0)
		fprintf(stderr, "edmctl: %s: ended on its way, by a hold, a "
			"stop or something that it met; edmctl status says "
			"where\n", c->verb);
	else if (strcmp(how, "fault") == 0)
		fprintf(stderr, "edmctl: %s: ended by fault %s; edmctl alarms "
			"says what clears it\n", c->verb,
			*fault ? fault : "that was reset since");
	else
		fprintf(stderr, "edmctl: %s: how it ended is not known: "
			"another motion began since, or edmd or edmd-jobs "
			"ended; edmctl status says where it stands\n",
			c->verb);
	return there ? 0 : strcmp(how, "unknown") == 0 ? EX_UNAVAILABLE : 1;
}

/* Return: < 0 while the motion goes on, else the exit code. */
static int look_moved(struct ctl *c)
{
	const struct talk_question q = { .verb = "moved" };
	struct talk_answer a;
	json_t *o;
	int err = talk_ask(c->talk, &q, c->timeout_s, &a);

	if (err < 0)
		return talk_interrupted() ? -1 : ctl_unanswered(c, err);
	o = json_loads(a.body, 0, NULL);
	err = strcmp(ctl_text_of(o, "moved"), "goes on") == 0 ? -1 :
	      tell_moved(c, ctl_text_of(o, "moved"), ctl_text_of(o, "fault"));
	json_decref(o);
	talk_answer_free(&a);
	return err;
}

/* For a verb that is answered when its motion begins. */
static int say_moved(struct ctl *c, const struct talk_question *q)
{
	int err = ctl_say(c, q);

	if (err || !c->wait)
		return err;
	fflush(stdout);
	while ((err = look_moved(c)) < 0 && !talk_interrupted())
		talk_wait(c->talk, 100);
	if (err >= 0)
		return err;
	fprintf(stderr, "edmctl: no longer watching; the motion goes on.  "
		"edmctl hold ends it\n");
	return EX_TEMPFAIL;
}

/* For a verb that a job goes on by. */
static int say_job(struct ctl *c, const struct talk_question *q)
{
	const struct talk_status *s;
	char id[TALK_WORD_MAX];
	int err = ctl_say(c, q);

	if (err || !c->wait)
		return err;
	fflush(stdout);
	s = q->job ? NULL : ctl_first_status(c);
	snprintf(id, sizeof(id), "%s", q->job ? q->job : s ? s->job : "");
	if (*id)
		return ctl_wait(c, id);
	fprintf(stderr, "edmctl: %s --wait: no job is loaded\n", c->verb);
	return 1;
}

int ctl_start(struct ctl *c)
{
	return say_job(c, &(struct talk_question) {
		.verb = "start", .job = c->arg,
	});
}

int ctl_resume(struct ctl *c)
{
	return say_job(c, &(struct talk_question) {
		.verb = "resume", .job = c->arg, .text = c->value,
	});
}

int ctl_retract(struct ctl *c)
{
	char *end;
	double mm = strtod(c->arg, &end);

	if (end == c->arg || *end || !(mm > 0)) {
		fprintf(stderr, "edmctl: retract %s: not a length; a number of "
			"mm above 0\n", c->arg);
		return EX_USAGE;
	}
	return say_moved(c, &(struct talk_question) {
		.verb = "retract", .arg = mm,
	});
}

int ctl_step(struct ctl *c)
{
	double n;
	int err = ctl_number(c, c->arg, "nodes, as +1 or -2", &n);

	return err ? err : say_moved(c, &(struct talk_question) {
		.verb = "step", .arg = n,
	});
}

int ctl_jog(struct ctl *c)
{
	double mm;
	int err = ctl_number(c, c->value, "mm, or degrees of A B C, + or -",
			     &mm);

	return err ? err : say_moved(c, &(struct talk_question) {
		.verb = "jog", .text = c->arg, .arg = mm,
	});
}

int ctl_home(struct ctl *c)
{
	return say_moved(c, &(struct talk_question) {
		.verb = "home", .text = c->arg,
	});
}

int ctl_place(struct ctl *c)
{
	const bool is = strcmp(c->value, "is") == 0;
	double mm = 0;
	char text[32];
	int err = 0;

	if (!is && strcmp(c->value, "as-seen") != 0) {
		fprintf(stderr, "edmctl: place %s %s: as-seen, or is and a "
			"number\n", c->arg, c->value);
		return EX_USAGE;
	}
	if (is)
		err = ctl_number(c, c->third ? c->third : "",
				 "mm, or degrees of A B C", &mm);
	if (err)
		return err;
	snprintf(text, sizeof(text), "%.8s %s", c->arg, c->value);
	return ctl_say(c, &(struct talk_question) {
		.verb = "place", .text = text, .arg = mm,
	});
}
