/* SPDX-License-Identifier: Apache-2.0 */
/* reports.c - the jobs that have ended, and the alarms, of the last day */
#include "reports.h"

#include "clocks.h"
#include "edm.h"
#include "plain.h"
#include "topic.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define DAY_US		86400000000LL
#define EACH_S		10.0		/* between two questions */
#define AGAIN_S		2.0		/* after one that was not answered */
#define ANSWER_S	3.0
#define PAGE		50		/* rows of a question */
#define ALARMS_MAX	200		/* as edmd-jobs has it */

enum { JOBS, ALARMS };

static void ask(struct reports *r, const char *verb, const char *after,
		int rows);

/* -- To DDS ---------------------------------------------------------------- */

static void take_back(struct reports *r, int list, size_t at)
{
	const uint32_t number = r->told[list][at].number;
	edm_JobReport job = { .number = number };
	edm_Alarm alarm = { .number = number };

	snprintf(job.machine, sizeof(job.machine), "%s", r->machine);
	snprintf(alarm.machine, sizeof(alarm.machine), "%s", r->machine);
	dds_unregister_instance(r->writer[list], list == JOBS ?
				(const void *)&job : (const void *)&alarm);
	r->told[list][at] = r->told[list][--r->ntold[list]];
}

/* What is older than a day; and the oldest, if there is no room. */
static void forget(struct reports *r, int list)
{
	const int64_t since = clock_us(CLOCK_REALTIME) - DAY_US;
	const struct reports_told *t = r->told[list];
	size_t oldest = 0;

	for (size_t i = r->ntold[list]; i-- > 0;)
		if (t[i].utime < since)
			take_back(r, list, i);
	for (size_t i = 0; i < r->ntold[list]; i++)
		if (t[i].utime < t[oldest].utime)
			oldest = i;
	if (r->ntold[list] == TOPIC_KEPT_MAX)
		take_back(r, list, oldest);
}

static struct reports_told *find(const struct reports *r, int list,
				 uint32_t number)
{
	for (size_t i = 0; i < r->ntold[list]; i++)
		if (r->told[list][i].number == number)
			return &r->told[list][i];
	return NULL;
}

/* A job that ended by a fault may go on, and end again.  Return: true if it is
 * new. */
static bool tell(struct reports *r, int list, struct reports_told what,
		 const void *sample)
{
	struct reports_told *t = find(r, list, what.number);

	if (t && t->utime == what.utime)
		return false;
	if (!t)
		forget(r, list);
	if (dds_write(r->writer[list], sample) < 0)
		r->failed = true;
	else if (t)
		*t = what;
	else
		r->told[list][r->ntold[list]++] = what;
	return true;
}

/* -- From edmd-jobs -------------------------------------------------------- */

static double number(const json_t *o, const char *name)
{
	const json_t *v = json_object_get(o, name);

	return json_is_number(v) ? json_number_value(v) : NAN;
}

static uint32_t count(const json_t *o, const char *name)
{
	return (uint32_t)json_integer_value(json_object_get(o, name));
}

static int64_t utime(const json_t *o, const char *name)
{
	return json_integer_value(json_object_get(o, name));
}

static void word(char *to, size_t room, const json_t *o, const char *name)
{
	const char *text = json_string_value(json_object_get(o, name));

	plain_copy(to, room, text ? text : "");
}

#define WORD(to, o, name)	word(to, sizeof(to), o, name)

static bool take_job(struct reports *r, const json_t *o)
{
	edm_JobReport m = {
		.number = count(o, "n"),
		.submitted_utime = utime(o, "submitted_us"),
		.first_utime = utime(o, "first_us"),
		.ended_utime = utime(o, "ended_us"),
		.job_s = number(o, "job_s"), .erode_s = number(o, "erode_s"),
		.path_mm = number(o, "path_mm"),
		.length_mm = number(o, "length_mm"),
		.depth_mm = number(o, "depth_mm"),
		.energy_j = number(o, "energy_j"),
		.jumps = count(o, "jumps"), .retracts = count(o, "retracts"),
		.shorts = count(o, "shorts"), .arcs = count(o, "arcs"),
		.lines = count(o, "lines"),
	};

	snprintf(m.machine, sizeof(m.machine), "%s", r->machine);
	WORD(m.job, o, "job");
	WORD(m.name, o, "name");
	WORD(m.state, o, "state");
	WORD(m.reason, o, "reason");
	WORD(m.sha256, o, "sha256");
	return tell(r, JOBS, (struct reports_told){ m.number, m.ended_utime },
		    &m);
}

static bool take_alarm(struct reports *r, const json_t *o)
{
	edm_Alarm m = {
		.number = count(o, "n"), .utime = utime(o, "utime"),
		.place_mm = number(o, "place_mm"),
	};

	WORD(m.kind, o, "kind");
	WORD(m.fault, o, "fault");
	WORD(m.job, o, "job");
	WORD(m.text, o, "text");
	snprintf(m.machine, sizeof(m.machine), "%s", r->machine);
	return tell(r, ALARMS, (struct reports_told){ m.number, m.utime }, &m);
}

