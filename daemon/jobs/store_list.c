/* SPDX-License-Identifier: Apache-2.0 */
/*
 * store_list.c - lists of jobs and events, as JSON
 */
#include "store_sql.h"
#include "store_turn.h"

#include "plain.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LIST_MAX	200
#define QUEUE_MAX	400		/* its rows are short */

/* Which electrodes cut it, and their wear before and after. */
#define ELECTRODES_JSON	", 'electrodes', (SELECT json_group_array(json(e)) " \
			"FROM (SELECT json_object('electrode', electrode, " \
			"'shift_mm', offset_mm, 'shift_x_mm', x_mm, " \
			"'shift_y_mm', y_mm, 'shift_c_deg', c_deg, " \
			"'wear_before_mm', before_mm, " \
			"'wear_after_mm', after_mm, 'known', json(iif(known, " \
			"'true', 'false')), 'sparked_s', after_s - before_s) " \
			"AS e FROM worn WHERE worn.job=job.n AND after_s>=0 " \
			"ORDER BY part))"

#define JOB_JSON(MORE)	"json_object('n', n, 'job', id, 'name', name, " \
			"'state', state, 'hold', json(iif(hold, 'true', " \
			"'false')), 'lines', lines, 'sha256', sha256, " \
			"'submitted_us', submitted_us, 'begun_us', begun_us, " \
			"'ended_us', ended_us, 'reason', reason, 'path_mm', " \
			"place_mm, 'length_mm', length_mm, 'depth_mm', " \
			"depth_mm, 'job_s', job_s, 'jumps', jumps, " \
			"'retracts', retracts, 'shorts', shorts, " \
			"'forecast_s', forecast_s, 'setting', setting, " \
			"'tech_sha256', tech_sha256" ELECTRODES_JSON MORE ")"

/* Of a job that waits there may be thousands. */
#define QUEUED_JSON	"json_object('n', n, 'job', id, 'name', name, " \
			"'state', state, 'hold', json(iif(hold, 'true', " \
			"'false')), 'lines', lines, 'submitted_us', " \
			"submitted_us, 'reason', reason, 'forecast_s', " \
			"forecast_s, 'forecast_why', forecast_why)"

/* What it came to.  Energy is null where the machine does not count it. */
#define SUMS_JSON	", 'first_us', first_us, 'erode_s', erode_s, " \
			"'energy_j', energy_j, 'arcs', arcs, 'conditions', " \
			"json(coalesce((SELECT conditions FROM used WHERE " \
			"used.n=job.n), '[]')), 'faults', (SELECT " \
			"json_group_array(json(f)) FROM (SELECT json_object(" \
			"'utime', time_ns / 1000, 'fault', fault, 'line', " \
			"line, 'place_mm', place_mm) AS f FROM fault WHERE " \
			"fault.n=job.n ORDER BY time_ns LIMIT 50))"

/* For one job only: what it called and what was set, in order of time. */
#define CHANGES_JSON	", 'changes', (SELECT json_group_array(json(c)) FROM " \
			"(SELECT json_object('utime', time_ns / 1000, " \
			"'place_mm', place_mm, 'what', what, 'was', was, " \
			"'now', now) AS c FROM (SELECT * FROM change WHERE " \
			"change.n=job.n ORDER BY time_ns DESC LIMIT ?2) " \
			"ORDER BY time_ns))"

/* What is cut differently from what is written. */
#define NOTES_JSON	", 'notes', (SELECT json_group_array(text) FROM " \
			"(SELECT text FROM event WHERE event.job=job.id AND " \
			"kind='note' ORDER BY event.rowid LIMIT ?2))"

/* What somebody said to it: that it is sent, that a stand is over; and what it
 * has touched off. */
#define SAID_JSON	", 'said', (SELECT json_group_array(json(e)) FROM " \
			"(SELECT json_object('utime', utime, 'text', text) AS " \
			"e FROM (SELECT * FROM event WHERE event.job=job.id " \
			"AND kind IN ('queued', 'confirmed', 'offset') ORDER BY " \
			"event.rowid DESC LIMIT ?2) ORDER BY rowid))"

/* The place of a job in a list; a smaller number is earlier. */
#define IN_HISTORY	"-ended_us, -n"

/* What is looked for, word by word, in a job that has ended: name, outcome,
 * day, electrodes.  Without words all of them are meant. */
#define DAY(FORM)	"strftime('" FORM "', ended_us / 1e6, 'unixepoch', " \
			"'localtime')"
#define WORDS		"'[\"' || replace(substr(json_quote(?3), 2, length(" \
			"json_quote(?3)) - 2), ' ', '\",\"') || '\"]'"
