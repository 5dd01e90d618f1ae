/* SPDX-License-Identifier: Apache-2.0 */
/*
 * store_over.c - a full disk is read on, and written over in memory
 *
 * SQLite holds the pages that a transaction changes in memory, and writes them
 * when it is committed.  So a transaction that is not committed as long as the
 * disk is full is a store whose rows are partly on the disk and partly in
 * memory, for every question.  Nothing is copied to begin it.  It holds the
 * lock of writers; who reads the database is not kept from it.
 */
#include "store_sql.h"

#define BESIDE	(64 << 10)		/* the log needs more than the pages */

bool store_over_begin(struct store *s)
{
	/* It would begin, but take nothing: the disk was full already at the
	 * start, and the file was opened to read (store_file_look()). */
	if (sqlite3_db_readonly(s->db, "main"))
		return false;
	sqlite3_busy_timeout(s->db, 0);
	s->over = sqlite3_exec(s->db, "PRAGMA synchronous=FULL;"
			       "PRAGMA cache_spill=OFF;"
			       "BEGIN IMMEDIATE", NULL, NULL, NULL) ==
		  SQLITE_OK;
	return s->over;
}

/* Without the pages that were only read. */
static int64_t bytes_held(sqlite3 *db)
{
	int now = 0, most;

	sqlite3_db_release_memory(db);
	sqlite3_db_status(db, SQLITE_DBSTATUS_CACHE_USED, &now, &most, 0);
	return now;
}

/* A commit that fails would undo all of it, so there is room first.  It writes
 * a page in any case: what changed nothing would say nothing of the disk. */
int store_over_end(struct store *s)
{
	const int err = store_file_room(s, bytes_held(s->db) + BESIDE);
	int rc;

	if (err < 0)
		return err;
	rc = sqlite3_exec(s->db, "REPLACE INTO number VALUES('room', 1);"
			  "DELETE FROM number WHERE key='room';"
			  "COMMIT", NULL, NULL, NULL);
	if (rc != SQLITE_OK) {
		store_over_failed(s, rc);
		return s->err;
	}
	sqlite3_exec(s->db, "PRAGMA cache_spill=ON", NULL, NULL, NULL);
	store_file_fold(s->db);
	sqlite3_busy_timeout(s->db, STORE_BUSY_MS);
	s->over = false;
	s->spared = 0;
	return 0;
}
