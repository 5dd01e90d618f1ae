/* SPDX-License-Identifier: Apache-2.0 */
/*
 * verbs.c - what a browser may ask for over the web socket: one table
 *
 * A verb that does something goes to edmd-jobs. It is answered when edmd-jobs
 * has answered. The journal says who did it, and with what result.
 */
#include "panel.h"
#include "clocks.h"
#include "press.h"
#include "values.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <time.h>
#include <unistd.h>

#define HISTORY_S_MAX	3600.0
#define TEXT_MAX	(4u << 20)	/* of what a child may say */
#define PAST_SHARE	0.2		/* share of the time, for answers about
					 * the past */
#define PAST_BURST_S	0.5
#define NUMBER		0x100u		/* it needs arg */
#define LINES		0x200u		/* its text has several lines */
#define LINES_MAX	4000

struct verb {
	const char *name;
	enum role role;			/* the least */
	void (*run)(struct browser *b, const struct verb *v, int64_t n,
		    const json_t *o);
	const char *asks;		/* the verb of edmd-jobs; NULL: the same
					 * name */
	enum verbs_urge act;		/* not VERBS_ASK: note it in the
					 * journal */
	unsigned int flags;		/* SERVICE_*, NUMBER, LINES */
};

/* A request that is not answered yet. */
struct pending {
	struct pending *next;
	struct browser *browser;	/* NULL: gone */
	struct panel *panel;
	const struct verb *verb;
	int64_t n;
	char what[256];			/* who did what; "": it does nothing */
};

static struct pending *all;

/* If a key is there, a word must be a short text, and a number must be a number
 * or null. Anything else must not count as missing: "home" without an axis
 * homes all axes. */
static bool is_fit(const struct verb *v, const json_t *o)
{
	const struct {
		const char *key;
		size_t max;
	} words[] = {
		{ "job", SERVICE_WORD_MAX },
		{ "text", v->flags & LINES ? LINES_MAX : SERVICE_WORD_MAX },
	};
	const json_t *arg = json_object_get(o, "arg");

	for (size_t i = 0; i < sizeof(words) / sizeof(words[0]); i++) {
		const json_t *w = json_object_get(o, words[i].key);

		if (w && (!json_is_string(w) ||
			  json_string_length(w) >= words[i].max))
			return false;
	}
	if (!arg)
		return !(v->flags & NUMBER);
	return json_is_number(arg) || json_is_null(arg);
}

static const char *text_of(const json_t *o, const char *key)
{
	const char *s = json_string_value(json_object_get(o, key));

	return s ? s : "";
}

static double number_of(const json_t *o, const char *key)
{
	return json_number_value(json_object_get(o, key));
}

static struct pending *pend(struct browser *b, const struct verb *v, int64_t n)
{
	struct pending *p = calloc(1, sizeof(*p));

	if (!p)
		return NULL;
	p->browser = b;
	p->panel = socket_panel(b);
	p->verb = v;
	p->n = n;
	p->next = all;
	all = p;
	return p;
}

static void unpend(struct pending *p)
{
	struct pending **at = &all;

	while (*at != p)
		at = &(*at)->next;
	*at = p->next;
	free(p);
}

void verbs_forget(struct browser *b)
{
	for (struct pending *p = all; p; p = p->next)
		if (p->browser == b)
			p->browser = NULL;
}

static void refuse(struct browser *b, int64_t n, int code, const char *reason)
{
	socket_answer(b, n, code, reason, NULL);
}

/* -- Of edmd-jobs --------------------------------------------------------- */

static void on_answer(void *arg, const struct service_answer *a)
{
	struct pending *p = arg;

	if (p->what[0])
		panel_note(p->panel, "%s: %.60s", p->what, a->reason);
	if (p->browser)
		socket_answer(p->browser, p->n, a->code, a->reason,
			      a->body && *a->body ?
			      json_loads(a->body, JSON_DECODE_ANY, NULL) :
			      NULL);
	unpend(p);
}