#define HAS_WORDS	"(?3='' OR NOT EXISTS (SELECT 1 FROM json_each(" WORDS ") " \
			"WHERE instr(lower(name || ' ' || state || ' ' || " \
			DAY("%Y-%m-%d") " || coalesce((SELECT group_concat(" \
			"' T' || electrode, '') FROM worn WHERE worn.job=" \
			"job.n), '')), lower(value))=0))"

/* So much of the jobs of a day or a month. */
#define TOTALS_SQL(FORM) \
	"SELECT json_object('time', " DAY(FORM) ", 'jobs', count(*), 'done', " \
	"sum(state='done'), 'job_s', total(job_s), 'erode_s', " \
	"total(erode_s), 'energy_j', sum(energy_j)) FROM job WHERE state IN (" \
	STORE_ENDED ") AND " HAS_WORDS " AND ?2='' GROUP BY " DAY(FORM) \
	" ORDER BY 1 DESC LIMIT ?1"

/* SQLite finds a page by the index of its order, if it is told where the page
 * begins, and that the index of the states is of no use (+).  Of the queue only
 * those that wait are in that index, so that a job that runs does not change
 * it. */
#define LOADED		"state IN ('ready', 'running', 'held', 'fault') AND " \
			"loaded=1"
#define WAITS		"state IN ('queued', 'interrupted') AND " \
			STORE_IN_QUEUE " >= coalesce((SELECT " STORE_IN_QUEUE \
			" FROM job WHERE id=?2), -9e18)"
#define HAS_ENDED	"+state IN ('done', 'stopped', 'fault') AND " \
			"-ended_us >= coalesce((SELECT -ended_us FROM job " \
			"WHERE id=?2), -9e18) AND " HAS_WORDS

/* Which jobs, of those after job ?2 if one is given: as many as asked for. */
#define SOME(JOB, WHICH, PLACE) \
	"SELECT * FROM (SELECT n AS m FROM " JOB " WHERE (" WHICH ") AND " \
	"(?2='' OR (" PLACE ") > (SELECT " PLACE " FROM job WHERE id=?2)) " \
	"ORDER BY " PLACE " LIMIT ?1)"

/* The order is found from a few columns, and JSON is made only of the rows that
 * are wanted. */
#define JOBS_SQL(JSON, SOME, PLACE) \
	"SELECT " JSON " FROM job JOIN (" SOME ") ON n=m ORDER BY " \
	PLACE " LIMIT ?1"

static sqlite3_stmt *list_query(struct store *s,
				const struct store_asked *a, int rows,
				int *ret_err)
{
	const char *id = a->job, *words = a->words;

	switch (a->what) {
	case STORE_SHOW:
		return store_ask(s, ret_err, "SELECT "
				 JOB_JSON(SUMS_JSON CHANGES_JSON
					  NOTES_JSON SAID_JSON)
				 " FROM job WHERE id=?1",
				 "si", id, (int64_t)rows);
	case STORE_QUEUE:
		return store_ask(s, ret_err, JOBS_SQL(QUEUED_JSON,
				 SOME("job", LOADED, STORE_IN_QUEUE)
				 " UNION ALL "
				 SOME("job INDEXED BY job_by_turn", WAITS,
				      STORE_IN_QUEUE), STORE_IN_QUEUE),
				 "is", (int64_t)rows, id);
	case STORE_EVENTS:
		return store_ask(s, ret_err,
				 "SELECT json_object('n', rowid, 'utime', "
				 "utime, 'kind', kind, 'job', job, 'outcome', outcome, "
				 "'place_mm', place_mm, 'text', text) FROM "
				 "event ORDER BY utime DESC, rowid DESC "
				 "LIMIT ?", "i", (int64_t)rows);
	case STORE_ALARMS:
		return store_ask(s, ret_err,
				 "SELECT json_object('n', rowid, 'utime', "
				 "utime, 'kind', kind, 'job', job, 'fault', "
				 "outcome, 'place_mm', place_mm, 'text', "
				 "text) FROM "
				 "event WHERE kind IN ('alarm', 'warning', "
				 "'lost', 'back') ORDER BY utime DESC, rowid "
				 "DESC LIMIT ?",
				 "i", (int64_t)rows);
	case STORE_TRAIL:
		return store_ask(s, ret_err, "SELECT trail FROM trail JOIN job "
				 "USING(n) WHERE id=?", "s", id);
	case STORE_DAYS:
		return store_ask(s, ret_err, TOTALS_SQL("%Y-%m-%d"), "iss",
				 (int64_t)rows, id, words);
	case STORE_MONTHS:
		return store_ask(s, ret_err, TOTALS_SQL("%Y-%m"), "iss",
				 (int64_t)rows, id, words);
	case STORE_HISTORY:
		break;
	}
	return store_ask(s, ret_err, JOBS_SQL(JOB_JSON(SUMS_JSON),
			 SOME("job", HAS_ENDED, IN_HISTORY), IN_HISTORY),
			 "iss", (int64_t)rows, id, words);
}

