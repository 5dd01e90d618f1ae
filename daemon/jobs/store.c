/* SPDX-License-Identifier: Apache-2.0 */
/* store.c - jobs, events and a few numbers: writing and asking */
#include "store_sql.h"
#include "store_text.h"
#include "store_turn.h"

#include "plain.h"

#include <errno.h>
#include <math.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const char *const state_names[JOB_NSTATES] = {
	[JOB_QUEUED]	= "queued",
	[JOB_READY]	= "ready",
	[JOB_RUNNING]	= "running",
	[JOB_HELD]	= "held",
	[JOB_DONE]	= "done",
	[JOB_FAULT]	= "fault",
	[JOB_STOPPED]	= "stopped",
	[JOB_INTERRUPTED] = "interrupted",
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

/* -- A new one ------------------------------------------------------------ */

static int insert(struct store *s, const struct store_new *j)
{
	return store_do(s, STORE_MUST, "INSERT INTO job(id, name, sha256, "
			"lines, hold, submitted_us, tech_sha256, electrode, "
			"measures, setting) VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, "
			"?)", "sssiiisiis", j->id, j->name, j->sha256,
			(int64_t)j->lines, (int64_t)j->hold, j->now_us,
			j->tech_sha256, (int64_t)j->electrode,
			(int64_t)j->measures, j->setting ? j->setting : "");
}

static int insert_text(struct store *s, const struct store_new *j, int64_t n)
{
	sqlite3_stmt *q = NULL;
	int rc = sqlite3_prepare_v2(s->db, "INSERT INTO text VALUES(?, ?)", -1,
				    &q, NULL);

	if (rc == SQLITE_OK) {
		sqlite3_bind_int64(q, 1, n);
		if (j->bytes > STORE_TEXT_INSIDE)
			sqlite3_bind_int64(q, 2, 0);
		else
			sqlite3_bind_blob64(q, 2, j->text, j->bytes,
					    SQLITE_STATIC);
		rc = sqlite3_step(q);
	}
	sqlite3_finalize(q);
	return rc == SQLITE_DONE ? 0 : store_failed(s, rc);
}

static int insert_begin(struct store *s, const struct store_new *j, int64_t n)
{
	return !j->begin_at ? 0 :
	       store_do(s, STORE_MUST, "INSERT INTO resume VALUES(?, ?)", "is",
			n, j->begin_at);
}

static int write_note(struct store *s, enum store_keep keep,
		      const struct store_note *e)
{
	return store_do(s, keep, "INSERT INTO event VALUES(?, ?, ?, ?, ?, ?)",
			"isssds", e->now_us, e->kind, e->job, e->outcome,
			e->place_mm, e->text);
}

/* It goes with the row of the job. */
static int insert_told(struct store *s, const struct store_new *j)
{
	return !j->told ? 0 :
	       write_note(s, STORE_MUST, &(struct store_note) {
			.kind = "queued", .job = j->id, .outcome = "",
			.text = j->told, .now_us = j->now_us,
	       });
}

/* A long one has its file already, if it comes from an upload. */
static int keep_long(struct store *s, const struct store_new *j)
{
	char path[STORE_TEXT_PATH_MAX];
	struct stat st;

	store_text_path(s, j->sha256, path);
	if (j->bytes <= STORE_TEXT_INSIDE ||
	    (stat(path, &st) == 0 && (size_t)st.st_size == j->bytes))
		return 0;
	return store_text_keep(path, j->text, j->bytes);
}