static void describe(struct pending *p, const struct session *s,
		     const struct service_question *q)
{
	snprintf(p->what, sizeof(p->what), "%s (%s, %s): %s%s%.40s%s%.40s",
		 s->user, role_name(s->role), s->address, q->verb,
		 *q->text ? " " : "", q->text, *q->job ? " " : "", q->job);
	if (q->arg != 0)
		snprintf(p->what + strlen(p->what),
			 sizeof(p->what) - strlen(p->what), " %g", q->arg);
}

void verbs_who(struct browser *b, enum verbs_urge urge, struct share_who *ret)
{
	socket_who(b, ret);
	ret->rank += (int)urge * (ROLE_SERVICE + 1);
}

static void run_ask(struct browser *b, const struct verb *v, int64_t n,
		    const json_t *o)
{
	struct share_who who;
	/* A JSON null takes a value back; messages/README.md calls this NaN. */
	const struct service_question q = {
		.who = &who,
		.verb = v->asks ? v->asks : v->name, .flags = v->flags,
		.job = text_of(o, "job"), .text = text_of(o, "text"),
		.arg = json_is_null(json_object_get(o, "arg")) ? NAN :
		       number_of(o, "arg"),
	};
	struct pending *p = pend(b, v, n);

	verbs_who(b, v->act, &who);
	if (p && v->act)
		describe(p, socket_session(b), &q);
	if (p && service_ask(socket_panel(b)->service, &q, on_answer, p) == 0)
		return;
	if (p)
		unpend(p);
	refuse(b, n, EX_TEMPFAIL, *service_why(socket_panel(b)->service) ?
	       service_why(socket_panel(b)->service) :
	       "too many requests are under way; try again");
}

/* -- Of the panel itself -------------------------------------------------- */

/* All browsers together get a share of the time for this. The state, and a
 * stop, must not wait for many who ask about the past. */
static bool may_look_back(struct panel *p, double at_s)
{
	p->past_owed_s -= (at_s - p->past_at_s) * PAST_SHARE;
	if (p->past_owed_s < 0)
		p->past_owed_s = 0;
	p->past_at_s = at_s;
	return p->past_owed_s < PAST_BURST_S;
}

static void run_history(struct browser *b, const struct verb *v, int64_t n,
			const json_t *o)
{
	const double s = number_of(o, "seconds");
	const double points = number_of(o, "points");
	struct panel *p = socket_panel(b);
	const double begun_s = clock_s(CLOCK_MONOTONIC);

	(void)v;
	if (!(s > 0 && s <= HISTORY_S_MAX && points >= 10 && points <= 2000)) {
		refuse(b, n, EX_DATAERR, "seconds up to 3600, and 10 to 2000 "
		       "points");
		return;
	}
	if (!may_look_back(p, begun_s)) {
		refuse(b, n, EX_TEMPFAIL, "too many browsers ask for the past; "
		       "try again");
		return;
	}
	socket_answer(b, n, 0, "done", live_history(p->live, s, (int)points));
	p->past_owed_s += clock_s(CLOCK_MONOTONIC) - begun_s;
}

static void run_latency(struct browser *b, const struct verb *v, int64_t n,
			const json_t *o)
{
	const uint32_t *bin = live_latency(socket_panel(b)->live);
	json_t *bins = json_array();

	(void)v, (void)o;
	for (int i = 0; bin && i < SHM_LATENCY_BINS; i++)
		json_array_append_new(bins, json_integer(bin[i]));
	socket_answer(b, n, 0, "done", bins);
}

static void run_notes(struct browser *b, const struct verb *v, int64_t n,
		      const json_t *o)
{
	(void)v, (void)o;
	socket_answer(b, n, 0, "done", panel_notes(socket_panel(b)));
}

static void run_press(struct browser *b, const struct verb *v, int64_t n,
		      const json_t *o)
{
	(void)v;
	press_take(b, n, o);
}

