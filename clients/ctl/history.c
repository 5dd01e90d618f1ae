/* SPDX-License-Identifier: Apache-2.0 */
/*
 * history.c - what jobs came to: as text, and as CSV
 *
 * CSV is that of RFC 4180: commas, quotes doubled, CR LF.  Some programs take a
 * text that begins with `=` for a formula and carry it out, and the name of a
 * job comes from who sent it.  Such a text gets a ' in front.
 */
#include "history.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sysexits.h>
#include <time.h>

static const char *condition_of(json_t *row)
{
	const char *name = ctl_text_of(row, "condition");

	return *name ? name : "none";
}

/* -- Text ------------------------------------------------------------------ */

static void say_energy(char to[32], json_t *row)
{
	json_t *j = json_object_get(row, "energy_j");

	if (json_is_number(j))
		snprintf(to, 32, "%.1f J", json_number_value(j));
	else
		snprintf(to, 32, "not counted");
}

static void print_conditions(json_t *rows)
{
	char took[32], energy[32];
	json_t *row;
	size_t i;

	json_array_foreach(rows, i, row) {
		ctl_duration(took, sizeof(took), ctl_number_of(row, "job_s"));
		say_energy(energy, row);
		printf("%-10s %-6s %s, eroding %.1f s, jumps %.0f, retracts "
		       "%.0f, shorts %.0f, arcs %.0f, energy %s\n",
		       i ? "" : "conditions", condition_of(row), took,
		       ctl_number_of(row, "erode_s"),
		       ctl_number_of(row, "jumps"),
		       ctl_number_of(row, "retracts"),
		       ctl_number_of(row, "shorts"), ctl_number_of(row, "arcs"),
		       energy);
	}
}

static void print_faults(json_t *rows)
{
	json_t *row;
	char at[32];
	size_t i;

	json_array_foreach(rows, i, row) {
		ctl_when(at, row, "utime");
		printf("%-10s %s %10.3f mm  line %.0f  %s\n",
		       i ? "" : "faults", at, ctl_number_of(row, "place_mm"),
		       ctl_number_of(row, "line"), ctl_text_of(row, "fault"));
	}
}

void history_print(json_t *job)
{
	char energy[32];

	if (!json_is_number(json_object_get(job, "erode_s")))
		return;
	say_energy(energy, job);
	printf("eroding    %.1f s\narcs       %.0f\nenergy     %s\n",
	       ctl_number_of(job, "erode_s"), ctl_number_of(job, "arcs"),
	       energy);
	print_conditions(json_object_get(job, "conditions"));
	print_faults(json_object_get(job, "faults"));
}

/* -- CSV ------------------------------------------------------------------- */

/* The last four are wide forms of the first four. */
static bool is_formula(const char *s)
{
	static const char *const starts[] = {
		"=", "+", "-", "@", "\t", "\r", "\n",
		"\xef\xbc\x9d", "\xef\xbc\x8b", "\xef\xbc\x8d", "\xef\xbc\xa0",
	};

	for (size_t i = 0; i < sizeof(starts) / sizeof(starts[0]); i++)
		if (strncmp(s, starts[i], strlen(starts[i])) == 0)
			return true;
	return false;
}

static void put_text(const char *s)
{
	const bool formula = is_formula(s);

	if (!formula && !strpbrk(s, ",\"\r\n'")) {
		fputs(s, stdout);
		return;
	}
	fputs(formula ? "\"'" : "\"", stdout);
	for (; *s; s++) {
		if (*s == '"')
			putchar('"');
		putchar(*s);
	}
	putchar('"');
}

static void put_time(json_t *v)
{
	const json_int_t us = json_integer_value(v);
	const time_t t = (time_t)(us / 1000000);
	struct tm tm;
	char text[32];

	if (us <= 0 || !gmtime_r(&t, &tm))
		return;
	strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%S", &tm);
	printf("%s.%03dZ", text, (int)(us / 1000 % 1000));
}

static void put_real(json_t *v)
{
	if (json_is_number(v))
		printf("%.3f", json_number_value(v));
}

static void put_whole(json_t *v)
{
	if (json_is_number(v))
		printf("%.0f", json_number_value(v));
}

static void put_string(json_t *v)
{
	if (json_is_string(v))
		put_text(json_string_value(v));
}

