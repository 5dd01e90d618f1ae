/* SPDX-License-Identifier: Apache-2.0 */
/*
 * store_sql.h - SQLite under the store: every result is checked and none is
 * lost
 *
 * While the disk takes what is written, `db` is the database on the disk. When
 * a write or a read fails, the store is degraded: what is written goes into
 * memory and into a list, and store_tick() tries to bring it to the disk.  A
 * question is always answered by what was written last.
 *
 * A disk that is full is still read: `db` stays, and what is written is a
 * transaction that is committed when there is room (store_over.c).  Of any
 * other disk, `db` becomes a copy in memory of all tables but the texts.  Then
 * the list goes to the disk in pieces, so that the loop does not stand, but in
 * one transaction: all of it, or nothing.  A full disk that fails in another
 * way becomes such a copy, and the list is repeated there.
 *
 * The list is bounded. Of two writes of the same statement to the same row only
 * the later one is needed. If there is no room, the oldest write that may be
 * dropped is dropped and counted.
 *
 * Private to the files store*.c.
 */
#ifndef JOBS_STORE_SQL_H
#define JOBS_STORE_SQL_H

#include "store.h"
#include "store_text.h"

#include <sqlite3.h>
#include <stdarg.h>

enum store_keep {
	STORE_MUST,			/* on the disk, or refused */
	STORE_KEEP,			/* else in memory, until it can be */
	STORE_MAY_GO,			/* the same; dropped if there are
					 * many */
	STORE_MAY_MISS			/* the same; not written at all if
					 * there are STORE_MISS_FROM */
};

/* What is written in memory takes room there until there is some on the disk:
 * up to 1 kB for an event. */
#define STORE_MISS_FROM	32768

struct store_value {
	char kind;			/* i, d, s as in store_do() */
	union {
		int64_t i;
		double d;
		char *s;
	};
};

/* So many writes are brought to the disk at a time. */
#define STORE_PIECE	128

/* A statement with its values. */
struct store_write {
	struct store_write *next;
	const char *sql;		/* a constant */
	enum store_keep keep;
	int key;			/* the value that says which row; -1 */
	int n;
	struct store_value v[20];
};

struct store_writes {
	struct store_write *first, **last;
	uint32_t n;
};

/* Where lines of the long text that was asked for last begin. */
struct store_lines {
	char path[STORE_TEXT_PATH_MAX];	/* "": none was */
	int64_t *at;
	size_t n, room;
};

struct store {
	struct store_lines lines;
	sqlite3 *db;			/* the one in force */
	bool in_memory;			/* what is written stays there */
	bool over;			/* in a transaction of `db`; else that
					 * is a copy */
	bool unread;			/* nothing could be copied */
	char dir[256], path[512];
	int lock;			/* -1: the disk would not have it */
	int err;			/* why it is degraded; 0: it is not */
	int64_t again_us;		/* not before */
	bool together;			/* a transaction is open ... */
	struct store_writes group;	/* ... of these */
	struct store_writes kept;
	sqlite3 *disk;			/* where what was kept is brought to;
					 * NULL: it is not yet */
	struct store_writes brought;	/* into its transaction */
	uint32_t may_miss;		/* of them, written in memory */
	uint64_t missed;		/* not written, this time */
	uint64_t dropped;		/* and they, and what left the list */
	uint64_t spared;		/* from the list, but not from the
					 * transaction */
	int64_t retained_us;
	bool gone;			/* at the start it was empty, beside
					 * its other files */
	char told[512];			/* what was mended at the start */
};

/* The states of a job that is over, in SQL. */
#define STORE_ENDED	"'done', 'stopped', 'fault'"

/**
 * store_do() - write.
 *
 * @sql: a constant. @kinds: one letter for each ?: i int64_t, d double, s
 * string. A capital letter marks the value that identifies the row.
 *
 * Return: 0: it is on the disk, or will be with its transaction; STORE_KEPT: it
 * is in memory; -EEXIST: a constraint; for STORE_MUST the reason why it cannot
 * be written.
 */
int store_do(struct store *s, enum store_keep keep, const char *sql,
	     const char *kinds, ...);

/**
 * store_ask() - the first row of a query; finalize it.
 *
 * @ret_err: -ENOENT: there is none; or the reason why it cannot be read. It may
 * be NULL.
 */
