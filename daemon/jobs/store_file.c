/* SPDX-License-Identifier: Apache-2.0 */
/*
 * store_file.c - the file of the database: opened, updated, copied
 *
 * A change of the tables is a new row of `steps`, never a change of an old
 * row.  A new file goes through all steps.  So it has the same columns in the
 * same order as a file that the first edmd-jobs made.
 */
#include "store_log.h"
#include "store_sql.h"
#include "store_text.h"

#include "jobs_log.h"
#include "regular.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define CHECK_BYTES	(256ll << 20)	/* checking a larger file would take too
					 * long */

/* Step i changes a file of version i to version i + 1. */
static const char *const steps[] = {
	"CREATE TABLE job("
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
	" jumps INTEGER, retracts INTEGER, shorts INTEGER);",

	"ALTER TABLE job ADD COLUMN tech_sha256 TEXT NOT NULL DEFAULT '';",

	/* The text has its own table, because an update of a job writes its
	 * whole row again.  A table without a version, from an earlier
	 * edmd-jobs, may be there. */
	"CREATE TABLE text(n INTEGER PRIMARY KEY, text BLOB NOT NULL);"
	"INSERT INTO text SELECT n, text FROM job;"
	"ALTER TABLE job DROP COLUMN text;"
	"CREATE TABLE IF NOT EXISTS change("
	" n INTEGER NOT NULL, time_ns INTEGER NOT NULL, what TEXT NOT NULL,"
	" was, now, place_mm REAL, PRIMARY KEY(n, time_ns, what));"
	"CREATE INDEX IF NOT EXISTS job_by_state ON job(state, loaded);"
	"CREATE TABLE IF NOT EXISTS event("
	" utime INTEGER NOT NULL, kind TEXT NOT NULL, job TEXT NOT NULL,"
	" outcome TEXT NOT NULL, place_mm REAL, text TEXT NOT NULL);"
	"CREATE INDEX event_by_job ON event(job);"
	"CREATE TABLE IF NOT EXISTS number("
	" key TEXT PRIMARY KEY, value INTEGER NOT NULL);"
	"CREATE TABLE IF NOT EXISTS key("
	" public TEXT PRIMARY KEY, name TEXT NOT NULL UNIQUE,"
	" role TEXT NOT NULL, added_us INTEGER NOT NULL);"
	"CREATE TABLE IF NOT EXISTS act("
	" id INTEGER PRIMARY KEY, instance INTEGER NOT NULL,"
	" born INTEGER NOT NULL, verb TEXT NOT NULL, by TEXT NOT NULL,"
	" begun_us INTEGER NOT NULL, code INTEGER, reason TEXT);"
	"CREATE TRIGGER job_gone AFTER DELETE ON job BEGIN"
	" DELETE FROM text WHERE n=old.n;"
	" DELETE FROM change WHERE n=old.n;"
	" DELETE FROM event WHERE job=old.id; END;",

	/* The checkpoint of an interrupted job, in hex. */
	"CREATE TABLE resume(n INTEGER PRIMARY KEY, at TEXT NOT NULL);"
	"CREATE TRIGGER resume_gone AFTER DELETE ON job BEGIN"
	" DELETE FROM resume WHERE n=old.n; END;",

	/* Electrodes, and how each job used them: docs/electrodes.md. */
	"CREATE TABLE electrode("
	" n INTEGER PRIMARY KEY, name TEXT NOT NULL, material TEXT NOT NULL,"
	" note TEXT NOT NULL, undersize_mm REAL NOT NULL,"
	" length_mm REAL NOT NULL, wear_mm REAL NOT NULL,"
	" spark_s REAL NOT NULL, life_mm REAL NOT NULL, life_s REAL NOT NULL,"
	" state TEXT NOT NULL);"
	"ALTER TABLE job ADD COLUMN electrode INTEGER NOT NULL DEFAULT 0;"
	"ALTER TABLE job ADD COLUMN measures INTEGER NOT NULL DEFAULT 0;"
	"CREATE TABLE worn("
	" job INTEGER NOT NULL, part INTEGER NOT NULL,"
	" electrode INTEGER NOT NULL, offset_mm REAL NOT NULL,"
	" before_mm REAL NOT NULL, after_mm REAL NOT NULL,"
	" before_s REAL NOT NULL, after_s REAL NOT NULL,"
	" known INTEGER NOT NULL, PRIMARY KEY(job, part));"
	"CREATE TRIGGER worn_gone AFTER DELETE ON job BEGIN"
	" DELETE FROM worn WHERE job=old.n; END;",

	/* What a job came to.  Of a job that was resumed begun_us is when its
	 * last part began, first_us its first.  energy_j is NULL if the machine
	 * does not count it.  Both tables hold JSON: tally_json.c. */
	"ALTER TABLE job ADD COLUMN first_us INTEGER NOT NULL DEFAULT 0;"
	"ALTER TABLE job ADD COLUMN erode_s REAL;"
	"ALTER TABLE job ADD COLUMN energy_j REAL;"
	"ALTER TABLE job ADD COLUMN arcs INTEGER;"
	"UPDATE job SET first_us=begun_us;"
	"CREATE TABLE used(n INTEGER PRIMARY KEY, conditions TEXT NOT NULL);"
	"CREATE TABLE trail(n INTEGER PRIMARY KEY, trail TEXT NOT NULL);"
	"CREATE TABLE fault("
	" n INTEGER NOT NULL, time_ns INTEGER NOT NULL, fault TEXT NOT NULL,"
	" line INTEGER NOT NULL, place_mm REAL, PRIMARY KEY(n, time_ns, fault));"
	"CREATE TRIGGER tally_gone AFTER DELETE ON job BEGIN"
	" DELETE FROM used WHERE n=old.n;"
	" DELETE FROM trail WHERE n=old.n;"
	" DELETE FROM fault WHERE n=old.n; END;",

	/* The history is read page by page in this order: store_list.c. */
	"CREATE INDEX job_by_end ON job(-ended_us, -n);",

	/* Work offsets that were touched off; job 0: those in force. */
	"CREATE TABLE work("
	" job INTEGER NOT NULL, work INTEGER NOT NULL,"
	" axis INTEGER NOT NULL, mm REAL NOT NULL,"
	" PRIMARY KEY(job, work, axis));"
	"CREATE TRIGGER work_gone AFTER DELETE ON job BEGIN"
	" DELETE FROM work WHERE job=old.n; END;",

	/* The queue is read page by page in this order: store_list.c.  A turn
	 * is that of a job that was moved. */
	"ALTER TABLE job ADD COLUMN turn INTEGER;"
	"UPDATE job SET turn=(SELECT value FROM number WHERE key='turn '||n);"
	"DELETE FROM number WHERE key LIKE 'turn %';"
	"CREATE INDEX job_by_turn ON job(coalesce(turn, n) - loaded * 1e15)"
	" WHERE state IN ('queued', 'interrupted');",

	/* Which jobs have a text of a file: store_text.c. */
	"CREATE INDEX job_by_text ON job(sha256);",

	/* The last events and alarms, and the oldest events. */
	"CREATE INDEX event_by_time ON event(utime);"
	"CREATE INDEX event_by_alarm ON event(utime) WHERE kind IN "
	"('alarm', 'warning', 'lost', 'back');",

	/* What jobs took of their forecast: store_learnt.h. */
	"CREATE TABLE learnt("
	" condition TEXT NOT NULL, electrode TEXT NOT NULL, work TEXT NOT NULL,"
	" passed_s REAL NOT NULL, expected_s REAL NOT NULL,"
	" jobs INTEGER NOT NULL, PRIMARY KEY(condition, electrode, work));",

	/* What it will take.  NULL: nobody has looked yet; below 0: it cannot
	 * be told. */
	"ALTER TABLE job ADD COLUMN forecast_s REAL;",

	/* An electrode may shift X Y and C too, as it sits in its holder. */
	"ALTER TABLE electrode ADD COLUMN x_mm REAL NOT NULL DEFAULT 0;"
	"ALTER TABLE electrode ADD COLUMN y_mm REAL NOT NULL DEFAULT 0;"
	"ALTER TABLE electrode ADD COLUMN c_deg REAL NOT NULL DEFAULT 0;"
	"ALTER TABLE worn ADD COLUMN x_mm REAL NOT NULL DEFAULT 0;"
	"ALTER TABLE worn ADD COLUMN y_mm REAL NOT NULL DEFAULT 0;"
	"ALTER TABLE worn ADD COLUMN c_deg REAL NOT NULL DEFAULT 0;",

	/* Why that cannot be told. */
	"ALTER TABLE job ADD COLUMN forecast_why TEXT NOT NULL DEFAULT '';",

	/* Versions of the technology table: store_tech.h. */
	"CREATE TABLE tech("
	" n INTEGER PRIMARY KEY AUTOINCREMENT, utime INTEGER NOT NULL,"
	" by TEXT NOT NULL, what TEXT NOT NULL, text TEXT NOT NULL);",

	/* What was set for a job: interp/setting.h. */
	"ALTER TABLE job ADD COLUMN setting TEXT NOT NULL DEFAULT '';",
};

