/* SPDX-License-Identifier: Apache-2.0 */
/* store_sql.c - SQLite under the store: checks every result, loses no write */
#include "store_sql.h"

#include "jobs_log.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define TRY_US		2000000

const char *store_why(const struct store *s)
{
	switch (s->err) {
	case 0:
		return "";
	case -ENOSPC:
		return "the disk is full";
	case -EROFS:
		return "the disk is read-only";
	case -EILSEQ:
		return "the database is damaged";
	case -EBUSY:
		return "another program holds the database";
	case -EACCES:
		return "the folder cannot be written";
	default:
		return "the disk fails: input/output error";
	}
}

/* -- From the disk to memory, and back ------------------------------------ */

static void tell_degraded(const struct store *s)
{
	log_error("store: %s (%s); what is written is kept in memory until it "
		  "can be stored, and no job is taken or begun until then",
		  store_why(s), s->path);
}

/* A disk that is full can be read on. */
static void go_over(struct store *s, bool is_full)
{
	sqlite3 *disk = s->db;

	if (disk && !sqlite3_get_autocommit(disk))
		sqlite3_exec(disk, "ROLLBACK", NULL, NULL, NULL);
	if (is_full && disk && store_over_begin(s))
		return;
	s->db = store_file_copy(s, disk);
	sqlite3_close_v2(disk);
}

void store_over_failed(struct store *s, int rc)
{
	const int err = store_file_errno(s->db, rc);

	s->over = false;
	s->dropped += s->spared;
	s->spared = 0;
	s->err = err == -EIO ? store_file_probe(s) : err;
	/* Only a commit is refused because the disk is full. */
	go_over(s, err == -ENOSPC);
	for (const struct store_write *w = s->kept.first; w; w = w->next)
		store_write_do(s->db, w);
}

void store_degrade(struct store *s, int err)
{
	struct store_write *w;

	if (s->in_memory)
		return;
	s->in_memory = true;
	s->may_miss = 0;
	s->missed = 0;
	s->err = err == -EIO ? store_file_probe(s) : err;
	s->together = false;
	go_over(s, s->err == -ENOSPC);
	/* A promise that was not written in time is not written later. */
	while ((w = store_writes_pop(&s->group))) {
		if (w->keep == STORE_MUST) {
			store_write_free(w);
			continue;
		}
		store_write_do(s->db, w);
		store_write_keep(s, w);
	}
	tell_degraded(s);
}

int store_failed(struct store *s, int rc)
{
	const int err = store_file_errno(s->db, rc);

	if (err == -EEXIST || (s->in_memory && !s->over))
		return err;
	log_error("store: %s", sqlite3_errmsg(s->db));
	if (s->over)
		store_over_failed(s, rc);
	else
		store_degrade(s, err);
	return s->err;
}

/* The disk fails again: what was brought there is in no transaction any more.
 * Return: why, -errno. */
static int leave_disk(struct store *s, int rc)
{
	const int err = store_file_errno(s->disk, rc);
	struct store_writes behind = s->kept;

	sqlite3_close_v2(s->disk);
	s->disk = NULL;
	s->kept = (struct store_writes) { .n = 0 };
	store_writes_move(&s->kept, &s->brought);
	store_writes_move(&s->kept, &behind);
	return err;
}

static int bring_begin(struct store *s)
{
	int err, rc;

	s->told[0] = '\0';
	err = store_file_open(s, &s->disk);
	if (err < 0) {
		s->disk = NULL;
		return err;
	}
	sqlite3_busy_timeout(s->disk, 50);
	rc = sqlite3_exec(s->disk, "BEGIN IMMEDIATE", NULL, NULL, NULL);
	return rc == SQLITE_OK ? 0 : leave_disk(s, rc);
}

static int bring_piece(struct store *s)
{
	for (int i = 0; i < STORE_PIECE && s->kept.n; i++) {
		const int rc = store_write_do(s->disk, s->kept.first);

		/* If the row exists already, that is fine. */
		if (rc != SQLITE_OK && (rc & 0xff) != SQLITE_CONSTRAINT)
			return rc;
		store_writes_add(&s->brought, store_writes_pop(&s->kept));
	}
	return SQLITE_OK;
}

static void tell_stored(struct store *s, struct store_writes *w)
{
	s->in_memory = false;
	s->err = 0;
	log_notice("store: it can be written again; %u entries that were kept "
		   "in memory are stored, %llu were dropped", w->n,
		   (unsigned long long)s->dropped);
	store_writes_free(w);
}

static int come_back_over(struct store *s)
{
	const int err = store_over_end(s);

	if (err == 0)
		tell_stored(s, &s->kept);
	return err;
}

int store_come_back(struct store *s)
{
	int err = 0, rc;

	if (s->over)
		return come_back_over(s);
	if (!s->disk)
		err = bring_begin(s);
	if (err < 0)
		return err;
	rc = bring_piece(s);
	if (rc == SQLITE_OK && s->kept.n)
		return 1;
	if (rc == SQLITE_OK)
		rc = sqlite3_exec(s->disk, "COMMIT", NULL, NULL, NULL);
	if (rc != SQLITE_OK)
		return leave_disk(s, rc);
	sqlite3_busy_timeout(s->disk, STORE_BUSY_MS);
	sqlite3_close_v2(s->db);
	s->db = s->disk;
	s->disk = NULL;
	tell_stored(s, &s->brought);
	return 0;
}