/* -- Of other programs ---------------------------------------------------- */

/* Read one JSON value, or one in each line. */
static json_t *read_said(const char *text)
{
	json_t *one = json_loads(text, 0, NULL), *rows;

	if (one)
		return one;
	rows = json_array();
	while (*text) {
		const size_t len = strcspn(text, "\n");
		json_t *row = json_loadb(text, len, 0, NULL);

		if (row)
			json_array_append_new(rows, row);
		text += len + (text[len] == '\n');
	}
	return rows;
}

static void tell_said(struct pending *p, int status, const char *text)
{
	if (!p->browser)
		return;
	if (text && status < 64)
		socket_answer(p->browser, p->n, 0, "done", read_said(text));
	else
		refuse(p->browser, p->n, EX_UNAVAILABLE, status == 127 ?
		       "the program that tells it is not installed" :
		       "the program that tells it failed");
}

/* Answer everybody who has asked for it meanwhile. */
static void on_said(void *arg, int status, int out_fd)
{
	const struct verb *verb = arg;
	char *text = child_read(out_fd, TEXT_MAX, NULL);
	struct pending *next;

	close(out_fd);
	for (struct pending *p = all; p; p = next) {
		next = p->next;
		if (p->verb != verb)
			continue;
		tell_said(p, status, text);
		unpend(p);
	}
	free(text);
}

static bool is_under_way(const struct verb *v)
{
	for (const struct pending *p = all; p; p = p->next)
		if (p->verb == v)
			return true;
	return false;
}

/* A program runs only once, even if many ask what it says. */
static void say(struct browser *b, const struct verb *v, int64_t n,
		const char *const argv[])
{
	const struct child_job j = { .argv = argv, .in_fd = -1, .limit_s = 15 };
	const bool runs = is_under_way(v);
	struct pending *p = pend(b, v, n);

	if (p && (runs || child_start(socket_panel(b)->children, &j, on_said,
				      (void *)(uintptr_t)v) == 0))
		return;
	if (p)
		unpend(p);
	refuse(b, n, EX_TEMPFAIL, "too much is under way; try again");
}

/* A program in the folder of this one, or in PATH. */
static const char *beside(const struct panel *p, const char *name,
			  char to[512])
{
	const char *slash = strrchr(p->self, '/');

	snprintf(to, 512, "%.*s/%s", slash ? (int)(slash - p->self) : 0,
		 p->self, name);
	return access(to, X_OK) == 0 ? to : name;
}

static void run_doctor(struct browser *b, const struct verb *v, int64_t n,
		       const json_t *o)
{
	struct panel *p = socket_panel(b);
	char path[512];
	const char *const argv[] = {
		beside(p, "edmctl", path), "--machine", p->config.name,
		"--json", "doctor", NULL
	};

	(void)o;
	say(b, v, n, argv);
}

static void run_fleet(struct browser *b, const struct verb *v, int64_t n,
		      const json_t *o)
{
	struct panel *p = socket_panel(b);
	char path[512], domain[16];
	const char *const argv[] = {
		beside(p, "edm-fleet", path), "--once", "--json", "--wait",
		"2", "--domain", domain, NULL
	};

	(void)o;
	snprintf(domain, sizeof(domain), "%d", (int)p->config.dds_domain);
	say(b, v, n, argv);
}

static void run_log(struct browser *b, const struct verb *v, int64_t n,
		    const json_t *o)
{
	static const char *const argv[] = {
		"journalctl", "-u", "edmd", "-u", "edmd-jobs", "-u",
		"edm-panel", "-n", "200", "-o", "json", "--output-fields",
		"MESSAGE,_SYSTEMD_UNIT,PRIORITY", "--no-pager", "-q", NULL
	};

	(void)o;
	say(b, v, n, argv);
}

static void run_tech(struct browser *b, const struct verb *v, int64_t n,
		     const json_t *o)
{
	struct panel *p = socket_panel(b);
	const char *const argv[] = {
		p->self, "--work", "tech", "--config", p->config_path, NULL
	};

	(void)o;
	say(b, v, n, argv);
}

