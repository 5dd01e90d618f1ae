/* SPDX-License-Identifier: Apache-2.0 */
/*
 * store.c - jobs, events and a few numbers in SQLite
 */
#include "store.h"

#include "jobs_log.h"

#include <errno.h>
#include <fcntl.h>
#include <sqlite3.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#define STORE_VERSION	2
#define HISTORY_MAX	200
#define ALARMS_MAX	20

struct store {
	sqlite3 *db;
	int lock;
};

static const char schema[] =
	"CREATE TABLE IF NOT EXISTS job("
	" n INTEGER PRIMARY KEY AUTOINCREMENT,"
	" id TEXT NOT NULL UNIQUE, name TEXT NOT NULL,"
	" sha256 TEXT NOT NULL, text BLOB NOT NULL, lines INTEGER NOT NULL,"
	" state TEXT NOT NULL DEFAULT 'queued',"
	" hold INTEGER NOT NULL, loaded INTEGER NOT NULL DEFAULT 0,"
	" submitted_us INTEGER NOT NULL,"
	" begun_us INTEGER NOT NULL DEFAULT 0,"
	" ended_us INTEGER NOT NULL DEFAULT 0,"
	" reason TEXT NOT NULL DEFAULT '',"
	" place_mm REAL, length_mm REAL, depth_mm REAL, job_s REAL,"
	" jumps INTEGER, retracts INTEGER, shorts INTEGER,"
	" tech_sha256 TEXT NOT NULL DEFAULT '');"
	"CREATE TABLE IF NOT EXISTS change("
	" n INTEGER NOT NULL, time_ns INTEGER NOT NULL, what TEXT NOT NULL,"
	" was, now, place_mm REAL, PRIMARY KEY(n, time_ns, what));"
	"CREATE INDEX IF NOT EXISTS job_by_state ON job(state, loaded);"
	"CREATE TABLE IF NOT EXISTS event("
	" utime INTEGER NOT NULL, kind TEXT NOT NULL, job TEXT NOT NULL,"
	" outcome TEXT NOT NULL, place_mm REAL, text TEXT NOT NULL);"
	"CREATE TABLE IF NOT EXISTS number("
	" key TEXT PRIMARY KEY, value INTEGER NOT NULL);";

/* What a store of version 1 has not got. */
static const char upgrade[] =
	"ALTER TABLE job ADD COLUMN tech_sha256 TEXT NOT NULL DEFAULT '';";

static const char *const state_names[JOB_NSTATES] = {
	[JOB_QUEUED]	= "queued",
	[JOB_READY]	= "ready",
	[JOB_RUNNING]	= "running",
	[JOB_HELD]	= "held",
	[JOB_DONE]	= "done",
	[JOB_FAULT]	= "fault",
	[JOB_STOPPED]	= "stopped",
};

const char *store_state_name(enum job_state s)
{
	return state_names[s];
}

static enum job_state state_of(const unsigned char *name)
{
	for (int i = 0; i < JOB_NSTATES; i++)
		if (name && strcmp((const char *)name, state_names[i]) == 0)
			return (enum job_state)i;
	return JOB_STOPPED;
}

static int complain(struct store *s)
{
	const int code = sqlite3_errcode(s->db);

	log_error("store: %s", sqlite3_errmsg(s->db));
	return code == SQLITE_NOTADB || code == SQLITE_CORRUPT ? -EILSEQ : -EIO;
}

/* @kinds: a letter per ?: i int64_t, d double, s string. */
static sqlite3_stmt *prepare(struct store *s, const char *sql,
			     const char *kinds, va_list ap)
{
	sqlite3_stmt *q;

	if (sqlite3_prepare_v2(s->db, sql, -1, &q, NULL) != SQLITE_OK) {
		complain(s);
		return NULL;
	}
	for (int i = 1; *kinds; kinds++, i++) {
		if (*kinds == 'i')
			sqlite3_bind_int64(q, i, va_arg(ap, int64_t));
		else if (*kinds == 'd')
			sqlite3_bind_double(q, i, va_arg(ap, double));
		else
			sqlite3_bind_text(q, i, va_arg(ap, const char *), -1,
					  SQLITE_TRANSIENT);
	}
	return q;
}

