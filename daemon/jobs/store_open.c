/* SPDX-License-Identifier: Apache-2.0 */
/* store_open.c - opens and closes the store; its size, and what it forgets */
#include "store_sql.h"
#include "store_text.h"

#include "jobs_log.h"
#include "regular.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#define RETAIN_US	INT64_C(10000000)
#define DAY_US		INT64_C(86400000000)
/* An event of a job goes with it; any other one behind so many newer ones. */
#define EVENTS_BEHIND	100000

/* Is it a fault of the disk, not of the path that was given? */
static bool is_of_disk(int err)
{
	return err == -ENOSPC || err == -EDQUOT || err == -EROFS ||
	       err == -EIO;
}

/*
 * The folder is open to the group because of the host's key.  Everything else
 * in it is for this user only: main() sets the umask.  An earlier version let
 * the group read it.  But who may read a file may lock it, and so could keep
 * the service from starting, or from writing a job.
 */
static const struct {
	const char *suffix;
	bool alone;			/* only this user may open it */
} files[] = {
	{ "lock", true }, { "db", true }, { "db-wal", true },
	{ "db-shm", true }, { "db-journal", true }, { "place", false },
	{ "key", false }, { "machine-key", false },
};

static int folder_make(const struct store *s, const char *machine)
{
	char path[600];

	if (mkdir(s->dir, 0750) == 0)
		chmod(s->dir, 0750);
	else if (errno != EEXIST)
		return -errno;
	for (size_t i = 0; i < sizeof(files) / sizeof(files[0]); i++) {
		snprintf(path, sizeof(path), "%s/%s.%s", s->dir, machine,
			 files[i].suffix);
		if (regular_check(path) == -ELOOP) {
			log_error("store: %s is a symbolic link, or no regular "
				  "file; put the file itself there, or move it "
				  "away", path);
			return -ELOOP;
		}
		/* If a file does not belong to us or cannot be changed,
		 * opening it will report that. */
		if (files[i].alone)
			chmod(path, 0600);
	}
	return 0;
}

/* On a disk that accepts no new file, shm_writer_claim() still protects. */
static int lock_take(struct store *s, const char *machine)
{
	char path[512];
	int err = folder_make(s, machine);

	if (err < 0)
		return err;
	snprintf(path, sizeof(path), "%s/%s.lock", s->dir, machine);
	s->lock = regular_open(path, O_RDWR | O_CREAT, 0600);
	err = s->lock < 0 ? s->lock : 0;
	if (is_of_disk(err))
		s->lock = regular_open(path, O_RDONLY, 0);
	if (s->lock < 0)
		return is_of_disk(err) ? 0 : err;
	if (flock(s->lock, LOCK_EX | LOCK_NB) < 0)
		return errno == EWOULDBLOCK ? -EALREADY : -errno;
	return 0;
}

static int store_init(struct store *s, const char *dir, const char *machine)
{
	int err;

	s->lock = -1;
	snprintf(s->dir, sizeof(s->dir), "%s", dir);
	snprintf(s->path, sizeof(s->path), "%s/%s.db", dir, machine);
	err = lock_take(s, machine);
	if (err < 0)
		return err;
	err = store_file_open(s, &s->db);
	if (err == 0)
		store_text_sweep(s);
	if (err == 0 || err == -EPROTO || err == -EACCES)
		return err;
	/* The disk does not accept it: begin with what can be read. */
	s->db = store_file_look(s);
	store_degrade(s, err);
	return 0;
}

int store_open(struct store **ret, const char *dir, const char *machine)
{
	struct store *s = calloc(1, sizeof(*s));
	int err;

	if (!s)
		return -ENOMEM;
	err = store_init(s, dir, machine);
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
	/* It is nearly there. */
	while (s->disk)
		store_come_back(s);
	if (s->kept.n)
		log_error("store: %u entries could not be stored: %s",
			  s->kept.n, store_why(s));
	store_lines_fini(&s->lines);
	store_writes_free(&s->group);
	store_writes_free(&s->kept);
	sqlite3_close_v2(s->db);
	if (s->lock >= 0)
		close(s->lock);
	free(s);
}

