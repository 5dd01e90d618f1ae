/* SPDX-License-Identifier: Apache-2.0 */
/* ledger.c - what a fleet did, in one SQLite file or in memory */
#include "ledger.h"

#include "plain.h"

#include <errno.h>
#include <fcntl.h>
#include <jansson.h>
#include <math.h>
#include <sqlite3.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

#define VERSION		1
#define BUSY_MS		500		/* less than the second in which sink.c
					 * looks at the states */
#define TEXT_MAX	256

struct ledger {
	sqlite3 *db;			/* NULL: not open */
	const char *path;		/* NULL: in memory */
	bool write;
	int lock;			/* -1: none */
	char why[TEXT_MAX];
};

static const char schema[] =
	"CREATE TABLE report("
	" machine TEXT, job TEXT, number INTEGER, name TEXT, state TEXT,"
	" reason TEXT, submitted_us INTEGER, first_us INTEGER,"
	" ended_us INTEGER, job_s REAL, erode_s REAL, path_mm REAL,"
	" length_mm REAL, depth_mm REAL, energy_j REAL, jumps INTEGER,"
	" retracts INTEGER, shorts INTEGER, arcs INTEGER, lines INTEGER,"
	" sha256 TEXT, PRIMARY KEY(machine, job));"
	"CREATE INDEX report_by_end ON report(ended_us);"
	"CREATE TABLE alarm("
	" machine TEXT, number INTEGER, utime INTEGER, kind TEXT, fault TEXT,"
	" job TEXT, place_mm REAL, text TEXT,"
	" PRIMARY KEY(machine, number, utime));"
	"CREATE INDEX alarm_by_time ON alarm(utime);"
	"CREATE TABLE spent("
	" day TEXT, machine TEXT, what TEXT, why TEXT, s REAL,"
	" PRIMARY KEY(day, machine, what, why));"
	"PRAGMA user_version=1";

/* What was spent since the last commit. */
static const char memory[] =
	"PRAGMA temp_store=MEMORY;"
	"CREATE TEMP TABLE now("
	" day TEXT, machine TEXT, what TEXT, why TEXT, s REAL,"
	" PRIMARY KEY(day, machine, what, why))";

static const char spend[] =
	"INSERT INTO temp.now VALUES(date('now', 'localtime'), ?, ?, ?, ?)"
	" ON CONFLICT DO UPDATE SET s=s+excluded.s";

static const char settle[] =
	"INSERT INTO main.spent SELECT * FROM temp.now WHERE true"
	" ON CONFLICT DO UPDATE SET s=s+excluded.s";

/* -- SQLite ---------------------------------------------------------------- */

static int failed(struct ledger *l, int rc)
{
	const int err = sqlite3_system_errno(l->db);

	snprintf(l->why, sizeof(l->why), "%s", sqlite3_errmsg(l->db));
	if ((rc & 0xff) == SQLITE_FULL)
		return -ENOSPC;
	return err > 0 ? -err : -EIO;
}

static int run(struct ledger *l, const char *sql)
{
	const int rc = sqlite3_exec(l->db, sql, NULL, NULL, NULL);

	return rc == SQLITE_OK ? 0 : failed(l, rc);
}

/* What comes from the network is plain from here on. */
static void bind_text(sqlite3_stmt *q, int at, const char *text)
{
	char plain[TEXT_MAX];

	plain_copy(plain, sizeof(plain), text);
	sqlite3_bind_text(q, at, plain, -1, SQLITE_TRANSIENT);
}

/* @types: a letter for each value: s text, i int64_t, d double. */
static sqlite3_stmt *ask(struct ledger *l, const char *sql, const char *types,
			 va_list values)
{
	sqlite3_stmt *q = NULL;

	if (sqlite3_prepare_v2(l->db, sql, -1, &q, NULL) != SQLITE_OK)
		return NULL;
	for (int i = 0; types[i]; i++)
		if (types[i] == 's')
			bind_text(q, i + 1, va_arg(values, const char *));
		else if (types[i] == 'i')
			sqlite3_bind_int64(q, i + 1, va_arg(values, int64_t));
		else
			sqlite3_bind_double(q, i + 1, va_arg(values, double));
	return q;
}

static int put(struct ledger *l, const char *sql, const char *types, ...)
{
	sqlite3_stmt *q;
	va_list values;
	int rc;

	if (!l->db)
		return -EIO;
	va_start(values, types);
	q = ask(l, sql, types, values);
	va_end(values);
	rc = q ? sqlite3_step(q) : SQLITE_ERROR;
	if (rc != SQLITE_DONE)
		rc = failed(l, rc);
	else
		rc = 0;
	sqlite3_finalize(q);
	return rc;
}

/* -- Open and close -------------------------------------------------------- */

/* A file of its own: SQLite loses its own locks of a file that somebody else
 * in the process closes. */