#define VERSION	((int)(sizeof(steps) / sizeof(steps[0])))

int store_file_errno(sqlite3 *db, int rc)
{
	const int system = db ? sqlite3_system_errno(db) : 0;

	switch (rc & 0xff) {
	case SQLITE_FULL:
		return -ENOSPC;
	case SQLITE_READONLY:
		return -EROFS;
	case SQLITE_CORRUPT:
	case SQLITE_NOTADB:
		return -EILSEQ;
	case SQLITE_BUSY:
	case SQLITE_LOCKED:
		return -EBUSY;
	case SQLITE_CONSTRAINT:
		return -EEXIST;
	case SQLITE_NOMEM:
		return -ENOMEM;
	default:
		break;
	}
	if (system == ENOSPC || system == EDQUOT)
		return -ENOSPC;
	return system == EROFS ? -EROFS : system == EACCES ? -EACCES : -EIO;
}

static int execute(sqlite3 *db, const char *sql)
{
	const int rc = sqlite3_exec(db, sql, NULL, NULL, NULL);

	return rc == SQLITE_OK ? 0 : store_file_errno(db, rc);
}

/* The first column of the first row: 0 or -errno. */
static int ask_number(sqlite3 *db, const char *sql, int64_t *ret)
{
	sqlite3_stmt *q = NULL;
	int rc = sqlite3_prepare_v2(db, sql, -1, &q, NULL);

	if (rc == SQLITE_OK)
		rc = sqlite3_step(q);
	*ret = rc == SQLITE_ROW ? sqlite3_column_int64(q, 0) : 0;
	sqlite3_finalize(q);
	return rc == SQLITE_ROW ? 0 : rc == SQLITE_DONE ? -EIO :
	       store_file_errno(db, rc);
}