/* clang-format off */
static const struct verb verbs[] = {
	{ "start",    ROLE_OPERATOR, run_ask, NULL, VERBS_ACT, 0 },
	{ "hold",     ROLE_OPERATOR, run_ask, NULL, VERBS_END, 0 },
	{ "resume",   ROLE_OPERATOR, run_ask, NULL, VERBS_ACT, 0 },
	{ "stop",     ROLE_OPERATOR, run_ask, NULL, VERBS_END, 0 },
	{ "retract",  ROLE_OPERATOR, run_ask, NULL, VERBS_ACT, NUMBER },
	{ "step",     ROLE_OPERATOR, run_ask, NULL, VERBS_ACT, NUMBER },
	{ "done",     ROLE_OPERATOR, run_ask, NULL, VERBS_ACT, NUMBER },
	{ "jog",      ROLE_OPERATOR, run_ask, NULL, VERBS_ACT,
	  SERVICE_ONCE | NUMBER },
	{ "press",    ROLE_OPERATOR, run_press, NULL, VERBS_ASK, NUMBER },
	{ "home",     ROLE_OPERATOR, run_ask, NULL, VERBS_ACT, 0 },
	{ "place",    ROLE_OPERATOR, run_ask, NULL, VERBS_ACT, NUMBER },
	{ "override", ROLE_OPERATOR, run_ask, NULL, VERBS_ACT, NUMBER },
	{ "estop",    ROLE_OPERATOR, run_ask, NULL, VERBS_END, 0 },
	{ "reset",    ROLE_OPERATOR, run_ask, NULL, VERBS_ACT, 0 },
	{ "set",      ROLE_OPERATOR, run_ask, NULL, VERBS_ACT, NUMBER },
	{ "remove",   ROLE_OPERATOR, run_ask, NULL, VERBS_ACT, 0 },
	{ "move",     ROLE_OPERATOR, run_ask, NULL, VERBS_ACT, NUMBER },
	{ "electrode-add", ROLE_OPERATOR, run_ask, NULL, VERBS_ACT, NUMBER | LINES },
	{ "electrode-set", ROLE_OPERATOR, run_ask, NULL, VERBS_ACT, NUMBER | LINES },
	{ "electrode-remove", ROLE_OPERATOR, run_ask, NULL, VERBS_ACT, NUMBER },
	{ "electrode-use", ROLE_OPERATOR, run_ask, NULL, VERBS_ACT, NUMBER },
	{ "electrode-measure", ROLE_OPERATOR, run_ask, NULL, VERBS_ACT, NUMBER },
	{ "electrodes", ROLE_VIEWER, run_ask, NULL, VERBS_ASK, NUMBER },
	{ "offset",   ROLE_OPERATOR, run_ask, NULL, VERBS_ACT, LINES },
	{ "mdi",      ROLE_OPERATOR, run_ask, NULL, VERBS_ACT, LINES },
	{ "tech-set", ROLE_OPERATOR, run_ask, NULL, VERBS_ACT, LINES },
	{ "tech-back", ROLE_OPERATOR, run_ask, NULL, VERBS_ACT, NUMBER },
	{ "tech-versions", ROLE_VIEWER, run_ask, NULL, VERBS_ASK, 0 },
	{ "offsets",  ROLE_VIEWER,   run_ask, NULL, VERBS_ASK, 0 },
	{ "text",     ROLE_VIEWER,   run_ask, NULL, VERBS_ASK, 0 },
	{ "queue",    ROLE_VIEWER,   run_ask, NULL, VERBS_ASK, 0 },
	{ "show",     ROLE_VIEWER,   run_ask, NULL, VERBS_ASK, 0 },
	{ "past",     ROLE_VIEWER,   run_ask, "history", VERBS_ASK, 0 },
	{ "totals",   ROLE_VIEWER,   run_ask, NULL, VERBS_ASK, NUMBER },
	{ "trail",    ROLE_VIEWER,   run_ask, NULL, VERBS_ASK, 0 },
	{ "alarms",   ROLE_VIEWER,   run_ask, NULL, VERBS_ASK, 0 },
	{ "history",  ROLE_VIEWER,   run_history, NULL, VERBS_ASK, 0 },
	{ "latency",  ROLE_VIEWER,   run_latency, NULL, VERBS_ASK, 0 },
	{ "notes",    ROLE_VIEWER,   run_notes, NULL, VERBS_ASK, 0 },
	{ "doctor",   ROLE_VIEWER,   run_doctor, NULL, VERBS_ASK, 0 },
	{ "fleet",    ROLE_VIEWER,   run_fleet, NULL, VERBS_ASK, 0 },
	{ "log",      ROLE_OPERATOR, run_log, NULL, VERBS_ASK, 0 },
	{ "tech",     ROLE_VIEWER,   run_tech, NULL, VERBS_ASK, 0 },
};
/* clang-format on */