/*
 * A store of an earlier version, or one that somebody changed, may have names
 * with control characters.  SQLite writes a control character in JSON as an
 * escape; all other characters stay as they are.
 */
static void make_plain(char *json)
{
	char *to = json;

	/* Most rows are plain to their end. */
	while (*to >= ' ' && *to < 0x7f && *to != '\\')
		to++;
	plain_copy(to, strlen(to) + 1, to);
	for (const char *at = to; *at; to++) {
		if (at[0] != '\\') {
			*to = *at++;
		} else if (at[1] == '"' || at[1] == '\\') {
			*to++ = *at++;
			*to = *at++;
		} else {
			*to = '?';
			at += at[1] == 'u' ? 6 : 2;
		}
	}
	*to = '\0';
}

/* The first column of the row at which a query stands. */
static char *row_text(sqlite3_stmt *q)
{
	char *text = strdup((const char *)sqlite3_column_text(q, 0));

	if (text)
		make_plain(text);
	return text;
}

/* A job that has not moved has none. */
static char *trail(struct store *s, const char *id)
{
	int err;
	sqlite3_stmt *q = list_query(s, &(struct store_asked) {
		.what = STORE_TRAIL, .job = id,
	}, 0, &err);
	char *text = q ? row_text(q) : err == -ENOENT ? strdup("{}") : NULL;

	sqlite3_finalize(q);
	return text;
}

/* Everything about one job, and of its calls and sets as many as fit. */
static char *one(struct store *s, const char *id)
{
	for (int rows = LIST_MAX; rows > 0; rows -= rows / 8 + 1) {
		int err;
		sqlite3_stmt *q = list_query(s, &(struct store_asked) {
			.what = STORE_SHOW, .job = id,
		}, rows, &err);
		char *text = q ? row_text(q) : NULL;

		sqlite3_finalize(q);
		if (!text || strlen(text) <= STORE_JSON_MAX)
			return text;
		free(text);
	}
	return NULL;
}

/* An array with as many rows as fit.  Return: SQLITE_DONE; otherwise the array
 * is not complete. */
static int put_rows(FILE *f, sqlite3_stmt *q)
{
	size_t bytes = 2;
	int rc = q ? SQLITE_ROW : SQLITE_DONE;

	fputc('[', f);
	while (rc == SQLITE_ROW) {
		char *text = row_text(q);

		if (!text)
			return SQLITE_NOMEM;
		bytes += strlen(text) + 1;
		if (bytes <= STORE_JSON_MAX)
			fprintf(f, "%s%s", ftell(f) > 1 ? "," : "", text);
		free(text);
		rc = bytes <= STORE_JSON_MAX ? sqlite3_step(q) : SQLITE_DONE;
	}
	fputc(']', f);
	return rc;
}

static char *list_text(struct store *s, const struct store_asked *a, int rows)
{
	int err = 0, rc = SQLITE_NOMEM;
	sqlite3_stmt *q = list_query(s, a, rows, &err);
	char *text = NULL;
	size_t size;
	FILE *f = open_memstream(&text, &size);

	if (f && (q || err == -ENOENT))
		rc = put_rows(f, q);
	sqlite3_finalize(q);
	if (f && fclose(f) == 0 && rc == SQLITE_DONE)
		return text;
	free(text);
	/* The disk failed in the middle of the answer: ask the copy in
	 * memory. */
	if (rc != SQLITE_NOMEM && rc != SQLITE_DONE)
		store_failed(s, rc);
	return NULL;
}

char *store_look(struct store *s, const struct store_asked *a)
{
	const int most = a->what == STORE_QUEUE ? QUEUE_MAX : LIST_MAX;
	const int rows = a->rows > 0 && a->rows < most ? a->rows : most;
	char *text = list_text(s, a, rows);

	return text ? text : list_text(s, a, rows);
}

char *store_json(struct store *s, enum store_list what, const char *id,
		 int rows)
{
	if (what == STORE_SHOW)
		return one(s, id);
	if (what == STORE_TRAIL)
		return trail(s, id);
	return store_look(s, &(struct store_asked) { what, id, "", rows });
}