int store_add(struct store *s, const struct store_new *j, uint32_t *ret_n)
{
	int64_t n = 0;
	int err = s->in_memory ? STORE_KEPT : keep_long(s, j);

	if (err < 0)
		return err;
	err = store_together(s, true);

	if (err == STORE_KEPT)
		return s->err;
	if (err == 0)
		err = insert(s, j);
	if (err == 0) {
		n = sqlite3_last_insert_rowid(s->db);
		err = insert_text(s, j, n);
	}
	if (err == 0)
		err = insert_begin(s, j, n);
	if (err == 0)
		err = insert_told(s, j);
	if (err < 0) {
		store_undo(s);
		return err;
	}
	*ret_n = (uint32_t)n;
	if (store_commit(s) == 0)
		return 0;
	/* The row may have reached the file even so, but it is not a job. */
	store_do(s, STORE_KEEP, "DELETE FROM job WHERE id=? AND begun_us=0",
		 "S", j->id);
	return s->err;
}

/* -- One that is there ---------------------------------------------------- */

static void column_copy(sqlite3_stmt *q, int i, char *to, size_t size)
{
	const unsigned char *from = sqlite3_column_text(q, i);

	plain_copy(to, size, from ? (const char *)from : "");
}

#define JOB_COLUMNS	"n, id, name, sha256, state, hold, loaded, " \
			"begun_us, lines, tech_sha256, submitted_us, " \
			"electrode, measures, setting"

static int job_get(sqlite3_stmt *q, int err, struct store_job *ret)
{
	if (!q)
		return err;
	ret->n = (uint32_t)sqlite3_column_int64(q, 0);
	column_copy(q, 1, ret->id, sizeof(ret->id));
	column_copy(q, 2, ret->name, sizeof(ret->name));
	column_copy(q, 3, ret->sha256, sizeof(ret->sha256));
	ret->state = state_of(sqlite3_column_text(q, 4));
	ret->hold = sqlite3_column_int(q, 5) != 0;
	ret->loaded = sqlite3_column_int(q, 6) != 0;
	ret->begun_us = sqlite3_column_int64(q, 7);
	ret->lines = (uint32_t)sqlite3_column_int64(q, 8);
	column_copy(q, 9, ret->tech_sha256, sizeof(ret->tech_sha256));
	ret->submitted_us = sqlite3_column_int64(q, 10);
	ret->electrode = (uint32_t)sqlite3_column_int64(q, 11);
	ret->measures = (uint32_t)sqlite3_column_int64(q, 12);
	column_copy(q, 13, ret->setting, sizeof(ret->setting));
	sqlite3_finalize(q);
	return 0;
}

int store_find(struct store *s, const char *id, struct store_job *ret)
{
	int err;
	sqlite3_stmt *q = store_ask(s, &err, "SELECT " JOB_COLUMNS " FROM job "
				    "WHERE id=?", "s", id);

	return job_get(q, err, ret);
}

int store_find_number(struct store *s, uint32_t n, struct store_job *ret)
{
	int err;
	sqlite3_stmt *q = store_ask(s, &err, "SELECT " JOB_COLUMNS " FROM job "
				    "WHERE n=?", "i", (int64_t)n);

	return job_get(q, err, ret);
}

int store_loaded(struct store *s, struct store_job *ret)
{
	int err;
	/* With all states, for the index that begins with them. */
	sqlite3_stmt *q = store_ask(s, &err, "SELECT " JOB_COLUMNS " FROM job "
				    "WHERE state IN (" STORE_ENDED ", 'queued'"
				    ", 'ready', 'running', 'held', "
				    "'interrupted') AND loaded=1 ORDER BY n "
				    "LIMIT 1", "");

	return job_get(q, err, ret);
}

#define MAY_BE_NEXT	" AND state='queued' AND loaded=0"

int store_head(struct store *s, struct store_job *ret)
{
	int err;
	sqlite3_stmt *q = store_ask(s, &err, "SELECT " JOB_COLUMNS " FROM job "
				    "WHERE n=?" MAY_BE_NEXT, "i",
				    store_number(s, "selected", 0));

	if (!q && err == -ENOENT)
		q = store_ask(s, &err, "SELECT " JOB_COLUMNS " FROM job "
			      "INDEXED BY job_by_turn WHERE state IN ('queued',"
			      " 'interrupted')" MAY_BE_NEXT " ORDER BY "
			      STORE_IN_QUEUE " LIMIT 1", "");
	return job_get(q, err, ret);
}