#define NVERBS	(sizeof(verbs) / sizeof(verbs[0]))

void verbs_do(struct browser *b, const json_t *o)
{
	const char *name = json_string_value(json_object_get(o, "do"));
	const int64_t n = json_integer_value(json_object_get(o, "n"));
	const struct session *s = socket_session(b);
	char reason[160];

	for (size_t i = 0; i < NVERBS; i++) {
		if (strcmp(verbs[i].name, name) != 0)
			continue;
		if (!is_fit(&verbs[i], o)) {
			refuse(b, n, EX_DATAERR, "job and text are words of "
			       "less than 64 bytes (values on lines "
			       "of their own: less than 4000), arg is a number");
			return;
		}
		if (s->role >= verbs[i].role) {
			verbs[i].run(b, &verbs[i], n, o);
			return;
		}
		snprintf(reason, sizeof(reason), "the role %s may not %s; "
			 "log in as %s", role_name(s->role), name,
			 role_name(verbs[i].role));
		panel_note(socket_panel(b), "%s (%s, %s): %s was refused",
			   s->user, role_name(s->role), s->address, name);
		refuse(b, n, EX_NOPERM, reason);
		return;
	}
	refuse(b, n, EX_USAGE, "no such request");
}

/* -- Hello ---------------------------------------------------------------- */

static json_t *axis(const struct machine_config *c, int i)
{
	const struct interp_axis_limits *a = &c->axes.axis[i];

	return json_pack("{s:s#,s:i,s:b,s:f,s:f,s:f,s:f,s:f,s:b}", "name",
			 &INTERP_AXIS_LETTERS[i], 1, "index", i, "rotary",
			 interp_axis_is_rotary((enum interp_axis)i), "min",
			 a->travel_min_mm, "max", a->travel_max_mm, "pulse",
			 a->pulse_mm, "vMax", a->v_max_mm_s, "jog",
			 c->manual[i].jog_mm_s, "homes",
			 c->manual[i].method != 0);
}

json_t *verbs_hello(struct panel *p, const struct session *s)
{
	const struct machine_config *c = &p->config;
	json_t *axes = json_array();

	for (int i = 0; i < INTERP_NAXES; i++)
		if (c->axes.present >> i & 1)
			json_array_append_new(axes, axis(c, i));
	return json_pack("{s:s,s:s,s:s,s:s,s:o,s:o,s:i,s:f,s:b,s:b,s:s}",
			 "machine", c->name, "user", s->user, "role",
			 role_name(s->role), "version", EDM_VERSION, "axes",
			 axes, "fields", values_fields(), "process",
			 c->gap.process, "height",
			 config_wire_height_mm(c, &c->wire),
			 "plc", config_has_plc(c), "simulated",
			 config_machine_is(c, MACHINE_NO_WIRES), "table",
			 c->tech_table);
}
