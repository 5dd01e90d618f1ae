/* SPDX-License-Identifier: Apache-2.0 */
/*
 * store_log.c - is the log of the database as long as it was?
 *
 * What SQLite has written last is in the log alone.  It takes a log up to the
 * first frame that is damaged, and says nothing of what lay behind it: a
 * machine would cut by the work offsets of before.  The index of the log (-shm)
 * has how many frames were written and synced.  It outlives a kill, and SQLite
 * makes it anew when it opens the database.  After a power cut it may be an
 * older one, which says less or tells of a log before this one.
 *
 * https://sqlite.org/walformat.html
 */
#include "store_log.h"

#include "jobs_log.h"
#include "regular.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define INDEX_VERSION	3007000
#define LOG_MAGIC	0x377f0682u	/* + 1: its sums are big-endian */
#define LOG_HEAD	32		/* bytes; its salt and its sum: */
#define SALT_AT		16
#define SUM_AT		24

/* The index begins with this, twice; then comes how many frames are in the
 * database, too. */
struct index_head {
	uint32_t version, unused, change;
	uint8_t is_init, big_endian;
	uint16_t page_size;
	uint32_t frames, pages, frame_sum[2];
	uint8_t salt[8];
	uint32_t sum[2];
};

struct index {
	struct index_head head[2];
	uint32_t moved;
};

_Static_assert(sizeof(struct index_head) == 48, "as on the disk");

static bool read_head(const char *database, const char *suffix, void *to,
		      size_t size)
{
	char path[600];
	ssize_t n;
	int fd;

	snprintf(path, sizeof(path), "%s%s", database, suffix);
	fd = regular_open(path, O_RDONLY, 0);
	if (fd < 0)
		return false;
	n = read(fd, to, size);
	close(fd);
	return n == (ssize_t)size;
}

static uint32_t word(const uint8_t *at, bool big)
{
	return big ? (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 |
		     (uint32_t)at[2] << 8 | at[3] :
		     (uint32_t)at[3] << 24 | (uint32_t)at[2] << 16 |
		     (uint32_t)at[1] << 8 | at[0];
}

static bool head_is_whole(const uint8_t h[LOG_HEAD])
{
	uint32_t a = 0, b = 0;

	if ((word(h, true) & ~1u) != LOG_MAGIC)
		return false;
	for (int i = 0; i < SUM_AT; i += 8) {
		a += word(h + i, h[3] & 1) + b;
		b += word(h + i + 4, h[3] & 1) + a;
	}
	return a == word(h + SUM_AT, true) && b == word(h + SUM_AT + 4, true);
}

void store_log_look(struct store_log *l, const char *database)
{
	struct index x;
	uint8_t h[LOG_HEAD];

	*l = (struct store_log) { .frames = 0 };
	if (!read_head(database, "-shm", &x, sizeof(x)) ||
	    memcmp(&x.head[0], &x.head[1], sizeof(x.head[0])) != 0 ||
	    x.head[0].version != INDEX_VERSION || !x.head[0].is_init ||
	    x.head[0].frames <= x.moved)
		return;
	/* A log that was begun anew after that index. */
	if (read_head(database, "-wal", h, sizeof(h)) && head_is_whole(h) &&
	    memcmp(h + SALT_AT, x.head[0].salt, sizeof(x.head[0].salt)) != 0)
		return;
	l->frames = x.head[0].frames;
}

static bool is_cut(const struct store_log *l, sqlite3 *db)
{
	int frames = 0;

	/* The log is opened by the first that is read. */
	if (l->frames == 0 ||
	    sqlite3_exec(db, "PRAGMA schema_version", NULL, NULL, NULL) !=
	    SQLITE_OK ||
	    sqlite3_wal_checkpoint_v2(db, NULL, SQLITE_CHECKPOINT_PASSIVE,
				      &frames, NULL) != SQLITE_OK)
		return false;
	return frames < (int)l->frames;
}

int store_log_check(const struct store_log *l, sqlite3 *db)
{
	if (!is_cut(l, db))
		return 0;
	log_error("store: %s-wal is damaged, cut short or gone: what was "
		  "written last is lost", sqlite3_db_filename(db, "main"));
	sqlite3_db_config(db, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, NULL);
	return -EILSEQ;
}