bool store_tick(struct store *s, int64_t now_us)
{
	int err;

	if (!s->in_memory || s->together ||
	    (!s->disk && now_us < s->again_us))
		return false;
	s->again_us = now_us + TRY_US;
	err = store_come_back(s);
	if (err < 0 && err != s->err) {
		s->err = err;
		tell_degraded(s);
	}
	return err == 0;
}

/* -- What the others call ------------------------------------------------- */

static bool too_many(struct store *s, enum store_keep k)
{
	if (!s->in_memory || k != STORE_MAY_MISS ||
	    s->may_miss++ < STORE_MISS_FROM)
		return false;
	s->may_miss = STORE_MISS_FROM;
	s->missed++;
	s->dropped++;
	return true;
}

int store_do(struct store *s, enum store_keep k, const char *sql,
	     const char *kinds, ...)
{
	struct store_write *w;
	va_list ap;
	int rc, err = 0;

	if (s->in_memory && k == STORE_MUST)
		return s->err;
	if (too_many(s, k))
		return STORE_MISSED;
	va_start(ap, kinds);
	w = store_write_new(sql, k, kinds, ap);
	va_end(ap);
	rc = store_write_do(s->db, w);
	if (rc != SQLITE_OK && (!s->in_memory || s->over)) {
		err = store_failed(s, rc);
		if (err != -EEXIST && k != STORE_MUST)
			rc = store_write_do(s->db, w);
	}
	if (rc != SQLITE_OK) {
		store_write_free(w);
		return err ? err : store_file_errno(s->db, rc);
	}
	if (s->in_memory) {
		store_write_keep(s, w);
		return STORE_KEPT;
	}
	if (s->together)
		store_writes_add(&s->group, w);
	else
		store_write_free(w);
	return 0;
}

static sqlite3_stmt *ask(struct store *s, const struct store_write *w,
			 int *ret_err)
{
	sqlite3_stmt *q = NULL;
	int rc = store_write_begin(s->db, w, &q);

	/* If it cannot be read, ask the copy in memory. */
	if (rc != SQLITE_ROW && rc != SQLITE_DONE &&
	    (!s->in_memory || s->over)) {
		sqlite3_finalize(q);
		q = NULL;
		store_failed(s, rc);
		rc = store_write_begin(s->db, w, &q);
	}
	*ret_err = rc == SQLITE_ROW ? 0 : rc == SQLITE_DONE ? -ENOENT : -EIO;
	if (rc == SQLITE_ROW)
		return q;
	sqlite3_finalize(q);
	return NULL;
}

static sqlite3_stmt *ask_with(struct store *s, int *ret_err, const char *sql,
			      const char *kinds, va_list ap)
{
	struct store_write *w = store_write_new(sql, STORE_MAY_GO, kinds, ap);
	sqlite3_stmt *q = ask(s, w, ret_err);

	store_write_free(w);
	return q;
}

sqlite3_stmt *store_ask(struct store *s, int *ret_err, const char *sql,
			const char *kinds, ...)
{
	sqlite3_stmt *q;
	va_list ap;
	int err;

	va_start(ap, kinds);
	q = ask_with(s, ret_err ? ret_err : &err, sql, kinds, ap);
	va_end(ap);
	return q;
}

int64_t store_number_of(struct store *s, int64_t otherwise, const char *sql,
			const char *kinds, ...)
{
	int64_t value = otherwise;
	sqlite3_stmt *q;
	va_list ap;
	int err;

	va_start(ap, kinds);
	q = ask_with(s, &err, sql, kinds, ap);
	va_end(ap);
	if (q)
		value = sqlite3_column_int64(q, 0);
	sqlite3_finalize(q);
	return value;
}

/* -- Transactions --------------------------------------------------------- */

static int execute(struct store *s, const char *sql)
{
	const int rc = sqlite3_exec(s->db, sql, NULL, NULL, NULL);

	return rc == SQLITE_OK ? 0 : store_failed(s, rc);
}

int store_together(struct store *s, bool durable)
{
	int err;

	if (s->in_memory)
		return STORE_KEPT;
	err = execute(s, durable ? "PRAGMA synchronous=FULL" :
				   "PRAGMA synchronous=NORMAL");
	if (err == 0)
		err = execute(s, "BEGIN IMMEDIATE");
	s->together = err == 0;
	return s->in_memory ? STORE_KEPT : err;
}

void store_undo(struct store *s)
{
	if (s->together)
		sqlite3_exec(s->db, "ROLLBACK", NULL, NULL, NULL);
	s->together = false;
	store_writes_free(&s->group);
}

/* If this fails, the whole transaction goes on in memory. */
int store_commit(struct store *s)
{
	int err = STORE_KEPT;

	if (s->together && execute(s, "COMMIT") == 0) {
		store_writes_free(&s->group);
		err = 0;
	}
	s->together = false;
	if (!s->in_memory)
		execute(s, "PRAGMA synchronous=FULL");
	return err;
}