static int keep_out(struct ledger *l)
{
	char at[4096];

	snprintf(at, sizeof(at), "%s-lock", l->path);
	l->lock = open(at, O_RDWR | O_CREAT | O_CLOEXEC, 0640);
	if (l->lock < 0 || flock(l->lock, LOCK_EX | LOCK_NB) == 0)
		return 0;
	snprintf(l->why, sizeof(l->why), "another edm-fleet record writes it");
	return -EALREADY;
}

static int version(struct ledger *l)
{
	sqlite3_stmt *q = NULL;
	int v = -1;

	if (sqlite3_prepare_v2(l->db, "PRAGMA user_version", -1, &q, NULL) ==
		    SQLITE_OK && sqlite3_step(q) == SQLITE_ROW)
		v = sqlite3_column_int(q, 0);
	else
		failed(l, SQLITE_ERROR);
	sqlite3_finalize(q);
	return v;
}

static int make(struct ledger *l)
{
	const bool write = l->write;
	const int v = version(l);
	int err = v < 0 ? -EIO : 0;

	if (v > VERSION) {
		snprintf(l->why, sizeof(l->why), "a newer edm-fleet made it");
		return -EPROTO;
	}
	if (err == 0 && write)
		err = run(l, "PRAGMA journal_mode=WAL;"
			     "PRAGMA synchronous=FULL");
	if (err == 0 && v == 0 && write)
		err = run(l, "BEGIN IMMEDIATE");
	if (err == 0 && v == 0 && write) {
		err = run(l, schema);
		err = err ? err : run(l, "COMMIT");
	} else if (err == 0 && v == 0) {
		snprintf(l->why, sizeof(l->why), "edm-fleet record made no "
			 "such file");
		err = -EINVAL;
	}
	return err < 0 ? err : run(l, memory);
}

static int open_db(struct ledger *l)
{
	const int how = l->write ? SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE :
				   SQLITE_OPEN_READONLY;
	int err = 0;

	if (sqlite3_open_v2(l->path ? l->path : ":memory:", &l->db, how,
			    NULL) != SQLITE_OK)
		err = failed(l, SQLITE_CANTOPEN);
	if (err == 0) {
		sqlite3_busy_timeout(l->db, BUSY_MS);
		err = make(l);
	}
	if (err < 0) {
		sqlite3_close(l->db);
		l->db = NULL;
	}
	return err;
}

int ledger_open(struct ledger **ret, const char *path, bool write,
		const char **why)
{
	struct ledger *l = calloc(1, sizeof(*l));
	int err = 0;

	*ret = l;
	*why = "no memory";
	if (!l)
		return -ENOMEM;
	*why = l->why;
	*l = (struct ledger) { .path = path, .write = write, .lock = -1 };
	if (path && write)
		err = keep_out(l);
	return err < 0 ? err : open_db(l);
}

void ledger_close(struct ledger *l)
{
	if (!l)
		return;
	sqlite3_close(l->db);
	if (l->lock >= 0)
		close(l->lock);
	free(l);
}

const char *ledger_why(const struct ledger *l)
{
	return l->why;
}

/* -- What is put in -------------------------------------------------------- */

/* Somebody put the file away: what comes goes into a new one. */
static void follow(struct ledger *l)
{
	int moved = 0;

	if (l->db)
		sqlite3_file_control(l->db, "main", SQLITE_FCNTL_HAS_MOVED,
				     &moved);
	if (moved) {
		/* The old one is to be whole without what lies beside it. */
		run(l, "PRAGMA wal_checkpoint(TRUNCATE)");
		sqlite3_close(l->db);
		l->db = NULL;
	}
}

int ledger_begin(struct ledger *l)
{
	int err = 0;

	follow(l);
	if (!l->db)
		err = open_db(l);
	return err < 0 ? err : run(l, "BEGIN IMMEDIATE");
}

int ledger_end(struct ledger *l, int err)
{
	err = err < 0 ? err : run(l, settle);
	err = err < 0 ? err : run(l, "COMMIT");
	if (err == 0)
		return run(l, "DELETE FROM temp.now");
	if (l->db && !sqlite3_get_autocommit(l->db))
		sqlite3_exec(l->db, "ROLLBACK", NULL, NULL, NULL);
	return err;
}

int ledger_report(struct ledger *l, const edm_JobReport *m)
{
	/* A job that ended by a fault may go on, and end again. */
	return put(l, "INSERT OR REPLACE INTO report SELECT ?1, ?2, ?3, ?4, "
		   "?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16, "
		   "?17, ?18, ?19, ?20, ?21 WHERE NOT EXISTS (SELECT 1 FROM "
		   "report WHERE machine=?1 AND job=?2 AND ended_us>=?9)",
		   "ssisssiiiddddddiiiiis", m->machine, m->job,
		   (int64_t)m->number, m->name, m->state, m->reason,
		   m->submitted_utime, m->first_utime, m->ended_utime,
		   m->job_s, m->erode_s, m->path_mm, m->length_mm, m->depth_mm,
		   m->energy_j, (int64_t)m->jumps, (int64_t)m->retracts,
		   (int64_t)m->shorts, (int64_t)m->arcs, (int64_t)m->lines,
		   m->sha256);
}

