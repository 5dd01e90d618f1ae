/* SPDX-License-Identifier: Apache-2.0 */
/*
 * watch.c - follows the messages of edmd-jobs: status, watch, and submit --wait
 */
#include "ctl.h"
#include "screen.h"

#include "plain.h"
#include "process.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sysexits.h>

#define ASK_S		1.0
#define GIVE_UP_S	60.0		/* by then a restarted service is
					 * back */

#define PRINT(name, value)	json_object_set_new(j, #name, value);
#define PRINT_WORD(name)	PRINT(name, json_string(s->name))
#define PRINT_COUNT(name)	PRINT(name, json_integer(s->name))
#define PRINT_NUMBER(name)	PRINT(name, json_real(s->name))

static void print_json(const struct talk_status *s)
{
	json_t *pos = json_array(), *work = json_array(), *j;
	char *text;

	for (int i = 0; i < TALK_NAXES; i++)
		json_array_append_new(pos, json_real(s->pos_mm[i]));
	for (int i = 0; i < TALK_NAXES; i++)
		json_array_append_new(work, json_real(s->work_mm[i]));
	j = json_pack("{s:I,s:s,s:o,s:o}", "utime", (json_int_t)s->utime,
		      "machine", s->machine, "pos_mm", pos, "work_mm", work);
	STATUS_FIELDS(PRINT_WORD, PRINT_WORD, PRINT_COUNT, PRINT_NUMBER)
	if (j && s->contour_mm >= 0) {
		json_object_set_new(j, "contour_um",
				    json_real(s->contour_mm * 1e3));
		json_object_set_new(j, "contour_predicted_um",
				    json_real(s->contour_predicted_mm * 1e3));
	}
	text = j ? json_dumps(j, JSON_COMPACT) : NULL;
	if (text)
		printf("%s\n", text);
	fflush(stdout);
	free(text);
	json_decref(j);
}

#define TAKE_TOLD(name, id)	told[id] = s->told_##name;

static void print_generator(const struct talk_status *s)
{
	double told[PROCESS_NTOLD];
	char text[400];

	for (int i = 0; i < PROCESS_NTOLD; i++)
		told[i] = NAN;
	PROCESS_TELLS(TAKE_TOLD)
	if (*process_told_text(told, text, sizeof(text)))
		printf("generator  tells %s\n", text);
	if (*s->generator_fault)
		printf("           its own fault: %s\n", s->generator_fault);
}

/* Of a wire. */
static void print_pass(const struct talk_status *s)
{
	if (s->wire_pass)
		printf("pass       %d of %d, offset %.4f mm\n", s->wire_pass,
		       s->wire_passes, s->wire_offset_mm);
	else if (s->wire_offset_mm != 0)
		printf("offset     %.4f mm to the %s\n",
		       fabs(s->wire_offset_mm),
		       s->wire_offset_mm > 0 ? "left" : "right");
}

static void print_places(const char *work, const char *axes,
			 const double mm[TALK_NAXES], double turn_deg)
{
	printf("work       %s", work);
	for (int i = 0; i < TALK_NAXES; i++)
		if (strchr(axes, "XYZABCUV"[i]))
			printf(" %c %.3f", "XYZABCUV"[i], mm[i]);
	if (turn_deg != 0)
		printf(" (turned by %.4f degrees)", turn_deg);
	putchar('\n');
}

/* The system in force; and those that an operator has touched off. */
static void print_work(struct ctl *c, const struct talk_status *s)
{
	json_t *rows = NULL, *row;
	double mm[TALK_NAXES];
	size_t k;

	if (*s->work)
		print_places(s->work, s->axes, s->work_mm, s->work_turn_deg);
	if (ctl_ask_json(c, &(struct talk_question) { .verb = "offsets" },
			 &rows))
		return;
	json_array_foreach(rows, k, row) {
		const json_t *at = json_object_get(row, "at_mm");

		if (!*ctl_text_of(row, "touched") ||
		    strcmp(ctl_text_of(row, "work"), s->work) == 0)
			continue;
		for (size_t i = 0; i < TALK_NAXES; i++)
			mm[i] = json_number_value(json_array_get(at, i));
		print_places(ctl_text_of(row, "work"), s->axes, mm,
			     ctl_number_of(row, "turn_deg"));
	}
	json_decref(rows);
}