/* A query whose rows the caller steps through. */
static sqlite3_stmt *query(struct store *s, const char *sql,
			   const char *kinds, ...)
{
	sqlite3_stmt *q;
	va_list ap;

	va_start(ap, kinds);
	q = prepare(s, sql, kinds, ap);
	va_end(ap);
	return q;
}

static int run(struct store *s, const char *sql, const char *kinds, ...)
{
	sqlite3_stmt *q;
	va_list ap;
	int rc;

	va_start(ap, kinds);
	q = prepare(s, sql, kinds, ap);
	va_end(ap);
	if (!q)
		return -EIO;
	rc = sqlite3_step(q);
	sqlite3_finalize(q);
	return rc == SQLITE_DONE || rc == SQLITE_ROW ? 0 : complain(s);
}

static int64_t ask(struct store *s, const char *sql, const char *key,
		   int64_t otherwise)
{
	sqlite3_stmt *q = query(s, sql, key ? "s" : "", key);
	int64_t value = otherwise;

	if (q && sqlite3_step(q) == SQLITE_ROW)
		value = sqlite3_column_int64(q, 0);
	sqlite3_finalize(q);
	return value;
}

static int lock_take(struct store *s, const char *dir, const char *machine)
{
	char path[512];

	if (mkdir(dir, 0750) < 0 && errno != EEXIST)
		return -errno;
	snprintf(path, sizeof(path), "%s/%s.lock", dir, machine);
	s->lock = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0640);
	if (s->lock < 0)
		return -errno;
	if (flock(s->lock, LOCK_EX | LOCK_NB) < 0)
		return errno == EWOULDBLOCK ? -EBUSY : -errno;
	return 0;
}

static int db_open(struct store *s, const char *dir, const char *machine)
{
	char path[512];
	int64_t version;

	snprintf(path, sizeof(path), "%s/%s.db", dir, machine);
	if (sqlite3_open(path, &s->db) != SQLITE_OK)
		return complain(s);
	sqlite3_busy_timeout(s->db, 2000);
	if (sqlite3_exec(s->db, "PRAGMA journal_mode=WAL;"
			 "PRAGMA synchronous=FULL;", NULL, NULL, NULL) !=
	    SQLITE_OK)
		return complain(s);
	version = ask(s, "PRAGMA user_version", NULL, 0);
	if (version > STORE_VERSION)
		return -EPROTO;
	if ((version == 1 && sqlite3_exec(s->db, upgrade, NULL, NULL, NULL) !=
	     SQLITE_OK) ||
	    sqlite3_exec(s->db, schema, NULL, NULL, NULL) != SQLITE_OK ||
	    sqlite3_exec(s->db, "PRAGMA user_version=2", NULL, NULL, NULL) !=
	    SQLITE_OK)
		return complain(s);
	return 0;
}

int store_open(struct store **ret, const char *dir, const char *machine)
{
	struct store *s = calloc(1, sizeof(*s));
	int err;

	if (!s)
		return -ENOMEM;
	s->lock = -1;
	err = lock_take(s, dir, machine);
	if (err == 0)
		err = db_open(s, dir, machine);
	if (err < 0) {
		store_close(s);
		return err;
	}
	*ret = s;
	return 0;
}

void store_close(struct store *s)
{
	if (!s)
		return;
	sqlite3_close(s->db);
	if (s->lock >= 0)
		close(s->lock);
	free(s);
}

struct sqlite3 *store_db(struct store *s)
{
	return s->db;
}

int store_add(struct store *s, const struct store_new *j, uint32_t *ret_n)
{
	sqlite3_stmt *q = query(s, "INSERT INTO job(id, name, sha256, lines, "
				"hold, submitted_us, tech_sha256, text) VALUES"
				"(?, ?, ?, ?, ?, ?, ?, ?)", "sssiiis", j->id,
				j->name, j->sha256, (int64_t)j->lines,
				(int64_t)j->hold, j->now_us, j->tech_sha256);
	int rc;

	if (!q)
		return -EIO;
	sqlite3_bind_blob64(q, 8, j->text, j->bytes, SQLITE_STATIC);
	rc = sqlite3_step(q);
	sqlite3_finalize(q);
	if (rc != SQLITE_DONE)
		return complain(s);
	*ret_n = (uint32_t)sqlite3_last_insert_rowid(s->db);
	return 0;
}

