/* SPDX-License-Identifier: Apache-2.0 */
/* store_sql.c - SQLite under the store: checks every result, loses no write */
#include "store_sql.h"

#include "jobs_log.h"

#include <ctype.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define KEPT_MAX	4096
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

/* -- Statements with their values ----------------------------------------- */

static struct store_write *write_new(const char *sql, enum store_keep keep,
				     const char *kinds, va_list ap)
{
	struct store_write *w = calloc(1, sizeof(*w));
	const char *text;

	/* If there is no memory for a row, there is none for the service. */
	if (!w)
		abort();
	w->sql = sql;
	w->keep = keep;
	w->key = -1;
	for (; *kinds; kinds++, w->n++) {
		struct store_value *v = &w->v[w->n];

		v->kind = (char)tolower((unsigned char)*kinds);
		if (v->kind != *kinds)
			w->key = w->n;
		if (v->kind == 'i') {
			v->i = va_arg(ap, int64_t);
		} else if (v->kind == 'd') {
			v->d = va_arg(ap, double);
		} else {
			text = va_arg(ap, const char *);
			v->s = text ? strdup(text) : NULL;
		}
	}
	return w;
}

static void write_free(struct store_write *w)
{
	for (int i = 0; i < w->n; i++)
		if (w->v[i].kind == 's')
			free(w->v[i].s);
	free(w);
}

static struct store_write *writes_pop(struct store_writes *l)
{
	struct store_write *w = l->first;

	if (!w)
		return NULL;
	l->first = w->next;
	if (!l->first)
		l->last = &l->first;
	l->n--;
	return w;
}

void store_writes_free(struct store_writes *l)
{
	struct store_write *w;

	while ((w = writes_pop(l)))
		write_free(w);
}

static void writes_add(struct store_writes *l, struct store_write *w)
{
	if (!l->last)
		l->last = &l->first;
	w->next = NULL;
	*l->last = w;
	l->last = &w->next;
	l->n++;
}

static void writes_move(struct store_writes *to, struct store_writes *from)
{
	struct store_write *w;

	while ((w = writes_pop(from)))
		writes_add(to, w);
}

static void writes_take_out(struct store_writes *l, struct store_write **at)
{
	struct store_write *w = *at;

	*at = w->next;
	if (l->last == &w->next)
		l->last = at;
	l->n--;
	write_free(w);
}

static bool same_row(const struct store_write *a, const struct store_write *b)
{
	const struct store_value *x, *y;

	if (a->sql != b->sql || a->key < 0)
		return false;
	x = &a->v[a->key];
	y = &b->v[b->key];
	return x->kind == 'i' ? x->i == y->i :
	       x->s && y->s && strcmp(x->s, y->s) == 0;
}

/* The oldest entry that may be dropped makes room. */
static void keep_room(struct store *s)
{
	struct store_write **at = &s->kept.first;

	while (*at && (*at)->keep != STORE_MAY_GO)
		at = &(*at)->next;
	if (!*at)
		return;
	writes_take_out(&s->kept, at);
	s->dropped++;
}

/* Keep @w, and drop the entries that it replaces. */
static void keep(struct store *s, struct store_write *w)
{
	for (struct store_write **at = &s->kept.first; *at;) {
		if (same_row(*at, w))
			writes_take_out(&s->kept, at);
		else
			at = &(*at)->next;
	}
	if (s->kept.n + s->brought.n >= KEPT_MAX)
		keep_room(s);
	writes_add(&s->kept, w);
}

static void bind_all(sqlite3_stmt *q, const struct store_write *w)
{
	for (int i = 0; i < w->n; i++) {
		const struct store_value *v = &w->v[i];

		if (v->kind == 'i')
			sqlite3_bind_int64(q, i + 1, v->i);
		else if (v->kind == 'd')
			sqlite3_bind_double(q, i + 1, v->d);
		else
			sqlite3_bind_text(q, i + 1, v->s, -1, SQLITE_TRANSIENT);
	}
}