static int step_up(sqlite3 *db, int64_t from)
{
	char version[64];
	int err = execute(db, "BEGIN IMMEDIATE");

	for (int64_t i = from; i < VERSION && err == 0; i++)
		err = execute(db, steps[i]);
	snprintf(version, sizeof(version), "PRAGMA user_version=%d", VERSION);
	if (err == 0)
		err = execute(db, version);
	if (err == 0)
		err = execute(db, "COMMIT");
	if (err < 0 && !sqlite3_get_autocommit(db))
		execute(db, "ROLLBACK");
	return err;
}

/* A new database without tables is made here, and first of all.  If the files
 * that a service makes after it are there already, there was another one. */
static bool is_left_alone(const struct store *s)
{
	static const char *const later[] = { "place", "key", "machine-key" };
	char path[600];

	for (size_t i = 0; i < sizeof(later) / sizeof(later[0]); i++) {
		snprintf(path, sizeof(path), "%.*s%s",
			 (int)strlen(s->path) - 2, s->path, later[i]);
		if (access(path, F_OK) == 0)
			return true;
	}
	return store_text_bytes(s) > 0;
}

static int bring_up(struct store *s, sqlite3 *db)
{
	int64_t version, tables;
	int err = ask_number(db, "PRAGMA user_version", &version);

	if (err == 0)
		err = ask_number(db, "SELECT count(*) FROM sqlite_schema",
				 &tables);
	if (err < 0)
		return err;
	if (version > VERSION)
		return -EPROTO;
	if (version == VERSION)
		return 0;
	s->gone = tables == 0 && is_left_alone(s);
	if (s->gone)
		return -EILSEQ;
	if (tables > 0)
		log_notice("store: bringing it from version %d to %d",
			   (int)version, VERSION);
	return step_up(db, version);
}

/* A damaged page is found now, not when the turn of its job comes. */
static int check(struct store *s, sqlite3 *db)
{
	sqlite3_stmt *q = NULL;
	struct stat st;
	int rc, err = 0;

	if (stat(s->path, &st) < 0 || st.st_size > CHECK_BYTES)
		return 0;
	rc = sqlite3_prepare_v2(db, "PRAGMA quick_check(1)", -1, &q, NULL);
	if (rc == SQLITE_OK)
		rc = sqlite3_step(q);
	if (rc != SQLITE_ROW)
		err = store_file_errno(db, rc);
	else if (strcmp((const char *)sqlite3_column_text(q, 0), "ok") != 0)
		err = -EILSEQ;
	sqlite3_finalize(q);
	return err;
}

