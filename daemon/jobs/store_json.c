/* SPDX-License-Identifier: Apache-2.0 */
/*
 * store_json.c - what the store knows, as JSON
 */
#include "store.h"

#include "jobs_log.h"
#include "plain.h"

#include <errno.h>
#include <sqlite3.h>
#include <string.h>

#define HISTORY_MAX	200
#define ALARMS_MAX	20

/*
 * SQL: plain(text).  A store of an earlier version, or of another hand, may have
 * names that move a terminal.
 */
static void plain_text(sqlite3_context *c, int n, sqlite3_value **v)
{
	const char *from = (const char *)sqlite3_value_text(v[0]);
	const size_t room = from ? strlen(from) + 1 : 0;
	char *to = from ? sqlite3_malloc64(room) : NULL;

	(void)n;
	if (!to) {
		sqlite3_result_null(c);
		return;
	}
	plain_copy(to, room, from);
	sqlite3_result_text(c, to, -1, sqlite3_free);
}

int store_json_init(struct store *s)
{
	return sqlite3_create_function(store_db(s), "plain", 1, SQLITE_UTF8 |
				       SQLITE_DETERMINISTIC, NULL, plain_text,
				       NULL, NULL) == SQLITE_OK ? 0 : -EIO;
}

#define JOB_JSON(MORE)	"json_object('n', n, 'job', plain(id), " \
			"'name', plain(name), " \
			"'state', state, 'hold', json(iif(hold, 'true', " \
			"'false')), 'lines', lines, 'sha256', sha256, " \
			"'submitted_us', submitted_us, 'begun_us', begun_us, " \
			"'ended_us', ended_us, " \
			"'reason', plain(reason), 'path_mm', " \
			"place_mm, 'length_mm', length_mm, 'depth_mm', " \
			"depth_mm, 'job_s', job_s, 'jumps', jumps, " \
			"'retracts', retracts, 'shorts', shorts, " \
			"'tech_sha256', tech_sha256" MORE ")"

/* Of one job alone: what was called and set, in the order of time. */
#define CHANGES_JSON	", 'changes', (SELECT json_group_array(json(c)) FROM " \
			"(SELECT json_object('utime', time_ns / 1000, " \
			"'place_mm', place_mm, 'what', what, 'was', was, " \
			"'now', now) AS c FROM change WHERE change.n=job.n " \
			"ORDER BY time_ns))"

/* Each has one ?: the id, or how many rows. */
static const char *const lists[] = {
	[STORE_SHOW] = "SELECT " JOB_JSON(CHANGES_JSON) " FROM job WHERE id=?",
	[STORE_QUEUE] =
		"SELECT json_group_array(json(j)) FROM (SELECT " JOB_JSON("")
		" AS j FROM job WHERE state='queued' OR (loaded=1 AND state "
		"NOT IN ('done', 'stopped')) ORDER BY n LIMIT ?)",
	[STORE_ALARMS] =
		"SELECT json_group_array(json(a)) FROM (SELECT json_object("
		"'utime', utime, 'kind', kind, 'job', plain(job), 'fault', "
		"plain(outcome), 'place_mm', place_mm, 'text', plain(text)) "
		"AS a FROM event WHERE kind IN ('alarm', 'lost', 'back') "
		"ORDER BY utime DESC, rowid DESC LIMIT ?)",
	[STORE_HISTORY] =
		"SELECT json_group_array(json(j)) FROM (SELECT " JOB_JSON("")
		" AS j FROM job WHERE state IN ('done', 'stopped', 'fault') "
		"ORDER BY ended_us DESC, n DESC LIMIT ?)",
};

static int rows_of(enum store_list what, int rows)
{
	if (what == STORE_QUEUE)
		return -1;
	if (what == STORE_ALARMS)
		return ALARMS_MAX;
	return rows <= 0 || rows > HISTORY_MAX ? HISTORY_MAX : rows;
}

static sqlite3_stmt *list_query(struct store *s, enum store_list what,
				const char *id, int rows)
{
	sqlite3_stmt *q = NULL;

	if (sqlite3_prepare_v2(store_db(s), lists[what], -1, &q, NULL) !=
	    SQLITE_OK) {
		log_error("store: %s", sqlite3_errmsg(store_db(s)));
		return NULL;
	}
	if (what == STORE_SHOW)
		sqlite3_bind_text(q, 1, id, -1, SQLITE_TRANSIENT);
	else
		sqlite3_bind_int(q, 1, rows_of(what, rows));
	return q;
}

char *store_json(struct store *s, enum store_list what, const char *id,
		 int rows)
{
	sqlite3_stmt *q = list_query(s, what, id, rows);
	char *text = NULL;

	if (q && sqlite3_step(q) == SQLITE_ROW)
		text = strdup((const char *)sqlite3_column_text(q, 0));
	sqlite3_finalize(q);
	return text;
}