sqlite3_stmt *store_ask(struct store *s, int *ret_err, const char *sql,
			const char *kinds, ...);

/** store_number_of() - the first column of the first row. */
int64_t store_number_of(struct store *s, int64_t otherwise, const char *sql,
			const char *kinds, ...);

/** store_failed() - @rc of SQLite: degrade if it must be.  Return: -errno. */
int store_failed(struct store *s, int rc);

/** store_degrade() - from now on the store is in memory. */
void store_degrade(struct store *s, int err);

/** store_over_failed() - the transaction over a full disk is lost by @rc of
 *  SQLite; what was kept is written anew, over the disk or over a copy. */
void store_over_failed(struct store *s, int rc);

/** store_lines_fini() - forget them. */
void store_lines_fini(struct store_lines *l);

/** store_undo() - drop an open transaction and what is in it. */
void store_undo(struct store *s);

/** store_come_back() - bring the next piece of what was kept to the disk.
 *  Return: 1: there is more; 0: all is there; -errno. */
int store_come_back(struct store *s);

/* -- store_write.c -------------------------------------------------------- */

/* As for store_do(); a copy of the values. */
struct store_write *store_write_new(const char *sql, enum store_keep keep,
				    const char *kinds, va_list ap);
void store_write_free(struct store_write *w);

/** store_write_begin() - run it up to its first row.  Return: SQLITE_ROW,
 *  SQLITE_DONE, or why not. */
int store_write_begin(sqlite3 *db, const struct store_write *w,
		      sqlite3_stmt **ret);
/** store_write_do() - SQLITE_OK, or why not. */
int store_write_do(sqlite3 *db, const struct store_write *w);

/** store_write_keep() - keep @w, and drop the entries that it replaces. */
void store_write_keep(struct store *s, struct store_write *w);

void store_writes_add(struct store_writes *l, struct store_write *w);
/** store_writes_pop() - the first, or NULL. */
struct store_write *store_writes_pop(struct store_writes *l);
/** store_writes_move() - @from, behind what is in @to. */
void store_writes_move(struct store_writes *to, struct store_writes *from);
/** store_writes_free() - forget them. */
void store_writes_free(struct store_writes *w);

/* -- store_file.c --------------------------------------------------------- */

/** store_file_open() - open, mend, bring up to date.  Return: 0 or -errno. */
int store_file_open(struct store *s, sqlite3 **ret);

/** store_file_fold() - put what the log has into the file, so that the log
 *  begins anew: who was killed, or had no room, has left a long one. */
void store_file_fold(sqlite3 *db);

/** store_file_make() - a new, empty one at @path.  Return: 0 or -errno. */
int store_file_make(const char *path, sqlite3 **ret);

/** store_file_copy() - all but the texts, as far as it can be read.
 *  @disk: NULL is fine. */
sqlite3 *store_file_copy(struct store *s, sqlite3 *disk);

/** store_file_errno() - what SQLite's @rc, of @db, comes to. */
int store_file_errno(sqlite3 *db, int rc);

/** store_file_probe() - why nothing can be written: SQLite does not always say
 *  what the system said.  Return: -errno. */
int store_file_probe(const struct store *s);

/** store_file_look() - to read only, where nothing can be written; or NULL. */
sqlite3 *store_file_look(struct store *s);

/** store_file_room() - does the disk take so many bytes?  0 or -errno. */
int store_file_room(const struct store *s, int64_t bytes);

/* -- store_over.c --------------------------------------------------------- */

/** store_over_begin() - from now on what is written to `db` stays in memory,
 *  over what is on the disk.  Return: false: it cannot be. */
bool store_over_begin(struct store *s);

/** store_over_end() - bring it to the disk.  Return: 0 or -errno. */
int store_over_end(struct store *s);

/* -- store_count.c -------------------------------------------------------- */

/** store_count_begin() - from now on @db counts its jobs: table job_count has
 *  one row, `waiting` and `ended`.  Return: 0 or -errno. */
int store_count_begin(sqlite3 *db);

/* -- store_mend.c --------------------------------------------------------- */

/** store_mend() - set the damaged file aside, and put what can be recovered of
 *  it in its place.  Says in `told` what it did.  Return: 0 or -errno. */
int store_mend(struct store *s);

#endif /* JOBS_STORE_SQL_H */
