/* SPDX-License-Identifier: Apache-2.0 */
/*
 * store_list.c - lists of jobs and events, as JSON
 */
#include "store_sql.h"
#include "store_turn.h"

#include "plain.h"

#include <stdlib.h>
#include <string.h>

#define LIST_MAX	200
#define ALARMS_MAX	20

#define JOB_JSON(MORE)	"json_object('n', n, 'job', id, 'name', name, " \
			"'state', state, 'hold', json(iif(hold, 'true', " \
			"'false')), 'lines', lines, 'sha256', sha256, " \
			"'submitted_us', submitted_us, 'begun_us', begun_us, " \
			"'ended_us', ended_us, 'reason', reason, 'path_mm', " \
			"place_mm, 'length_mm', length_mm, 'depth_mm', " \
			"depth_mm, 'job_s', job_s, 'jumps', jumps, " \
			"'retracts', retracts, 'shorts', shorts, " \
			"'tech_sha256', tech_sha256" MORE ")"

/* Of one job alone: what was called and set, in the order of time. */
#define CHANGES_JSON	", 'changes', (SELECT json_group_array(json(c)) FROM " \
			"(SELECT json_object('utime', time_ns / 1000, " \
			"'place_mm', place_mm, 'what', what, 'was', was, " \
			"'now', now) AS c FROM (SELECT * FROM change WHERE " \
			"change.n=job.n ORDER BY time_ns DESC LIMIT ?2) " \
			"ORDER BY time_ns))"

/* What is cut otherwise than it is written. */
#define NOTES_JSON	", 'notes', (SELECT json_group_array(text) FROM " \
			"(SELECT text FROM event WHERE event.job=job.id AND " \
			"kind='note' ORDER BY event.rowid LIMIT ?2))"

static sqlite3_stmt *list_query(struct store *s, enum store_list what,
				const char *id, int rows)
{
	if (what == STORE_SHOW)
		return store_ask(s, NULL, "SELECT "
				 JOB_JSON(CHANGES_JSON NOTES_JSON) " FROM job "
				 "WHERE id=?1", "si", id, (int64_t)rows);
	if (what == STORE_QUEUE)
		return store_ask(s, NULL, "SELECT json_group_array(json(j)) FROM "
			     "(SELECT " JOB_JSON("") " AS j FROM job WHERE "
			     "state IN ('queued', 'interrupted') OR "
			     "(loaded=1 AND state NOT IN "
			     "('done', 'stopped')) ORDER BY loaded DESC, "
			     STORE_TURN " LIMIT ?)", "i", (int64_t)rows);
	if (what == STORE_ALARMS)
		return store_ask(s, NULL, "SELECT json_group_array(json(a)) FROM (SELECT "
			     "json_object('utime', utime, 'kind', kind, 'job', "
			     "job, 'fault', outcome, 'place_mm', place_mm, "
			     "'text', text) AS a FROM event WHERE kind IN "
			     "('alarm', 'warning', 'lost', 'back') "
			     "ORDER BY utime DESC, "
			     "rowid DESC LIMIT ?)", "i", (int64_t)ALARMS_MAX);
	return store_ask(s, NULL, "SELECT json_group_array(json(j)) FROM (SELECT "
		     JOB_JSON("") " AS j FROM job WHERE state IN ('done', "
		     "'stopped', 'fault') ORDER BY ended_us DESC, n DESC "
		     "LIMIT ?)", "i", (int64_t)rows);
}

/*
 * A store of an earlier version, or of another hand, may have names that move a
 * terminal.  In the JSON that SQLite makes of them a control character is an
 * escape, and all others are what they were.
 */
static void make_plain(char *json)
{
	char *to = json;

	plain_copy(json, strlen(json) + 1, json);
	for (const char *at = json; *at; to++) {
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

static char *list_text(struct store *s, enum store_list what, const char *id,
		       int rows)
{
	sqlite3_stmt *q = list_query(s, what, id, rows);
	char *text = NULL;

	if (q)
		text = strdup((const char *)sqlite3_column_text(q, 0));
	sqlite3_finalize(q);
	if (text)
		make_plain(text);
	return text;
}

/* A client reads what fits one packet: the first of them, then. */
char *store_json(struct store *s, enum store_list what, const char *id,
		 int rows)
{
	char *text;

	if (rows <= 0 || rows > LIST_MAX)
		rows = LIST_MAX;
	text = list_text(s, what, id, rows);
	while (text && strlen(text) > STORE_JSON_MAX && rows > 1) {
		rows -= rows / 8 + 1;
		free(text);
		text = list_text(s, what, id, rows);
	}
	return text;
}