uint64_t store_missed(const struct store *s)
{
	return s->missed;
}

const char *store_mended(const struct store *s)
{
	return s->told;
}

static int64_t file_bytes(const char *path, const char *suffix)
{
	struct stat st;
	char name[600];

	snprintf(name, sizeof(name), "%s%s", path, suffix);
	return stat(name, &st) == 0 ? st.st_size : 0;
}

void store_measure(struct store *s, struct store_size *ret)
{
	*ret = (struct store_size) {
		.bytes = file_bytes(s->path, "") + file_bytes(s->path, "-wal") +
			 store_text_bytes(s),
		.jobs = (uint32_t)store_number_of(s, 0, "SELECT count(*) FROM "
						  "job", ""),
		.kept = s->kept.n + s->brought.n, .dropped = s->dropped,
	};
	snprintf(ret->path, sizeof(ret->path), "%s", s->path);
}

/* Ten of the lowest numbers in one state, by the index of the states. */
#define FIRST(STATE) \
	"SELECT * FROM (SELECT n AS m FROM job WHERE state='" STATE "' AND " \
	"loaded=0 ORDER BY n LIMIT 10)"

/* Those above ?2, by their number, and those that ended before ?1.  Each is
 * found without a look at what stays.  The last 20 jobs stay, so that a clock
 * that jumped does not remove all. */
static const char old_jobs[] =
	"SELECT json_group_array(n), group_concat(sha256, ' ') FROM (SELECT n, "
	"sha256 FROM job WHERE n IN (SELECT m FROM (" FIRST("done")
	" UNION ALL " FIRST("stopped") " UNION ALL " FIRST("fault")
	" ORDER BY m LIMIT max(0, min(10, (SELECT ended FROM job_count) - ?2)))"
	" UNION ALL SELECT * FROM (SELECT n FROM job WHERE -ended_us>-?1 AND "
	"-ended_us<0 AND +state IN (" STORE_ENDED ") AND loaded=0 ORDER BY "
	"-ended_us DESC LIMIT 30)) AND n NOT IN (SELECT n FROM job ORDER BY n "
	"DESC LIMIT 20) ORDER BY n LIMIT 10)";

/* They go with their texts. */
static void retain_jobs(struct store *s, int64_t jobs, int64_t before)
{
	sqlite3_stmt *q = store_ask(s, NULL, old_jobs, "ii", before,
				    jobs ? jobs : INT64_MAX);
	const char *texts = q ? (const char *)sqlite3_column_text(q, 1) : NULL;

	if (texts) {
		store_do(s, STORE_MAY_GO, "DELETE FROM job WHERE n IN (SELECT "
			 "value FROM json_each(?))", "s",
			 sqlite3_column_text(q, 0));
		store_text_drop(s, texts);
	}
	sqlite3_finalize(q);
}

void store_retain(struct store *s, int64_t jobs, int64_t days, int64_t now_us)
{
	const int64_t before = days ? now_us - days * DAY_US : 0;

	if (s->in_memory || s->together ||
	    llabs(now_us - s->retained_us) < RETAIN_US)
		return;
	s->retained_us = now_us;
	retain_jobs(s, jobs, before);
	store_do(s, STORE_MAY_GO,
		 "DELETE FROM event WHERE rowid IN (SELECT rowid FROM event "
		 "WHERE utime<? ORDER BY utime LIMIT 100)",
		 "i", before);
	store_do(s, STORE_MAY_GO,
		 "DELETE FROM event WHERE rowid IN (SELECT rowid FROM event "
		 "WHERE job='' AND rowid <= (SELECT max(rowid) FROM event) - ? "
		 "LIMIT 100)", "i", (int64_t)EVENTS_BEHIND);
	if (!s->in_memory)
		sqlite3_exec(s->db, "PRAGMA incremental_vacuum(256)", NULL,
			     NULL, NULL);
}