static void column_copy(sqlite3_stmt *q, int i, char *to, size_t size)
{
	const unsigned char *from = sqlite3_column_text(q, i);

	snprintf(to, size, "%s", from ? (const char *)from : "");
}

#define JOB_COLUMNS	"n, id, name, sha256, state, hold, loaded, " \
			"begun_us, lines"

static int job_get(sqlite3_stmt *q, struct store_job *ret)
{
	int err = -ENOENT;

	if (q && sqlite3_step(q) == SQLITE_ROW) {
		ret->n = (uint32_t)sqlite3_column_int64(q, 0);
		column_copy(q, 1, ret->id, sizeof(ret->id));
		column_copy(q, 2, ret->name, sizeof(ret->name));
		column_copy(q, 3, ret->sha256, sizeof(ret->sha256));
		ret->state = state_of(sqlite3_column_text(q, 4));
		ret->hold = sqlite3_column_int(q, 5) != 0;
		ret->loaded = sqlite3_column_int(q, 6) != 0;
		ret->begun_us = sqlite3_column_int64(q, 7);
		ret->lines = (uint32_t)sqlite3_column_int64(q, 8);
		err = 0;
	}
	sqlite3_finalize(q);
	return err;
}

int store_find(struct store *s, const char *id, struct store_job *ret)
{
	return job_get(query(s, "SELECT " JOB_COLUMNS " FROM job WHERE id=?",
			     "s", id), ret);
}

int store_loaded(struct store *s, struct store_job *ret)
{
	return job_get(query(s, "SELECT " JOB_COLUMNS " FROM job WHERE "
			     "loaded=1 ORDER BY n LIMIT 1", ""), ret);
}

int store_head(struct store *s, struct store_job *ret)
{
	return job_get(query(s, "SELECT " JOB_COLUMNS " FROM job WHERE "
			     "state='queued' AND loaded=0 ORDER BY n=? DESC, n "
			     "LIMIT 1", "i",
			     store_number(s, "selected", 0)), ret);
}

int store_text(struct store *s, uint32_t n, char **ret, size_t *ret_bytes)
{
	sqlite3_stmt *q = query(s, "SELECT text FROM job WHERE n=?", "i",
				(int64_t)n);
	int err = -EIO;

	if (q && sqlite3_step(q) == SQLITE_ROW) {
		const void *text = sqlite3_column_blob(q, 0);
		size_t bytes = (size_t)sqlite3_column_bytes(q, 0);
		char *copy = malloc(bytes + 1);

		err = copy ? 0 : -ENOMEM;
		if (copy) {
			if (bytes)
				memcpy(copy, text, bytes);
			*ret = copy;
			*ret_bytes = bytes;
		}
	}
	sqlite3_finalize(q);
	return err;
}

int store_set_state(struct store *s, uint32_t n, enum job_state state)
{
	return run(s, "UPDATE job SET state=? WHERE n=?", "si",
		   state_names[state], (int64_t)n);
}

int store_set_hold(struct store *s, uint32_t n, bool hold)
{
	return run(s, "UPDATE job SET hold=? WHERE n=?", "ii", (int64_t)hold,
		   (int64_t)n);
}

int store_set_loaded(struct store *s, uint32_t n, bool loaded)
{
	return run(s, "UPDATE job SET loaded=? WHERE n=?", "ii",
		   (int64_t)loaded, (int64_t)n);
}

int store_begin(struct store *s, uint32_t n, int64_t now_us)
{
	return run(s, "UPDATE job SET begun_us=? WHERE n=?", "ii", now_us,
		   (int64_t)n);
}

