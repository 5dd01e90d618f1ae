/* SPDX-License-Identifier: Apache-2.0 */
/*
 * store_mend.c - sets a damaged database aside and recovers what can be read
 *
 * Every table is read by its row numbers, upward and then downward.  Jumps of
 * growing length skip what cannot be read.  So only the rows in damaged pages
 * are lost.  The first page has the names of the tables: if it is damaged,
 * everything is lost.
 */
#include "store_sql.h"

#include "jobs_log.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define JUMP_MAX	(INT64_C(1) << 40)

/* Give the file of @from a second name; it may be missing. */
static int name_too(const char *from, const char *to, const char *suffix)
{
	char a[600], b[600];

	snprintf(a, sizeof(a), "%s%s", from, suffix);
	snprintf(b, sizeof(b), "%s%s", to, suffix);
	if (link(a, b) < 0 && (errno != ENOENT || !*suffix))
		return -errno;
	return 0;
}

static void remove_with(const char *path, const char *suffix)
{
	char name[600];

	snprintf(name, sizeof(name), "%s%s", path, suffix);
	unlink(name);
}

/* -- Row by row ----------------------------------------------------------- */

struct rescue {
	sqlite3 *from, *to;
	const char *table;
	sqlite3_stmt *read[2];		/* upward, downward */
	sqlite3_stmt *write;
	int columns;
};

static int rescue_prepare(struct rescue *r)
{
	char sql[800];
	int n, rc;

	snprintf(sql, sizeof(sql), "SELECT rowid, * FROM \"%.60s\" WHERE "
		 "rowid>? ORDER BY rowid", r->table);
	rc = sqlite3_prepare_v2(r->from, sql, -1, &r->read[0], NULL);
	snprintf(sql, sizeof(sql), "SELECT rowid, * FROM \"%.60s\" WHERE "
		 "rowid<? ORDER BY rowid DESC", r->table);
	if (rc == SQLITE_OK)
		rc = sqlite3_prepare_v2(r->from, sql, -1, &r->read[1], NULL);
	if (rc != SQLITE_OK)
		return rc;
	r->columns = sqlite3_column_count(r->read[0]);
	n = snprintf(sql, sizeof(sql), "INSERT OR IGNORE INTO \"%.60s\"(rowid",
		     r->table);
	for (int i = 1; i < r->columns && n < 700; i++)
		n += snprintf(sql + n, sizeof(sql) - (size_t)n, ",\"%.30s\"",
			      sqlite3_column_name(r->read[0], i));
	n += snprintf(sql + n, sizeof(sql) - (size_t)n, ") VALUES(?");
	for (int i = 1; i < r->columns && n < 780; i++)
		n += snprintf(sql + n, sizeof(sql) - (size_t)n, ",?");
	snprintf(sql + n, sizeof(sql) - (size_t)n, ")");
	return sqlite3_prepare_v2(r->to, sql, -1, &r->write, NULL);
}

static void rescue_row(struct rescue *r, sqlite3_stmt *from)
{
	for (int i = 0; i < r->columns; i++)
		sqlite3_bind_value(r->write, i + 1,
				   sqlite3_column_value(from, i));
	sqlite3_step(r->write);
	sqlite3_reset(r->write);
}

static void rescue_way(struct rescue *r, int down)
{
	int64_t at = down ? INT64_MAX : INT64_MIN, jump = 1;
	sqlite3_stmt *q = r->read[down];
	int rc = SQLITE_ERROR;

	while (rc != SQLITE_DONE && jump < JUMP_MAX) {
		sqlite3_reset(q);
		sqlite3_bind_int64(q, 1, at);
		while ((rc = sqlite3_step(q)) == SQLITE_ROW) {
			rescue_row(r, q);
			at = sqlite3_column_int64(q, 0);
			jump = 1;
		}
		/* Rows are numbered from 1. */
		if (at < 0)
			at = 0;
		if (!down)
			at += jump;
		else if (at == INT64_MAX)
			break;
		else
			at -= jump;
		jump *= 2;
	}
	sqlite3_reset(q);
}

static void rescue_table(sqlite3 *from, sqlite3 *to, const char *table)
{
	struct rescue r = { .from = from, .to = to, .table = table };

	if (rescue_prepare(&r) == SQLITE_OK) {
		rescue_way(&r, 0);
		rescue_way(&r, 1);
	}
	sqlite3_finalize(r.read[0]);
	sqlite3_finalize(r.read[1]);
	sqlite3_finalize(r.write);
}