int store_unforecast(struct store *s, bool later, struct store_job *ret)
{
	int err;
	sqlite3_stmt *q = store_ask(s, &err, "SELECT " JOB_COLUMNS " FROM job "
				    "INDEXED BY job_by_turn WHERE state IN "
				    "('queued', 'interrupted') AND "
				    "+state='queued' AND loaded=0 AND "
				    "forecast_s IS ? ORDER BY " STORE_IN_QUEUE
				    " LIMIT 1", "d", later ? STORE_PUT_OFF :
				    NAN);

	return job_get(q, err, ret);
}

/* -- Its text ------------------------------------------------------------- */

/* SQLite does not always notice that a page comes back with other bytes. */
static bool is_the_text(const char *text, size_t bytes, const char *sha256)
{
	unsigned char hash[crypto_hash_sha256_BYTES];
	char hex[2 * sizeof(hash) + 1];

	crypto_hash_sha256(hash, (const unsigned char *)text, bytes);
	sodium_bin2hex(hex, sizeof(hex), hash, sizeof(hash));
	return sha256 && strcmp(sha256, hex) == 0;
}

static int text_get(sqlite3_stmt *q, char **ret, size_t *ret_bytes)
{
	const size_t bytes = (size_t)sqlite3_column_bytes(q, 0);
	char *copy = malloc(bytes + 1);

	if (!copy)
		return -ENOMEM;
	if (bytes)
		memcpy(copy, sqlite3_column_blob(q, 0), bytes);
	if (!is_the_text(copy, bytes,
			 (const char *)sqlite3_column_text(q, 1))) {
		free(copy);
		return -EILSEQ;
	}
	*ret = copy;
	*ret_bytes = bytes;
	return 0;
}

int store_text(struct store *s, uint32_t n, char **ret, size_t *ret_bytes)
{
	char path[STORE_TEXT_PATH_MAX];
	sqlite3_stmt *q;
	int err;

	if (s->in_memory)
		return s->err;
	if (store_text_file(s, n, path) == 0)
		return store_text_fetch(path, ret, ret_bytes);
	q = store_ask(s, &err, "SELECT text.text, sha256 FROM job JOIN text "
		      "USING(n) WHERE n=?", "i", (int64_t)n);
	if (!q)
		return err;
	err = text_get(q, ret, ret_bytes);
	sqlite3_finalize(q);
	return err;
}

/* -- What becomes of it --------------------------------------------------- */

int store_set_state(struct store *s, uint32_t n, enum job_state state)
{
	return store_do(s, STORE_KEEP, "UPDATE job SET state=? WHERE n=?", "sI",
			state_names[state], (int64_t)n);
}

int store_set_hold(struct store *s, uint32_t n, bool hold)
{
	return store_do(s, STORE_KEEP, "UPDATE job SET hold=? WHERE n=?", "iI",
			(int64_t)hold, (int64_t)n);
}

int store_set_loaded(struct store *s, uint32_t n, bool loaded)
{
	return store_do(s, loaded ? STORE_MUST : STORE_KEEP, loaded ?
			"UPDATE job SET loaded=1 WHERE n=?" :
			"UPDATE job SET loaded=0 WHERE n=?", "I", (int64_t)n);
}

int store_begin(struct store *s, uint32_t n, int64_t now_us)
{
	return store_do(s, STORE_KEEP, "UPDATE job SET begun_us=?, first_us="
			"iif(first_us=0, ?, first_us) WHERE n=?", "iiI",
			now_us, now_us, (int64_t)n);
}

int store_may_begin(struct store *s, uint32_t n)
{
	return store_do(s, n ? STORE_MUST : STORE_KEEP, "INSERT OR REPLACE "
			"INTO number VALUES(?, ?)", "Si", "started",
			(int64_t)n);
}