int store_end(struct store *s, uint32_t n, const struct store_end *e)
{
	return run(s, "UPDATE job SET state=?, reason=?, ended_us=?, "
		   "place_mm=?, length_mm=?, depth_mm=?, job_s=?, jumps=?, "
		   "retracts=?, shorts=? WHERE n=?", "ssiddddiiii",
		   state_names[e->state], e->reason, e->now_us, e->place_mm,
		   e->length_mm, e->depth_mm, e->job_s, (int64_t)e->jumps,
		   (int64_t)e->retracts, (int64_t)e->shorts, (int64_t)n);
}

int store_set_tech(struct store *s, uint32_t n, const char *sha256)
{
	return run(s, "UPDATE job SET tech_sha256=? WHERE n=?", "si", sha256,
		   (int64_t)n);
}

/* edmd's events come again when either side was restarted; their time tells
 * them.  NAN becomes NULL. */
int store_change(struct store *s, uint32_t n, const struct store_change *c)
{
	if (c->condition)
		return run(s, "INSERT OR IGNORE INTO change VALUES(?1, ?2, "
			   "'condition', (SELECT now FROM change WHERE n=?1 "
			   "AND what='condition' AND time_ns<?2 ORDER BY "
			   "time_ns DESC LIMIT 1), ?3, ?4)", "iisd",
			   (int64_t)n, c->time_ns, c->condition, c->place_mm);
	return run(s, "INSERT OR IGNORE INTO change VALUES(?, ?, ?, ?, ?, ?)",
		   "iisddd", (int64_t)n, c->time_ns, c->field, c->was, c->now,
		   c->place_mm);
}

int store_note(struct store *s, const struct store_note *e)
{
	return run(s, "INSERT INTO event VALUES(?, ?, ?, ?, ?, ?)", "isssds",
		   e->now_us, e->kind, e->job, e->outcome, e->place_mm,
		   e->text);
}

uint32_t store_waiting(struct store *s)
{
	return (uint32_t)ask(s, "SELECT count(*) FROM job WHERE "
			     "state='queued' AND loaded=0", NULL, 0);
}

int64_t store_number(struct store *s, const char *key, int64_t otherwise)
{
	return ask(s, "SELECT value FROM number WHERE key=?", key, otherwise);
}

int store_set_number(struct store *s, const char *key, int64_t value)
{
	return run(s, "INSERT OR REPLACE INTO number VALUES(?, ?)", "si", key,
		   value);
}

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
			"'now', now) AS c FROM change WHERE change.n=job.n " \
			"ORDER BY time_ns))"

static sqlite3_stmt *list_query(struct store *s, enum store_list what,
				const char *id, int rows)
{
	if (what == STORE_SHOW)
		return query(s, "SELECT " JOB_JSON(CHANGES_JSON) " FROM job "
			     "WHERE id=?",
			     "s", id);
	if (what == STORE_QUEUE)
		return query(s, "SELECT json_group_array(json(j)) FROM "
			     "(SELECT " JOB_JSON("") " AS j FROM job WHERE "
			     "state='queued' OR (loaded=1 AND state NOT IN "
			     "('done', 'stopped')) ORDER BY n)", "");
	if (what == STORE_ALARMS)
		return query(s, "SELECT json_group_array(json(a)) FROM (SELECT "
			     "json_object('utime', utime, 'kind', kind, 'job', "
			     "job, 'fault', outcome, 'place_mm', place_mm, "
			     "'text', text) AS a FROM event WHERE kind IN "
			     "('alarm', 'warning', 'lost', 'back') ORDER BY "
			     "utime DESC, "
			     "rowid DESC LIMIT ?)", "i", (int64_t)ALARMS_MAX);
	if (rows <= 0 || rows > HISTORY_MAX)
		rows = HISTORY_MAX;
	return query(s, "SELECT json_group_array(json(j)) FROM (SELECT "
		     JOB_JSON("") " AS j FROM job WHERE state IN ('done', "
		     "'stopped', 'fault') ORDER BY ended_us DESC, n DESC "
		     "LIMIT ?)", "i", (int64_t)rows);
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