/* A file of so many bytes, which is removed at once. */
static int try_file(const struct store *s, int64_t bytes, bool sync)
{
	char path[600] = "";	/* all of it is written */
	int fd, err = 0;

	snprintf(path, sizeof(path), "%s.probe", s->path);
	fd = regular_open(path, O_RDWR | O_CREAT | O_TRUNC, 0600);
	if (fd < 0)
		return fd;
	if (write(fd, path, sizeof(path)) < 0 || (sync && fsync(fd) < 0))
		err = -errno;
	if (err == 0 && bytes > 0)
		err = -posix_fallocate(fd, 0, (off_t)bytes);
	close(fd);
	unlink(path);
	return err;
}

int store_file_probe(const struct store *s)
{
	const int err = try_file(s, 0, true);

	return err ? err : -EIO;
}

int store_file_room(const struct store *s, int64_t bytes)
{
	return try_file(s, bytes, false);
}

static int open_once(struct store *s, sqlite3 **ret)
{
	static const char set[] =
		"PRAGMA auto_vacuum=INCREMENTAL;"
		"PRAGMA journal_mode=WAL;"
		"PRAGMA synchronous=FULL;"
		"PRAGMA journal_size_limit=4194304;";
	struct store_log log;
	sqlite3 *db = NULL;
	int err, rc;

	store_log_look(&log, s->path);
	rc = sqlite3_open(s->path, &db);
	err = rc == SQLITE_OK ? 0 : store_file_errno(db, rc);
	if (err == 0) {
		sqlite3_busy_timeout(db, STORE_BUSY_MS);
		if (!s->in_memory)
			err = store_log_check(&log, db);
	}
	if (err == 0)
		err = execute(db, set);
	/* This is not done each time that there may be room again. */
	if (err == 0 && (!s->in_memory || s->err == -EILSEQ))
		err = check(s, db);
	if (err == 0)
		err = bring_up(s, db);
	if (err == 0)
		err = store_count_begin(db);
	if (err < 0) {
		/* What SQLite has no error for, who asked says in words. */
		if (!s->in_memory && sqlite3_errcode(db) != SQLITE_OK)
			log_error("store: %s: %s", s->path,
				  sqlite3_errmsg(db));
		sqlite3_close_v2(db);
		return err == -EIO ? store_file_probe(s) : err;
	}
	*ret = db;
	return 0;
}

int store_file_make(const char *path, sqlite3 **ret)
{
	sqlite3 *db = NULL;
	int err, rc = sqlite3_open(path, &db);

	err = rc == SQLITE_OK ? 0 : store_file_errno(db, rc);
	if (err == 0)
		err = execute(db, "PRAGMA auto_vacuum=INCREMENTAL;"
			      "PRAGMA synchronous=FULL;");
	if (err == 0)
		err = step_up(db, 0);
	if (err == 0)
		*ret = db;
	else
		sqlite3_close_v2(db);
	return err;
}

/* If it cannot, the log has everything as before. */
void store_file_fold(sqlite3 *db)
{
	sqlite3_wal_checkpoint_v2(db, NULL, SQLITE_CHECKPOINT_PASSIVE, NULL,
				  NULL);
}

int store_file_open(struct store *s, sqlite3 **ret)
{
	int err = open_once(s, ret);

	if (err == -EILSEQ) {
		err = store_mend(s);
		err = err < 0 ? err : open_once(s, ret);
	}
	if (err == 0)
		store_file_fold(*ret);
	return err;
}

/* -- The copy in memory --------------------------------------------------- */

static int copy_row(sqlite3_stmt *from, sqlite3_stmt *to)
{
	for (int i = 0; i < sqlite3_column_count(from); i++)
		sqlite3_bind_value(to, i + 1, sqlite3_column_value(from, i));
	sqlite3_step(to);
	return sqlite3_reset(to);
}