/*
 * Newest first.  Return: does the list go on with what may be new?  It does not
 * behind what is older than a day, nor behind rows that all were told, unless
 * the whole day is asked for.
 */
static bool take_rows(struct reports *r, int list, const json_t *rows)
{
	const int64_t since = clock_us(CLOCK_REALTIME) - DAY_US;
	const char *when = list == JOBS ? "ended_us" : "utime";
	size_t news = 0, i;
	const json_t *o;

	json_array_foreach(rows, i, o) {
		if (utime(o, when) < since)
			return false;
		news += list == JOBS ? take_job(r, o) : take_alarm(r, o);
	}
	return i && (news || r->all);
}

static void say(struct reports *r, const char *what)
{
	if (*what && strcmp(r->said, what) != 0)
		fprintf(stderr, "edm-dds: no reports: %s\n", what);
	snprintf(r->said, sizeof(r->said), "%s", what);
}

static void on_jobs(struct reports *r, const json_t *rows)
{
	char last[64];

	if (take_rows(r, JOBS, rows)) {
		WORD(last, json_array_get(rows, json_array_size(rows) - 1),
		     "job");
		ask(r, "history", last, PAGE);
	} else {
		ask(r, "alarms", "", r->all ? ALARMS_MAX : PAGE);
	}
}

static void on_alarms(struct reports *r, const json_t *rows)
{
	if (take_rows(r, ALARMS, rows) && !r->all &&
	    json_array_size(rows) == PAGE) {
		ask(r, "alarms", "", ALARMS_MAX);
		return;
	}
	r->all = r->failed;
	r->due_s = talk_now_s() + (r->failed ? AGAIN_S : EACH_S);
}

static void answered(struct reports *r, int err, const struct talk_ack *a,
		     void (*take)(struct reports *r, const json_t *rows))
{
	json_t *rows = err || a->code ? NULL : json_loads(a->body, 0, NULL);

	r->asking = false;
	if (rows) {
		say(r, "");
		take(r, rows);
	} else {
		/* A job may have gone from the history meanwhile. */
		r->all = true;
		r->due_s = talk_now_s() + AGAIN_S;
		say(r, err ? talk_why(r->talk) : a->reason);
	}
	json_decref(rows);
}

static void on_history_answer(void *arg, int err, const struct talk_ack *a)
{
	answered(arg, err, a, on_jobs);
}

static void on_alarms_answer(void *arg, int err, const struct talk_ack *a)
{
	answered(arg, err, a, on_alarms);
}

static void ask(struct reports *r, const char *verb, const char *after,
		int rows)
{
	const struct talk_question q = {
		.verb = verb, .job = after, .arg = rows,
	};

	r->asking = talk_send(r->talk, &q, ANSWER_S, *verb == 'h' ?
			      on_history_answer : on_alarms_answer, r) == 0;
	if (!r->asking)
		r->due_s = talk_now_s() + AGAIN_S;
}

static void on_event(void *arg, const struct talk_event *e)
{
	static const char *const kinds[] = {
		"ended", "alarm", "warning", "lost", "back",
	};
	struct reports *r = arg;

	for (size_t i = 0; i < sizeof(kinds) / sizeof(kinds[0]); i++)
		if (strcmp(e->kind, kinds[i]) == 0)
			r->due_s = 0;
}

/* -- In the loop ----------------------------------------------------------- */

int reports_open(struct reports *r, dds_entity_t part,
		 const char *machine, const char *key)
{
	static const enum topic topics[] = { TOPIC_REPORT, TOPIC_ALARM };

	*r = (struct reports) { .machine = machine, .key = key, .all = true };
	for (int i = 0; i < REPORTS_LISTS; i++) {
		r->told[i] = calloc(TOPIC_KEPT_MAX, sizeof(*r->told[i]));
		if (!r->told[i])
			return DDS_RETCODE_OUT_OF_RESOURCES;
		r->writer[i] = topic_writer_create(part, topics[i]);
		if (r->writer[i] < 0)
			return r->writer[i];
	}
	return 0;
}

void reports_close(struct reports *r)
{
	talk_close(r->talk);
	for (int i = 0; i < REPORTS_LISTS; i++)
		free(r->told[i]);
}

static void reach(struct reports *r)
{
	char said[TALK_SAID_MAX];
	const struct talk_options o = {
		.machine = r->machine, .key = r->key, .program = "edm-dds",
	};

	if (talk_open(&r->talk, &o, said) < 0) {
		r->talk = NULL;
		r->due_s = talk_now_s() + AGAIN_S;
		say(r, said);
		return;
	}
	talk_on_event(r->talk, on_event, r);
}

void reports_step(struct reports *r)
{
	if (!r->machine)
		return;
	if (r->talk)
		talk_step(r->talk);
	if (r->asking || talk_now_s() < r->due_s)
		return;
	r->failed = false;
	if (!r->talk)
		reach(r);
	if (r->talk)
		ask(r, "history", "", PAGE);
}