static void rescue_tables(sqlite3 *from, sqlite3 *to)
{
	sqlite3_stmt *names = NULL;

	sqlite3_prepare_v2(to, "SELECT name FROM sqlite_schema WHERE "
			   "type='table' AND name NOT LIKE 'sqlite_%'", -1,
			   &names, NULL);
	while (names && sqlite3_step(names) == SQLITE_ROW)
		rescue_table(from, to, (const char *)
			     sqlite3_column_text(names, 0));
	sqlite3_finalize(names);
}

/* Numbers that were lost with their rows are not used again.  No recovered job
 * starts by itself.  A job without its text is not a job. */
static const char settle[] =
	"INSERT OR IGNORE INTO sqlite_sequence SELECT 'job', 0 WHERE NOT EXISTS"
	" (SELECT 1 FROM sqlite_sequence WHERE name='job');"
	"UPDATE sqlite_sequence SET seq=seq+1000 WHERE name='job';"
	"INSERT OR REPLACE INTO number VALUES('waiting', 1);"
	"INSERT OR REPLACE INTO number VALUES('elsewhere', 0x80000000 | "
	"ifnull((SELECT value FROM number WHERE key='elsewhere'), 0));"
	"DELETE FROM text WHERE n NOT IN (SELECT n FROM job);"
	"UPDATE job SET state='stopped', loaded=0, ended_us=unixepoch()*1000000,"
	" reason="
	"'its text was lost when the database was damaged' "
	"WHERE state NOT IN ('done', 'fault', 'stopped') AND "
	"n NOT IN (SELECT n FROM text);"
	"COMMIT;";

/* Return: the number of recovered jobs; -1: the new file cannot be made. */
static int64_t recover(const char *aside, const char *fresh)
{
	sqlite3 *from = NULL, *to = NULL;
	sqlite3_stmt *q = NULL;
	int64_t n = -1;

	if (store_file_make(fresh, &to) < 0)
		return -1;
	sqlite3_exec(to, "BEGIN", NULL, NULL, NULL);
	if (sqlite3_open_v2(aside, &from, SQLITE_OPEN_READWRITE, NULL) ==
	    SQLITE_OK)
		rescue_tables(from, to);
	if (sqlite3_exec(to, settle, NULL, NULL, NULL) == SQLITE_OK &&
	    sqlite3_prepare_v2(to, "SELECT count(*) FROM job", -1, &q, NULL) ==
	    SQLITE_OK && sqlite3_step(q) == SQLITE_ROW)
		n = sqlite3_column_int64(q, 0);
	sqlite3_finalize(q);
	sqlite3_close_v2(from);
	sqlite3_close_v2(to);
	return n;
}

static void name_aside(const struct store *s, char *to, size_t size)
{
	time_t now = time(NULL);
	char when[32];
	struct tm tm;

	localtime_r(&now, &tm);
	strftime(when, sizeof(when), "%Y%m%d-%H%M%S", &tm);
	snprintf(to, size, "%s.damaged-%s", s->path, when);
}

static void tell(struct store *s, int64_t jobs, const char *aside)
{
	if (s->gone)
		snprintf(s->told, sizeof(s->told),
			 "%.240s is gone or empty, beside its other files: "
			 "queue, history, work offsets, electrodes and keys are "
			 "lost, and nothing starts until start; if there is a "
			 "copy, end edmd-jobs and put it back", s->path);
	else
		snprintf(s->told, sizeof(s->told),
			 "the database was damaged; %lld jobs were recovered, "
			 "and nothing starts until start; what was there is "
			 "kept as %.200s", (long long)jobs, aside);
	log_error("store: %s", s->told);
}

int store_mend(struct store *s)
{
	char aside[560], fresh[560];
	int64_t n;
	int err;

	name_aside(s, aside, sizeof(aside));
	snprintf(fresh, sizeof(fresh), "%s.recovered", s->path);
	remove_with(fresh, "");
	remove_with(fresh, "-journal");
	/* The file has both names until the new file is whole.  If the service
	 * is killed before, the next start finds the damaged file with its log
	 * and begins again. */
	err = name_too(s->path, aside, "");
	if (err == 0)
		err = name_too(s->path, aside, "-wal");
	if (err < 0)
		return err;
	n = recover(aside, fresh);
	if (n < 0)
		return -EILSEQ;
	remove_with(s->path, "-wal");
	remove_with(s->path, "-shm");
	if (rename(fresh, s->path) < 0)
		return -errno;
	tell(s, n, aside);
	return 0;
}
