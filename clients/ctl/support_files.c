/* SPDX-License-Identifier: Apache-2.0 */
/* support_files.c - the files of a support archive: one table */
#include "support.h"

#include "shm.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/utsname.h>
#include <unistd.h>

#define LOG_BYTES	(1 << 20)	/* the end of a log */

static const char no_answer[] =
	"edmd-jobs did not answer: systemctl status edmd-jobs\n";

/* -- Other programs -------------------------------------------------------- */

/* This program again, with another verb. */
static void run_verb(struct support *s, struct support_text *to,
		     const char *verb, bool json)
{
	struct ctl *c = s->ctl;
	char timeout[32];
	const char *argv[14] = { "/proc/self/exe", "--machine", c->machine,
				 "--timeout", timeout };
	int n = 5;

	snprintf(timeout, sizeof(timeout), "%g", c->timeout_s);
	if (c->url) {
		argv[n++] = "--url";
		argv[n++] = c->url;
	}
	if (c->key) {
		argv[n++] = "--key";
		argv[n++] = c->key;
	}
	if (json)
		argv[n++] = "--json";
	argv[n++] = verb;
	support_run(to, (char *const *)(uintptr_t)argv);
}

static void fill_doctor(struct support *s, struct support_text *to)
{
	run_verb(s, to, "doctor", false);
}

static void fill_latency(struct support *s, struct support_text *to)
{
	run_verb(s, to, "latency", false);
}

static void fill_status(struct support *s, struct support_text *to)
{
	if (s->store)
		run_verb(s, to, "status", true);
	else
		support_say(to, no_answer);
}

static void fill_journal(struct support *s, struct support_text *to)
{
	static const char *const argv[] = {
		"journalctl", "--no-pager", "--lines=20000",
		"--output=short-iso-precise", "--unit=edmd",
		"--unit=edmd-jobs", "--unit=edm-panel", "--unit=edm-dds", NULL
	};

	(void)s;
	support_run(to, (char *const *)(uintptr_t)argv);
	support_scrub_lines(to);
}

/* -- Files ----------------------------------------------------------------- */

/* At most the last @most bytes. */
static void add_file(struct support_text *to, const char *path, long most)
{
	FILE *f = fopen(path, "re");
	char some[65536];
	size_t n;

	if (!f) {
		support_say(to, "%s: %s\n", path, strerror(errno));
		return;
	}
	if (fseek(f, 0, SEEK_END) == 0 && ftell(f) > most)
		fseek(f, -most, SEEK_END);
	else
		rewind(f);
	while ((n = fread(some, 1, sizeof(some), f)) > 0)
		support_add(to, some, n);
	if (ferror(f))
		support_say(to, "\n%s: %s\n", path, strerror(errno));
	fclose(f);
}

static void fill_versions(struct support *s, struct support_text *to)
{
	const char *jobs = ctl_text_of(s->store, "version");
	struct utsname u;

	support_say(to, "edmctl " EDM_VERSION "\nedmd-jobs %s\nlayout of the "
		    "shared memory %d\n", *jobs ? jobs : "did not answer",
		    SHM_LAYOUT);
	if (uname(&u) == 0)
		support_say(to, "%s %s %s %s\n", u.sysname, u.release,
			    u.version, u.machine);
	add_file(to, "/proc/cmdline", LOG_BYTES);
	add_file(to, "/etc/os-release", LOG_BYTES);
}

static void fill_machine(struct support *s, struct support_text *to)
{
	const char *path = ctl_text_of(s->store, "machine_file");

	add_file(to, *path ? path : "/etc/edmd/machine.ini", SUPPORT_FILE_MAX);
	support_scrub_lines(to);
}

/* A program that was started by hand may write into a file. */
static void add_log(struct support_text *to, long pid)
{
	char path[64];
	struct stat st;

	snprintf(path, sizeof(path), "/proc/%ld/fd/2", pid);
	if (pid <= 0)
		support_say(to, "it is not running, or on another host\n");
	else if (stat(path, &st) < 0)
		support_say(to, "%s: %s\n", path, strerror(errno));
	else if (!S_ISREG(st.st_mode))
		support_say(to, "it does not write into a file; see "
			    "journal.txt\n");
	else
		add_file(to, path, LOG_BYTES);
	support_scrub_lines(to);
}

static void fill_log_jobs(struct support *s, struct support_text *to)
{
	add_log(to, (long)ctl_number_of(s->store, "pid"));
}

static void fill_log_edmd(struct support *s, struct support_text *to)
{
	const struct shm_status *status;

	if (shm_status_open(&status, s->ctl->machine) < 0) {
		support_say(to, "there is no edmd of machine %s on this host\n",
			    s->ctl->machine);
		return;
	}
	add_log(to, status->head.pid);
	shm_close(status, sizeof(*status));
}

/* -- What edmd-jobs tells -------------------------------------------------- */

static void add_json(struct support_text *to, json_t *o)
{
	char *text = json_dumps(o, JSON_INDENT(1) | JSON_REAL_PRECISION(15));

	support_add(to, text ? text : "", text ? strlen(text) : 0);
	support_add(to, "\n", 1);
	free(text);
}