int ledger_alarm(struct ledger *l, const edm_Alarm *m)
{
	return put(l, "INSERT OR IGNORE INTO alarm VALUES(?, ?, ?, ?, ?, ?, "
		   "?, ?)", "siisssds", m->machine, (int64_t)m->number,
		   m->utime, m->kind, m->fault, m->job, m->place_mm, m->text);
}

struct use {
	const char *what, *why;
};

static bool is_one_of(const char *word, const char *words)
{
	const size_t n = strlen(word);
	const char *at = n ? strstr(words, word) : NULL;

	return at && (at == words || at[-1] == ' ') &&
	       (at[n] == ' ' || !at[n]);
}

static struct use use_of(const struct hall_machine *r)
{
	const char *state = r->m.state;

	if (r->gone)
		return (struct use) { "away", "gone" };
	if (r->disputed)
		return (struct use) { "away", "disputed" };
	if (is_one_of(state, "absent lost"))
		return (struct use) { "away", state };
	if (is_one_of(state, "fault"))
		return (struct use) { "stand", r->m.fault };
	if (*r->m.stand)
		return (struct use) { "stand", r->m.stand };
	if (is_one_of(state, "approach erode retract jump"))
		return (struct use) { "cut", "" };
	if (is_one_of(state, "travel jog home probe"))
		return (struct use) { "move", "" };
	if (is_one_of(state, "hold"))
		return (struct use) { "stand", "held" };
	return (struct use) { "idle", "" };
}

void ledger_spend(struct ledger *l, const struct hall_machine *r, double s)
{
	const struct use u = use_of(r);

	put(l, spend, "sssd", r->m.machine, u.what, u.why, s);
}

/* -- What is asked for ----------------------------------------------------- */

#define SINCE		"date('now', 'localtime', printf('-%d days', ?1))"
#define DAY(UTIME)	"date(" UTIME " / 1e6, 'unixepoch', 'localtime')"
#define HOURS(WHAT)	"(SELECT total(s)/3600 FROM some WHERE machine=m " \
			"AND what='" WHAT "')"
#define WHY		"coalesce((SELECT group_concat(why || printf(' %.2f " \
			"h', h), ', ') FROM (SELECT why, sum(s)/3600 AS h " \
			"FROM some WHERE machine=m AND what IN ('stand', " \
			"'away') GROUP BY why ORDER BY h DESC)), '')"
/* A machine whose states nobody recorded has cut what its jobs say. */
#define REPORT_SQL \
	"WITH done AS (SELECT * FROM report WHERE " DAY("ended_us") ">=" \
	SINCE "), some AS (SELECT * FROM spent WHERE day>=" SINCE "), " \
	"each(m) AS (SELECT machine FROM done UNION SELECT machine FROM " \
	"some) SELECT m AS machine, max(" HOURS("cut") ", " \
	"total(erode_s)/3600) AS cut_h, " HOURS("move") " AS move_h, " \
	HOURS("idle") " AS idle_h, " HOURS("stand") " AS stand_h, " \
	HOURS("away") " AS away_h, count(job) AS jobs, " \
	"total(state='done') AS done, total(path_mm) AS path_mm, " \
	"total(retracts) AS retracts, sum(energy_j) AS energy_j, " WHY \
	" AS why FROM each LEFT JOIN done ON machine=m GROUP BY m ORDER BY m"
#define ALARMS_SQL \
	"SELECT machine, strftime('%Y-%m-%d %H:%M:%S', utime / 1e6, " \
	"'unixepoch', 'localtime') AS time, utime, kind, fault, job, " \
	"place_mm, text FROM alarm WHERE " DAY("utime") ">=" SINCE \
	" ORDER BY utime DESC, number DESC"

struct column {
	const char *name;		/* of the query */
	const char *head;
	int width, digits;
};

static const struct column report_columns[] = {
	{ "machine", "MACHINE", -14, 0 }, { "cut_h", "CUT h", 8, 2 },
	{ "move_h", "MOVE h", 8, 2 }, { "idle_h", "IDLE h", 8, 2 },
	{ "stand_h", "STAND h", 8, 2 }, { "away_h", "AWAY h", 8, 2 },
	{ "jobs", "JOBS", 6, 0 }, { "done", "DONE", 6, 0 },
	{ "path_mm", "PATH mm", 11, 1 }, { "retracts", "RETR.", 7, 0 },
	{ "energy_j", "ENERGY J", 11, 1 },
	{ "why", "STOOD AND AWAY", -1, 0 },
};