static void print_text(struct ctl *c, const struct talk_status *s)
{
	char took[32], left[64], why[96], deep[64], sums[64], speed[64];

	ctl_duration(took, sizeof(took), s->job_s);
	ctl_left(left, sizeof(left), s);
	ctl_left_why(why, sizeof(why), s);
	ctl_deep(deep, sizeof(deep), s);
	ctl_sums(sums, sizeof(sums), s);
	ctl_speed(speed, sizeof(speed), s, s->feed_mm_s * 60);
	printf("machine    %s\nedmd       %s\nstate      %s\nfault      %s\n",
	       s->machine, s->daemon, s->state, s->fault);
	if (*s->asks)
		printf("stands     %s, %s\n", s->stand, s->asks);
	if (*s->job)
		printf("job        %s, %s, %s\nline       %d of %d\n"
		       "path       %.3f mm of %.3f mm, %.3f to go\n"
		       "%-10s %s\n"
		       "sums       %s\n"
		       "time       %s, %.1f %%, left %s%s\n", s->job,
		       s->job_name, s->job_state, s->line, s->lines,
		       s->place_mm, s->length_mm, s->length_mm - s->place_mm,
		       ctl_deep_word(s), deep, sums, took, s->progress * 100,
		       left, why);
	else
		printf("job        none\n");
	if (s->hunts > 0)
		printf("warning    the gap servo hunts; edmctl alarms\n");
	printf("gap        %.1f V\nfeed       %s\n", s->gap_v, speed);
	print_pass(s);
	if (strcmp(s->daemon, "ok") == 0)
		print_work(c, s);
	printf("machine at");
	for (int i = 0; i < TALK_NAXES; i++)
		if (strchr(s->axes, "XYZABCUV"[i]))
			printf(" %c %.3f", "XYZABCUV"[i], s->pos_mm[i]);
	printf(" (mm, degrees)\n");
	if (s->electrode)
		printf("electrode %u shifts Z by %+.4f mm, wear %.4f mm\n",
		       s->electrode, s->electrode_shift_mm,
		       s->electrode_wear_mm);
	if (*s->lost)
		printf("not sure   %s: not homed, or nothing homes it, since "
		       "the power went\n", s->lost);
	if (*s->interrupted)
		printf("interrupted %s; edmctl show tells where\n",
		       s->interrupted);
	print_generator(s);
	if (s->contour_mm >= 0)
		printf("contour    off by %.1f um at most, predicted %.1f um\n",
		       s->contour_mm * 1e3, s->contour_predicted_mm * 1e3);
	printf("queue      %d\n"
	       "condition  %s\nstore      %s\ntiming     woken late by %d us "
	       "at most, %d overruns\n",
	       s->queue_len, *s->condition ? s->condition : "none", s->store,
	       s->wake_late_max_us, s->overruns);
}

const struct talk_status *ctl_first_status(struct ctl *c)
{
	double until_s = talk_now_s() + c->timeout_s;
	uint64_t before, count;

	if (!c->talk)
		return NULL;
	talk_status(c->talk, &before);
	do {
		const struct talk_status *s;

		talk_wait(c->talk, 50);
		s = talk_status(c->talk, &count);
		if (count != before)
			return s;
	} while (talk_now_s() < until_s && !talk_interrupted());
	return NULL;
}

int ctl_status(struct ctl *c)
{
	const struct talk_status *s = ctl_first_status(c);

	if (!s)
		return ctl_unanswered(c, talk_interrupted() ? -EINTR :
				      -ETIMEDOUT);
	if (c->json)
		print_json(s);
	else
		print_text(c, s);
	return strcmp(s->daemon, "ok") == 0 ? 0 : EX_UNAVAILABLE;
}

static void goes_on(const struct ctl *c, const char *job)
{
	fprintf(stderr, "edmctl: no longer watching; %s%s goes on.  edmctl "
		"--machine %s watch shows it, stop ends it\n",
		*job ? "job " : "the machine", job, c->machine);
}

/* stop would end the one before it. */
static void waits_on(const struct ctl *c, const char *job)
{
	fprintf(stderr, "edmctl: no longer watching; job %s waits on.  edmctl "
		"--machine %s queue shows it, remove %s takes it away\n", job,
		c->machine, job);
}

static int watch_once(struct ctl *c, struct line *l,
		      const struct talk_status *s)
{
	if (c->json)
		print_json(s);
	else
		line_status(l, s);
	line_end(l);
	return 0;
}

/* Return: 0 if interrupted, -ETIMEDOUT if no status came any more. */
static int watch_on(struct ctl *c, struct line *l)
{
	double heard_s = talk_now_s();
	uint64_t seen = 0, count;

	while (!talk_interrupted()) {
		const struct talk_status *s = talk_status(c->talk, &count);

		if (count != seen && c->json)
			print_json(s);
		else if (count != seen)
			line_status(l, s);
		if (count != seen)
			heard_s = talk_now_s();
		seen = count;
		if (talk_now_s() - heard_s > c->timeout_s)
			return -ETIMEDOUT;
		talk_wait(c->talk, 100);
	}
	return 0;
}

int ctl_watch(struct ctl *c)
{
	const struct talk_status *s = ctl_first_status(c);
	struct line l;
	uint64_t count;
	int err;

	if (!s)
		return ctl_unanswered(c, talk_interrupted() ? -EINTR :
				      -ETIMEDOUT);
	line_init(&l);
	if (c->once)
		return watch_once(c, &l, s);
	err = c->json || c->in_line || !screen_can() ? -ENOTTY :
						       screen_watch(c);
	if (err == -ENOTTY)
		err = watch_on(c, &l);
	line_end(&l);
	if (err < 0)
		return ctl_unanswered(c, err);
	goes_on(c, talk_status(c->talk, &count)->job);
	return 0;
}