/* Run it up to its first row.  Return: SQLITE_ROW, SQLITE_DONE, or why not. */
static int begin(sqlite3 *db, const struct store_write *w, sqlite3_stmt **ret)
{
	int rc = sqlite3_prepare_v2(db, w->sql, -1, ret, NULL);

	if (rc != SQLITE_OK)
		return rc;
	bind_all(*ret, w);
	return sqlite3_step(*ret);
}

static int carry_out(sqlite3 *db, const struct store_write *w)
{
	sqlite3_stmt *q = NULL;
	int rc = begin(db, w, &q);

	sqlite3_finalize(q);
	return rc == SQLITE_ROW || rc == SQLITE_DONE ? SQLITE_OK : rc;
}

/* -- From the disk to memory, and back ------------------------------------ */

static void tell_degraded(const struct store *s)
{
	log_error("store: %s (%s); what is written is kept in memory until it "
		  "can be stored, and no job is taken or begun until then",
		  store_why(s), s->path);
}

void store_degrade(struct store *s, int err)
{
	struct store_write *w;
	sqlite3 *disk = s->db;

	if (s->in_memory)
		return;
	if (disk && !sqlite3_get_autocommit(disk))
		sqlite3_exec(disk, "ROLLBACK", NULL, NULL, NULL);
	s->db = store_file_copy(s, disk);
	sqlite3_close_v2(disk);
	s->in_memory = true;
	s->err = err == -EIO ? store_file_probe(s) : err;
	s->together = false;
	/* A promise that was not written in time is not written later. */
	while ((w = writes_pop(&s->group))) {
		if (w->keep == STORE_MUST) {
			write_free(w);
			continue;
		}
		carry_out(s->db, w);
		keep(s, w);
	}
	tell_degraded(s);
}

int store_failed(struct store *s, int rc)
{
	const int err = store_file_errno(s->db, rc);

	if (err == -EEXIST || s->in_memory)
		return err;
	log_error("store: %s", sqlite3_errmsg(s->db));
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
	writes_move(&s->kept, &s->brought);
	writes_move(&s->kept, &behind);
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
		const int rc = carry_out(s->disk, s->kept.first);

		/* If the row exists already, that is fine. */
		if (rc != SQLITE_OK && (rc & 0xff) != SQLITE_CONSTRAINT)
			return rc;
		writes_add(&s->brought, writes_pop(&s->kept));
	}
	return SQLITE_OK;
}

int store_come_back(struct store *s)
{
	const int err = s->disk ? 0 : bring_begin(s);
	int rc;

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
	s->in_memory = false;
	s->err = 0;
	log_notice("store: it can be written again; %u entries that were kept "
		   "in memory are stored, %llu were dropped", s->brought.n,
		   (unsigned long long)s->dropped);
	store_writes_free(&s->brought);
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

int store_do(struct store *s, enum store_keep k, const char *sql,
	     const char *kinds, ...)
{
	struct store_write *w;
	va_list ap;
	int rc, err = 0;

	if (s->in_memory && k == STORE_MUST)
		return s->err;
	va_start(ap, kinds);
	w = write_new(sql, k, kinds, ap);
	va_end(ap);
	rc = carry_out(s->db, w);
	if (rc != SQLITE_OK && !s->in_memory) {
		err = store_failed(s, rc);
		if (err != -EEXIST && k != STORE_MUST)
			rc = carry_out(s->db, w);
	}
	if (rc != SQLITE_OK) {
		write_free(w);
		return err ? err : store_file_errno(s->db, rc);
	}
	if (s->in_memory) {
		keep(s, w);
		return STORE_KEPT;
	}
	if (s->together)
		writes_add(&s->group, w);
	else
		write_free(w);
	return 0;
}

static sqlite3_stmt *ask(struct store *s, const struct store_write *w,
			 int *ret_err)
{
	sqlite3_stmt *q = NULL;
	int rc = begin(s->db, w, &q);

	/* If it cannot be read, ask the copy in memory. */
	if (rc != SQLITE_ROW && rc != SQLITE_DONE && !s->in_memory) {
		sqlite3_finalize(q);
		q = NULL;
		store_failed(s, rc);
		rc = begin(s->db, w, &q);
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
	struct store_write *w = write_new(sql, STORE_MAY_GO, kinds, ap);
	sqlite3_stmt *q = ask(s, w, ret_err);

	write_free(w);
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