/* The names of conditions and faults are our own: no comma, no formula. */
static void put_conditions(json_t *v)
{
	json_t *row;
	size_t i;

	json_array_foreach(v, i, row)
		printf("%s%s=%.3f", i ? ";" : "", condition_of(row),
		       ctl_number_of(row, "job_s"));
}

static void put_faults(json_t *v)
{
	json_t *row;
	size_t i;

	json_array_foreach(v, i, row)
		printf("%s%s@%.3f/%.0f", i ? ";" : "",
		       ctl_text_of(row, "fault"),
		       ctl_number_of(row, "place_mm"),
		       ctl_number_of(row, "line"));
}

/* By how much each electrode was worn; nothing where that is not known. */
static void put_electrodes(json_t *v)
{
	json_t *row;
	size_t i;

	json_array_foreach(v, i, row) {
		printf("%s%.0f=", i ? ";" : "",
		       ctl_number_of(row, "electrode"));
		if (json_is_true(json_object_get(row, "known")))
			printf("%.4f", ctl_number_of(row, "wear_after_mm") -
			       ctl_number_of(row, "wear_before_mm"));
	}
}

/* A new column is put behind the last one: docs/history.md. */
static const struct {
	const char *head, *key;
	void (*put)(json_t *v);
} columns[] = {
	{ "job", "job", put_string },
	{ "name", "name", put_string },
	{ "state", "state", put_string },
	{ "reason", "reason", put_string },
	{ "submitted", "submitted_us", put_time },
	{ "begun", "first_us", put_time },
	{ "ended", "ended_us", put_time },
	{ "job_s", "job_s", put_real },
	{ "erode_s", "erode_s", put_real },
	{ "path_mm", "path_mm", put_real },
	{ "length_mm", "length_mm", put_real },
	{ "depth_mm", "depth_mm", put_real },
	{ "jumps", "jumps", put_whole },
	{ "retracts", "retracts", put_whole },
	{ "shorts", "shorts", put_whole },
	{ "arcs", "arcs", put_whole },
	{ "energy_j", "energy_j", put_real },
	{ "conditions", "conditions", put_conditions },
	{ "faults", "faults", put_faults },
	{ "lines", "lines", put_whole },
	{ "sha256", "sha256", put_string },
	{ "tech_sha256", "tech_sha256", put_string },
	{ "electrodes", "electrodes", put_electrodes },
};

#define NCOLUMNS	(sizeof(columns) / sizeof(columns[0]))

static void put_head(void)
{
	for (size_t i = 0; i < NCOLUMNS; i++)
		printf("%s%s", i ? "," : "", columns[i].head);
	fputs("\r\n", stdout);
}

static void put_job(json_t *job)
{
	for (size_t i = 0; i < NCOLUMNS; i++) {
		if (i)
			putchar(',');
		columns[i].put(json_object_get(job, columns[i].key));
	}
	fputs("\r\n", stdout);
}

static int put_page(void *arg, json_t *page)
{
	json_t *row;
	size_t i;

	(void)arg;
	json_array_foreach(page, i, row)
		put_job(row);
	return ferror(stdout) ? EX_IOERR : 0;
}

static int put_one(struct ctl *c)
{
	json_t *job = NULL;
	const int err = ctl_ask_json(c, &(struct talk_question) {
		.verb = "show", .job = c->arg,
	}, &job);

	if (err == 0)
		put_job(job);
	json_decref(job);
	return err;
}

int history_csv(struct ctl *c)
{
	int err;

	put_head();
	err = c->arg ? put_one(c) : ctl_pages(c, "history", put_page, NULL);
	if (err && !ferror(stdout))	/* of that standard_guard() tells */
		fprintf(stderr, "edmctl: history: the output is not "
			"complete\n");
	return err;
}

/* -- The verb -------------------------------------------------------------- */

int ctl_history(struct ctl *c)
{
	if (c->picture && !c->arg) {
		fprintf(stderr, "edmctl: history: --picture without a job; "
			"edmctl history JOB --picture FILE.svg\n");
		return EX_USAGE;
	}
	if (c->csv + c->json + (c->picture != NULL) > 1) {
		fprintf(stderr, "edmctl: history: one of --csv, --json and "
			"--picture\n");
		return EX_USAGE;
	}
	if (c->picture)
		return history_picture(c);
	if (c->csv)
		return history_csv(c);
	return c->arg ? ctl_show(c) : ctl_ended(c);
}