/* -- submit --wait -------------------------------------------------------- */

static bool is_over(const char *state)
{
	return strcmp(state, "done") == 0 || strcmp(state, "fault") == 0 ||
	       strcmp(state, "stopped") == 0 ||
	       strcmp(state, "interrupted") == 0;
}

static int report(const struct ctl *c, const char *body, json_t *job)
{
	const char *name = "", *state = "", *reason = "";
	double path = 0, length = 0, depth = 0, took_s = 0;
	int jumps = 0, retracts = 0, shorts = 0;
	char took[32];

	/* A job that was never begun has no totals: null leaves them 0. */
	json_unpack(job, "{s:s,s:s,s:s}", "name", &name, "state", &state,
		    "reason", &reason);
	json_unpack(job, "{s:F,s:F,s:F,s:F,s:i,s:i,s:i}", "path_mm", &path,
		    "length_mm", &length, "depth_mm", &depth, "job_s", &took_s,
		    "jumps", &jumps, "retracts", &retracts, "shorts", &shorts);
	ctl_duration(took, sizeof(took), took_s);
	if (c->json)
		printf("%s\n", body);
	else if (strcmp(c->verb, "offset") == 0)
		printf("job %s: %s%s%s\n", name, state, *reason ? ": " : "",
		       reason);
	else
		printf("job %s: %s%s%s\n"
		       "path       %.3f mm of %.3f mm\ndepth      %.3f mm\n"
		       "time       %s\njumps      %d\nretracts   %d\n"
		       "shorts     %d\n", name, state, *reason ? ": " : "",
		       reason, path, length, depth, took, jumps, retracts,
		       shorts);
	return strcmp(state, "done") == 0 ? 0 : 1;
}

/* What it waits for, and what ends that. */
static void tell_why(struct ctl *c, const char *id, struct line *l)
{
	const struct talk_question q = { .verb = "why", .job = id };
	char text[440] = "waits: ";
	struct talk_answer a;
	json_t *o;

	if (c->json || talk_ask(c->talk, &q, c->timeout_s, &a) < 0)
		return;
	o = a.code ? NULL : json_loads(a.body, 0, NULL);
	plain_copy(text + strlen(text), sizeof(text) - strlen(text),
		   ctl_text_of(o, "why"));
	if (*ctl_text_of(o, "why"))
		line_words(l, text);
	json_decref(o);
	talk_answer_free(&a);
}

/* Return: < 0 while the job goes on, else the exit code.
 * @waits: it has not begun. */
static int look(struct ctl *c, const char *id, struct line *l, double *heard_s,
		bool *waits)
{
	struct talk_question q = { .verb = "show", .job = id };
	struct talk_answer a;
	const char *state = "";
	json_t *job;
	int err = -1;

	if (talk_ask(c->talk, &q, c->timeout_s, &a) < 0)
		return -1;
	*heard_s = talk_now_s();
	job = a.code ? NULL : json_loads(a.body, 0, NULL);
	*waits = ctl_number_of(job, "begun_us") <= 0;
	if (a.code) {
		line_end(l);
		fprintf(stderr, "edmctl: job %s: %s\n", id, a.reason);
		err = a.code;
	} else if (json_unpack(job, "{s:s}", "state", &state) == 0 &&
		   is_over(state)) {
		line_end(l);
		err = report(c, a.body, job);
	} else if (strcmp(state, "running") != 0) {
		tell_why(c, id, l);
	}
	json_decref(job);
	talk_answer_free(&a);
	return err;
}

static void draw(struct ctl *c, struct line *l, const char *id,
		 uint64_t *seen)
{
	uint64_t count;
	const struct talk_status *s = talk_status(c->talk, &count);

	if (count == *seen || c->json)
		return;
	*seen = count;
	/* Otherwise tell_why() has the line. */
	if ((strcmp(s->job, id) == 0 && strcmp(s->job_state, "running") == 0) ||
	    strcmp(s->daemon, "ok") != 0)
		line_status(l, s);
}

int ctl_wait(struct ctl *c, const char *id)
{
	struct line l;
	double heard_s = talk_now_s(), asked_s = 0;
	uint64_t seen = 0, events = 0;
	bool waits = true;
	int err = -1;

	line_init(&l);
	while (err < 0 && !talk_interrupted()) {
		bool told = talk_events(c->talk) != events;

		if (told || talk_now_s() - asked_s > ASK_S) {
			events = talk_events(c->talk);
			asked_s = talk_now_s();
			err = look(c, id, &l, &heard_s, &waits);
		}
		if (err < 0 && talk_now_s() - heard_s > GIVE_UP_S) {
			line_end(&l);
			return ctl_unanswered(c, -ETIMEDOUT);
		}
		if (err < 0) {
			draw(c, &l, id, &seen);
			talk_wait(c->talk, 100);
		}
	}
	line_end(&l);
	if (err >= 0)
		return err;
	if (waits)
		waits_on(c, id);
	else
		goes_on(c, id);
	return EX_TEMPFAIL;
}