static const struct column alarm_columns[] = {
	{ "time", "TIME", -20, 0 }, { "machine", "MACHINE", -14, 0 },
	{ "kind", "KIND", -8, 0 }, { "fault", "FAULT", -20, 0 },
	{ "place_mm", "PLACE mm", 10, 3 }, { "job", "JOB", -20, 0 },
	{ "text", "TEXT", -1, 0 },
};

static void print_cell(sqlite3_stmt *q, int at, const struct column *c,
		       FILE *f)
{
	const int type = sqlite3_column_type(q, at);

	if (type == SQLITE_INTEGER || type == SQLITE_FLOAT)
		fprintf(f, "%*.*f", c->width, c->digits,
			sqlite3_column_double(q, at));
	else
		fprintf(f, "%*s", c->width, type == SQLITE_NULL ? "-" :
			(const char *)sqlite3_column_text(q, at));
}

static void print_row(sqlite3_stmt *q, const struct column *c, int n, FILE *f)
{
	for (int i = 0; i < n; i++) {
		for (int at = 0; at < sqlite3_column_count(q); at++)
			if (!strcmp(sqlite3_column_name(q, at), c[i].name))
				print_cell(q, at, &c[i], f);
		fputs(i + 1 < n ? " " : "\n", f);
	}
}

static void print_heads(const struct column *c, int n, FILE *f)
{
	for (int i = 0; i < n; i++)
		fprintf(f, "%*s%s", c[i].width, c[i].head,
			i + 1 < n ? " " : "\n");
}

static void put_json(json_t *o, sqlite3_stmt *q, int at)
{
	const char *name = sqlite3_column_name(q, at);
	const double v = sqlite3_column_double(q, at);

	switch (sqlite3_column_type(q, at)) {
	case SQLITE_INTEGER:
		json_object_set_new(o, name,
				    json_integer(sqlite3_column_int64(q, at)));
		break;
	case SQLITE_FLOAT:
		json_object_set_new(o, name, isfinite(v) ? json_real(v) :
							   json_null());
		break;
	case SQLITE_TEXT:
		json_object_set_new(o, name, json_string(
			(const char *)sqlite3_column_text(q, at)));
		break;
	default:
		json_object_set_new(o, name, json_null());
	}
}

static json_t *json_row(sqlite3_stmt *q)
{
	json_t *o = json_object();

	for (int at = 0; at < sqlite3_column_count(q); at++)
		put_json(o, q, at);
	return o;
}

struct sheet {
	const char *name, *sql;
	const struct column *column;
	int ncolumns;
};

static int print_table(struct ledger *l, const struct sheet *s,
		       sqlite3_stmt *q, FILE *f)
{
	int n = 0, rc;

	for (; (rc = sqlite3_step(q)) == SQLITE_ROW; n++) {
		if (n == 0)
			print_heads(s->column, s->ncolumns, f);
		print_row(q, s->column, s->ncolumns, f);
	}
	return rc == SQLITE_DONE ? n : failed(l, rc);
}

static int print_json(struct ledger *l, const struct sheet *s, sqlite3_stmt *q,
		      FILE *f)
{
	json_t *all = json_array(), *o = json_object();
	int n = 0, rc;

	for (; (rc = sqlite3_step(q)) == SQLITE_ROW; n++)
		json_array_append_new(all, json_row(q));
	json_object_set_new(o, s->name, all);
	if (rc == SQLITE_DONE) {
		json_dumpf(o, f, JSON_COMPACT | JSON_REAL_PRECISION(15));
		fputc('\n', f);
	}
	json_decref(o);
	return rc == SQLITE_DONE ? n : failed(l, rc);
}

static int print(struct ledger *l, const struct sheet *s, int days, bool json,
		 FILE *f)
{
	sqlite3_stmt *q = NULL;
	int n;

	if (sqlite3_prepare_v2(l->db, s->sql, -1, &q, NULL) != SQLITE_OK)
		return failed(l, SQLITE_ERROR);
	sqlite3_bind_int(q, 1, days);
	n = json ? print_json(l, s, q, f) : print_table(l, s, q, f);
	sqlite3_finalize(q);
	return n;
}

#define SHEET(name, sql, column) \
	&(const struct sheet){ name, sql, column, \
			       sizeof(column) / sizeof(column[0]) }

int ledger_print_report(struct ledger *l, int days, bool json, FILE *f)
{
	return print(l, SHEET("report", REPORT_SQL, report_columns), days,
		     json, f);
}

int ledger_print_alarms(struct ledger *l, int days, bool json, FILE *f)
{
	return print(l, SHEET("alarms", ALARMS_SQL, alarm_columns), days, json,
		     f);
}