int store_end(struct store *s, uint32_t n, const struct store_end *e)
{
	return store_do(s, STORE_KEEP, "UPDATE job SET state=?, reason=?, "
			"ended_us=?, place_mm=?, length_mm=?, depth_mm=?, "
			"job_s=?, erode_s=?, energy_j=?, jumps=?, retracts=?, "
			"shorts=?, arcs=? WHERE n=?",
			"ssiddddddiiiiI", state_names[e->state], e->reason,
			e->now_us, e->place_mm, e->length_mm, e->depth_mm,
			e->job_s, e->erode_s, e->energy_j, (int64_t)e->jumps,
			(int64_t)e->retracts, (int64_t)e->shorts,
			(int64_t)e->arcs, (int64_t)n);
}

int store_give_up(struct store *s, uint32_t n, const char *reason,
		  int64_t now_us)
{
	return store_do(s, STORE_KEEP, "UPDATE job SET state='stopped', "
			"reason=?, ended_us=? WHERE n=?", "siI", reason, now_us,
			(int64_t)n);
}

int store_set_tech(struct store *s, uint32_t n, const char *sha256)
{
	return store_do(s, STORE_KEEP, "UPDATE job SET tech_sha256=? WHERE n=?",
			"sI", sha256, (int64_t)n);
}

int store_set_forecast(struct store *s, uint32_t n, double forecast_s,
		       const char *why)
{
	return store_do(s, STORE_KEEP, "UPDATE job SET forecast_s=?, "
			"forecast_why=? WHERE n=?", "dsI", forecast_s, why,
			(int64_t)n);
}

int store_interrupt(struct store *s, uint32_t n, const char *at)
{
	return store_do(s, STORE_KEEP, "INSERT OR REPLACE INTO resume VALUES"
			"(?, ?)", "Is", (int64_t)n, at);
}

int store_again(struct store *s, uint32_t n)
{
	return store_do(s, STORE_KEEP, "UPDATE job SET state='queued', hold=1, "
			"begun_us=0 WHERE n=? AND state='interrupted'", "I",
			(int64_t)n);
}

int store_interrupted(struct store *s, struct store_job *ret)
{
	int err;
	sqlite3_stmt *q = store_ask(s, &err, "SELECT " JOB_COLUMNS " FROM job "
				    "WHERE state='interrupted' ORDER BY n DESC "
				    "LIMIT 1", "");

	return job_get(q, err, ret);
}

char *store_resume_at(struct store *s, uint32_t n)
{
	sqlite3_stmt *q = store_ask(s, NULL, "SELECT at FROM resume WHERE n=?",
				    "i", (int64_t)n);
	char *at = q ? strdup((const char *)sqlite3_column_text(q, 0)) : NULL;

	sqlite3_finalize(q);
	return at;
}

/* edmd's events come again when either program was restarted; their time shows
 * that they are the same.  NAN becomes NULL. */
int store_change(struct store *s, uint32_t n, const struct store_change *c)
{
	return store_do(s, STORE_MAY_MISS, "INSERT OR IGNORE INTO change "
			"VALUES(?, ?, ?, ?, ?, ?)", "iisddd", (int64_t)n,
			c->time_ns, c->field, c->was, c->now, c->place_mm);
}

int store_note(struct store *s, const struct store_note *e)
{
	return write_note(s, STORE_MAY_MISS, e);
}

/* -- Numbers -------------------------------------------------------------- */

int64_t store_number(struct store *s, const char *key, int64_t otherwise)
{
	return store_number_of(s, otherwise, "SELECT value FROM number WHERE "
			       "key=?", "s", key);
}

int store_set_number(struct store *s, const char *key, int64_t value)
{
	return store_do(s, STORE_KEEP, "INSERT OR REPLACE INTO number VALUES"
			"(?, ?)", "Si", key, value);
}