/* Row by row: what can be read of a disk that fails. */
static int copy_rows(sqlite3 *disk, sqlite3 *memory, const char *name)
{
	sqlite3_stmt *from = NULL, *to = NULL;
	char sql[400];
	int n, rc;

	snprintf(sql, sizeof(sql), "SELECT * FROM \"%.60s\"", name);
	rc = sqlite3_prepare_v2(disk, sql, -1, &from, NULL);
	if (rc != SQLITE_OK)
		return rc;
	n = snprintf(sql, sizeof(sql), "INSERT INTO \"%.60s\" VALUES(?", name);
	for (int i = 1; i < sqlite3_column_count(from) && n < 380; i++)
		n += snprintf(sql + n, sizeof(sql) - (size_t)n, ",?");
	snprintf(sql + n, sizeof(sql) - (size_t)n, ")");
	rc = sqlite3_prepare_v2(memory, sql, -1, &to, NULL);
	while (rc == SQLITE_OK && (rc = sqlite3_step(from)) == SQLITE_ROW)
		rc = copy_row(from, to);
	sqlite3_finalize(from);
	sqlite3_finalize(to);
	return rc == SQLITE_DONE ? SQLITE_OK : rc;
}

/* SQLite moves rows of two tables that are alike as they are, which takes a
 * fifth of the time. */
static int copy_table(sqlite3 *disk, sqlite3 *memory, const char *name)
{
	char sql[200];
	int rc;

	snprintf(sql, sizeof(sql), "INSERT INTO main.\"%.60s\" "
		 "SELECT * FROM disk.\"%.60s\"", name, name);
	rc = sqlite3_exec(memory, sql, NULL, NULL, NULL);
	return rc == SQLITE_OK ? rc : copy_rows(disk, memory, name);
}

/* A disk that cannot be read in the usual way is not attached; its tables are
 * copied by rows. */
static void attach(sqlite3 *memory, sqlite3 *disk)
{
	char *sql = sqlite3_mprintf("ATTACH 'file:%q?mode=ro' AS disk",
				    sqlite3_db_filename(disk, "main"));

	if (sql)
		sqlite3_exec(memory, sql, NULL, NULL, NULL);
	sqlite3_free(sql);
}

static int copy_tables(sqlite3 *disk, sqlite3 *memory)
{
	sqlite3_stmt *names = NULL;
	int rc = sqlite3_prepare_v2(memory, "SELECT name FROM sqlite_schema "
				    "WHERE type='table' AND name NOT LIKE "
				    "'sqlite_%' AND name<>'text'", -1, &names,
				    NULL);
	int all = rc;

	while (rc == SQLITE_OK && sqlite3_step(names) == SQLITE_ROW) {
		const int one = copy_table(disk, memory, (const char *)
					   sqlite3_column_text(names, 0));

		all = all == SQLITE_OK ? one : all;
	}
	sqlite3_finalize(names);
	return all;
}

sqlite3 *store_file_copy(struct store *s, sqlite3 *disk)
{
	sqlite3 *memory = NULL;

	/* If there is no memory for a row, there is none for the service. */
	if (sqlite3_open_v2(":memory:", &memory, SQLITE_OPEN_READWRITE |
			    SQLITE_OPEN_URI, NULL) != SQLITE_OK ||
	    step_up(memory, 0) < 0)
		abort();
	if (disk)
		attach(memory, disk);
	if (execute(memory, "BEGIN") < 0)
		abort();
	s->unread = !disk || copy_tables(disk, memory) != SQLITE_OK;
	if (execute(memory, "COMMIT") < 0 || store_count_begin(memory) < 0)
		abort();
	sqlite3_exec(memory, "DETACH disk", NULL, NULL, NULL);
	if (s->unread)
		log_error("store: %s cannot be read either; what is in it is "
			  "not known until it can be", s->path);
	return memory;
}

/* If the log cannot be locked or written, it is read into memory by a private
 * database.  Without a log, the file has everything. */
sqlite3 *store_file_look(struct store *s)
{
	char uri[600], log[520];
	struct stat st;
	sqlite3 *db = NULL;
	bool has_log;

	snprintf(log, sizeof(log), "%s-wal", s->path);
	has_log = stat(log, &st) == 0 && st.st_size > 0;
	snprintf(uri, sizeof(uri), "file:%s?mode=ro%s", s->path,
		 has_log ? "&vfs=unix-none" : "&immutable=1");
	if (sqlite3_open_v2(uri, &db, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI,
			    NULL) == SQLITE_OK) {
		execute(db, "PRAGMA locking_mode=EXCLUSIVE");
		return db;
	}
	sqlite3_close_v2(db);
	return NULL;
}