static void ask(struct support *s, struct support_text *to, const char *verb)
{
	const struct talk_question q = { .verb = verb };
	struct talk_answer a;
	json_t *o;

	if (!s->store || talk_ask(s->ctl->talk, &q, s->ctl->timeout_s,
				  &a) < 0) {
		support_say(to, no_answer);
		return;
	}
	o = a.code == 0 && a.body ? json_loads(a.body, 0, NULL) : NULL;
	if (o)
		add_json(to, o);
	else
		support_say(to, "%s\n", a.reason);
	json_decref(o);
	talk_answer_free(&a);
}

static void fill_store(struct support *s, struct support_text *to)
{
	if (s->store)
		add_json(to, s->store);
	else
		support_say(to, no_answer);
}

static void fill_checkpoint(struct support *s, struct support_text *to)
{
	ask(s, to, "checkpoint");
}

static void fill_events(struct support *s, struct support_text *to)
{
	ask(s, to, "events");
}

static void fill_alarms(struct support *s, struct support_text *to)
{
	ask(s, to, "alarms");
}

static void fill_queue(struct support *s, struct support_text *to)
{
	ask(s, to, "queue");
}

static void fill_history(struct support *s, struct support_text *to)
{
	ask(s, to, "history");
}

/* -- Shared memory --------------------------------------------------------- */

static json_t *real(double x)
{
	return isfinite(x) ? json_real(x) : json_null();
}

static json_t *axes(const int32_t x[SHM_NAXES])
{
	json_t *row = json_array();

	for (int i = 0; i < SHM_NAXES; i++)
		json_array_append_new(row, json_integer(x[i]));
	return row;
}

static json_t *snapshot_put(const struct shm_snapshot *s)
{
	json_t *o = json_pack(
		"{s:I,s:I,s:s,s:I,s:I,s:I,s:I,s:I,s:I,s:b,s:b,s:b}",
		"cycle", (json_int_t)s->cycle,
		"time_ns", (json_int_t)s->time_ns,
		"state", shm_state_name(s->state),
		"fault", (json_int_t)s->fault,
		"faults", (json_int_t)s->faults,
		"program", (json_int_t)s->program, "line", (json_int_t)s->line,
		"segment", (json_int_t)s->seg, "tick", (json_int_t)s->tick,
		"power", s->power, "pump", s->pump, "loaded", s->loaded);

	json_object_update_new(o, json_pack(
		"{s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:i,s:i,s:i,s:i}",
		"place_mm", real(s->place_mm), "far_mm", real(s->far_mm),
		"gap_v", real(s->gap_v), "feed_mm_s", real(s->feed_mm_s),
		"override", real(s->override), "pos", axes(s->pos),
		"drive", axes(s->drive), "shift", axes(s->shift),
		"homed", s->homed, "unhomed", s->unhomed,
		"unplaced", s->unplaced, "limit", s->limit));
	json_object_update_new(o, json_pack(
		"{s:I,s:I,s:I,s:I,s:I,s:I,s:I,s:I,s:I}",
		"job_cycles", (json_int_t)s->job_cycles,
		"retracts", (json_int_t)s->retracts,
		"shorts", (json_int_t)s->shorts, "jumps", (json_int_t)s->jumps,
		"arcs", (json_int_t)s->arcs,
		"overruns", (json_int_t)s->overruns,
		"period_ns", (json_int_t)s->period_ns,
		"wake_late_max_ns", (json_int_t)s->wake_late_max_ns,
		"took_max_ns", (json_int_t)s->took_max_ns));
	return o;
}

static void fill_snapshot(struct support *s, struct support_text *to)
{
	const struct shm_status *status;
	struct shm_snapshot snap;
	const int err = shm_status_open(&status, s->ctl->machine);
	json_t *o = NULL;

	if (err < 0) {
		support_say(to, "no shared memory of edmd: %s\n",
			    strerror(-err));
		return;
	}
	if (shm_snapshot(status, &snap))
		o = snapshot_put(&snap);
	if (o)
		add_json(to, o);
	else
		support_say(to, "edmd has written no snapshot yet\n");
	json_decref(o);
	shm_close(status, sizeof(*status));
}

/* -- The table ------------------------------------------------------------- */

const struct support_file support_files[] = {
	{ "versions.txt", "releases of edmd, kernel and system",
	  fill_versions },
	{ "machine.ini", "the machine file", fill_machine },
	{ "doctor.txt", "what this host has and lacks", fill_doctor },
	{ "latency.txt", "how late edmd woke", fill_latency },
	{ "status.json", "the state of the machine", fill_status },
	{ "snapshot.json", "the same as edmd has it", fill_snapshot },
	{ "checkpoint.json", "the last checkpoint", fill_checkpoint },
	{ "store.json", "size and state of the database", fill_store },
	{ "events.json", "the last events", fill_events },
	{ "alarms.json", "the last alarms", fill_alarms },
	{ "queue.json", "the first jobs that wait", fill_queue },
	{ "history.json", "the last jobs that ended", fill_history },
	{ "journal.txt", "the journal of the services", fill_journal },
	{ "edmd.log", "what edmd writes into a file", fill_log_edmd },
	{ "edmd-jobs.log", "what edmd-jobs writes into a file", fill_log_jobs },
};

const int support_nfiles = sizeof(support_files) / sizeof(support_files[0]);
