/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_store.c - the store on disks that are full, read-only, damaged or cut
 * off
 */
#include "store.h"
#include "store_sql.h"
#include "store_tally.h"
#include "store_text.h"
#include "store_turn.h"
#include "store_trust.h"
#include "disk_help.h"

#include <errno.h>
#include <fcntl.h>
#include <setjmp.h>
#include <signal.h>
#include <sodium.h>
#include <stdarg.h>
#include <stdio.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

static char base[64], dir[128];		/* the store's; base for all */

static void in_dir(const char *command)
{
	char line[500];

	snprintf(line, sizeof(line), command, dir, dir, dir);
	assert_int_equal(system(line), 0);
}

static int setup(void **state)
{
	(void)state;
	snprintf(base, sizeof(base), "/tmp/edmd-store.XXXXXX");
	disk.fail_from = -1;
	disk.snoop = NULL;
	if (!mkdtemp(base))
		return -1;
	snprintf(dir, sizeof(dir), "%s", base);
	return 0;
}

static int teardown(void **state)
{
	(void)state;
	disk.fail_from = -1;
	disk.unread = false;
	disk.snoop = NULL;
	in_dir("rm -rf %s");
	return 0;
}

static struct store *open_store(void)
{
	struct store *s = NULL;

	assert_int_equal(store_open(&s, dir, "m"), 0);
	return s;
}

/* By SQLite itself, while no store is open. */
static void by_hand(const char *sql)
{
	char path[200];
	sqlite3 *db = NULL;

	snprintf(path, sizeof(path), "%s/m.db", dir);
	assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
	assert_int_equal(sqlite3_exec(db, sql, NULL, NULL, NULL), SQLITE_OK);
	sqlite3_close(db);
}

static void by_file(const char *name)
{
	char text[16384] = "";
	FILE *f = fopen(name, "re");

	assert_non_null(f);
	assert_true(fread(text, 1, sizeof(text) - 1, f) > 0);
	fclose(f);
	by_hand(text);
}

static int add_text(struct store *s, const char *id, const char *text,
		    size_t bytes, uint32_t *n)
{
	unsigned char hash[32];
	char hex[65];

	crypto_hash_sha256(hash, (const unsigned char *)text, bytes);
	sodium_bin2hex(hex, sizeof(hex), hash, sizeof(hash));
	return store_add(s, &(struct store_new) {
		.id = id, .name = id, .sha256 = hex, .tech_sha256 = "",
		.text = text, .bytes = bytes, .lines = 3, .now_us = 1000,
		.told = "it is queued",
	}, n);
}

static int add(struct store *s, const char *id, uint32_t *n)
{
	return add_text(s, id, "G1 X1\n", 6, n);
}

static enum job_state state_in(struct store *s, const char *id)
{
	struct store_job j = { .n = 0 };

	return store_find(s, id, &j) == 0 ? j.state : JOB_NSTATES;
}

static int end(struct store *s, uint32_t n, enum job_state state)
{
	return store_end(s, n, &(struct store_end) {
		.state = state, .reason = "", .now_us = 5000, .jumps = 7,
	});
}

/* -- A life of two jobs, and what must be true of it whatever fails ------- */

struct life {
	bool added[2];			/* acknowledged */
	bool promised;			/* that the first may begin */
	bool ended;			/* it was told */
};

static const char *const ids[] = { "first", "second" };

static void live(struct store *s, struct life *l)
{
	uint32_t n[2] = { 0 };

	for (int i = 0; i < 2; i++)
		l->added[i] = add(s, ids[i], &n[i]) == 0;
	if (!l->added[0] || store_set_loaded(s, n[0], true) != 0)
		return;
	l->promised = store_may_begin(s, n[0]) == 0;
	if (!l->promised)
		return;
	store_set_state(s, n[0], JOB_RUNNING);
	store_begin(s, n[0], 2000);
	store_may_begin(s, 0);
	store_calls(s, n[0], "[[1,\"C1\",0.5]]");
	end(s, n[0], JOB_DONE);
	l->ended = true;
	store_set_loaded(s, n[0], false);
	store_note(s, &(struct store_note) {
		.kind = "ended", .job = "first", .outcome = "done",
		.text = "job first done", .now_us = 5000 });
	/* What was told is what is answered, disk or not. */
	assert_int_equal(state_in(s, "first"), JOB_DONE);
}

/* How often it was told that this job is queued. */
static int times_queued(struct store *s, const char *id)
{
	char *all = store_json(s, STORE_EVENTS, "", 0), what[100];
	int n = 0;

	assert_non_null(all);
	snprintf(what, sizeof(what), "\"kind\":\"queued\",\"job\":\"%s\"",
		 id);
	for (const char *at = all; (at = strstr(at, what)); at++)
		n++;
	free(all);
	return n;
}

/* A job is there with its event, or not at all. */
static void look_at_queued(struct store *s)
{
	for (int i = 0; i < 2; i++)
		assert_int_equal(times_queued(s, ids[i]),
				 state_in(s, ids[i]) != JOB_NSTATES);
}

/* What the next service finds, when this one was killed. */
static void look(struct life *l, bool healed)
{
	struct store *s = open_store();
	uint32_t n;

	assert_string_equal(store_why(s), "");
	for (int i = 0; i < 2; i++)
		assert_true(!l->added[i] || state_in(s, ids[i]) != JOB_NSTATES);
	look_at_queued(s);
	if (l->ended && healed)
		assert_int_equal(state_in(s, "first"), JOB_DONE);
	/* A job that began is known to have: it is not cut as a new one. */
	if (l->promised && state_in(s, "first") != JOB_DONE) {
		struct store_job j;

		assert_int_equal(store_find(s, "first", &j), 0);
		assert_true(j.begun_us != 0 ||
			    store_number(s, "started", 0) == j.n);
	}
	assert_int_equal(add(s, "next", &n), 0);
	store_close(s);
}

static const int failures[] = {
	SQLITE_FULL, SQLITE_IOERR_FSYNC
};

static long count_changes(void)
{
	struct store *s = open_store();
	struct life l = { .ended = false };
	long n;

	disk.n = 0;
	live(s, &l);
	n = disk.n;
	store_close(s);
	in_dir("rm -f %s/*");
	assert_true(l.ended);
	return n;
}

/* The disk fails from change @k on; it heals, or the service is killed. */
static void fail_at(long k, int rc, bool heals)
{
	struct store *s = open_store();
	struct life l = { .ended = false };
	uint32_t n;

	disk.n = 0;
	disk.fail_from = k;
	disk.fail_rc = rc;
	live(s, &l);
	if (*store_why(s)) {
		assert_true(add(s, "third", &n) < 0);
		assert_false(store_tick(s, 10000000));
	}
	disk.fail_from = -1;
	if (heals && *store_why(s)) {
		assert_true(store_tick(s, 20000000));
		assert_int_equal(state_in(s, "third"), JOB_NSTATES);
		for (int i = 0; i < 2; i++)
			assert_true(l.added[i] ||
				    state_in(s, ids[i]) == JOB_NSTATES);
		look_at_queued(s);
	}
	assert_true(!heals || !*store_why(s));
	store_close(s);
	look(&l, heals);
	in_dir("rm -f %s/*");
}

static void a_disk_that_fails_at_any_write_loses_no_truth(void **state)
{
	const long n = count_changes();

	(void)state;
	print_message("%ld changes of the disk in the life\n", n);
	for (size_t i = 0; i < sizeof(failures) / sizeof(*failures); i++)
		for (long k = 0; k < n; k++)
			for (int heals = 0; heals < 2; heals++)
				fail_at(k, failures[i], heals != 0);
}

/* -- The host dies at every write ----------------------------------------- */

#define CUTS_MAX	400

static int ncuts;
static struct life cut_life;		/* as it is at the moment */
static struct life cuts[CUTS_MAX];

static void copy_with(const char *path, const void *data, int n, int64_t at)
{
	char line[600], to[300];
	FILE *f;

	snprintf(line, sizeof(line), "mkdir -p %s/cut%d && cp -f %s/m.db* "
		 "%s/cut%d/", dir, ncuts, dir, dir, ncuts);
	assert_int_equal(system(line), 0);
	if (n <= 0)
		return;
	/* Half of the write came to the disk. */
	snprintf(to, sizeof(to), "%s/cut%d/%s", dir, ncuts,
		 strrchr(path, '/') + 1);
	f = fopen(to, "r+e");
	assert_non_null(f);
	assert_int_equal(fseek(f, (long)at, SEEK_SET), 0);
	assert_int_equal(fwrite(data, 1, (size_t)n / 2, f), (size_t)n / 2);
	fclose(f);
}

static void snoop(const char *path, const void *data, int n, int64_t at)
{
	assert_true(ncuts < CUTS_MAX);
	copy_with(path, data, n, at);
	cuts[ncuts++] = cut_life;
}

static void a_host_that_dies_at_any_write_leaves_a_store(void **state)
{
	struct store *s = open_store();

	(void)state;
	ncuts = 0;
	memset(&cut_life, 0, sizeof(cut_life));
	disk.snoop = snoop;
	live(s, &cut_life);
	disk.snoop = NULL;
	store_close(s);
	print_message("%d copies, each cut within a write\n", ncuts);
	assert_true(ncuts > 20);
	for (int i = 0; i < ncuts; i++) {
		snprintf(dir, sizeof(dir), "%s/cut%d", base, i);
		look(&cuts[i], false);
	}
	snprintf(dir, sizeof(dir), "%s", base);
}

/* -- Other rows ----------------------------------------------------------- */

/* A job from its arrival to its end. */
static void live_one(struct store *s, const char *id, const char *text,
		     size_t bytes)
{
	struct store_job j;
	uint32_t n;

	assert_int_equal(add_text(s, id, text, bytes, &n), 0);
	assert_int_equal(store_head(s, &j), 0);
	store_set_loaded(s, n, true);
	for (int i = 0; i < 20; i++)
		store_set_state(s, n, i % 2 ? JOB_HELD : JOB_RUNNING);
	end(s, n, JOB_DONE);
}

/* Bytes that are written to the database for a job of a text of @bytes. */
static int64_t life_bytes(const char *id, size_t bytes)
{
	char *text = calloc(1, bytes);
	struct store *s = open_store();

	memset(text, ' ', bytes);
	disk.bytes = 0;
	live_one(s, id, text, bytes);
	store_close(s);
	free(text);
	return disk.bytes;
}

static void a_long_text_costs_the_database_nothing(void **state)
{
	int64_t one, ten;

	(void)state;
	store_close(open_store());
	one = life_bytes("one", 1 << 20);
	ten = life_bytes("ten", 10 << 20);
	print_message("%lld bytes for 1 MiB, %lld for 10\n", (long long)one,
		      (long long)ten);
	assert_true(ten < one + one / 10);
}

/* docs/power.md: with CHECKPOINT_DAY_BYTES, 100 MB a day. */
#define STORE_DAY_MB	35

/* What edmd-jobs stores of a cut that never ends, as tally.c does: each three
 * minutes the sums and the conditions that were called, each half hour the
 * trail. */
static void a_cut_that_never_ends_writes_little(void **state)
{
	const int minutes = 240;
	static char calls[8192], used[1200], trail[30000];
	struct store *s = open_store();
	double day_mb;
	uint32_t n;

	(void)state;
	memset(used, '1', sizeof(used) - 1);
	memset(trail, '1', sizeof(trail) - 1);
	assert_int_equal(add(s, "cut", &n), 0);
	disk.bytes = 0;
	for (int at = 3; at <= minutes; at += 3) {
		for (int i = 0, k = 0; i < 180; i++)
			k += snprintf(calls + k, sizeof(calls) - (size_t)k,
				      "%c[%d000000000,\"C%d\",%d.5]",
				      i ? ',' : '[', at * 60 + i, i & 1, i);
		strcat(calls, "]");
		assert_int_equal(store_calls(s, n, calls), 0);
		assert_int_equal(store_used_write(s, n, used), 0);
		if (at % 30 == 0)
			store_trail_write(s, n, trail);
	}
	store_close(s);
	day_mb = (double)disk.bytes / 1e6 * 24 * 60 / minutes;
	print_message("a cut that calls a condition each second: %.1f MB a "
		      "day\n", day_mb);
	assert_true(day_mb <= STORE_DAY_MB);
}

/* As another program sees it; the store may be open. */
static int alarms_on_disk(void)
{
	char path[200];
	sqlite3_stmt *q = NULL;
	sqlite3 *db = NULL;
	int n;

	snprintf(path, sizeof(path), "%s/m.db", dir);
	assert_int_equal(sqlite3_open_v2(path, &db, SQLITE_OPEN_READONLY,
					 NULL), SQLITE_OK);
	assert_int_equal(sqlite3_prepare_v2(db, "SELECT count(*), "
			 "count(DISTINCT utime) FROM event WHERE kind='alarm'",
			 -1, &q, NULL), SQLITE_OK);
	assert_int_equal(sqlite3_step(q), SQLITE_ROW);
	n = sqlite3_column_int(q, 0);
	assert_int_equal(n, sqlite3_column_int(q, 1));
	sqlite3_finalize(q);
	sqlite3_close(db);
	return n;
}

static void alarms(struct store *s, int from, int n)
{
	for (int i = from; i < from + n; i++)
		store_note(s, &(struct store_note) {
			.kind = "alarm", .job = "", .outcome = "", .text = "",
			.now_us = i });
}

static void disk_fails(int rc)
{
	disk.n = 0;
	disk.fail_from = 0;
	disk.fail_rc = rc;
}

/* Return: how many alarms were dropped. */
static int keep_many(int rc)
{
	struct store *s = open_store();
	struct store_size size;
	uint32_t n;

	assert_int_equal(add(s, "job", &n), 0);
	disk_fails(rc);
	assert_int_equal(end(s, n, JOB_DONE), STORE_KEPT);
	for (int i = 0; i < 20000; i++) {
		alarms(s, i, 1);
		store_set_number(s, "waiting", i);
	}
	store_measure(s, &size);
	assert_true(size.kept <= 4096);
	disk.fail_from = -1;
	while (!store_tick(s, 1))
		assert_ptr_not_equal(s->disk, NULL);
	store_close(s);
	assert_int_equal(alarms_on_disk(), 20000 - (int)size.dropped);
	s = open_store();
	assert_int_equal(state_in(s, "job"), JOB_DONE);
	assert_int_equal(store_number(s, "waiting", 0), 19999);
	store_close(s);
	return (int)size.dropped;
}

static void the_list_in_memory_is_bounded_and_keeps_what_counts(void **state)
{
	(void)state;
	assert_true(keep_many(SQLITE_IOERR_WRITE) > 15000);
}

#define ALARMS	1000

/* -- A disk that is full, and is read on ---------------------------------- */

static void a_full_disk_drops_nothing(void **state)
{
	(void)state;
	assert_int_equal(keep_many(SQLITE_FULL), 0);
}

/* Otherwise every event would take memory until there is none. */
static void what_is_told_in_memory_is_bounded(int rc)
{
	const int more = 500;
	struct store *s = open_store();
	struct store_size size;
	uint32_t n;

	assert_int_equal(add(s, "job", &n), 0);
	disk_fails(rc);
	assert_int_equal(store_set_number(s, "waiting", 1), STORE_KEPT);
	alarms(s, 0, STORE_MISS_FROM);
	assert_int_equal(store_missed(s), 0);
	alarms(s, STORE_MISS_FROM, more - 1);
	assert_int_equal(store_note(s, &(struct store_note) {
		.kind = "alarm", .job = "", .outcome = "", .text = "",
	}), STORE_MISSED);
	assert_int_equal(store_missed(s), more);
	assert_int_equal(store_number_of(s, 0, "SELECT count(*) FROM event "
					 "WHERE kind='alarm'", ""),
			 STORE_MISS_FROM);
	/* A job is written nevertheless. */
	assert_int_equal(end(s, n, JOB_DONE), STORE_KEPT);
	assert_int_equal(state_in(s, "job"), JOB_DONE);
	disk.fail_from = -1;
	while (!store_tick(s, 1))
		assert_ptr_not_equal(s->disk, NULL);
	store_measure(s, &size);
	assert_int_equal(store_missed(s), more);
	assert_int_equal(alarms_on_disk(),
			 STORE_MISS_FROM + more - (int)size.dropped);
	assert_int_equal(state_in(s, "job"), JOB_DONE);
	alarms(s, STORE_MISS_FROM + more, 1);
	assert_int_equal(alarms_on_disk(),
			 STORE_MISS_FROM + more + 1 - (int)size.dropped);
	/* The next time it is counted anew. */
	disk_fails(rc);
	alarms(s, STORE_MISS_FROM + more + 1, 1);
	assert_int_equal(store_missed(s), 0);
	disk.fail_from = -1;
	store_close(s);
}

static void many_events_of_a_full_disk_are_counted_and_left_out(void **state)
{
	(void)state;
	what_is_told_in_memory_is_bounded(SQLITE_FULL);
}

static void many_events_of_a_copy_are_counted_and_left_out(void **state)
{
	(void)state;
	what_is_told_in_memory_is_bounded(SQLITE_IOERR_WRITE);
}

static void what_is_written_over_a_full_disk_is_seen_by_us_alone(void **state)
{
	struct store *s = open_store();
	uint32_t n;

	(void)state;
	assert_int_equal(add(s, "old", &n), 0);
	alarms(s, 0, 7);
	disk_fails(SQLITE_FULL);
	alarms(s, 7, 3);
	assert_int_equal(store_set_state(s, n, JOB_HELD), STORE_KEPT);
	assert_true(s->over);
	assert_int_equal(state_in(s, "old"), JOB_HELD);
	assert_int_equal(store_number_of(s, 0, "SELECT count(*) FROM event "
					 "WHERE kind='alarm'", ""), 10);
	assert_int_equal(alarms_on_disk(), 7);
	disk.fail_from = -1;
	assert_true(store_tick(s, 1));
	assert_string_equal(store_why(s), "");
	assert_int_equal(alarms_on_disk(), 10);
	assert_int_equal(store_set_state(s, n, JOB_DONE), 0);
	store_close(s);
}

/* There was room, and it is gone again: what was kept is written anew. */
static void a_disk_that_is_full_again_loses_nothing(void **state)
{
	struct store *s = open_store();
	uint32_t n;

	(void)state;
	assert_int_equal(add(s, "old", &n), 0);
	disk_fails(SQLITE_FULL);
	alarms(s, 0, 100);
	assert_int_equal(store_set_state(s, n, JOB_HELD), STORE_KEPT);
	for (int64_t i = 1; i < 4; i++) {
		assert_false(store_tick(s, i * 10000000));
		assert_true(s->over);
		assert_int_equal(state_in(s, "old"), JOB_HELD);
		assert_int_equal(alarms_on_disk(), 0);
	}
	disk.fail_from = -1;
	assert_true(store_tick(s, 90000000));
	assert_int_equal(state_in(s, "old"), JOB_HELD);
	assert_int_equal(alarms_on_disk(), 100);
	store_close(s);
}

static int64_t log_bytes(void)
{
	char path[200];
	struct stat st;

	snprintf(path, sizeof(path), "%s/m.db-wal", dir);
	assert_int_equal(stat(path, &st), 0);
	return st.st_size;
}

/* Else the log of a full disk would take the room that there is again. */
static void where_there_is_room_again_the_log_begins_anew(void **state)
{
	struct store *s = open_store();
	int64_t bytes;

	(void)state;
	alarms(s, 0, 20);
	disk_fails(SQLITE_FULL);
	alarms(s, 20, 1);
	disk.fail_from = -1;
	assert_true(store_tick(s, 90000000));
	bytes = log_bytes();
	alarms(s, 21, 20);
	assert_int_equal(log_bytes(), bytes);
	assert_int_equal(alarms_on_disk(), 41);
	store_close(s);
}

static void the_log_of_one_that_was_killed_begins_anew(void **state)
{
	const pid_t pid = fork();
	int64_t bytes;
	int status;
	struct store *s;

	(void)state;
	if (pid == 0) {
		alarms(open_store(), 0, 20);
		_exit(0);
	}
	assert_int_equal(waitpid(pid, &status, 0), pid);
	s = open_store();
	bytes = log_bytes();
	alarms(s, 20, 20);
	assert_int_equal(log_bytes(), bytes);
	assert_int_equal(alarms_on_disk(), 40);
	store_close(s);
}

/* Then nobody knows of the job until it can be read again. */
static void a_full_disk_that_cannot_be_read_in_the_end_loses_nothing(
	void **state)
{
	struct store *s = open_store();
	uint32_t n;

	(void)state;
	assert_int_equal(add(s, "old", &n), 0);
	disk_fails(SQLITE_FULL);
	alarms(s, 0, ALARMS);
	assert_int_equal(store_set_state(s, n, JOB_HELD), STORE_KEPT);
	sqlite3_db_release_memory(s->db);
	disk.unread = true;
	assert_int_equal(state_in(s, "old"), JOB_NSTATES);
	assert_false(s->over);
	assert_string_equal(store_why(s), "the disk fails: input/output error");
	assert_int_equal(store_number_of(s, 0, "SELECT count(*) FROM event",
					 ""), ALARMS);
	disk.unread = false;
	disk.fail_from = -1;
	while (!store_tick(s, 10000000))
		assert_ptr_not_equal(s->disk, NULL);
	assert_int_equal(state_in(s, "old"), JOB_HELD);
	assert_int_equal(alarms_on_disk(), ALARMS);
	store_close(s);
}

/* The file is opened to read, so nothing can be written over it. */
static void a_disk_that_is_full_from_the_start_is_not_called_read_only(
	void **state)
{
	struct store *s = open_store();
	uint32_t n;

	(void)state;
	assert_int_equal(add(s, "old", &n), 0);
	store_close(s);
	by_hand("PRAGMA journal_mode=DELETE");	/* to have it opened, it is
						 * written */
	disk_fails(SQLITE_FULL);
	s = open_store();
	alarms(s, 0, 3);
	assert_string_equal(store_why(s), "the disk is full");
	assert_int_equal(store_set_state(s, n, JOB_HELD), STORE_KEPT);
	assert_int_equal(state_in(s, "old"), JOB_HELD);
	disk.fail_from = -1;
	while (!store_tick(s, 10000000))
		assert_ptr_not_equal(s->disk, NULL);
	assert_int_equal(state_in(s, "old"), JOB_HELD);
	assert_int_equal(alarms_on_disk(), 3);
	store_close(s);
}

/* -- A list that is brought to the disk in pieces ------------------------- */

/* A store that keeps so many alarms; the disk is good again. */
static struct store *open_with_alarms(void)
{
	struct store *s = open_store();

	disk_fails(SQLITE_IOERR_WRITE);
	alarms(s, 0, ALARMS);
	disk.fail_from = -1;
	assert_int_equal(s->kept.n, ALARMS);
	return s;
}

/* Return: the ticks that it took. */
static int bring_all(struct store *s)
{
	uint32_t left = s->kept.n;
	int ticks = 1;

	for (; !store_tick(s, 10000000); ticks++) {
		assert_ptr_not_equal(s->disk, NULL);
		assert_in_range(left - s->kept.n, 1, STORE_PIECE);
		left = s->kept.n;
		/* A piece alone is nothing. */
		assert_int_equal(alarms_on_disk(), 0);
	}
	assert_true(left <= STORE_PIECE);
	return ticks;
}

static void what_was_kept_comes_in_pieces_and_at_once(void **state)
{
	struct store *s = open_with_alarms();

	(void)state;
	assert_int_equal(bring_all(s), (ALARMS - 1) / STORE_PIECE + 1);
	assert_int_equal(alarms_on_disk(), ALARMS);
	assert_string_equal(store_why(s), "");
	store_close(s);
}

static void what_is_written_between_the_pieces_comes_with_them(void **state)
{
	struct store *s = open_with_alarms();
	uint32_t n;

	(void)state;
	assert_false(store_tick(s, 10000000));
	alarms(s, ALARMS, 10);
	assert_int_equal(store_set_number(s, "waiting", 7), STORE_KEPT);
	assert_true(add(s, "new", &n) < 0);
	bring_all(s);
	assert_int_equal(alarms_on_disk(), ALARMS + 10);
	assert_int_equal(store_number(s, "waiting", 0), 7);
	store_close(s);
}

/* At the end of the pieces, or when their pages no longer fit into memory. */
static void a_disk_that_fails_between_the_pieces_loses_nothing(void **state)
{
	struct store *s = open_with_alarms();

	(void)state;
	assert_false(store_tick(s, 10000000));
	disk_fails(SQLITE_FULL);
	for (int i = 0; s->disk && i < ALARMS; i++)
		assert_false(store_tick(s, 10000000));
	assert_string_equal(store_why(s), "the disk is full");
	assert_int_equal(s->kept.n, ALARMS);
	disk.fail_from = -1;
	assert_int_equal(alarms_on_disk(), 0);
	while (!store_tick(s, 20000000))
		assert_ptr_not_equal(s->disk, NULL);
	assert_int_equal(alarms_on_disk(), ALARMS);
	store_close(s);
}

static void a_service_that_ends_between_the_pieces_brings_them_all(void **state)
{
	struct store *s = open_with_alarms();

	(void)state;
	assert_false(store_tick(s, 10000000));
	store_close(s);
	assert_int_equal(alarms_on_disk(), ALARMS);
}

static void a_store_of_0_1_0_is_brought_up(void **state)
{
	struct store_job j;
	struct store *s;
	size_t bytes;
	char *text;

	(void)state;
	by_file("tests/data/store-0.1.0.sql");
	s = open_store();
	assert_int_equal(state_in(s, "old-done"), JOB_DONE);
	assert_int_equal(store_find(s, "old-queued", &j), 0);
	assert_int_equal(j.state, JOB_QUEUED);
	assert_int_equal(store_text(s, j.n, &text, &bytes), 0);
	assert_memory_equal(text, "G21 G90\nG1 X1 F60\nM30\n", bytes);
	free(text);
	text = store_json(s, STORE_SHOW, "old-done", 0);
	assert_non_null(strstr(text, "\"now\":\"C120\""));
	free(text);
	assert_int_equal(store_number(s, "waiting", 0), 1);
	store_close(s);
	/* And once more: it is of this version now. */
	s = open_store();
	assert_int_equal(state_in(s, "old-done"), JOB_DONE);
	store_close(s);
}

/* Nobody knows what its conditions came to, and nothing is guessed. */
static void a_store_without_sums_by_condition_is_brought_up(void **state)
{
	struct store *s;
	uint32_t n;
	char *text;

	(void)state;
	by_file("tests/data/store-5.sql");
	s = open_store();
	text = store_json(s, STORE_SHOW, "old-done", 0);
	assert_non_null(strstr(text, "\"job_s\":4.01"));
	assert_non_null(strstr(text, "\"conditions\":[]"));
	assert_non_null(strstr(text, "\"energy_j\":null"));
	assert_non_null(strstr(text, "\"first_us\":1795357452615187"));
	free(text);
	text = store_json(s, STORE_TRAIL, "old-done", 0);
	assert_string_equal(text, "{}");
	free(text);
	assert_int_equal(add(s, "new", &n), 0);
	assert_int_equal(n, 4);
	assert_int_equal(store_used_write(s, n, "[{\"condition\":\"C1\"}]"),
			 0);
	end(s, n, JOB_DONE);
	store_close(s);
	s = open_store();
	text = store_json(s, STORE_HISTORY, "", 0);
	assert_non_null(strstr(text, "\"conditions\":[{\"condition\":"
			       "\"C1\"}]"));
	free(text);
	store_close(s);
}

static uint32_t rows_of(const char *table)
{
	char sql[80], path[200];
	sqlite3_stmt *q = NULL;
	sqlite3 *db = NULL;
	uint32_t n;

	snprintf(path, sizeof(path), "%s/m.db", dir);
	snprintf(sql, sizeof(sql), "SELECT count(*) FROM %s", table);
	assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
	assert_int_equal(sqlite3_prepare_v2(db, sql, -1, &q, NULL), SQLITE_OK);
	assert_int_equal(sqlite3_step(q), SQLITE_ROW);
	n = (uint32_t)sqlite3_column_int64(q, 0);
	sqlite3_finalize(q);
	sqlite3_close(db);
	return n;
}

static void what_a_job_came_to_goes_with_it(void **state)
{
	static const char *const tables[] = { "used", "trail", "fault" };
	struct store_fault f = { 7, "short", 3, 0.5 };
	struct store *s = open_store();
	uint32_t n;
	char *text;

	(void)state;
	assert_int_equal(add(s, "old", &n), 0);
	disk.fail_from = 0;
	assert_int_equal(store_used_write(s, n, "[]"), STORE_KEPT);
	assert_int_equal(store_used_write(s, n, "[1]"), STORE_KEPT);
	assert_int_equal(store_trail_write(s, n, "{}"), STORE_KEPT);
	assert_int_equal(store_fault(s, n, &f), STORE_KEPT);
	assert_int_equal(store_fault(s, n, &f), STORE_KEPT);
	text = store_used(s, n);
	assert_string_equal(text, "[1]");
	free(text);
	disk.fail_from = -1;
	assert_true(store_tick(s, 1));
	end(s, n, JOB_DONE);
	store_close(s);
	for (int i = 0; i < 3; i++)
		assert_int_equal(rows_of(tables[i]), 1);
	by_hand("DELETE FROM job");
	for (int i = 0; i < 3; i++)
		assert_int_equal(rows_of(tables[i]), 0);
}

static void many_jobs(struct store *s, int count)
{
	char id[32];
	uint32_t n;

	for (int i = 0; i < count; i++) {
		snprintf(id, sizeof(id), "job-%d", i);
		assert_int_equal(add(s, id, &n), 0);
		end(s, n, JOB_DONE);
	}
}

/* Through all pages of a list: how many jobs; each is the one before or after
 * the last, by @step. */
static int walk_pages(struct store *s, enum store_list what, int first,
		      int step)
{
	char last[32] = "";
	int seen = 0;

	for (int pages = 0; pages < 100; pages++) {
		char *text = store_json(s, what, last, 0), *at = text;
		int here = 0;

		assert_non_null(text);
		assert_true(strlen(text) <= STORE_JSON_MAX);
		for (; (at = strstr(at, "\"job\":\"")); at++, seen++, here++) {
			char wanted[32];

			snprintf(wanted, sizeof(wanted), "job-%d",
				 first + step * seen);
			snprintf(last, sizeof(last), "%.*s",
				 (int)strcspn(at + 7, "\""), at + 7);
			assert_string_equal(last, wanted);
		}
		free(text);
		if (here == 0)
			return seen;
	}
	return -1;
}

static void a_long_list_comes_in_pages(void **state)
{
	struct store *s = open_store();
	char id[32];
	uint32_t n;

	(void)state;
	many_jobs(s, 450);
	for (int i = 450; i < 800; i++) {
		snprintf(id, sizeof(id), "job-%d", i);
		assert_int_equal(add(s, id, &n), 0);
	}
	assert_int_equal(walk_pages(s, STORE_QUEUE, 450, 1), 350);
	/* One of which the turn is earlier than its number. */
	assert_int_equal(store_move(s, n, true), 0);
	assert_int_equal(store_move(s, n, false), 0);
	assert_int_equal(walk_pages(s, STORE_QUEUE, 450, 1), 350);
	assert_int_equal(walk_pages(s, STORE_HISTORY, 449, -1), 450);
	store_close(s);
}

#define PAGE	50

static int count_step(void *arg)
{
	++*(long *)arg;
	return 0;
}

/* Instructions of SQLite for the page of @what behind job @id. */
static long page_steps(struct store *s, enum store_list what, const char *id)
{
	long steps = 0;
	char *text;

	sqlite3_progress_handler(s->db, 1, count_step, &steps);
	text = store_json(s, what, id, PAGE);
	sqlite3_progress_handler(s->db, 0, NULL, NULL);
	assert_non_null(text);
	assert_non_null(strstr(text, "\"job\""));
	free(text);
	return steps;
}

/* @count jobs, half of them done and half in the queue. */
static void jobs_by_hand(int count)
{
	char sql[400];

	snprintf(sql, sizeof(sql), "DELETE FROM job; WITH RECURSIVE i(n) AS "
		 "(SELECT 0 UNION ALL SELECT n + 1 FROM i WHERE n < %d) INSERT "
		 "INTO job(id, name, sha256, lines, hold, submitted_us, state, "
		 "ended_us) SELECT 'job-' || n, 'part', n, 1, 0, 1, iif(n < %d,"
		 "'done', 'queued'), n FROM i;", count - 1, count / 2);
	by_hand(sql);
}

/* Instructions of SQLite for the life of a job beside @count others. */
static long life_steps(int count)
{
	struct store *s;
	long steps = 0;

	store_close(open_store());
	jobs_by_hand(count);
	s = open_store();
	sqlite3_progress_handler(s->db, 1, count_step, &steps);
	live_one(s, "new", "G1 X1\n", 6);
	sqlite3_progress_handler(s->db, 0, NULL, NULL);
	store_close(s);
	return steps;
}

static void a_job_costs_the_same_beside_ten_times_as_many(void **state)
{
	const long few = life_steps(1000), many = life_steps(10000);

	(void)state;
	print_message("%ld steps beside 1000 jobs, %ld beside 10000\n", few,
		      many);
	assert_true(many < few + few / 10);
}

/* A page of a queue of 10,000 jobs, of which one was moved, and one of the
 * history behind as many. */
static void a_page_costs_what_is_in_it(void **state)
{
	struct store *s = open_store();
	static const int behind[] = { 100, 9998, 10001, 15001, 19900 };
	char id[32];
	long steps;

	(void)state;
	store_close(s);
	jobs_by_hand(20000);
	by_hand("UPDATE job SET turn=15000 WHERE id='job-15001'");
	s = open_store();
	for (size_t i = 0; i < sizeof(behind) / sizeof(*behind); i++) {
		const int n = behind[i];

		snprintf(id, sizeof(id), "job-%d", n);
		steps = page_steps(s, n < 10000 ? STORE_HISTORY : STORE_QUEUE,
				   id);
		print_message("%ld steps for a page behind %s\n", steps, id);
		assert_in_range(steps, 1, 300 * PAGE);
	}
	store_close(s);
}

static void break_pages(const char *from, const char *count)
{
	char line[500];

	snprintf(line, sizeof(line), "dd if=/dev/urandom of=%s/m.db bs=4096 "
		 "seek=%s count=%s conv=notrunc status=none", dir, from, count);
	assert_int_equal(system(line), 0);
}

/* Any one page but the first: the others' jobs are there afterwards. */
static void a_damaged_page_costs_what_is_in_it(void **state)
{
	struct store *s = open_store();
	struct store_size size;
	uint32_t n, worst = 200;
	int pages, mended = 0;
	char from[16];
	struct stat st;
	char path[200];

	(void)state;
	many_jobs(s, 200);
	store_close(s);
	snprintf(path, sizeof(path), "%s/m.db", dir);
	assert_int_equal(stat(path, &st), 0);
	pages = (int)(st.st_size / 4096);
	in_dir("mv %s/m.db %s/whole");
	for (int i = 1; i < pages; i++) {
		in_dir("rm -f %s/m.db*; cp %s/whole %s/m.db");
		snprintf(from, sizeof(from), "%d", i);
		break_pages(from, "1");
		s = open_store();
		assert_string_equal(store_why(s), "");
		store_measure(s, &size);
		mended += *store_mended(s) != 0;
		worst = size.jobs < worst ? size.jobs : worst;
		assert_int_equal(add(s, "new", &n), 0);
		if (*store_mended(s)) {
			assert_true(n > 1000);
			assert_int_equal(store_number(s, "waiting", 0), 1);
			in_dir("ls %s/m.db.damaged-* > /dev/null");
		}
		store_close(s);
	}
	print_message("%d pages, %d mended, %u of 200 jobs at the worst\n",
		      pages, mended, worst);
	assert_true(mended > 5);
}

static void what_is_no_database_is_set_aside(void **state)
{
	struct store *s;
	uint32_t n;

	(void)state;
	in_dir("head -c 20000 /dev/urandom > %s/m.db");
	s = open_store();
	assert_string_equal(store_why(s), "");
	assert_int_equal(add(s, "new", &n), 0);
	store_close(s);
	in_dir("ls %s/m.db.damaged-* > /dev/null");
}

/* Each is what a disk, or a person, may leave of the database. */
static void a_database_that_is_gone_is_told(void **state)
{
	static const char *const left[] = {
		"rm -f %s/m.db*", "rm -f %s/m.db*; : > %s/m.db",
		"rm -f %s/m.db*; head -c 4096 /dev/zero > %s/m.db",
		": > %s/m.db",
	};
	static const char *const beside[] = {
		"touch %s/m.place", "touch %s/m.key", "touch %s/m.machine-key",
		"echo G1 > %s/m.text-0a",
	};
	struct store *s;

	(void)state;
	for (size_t i = 0; i < sizeof(left) / sizeof(left[0]); i++) {
		for (size_t k = 0; k < 4; k++) {
			in_dir("rm -rf %s/*");
			s = open_store();
			assert_string_equal(store_mended(s), "");
			store_close(s);
			in_dir(left[i]);
			in_dir(beside[k]);
			s = open_store();
			assert_non_null(strstr(store_mended(s), i == 2 ?
					       "damaged" : "gone or empty"));
			assert_int_equal(store_number(s, "waiting", 0), 1);
			store_close(s);
			s = open_store();
			assert_string_equal(store_mended(s), "");
			store_close(s);
		}
	}
}

/* As a kill leaves it: what was written last is in the log alone. */
static void leave_as_killed(void)
{
	struct store *s;
	uint32_t n;

	in_dir("rm -rf %s/*");
	s = open_store();
	for (int i = 0; i < 20; i++) {
		char id[16];

		snprintf(id, sizeof(id), "job-%d", i);
		assert_int_equal(add(s, id, &n), 0);
	}
	in_dir("mkdir %s/k; cp %s/m.db* %s/k");
	store_close(s);
	in_dir("mv %s/k/m.db* %s");
}

/* Another salt, whatever it was: a byte that is merely written may be the one
 * that stood there. */
#define FLIP_BYTE_17	NULL

static void flip_byte_17_of_log(void)
{
	char path[160];
	FILE *f;
	int c;

	snprintf(path, sizeof(path), "%s/m.db-wal", dir);
	f = fopen(path, "r+b");
	assert_non_null(f);
	assert_int_equal(fseek(f, 17, SEEK_SET), 0);
	c = fgetc(f);
	assert_int_not_equal(c, EOF);
	assert_int_equal(fseek(f, 17, SEEK_SET), 0);
	assert_int_equal(fputc(c ^ 1, f), c ^ 1);
	assert_int_equal(fclose(f), 0);
}

static void a_log_that_lost_its_end_is_told(void **state)
{
	static const char *const damage[] = {
		"rm %s/m.db-wal", ": > %s/m.db-wal",
		"truncate -s 5000 %s/m.db-wal",
		"truncate -s -1 %s/m.db-wal",
		"head -c 90000 /dev/urandom > %s/m.db-wal",
		FLIP_BYTE_17,
		"printf xyzzy | dd of=%s/m.db-wal bs=1 seek=9000 conv=notrunc "
		"2>/dev/null",
		"dd if=/dev/zero of=%s/m.db-wal bs=4096 seek=2 count=1 "
		"conv=notrunc 2>/dev/null",
	};
	struct store *s;

	(void)state;
	for (size_t i = 0; i < sizeof(damage) / sizeof(damage[0]); i++) {
		leave_as_killed();
		if (damage[i] == FLIP_BYTE_17)
			flip_byte_17_of_log();
		else
			in_dir(damage[i]);
		s = open_store();
		assert_non_null(strstr(store_mended(s), "damaged"));
		assert_int_equal(store_number(s, "waiting", 0), 1);
		store_close(s);
		in_dir("ls %s/m.db.damaged-* > /dev/null");
		s = open_store();
		assert_string_equal(store_mended(s), "");
		store_close(s);
	}
}

/* The index may be older than the log, or gone; the log may end in what was
 * being written when the power went. */
static void a_log_that_is_whole_is_no_loss(void **state)
{
	static const char *const odd[] = {
		":", "rm %s/m.db-shm", ": > %s/m.db-shm",
		"head -c 32768 /dev/urandom > %s/m.db-shm",
		"head -c 3000 /dev/urandom >> %s/m.db-wal",
		/* Of a log before this one. */
		"printf qqqqqqqq | dd of=%s/m.db-shm bs=1 seek=32 conv=notrunc "
		"2>/dev/null; printf qqqqqqqq | dd of=%s/m.db-shm bs=1 seek=80 "
		"conv=notrunc 2>/dev/null",
	};
	struct store_job job;
	struct store *s;

	(void)state;
	for (size_t i = 0; i < sizeof(odd) / sizeof(odd[0]); i++) {
		leave_as_killed();
		in_dir(odd[i]);
		s = open_store();
		assert_string_equal(store_mended(s), "");
		assert_int_equal(store_find(s, "job-19", &job), 0);
		store_close(s);
	}
}

static void a_new_folder_is_no_loss(void **state)
{
	struct store *s;

	(void)state;
	/* Those of another machine are there already. */
	in_dir("touch %s/n.place %s/n.key %s/n.db");
	s = open_store();
	assert_string_equal(store_mended(s), "");
	assert_int_equal(store_number(s, "waiting", 0), 0);
	store_close(s);
}

static void links_and_fifos_are_not_opened(void **state)
{
	static const char *const names[] = {
		"lock", "db", "db-wal", "db-shm", "place", "key", "machine-key",
	};
	static const char *const odd[] = {
		"echo 1 > %s/elsewhere; chmod 644 %s/elsewhere; ln -s "
		"elsewhere %s/m.", "ln -s nowhere %s/m.", "mkfifo %s/m.",
		"mkdir %s/m.",
	};
	char command[200];
	struct store *s;
	struct stat st;

	(void)state;
	for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
		for (size_t k = 0; k < sizeof(odd) / sizeof(odd[0]); k++) {
			in_dir("rm -rf %s/*");
			snprintf(command, sizeof(command), "%s%s", odd[k],
				 names[i]);
			in_dir(command);
			assert_int_equal(store_open(&s, dir, "m"), -ELOOP);
			snprintf(command, sizeof(command), "%s/elsewhere", dir);
			if (k == 0) {
				assert_int_equal(stat(command, &st), 0);
				assert_int_equal(st.st_mode & 0777, 0644);
				assert_int_equal(st.st_size, 2);
			}
			in_dir("! test -e %s/nowhere");
		}
	}
}

static void the_first_page_torn_is_no_end(void **state)
{
	struct store *s = open_store();

	(void)state;
	many_jobs(s, 50);
	store_close(s);
	break_pages("0", "1");
	s = open_store();
	assert_string_equal(store_why(s), "");
	store_close(s);
}

static void a_text_of_other_bytes_is_not_cut(void **state)
{
	struct store *s = open_store();
	uint32_t n;
	size_t bytes;
	char *text;

	(void)state;
	assert_int_equal(add(s, "job", &n), 0);
	store_close(s);
	by_hand("UPDATE text SET text='G1 X9'||char(10)");
	s = open_store();
	assert_int_equal(store_text(s, n, &text, &bytes), -EILSEQ);
	store_close(s);
}

/* -- Long texts ------------------------------------------------------------ */

#define LONG	(3 * STORE_TEXT_INSIDE)

/* A store with one job of a long text.  @path: its file. */
static struct store *long_job(uint32_t *n, char path[STORE_TEXT_PATH_MAX])
{
	struct store *s = open_store();
	char *text = calloc(1, LONG);

	memset(text, ' ', LONG);
	assert_int_equal(add_text(s, "long", text, LONG, n), 0);
	assert_int_equal(store_text_file(s, *n, path), 0);
	free(text);
	return s;
}

static int fetch(struct store *s, uint32_t n)
{
	size_t bytes = 0;
	char *text = NULL;
	const int err = store_text(s, n, &text, &bytes);

	if (err == 0)
		assert_int_equal(bytes, LONG);
	else
		assert_null(text);
	free(text);
	return err;
}

/* Cut off, with another byte, longer, empty, gone, no file at all: it is never
 * read, and nothing waits for it. */
static void a_long_text_that_was_damaged_is_not_cut(void **state)
{
	static const char *const how[] = {
		"truncate -s -1 %s", "truncate -s +1 %s", "truncate -s 0 %s",
		"printf x | dd of=%s bs=1 seek=99999 conv=notrunc status=none",
		"rm %s", "rm %s; mkfifo %s", "rm %s; mkdir %s",
		"cp %s %s.too; ln -sf %s.too %s",
	};
	char path[STORE_TEXT_PATH_MAX], line[5 * STORE_TEXT_PATH_MAX];
	uint32_t n;

	(void)state;
	for (size_t i = 0; i < sizeof(how) / sizeof(*how); i++) {
		struct store *s = long_job(&n, path);

		assert_int_equal(fetch(s, n), 0);
		snprintf(line, sizeof(line), how[i], path, path, path, path);
		assert_int_equal(system(line), 0);
		assert_int_equal(fetch(s, n), -EILSEQ);
		store_close(s);
		in_dir("rm -rf %s/*");
	}
}

/* Neither a job without a text, nor a part of a text. */
static void a_long_text_that_does_not_fit_is_no_job(void **state)
{
	const struct rlimit small = { LONG / 2, RLIM_INFINITY };
	struct store *s = open_store();
	char *text = calloc(1, LONG);
	struct rlimit was;
	uint32_t n;

	(void)state;
	signal(SIGXFSZ, SIG_IGN);
	assert_int_equal(getrlimit(RLIMIT_FSIZE, &was), 0);
	assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
	assert_true(add_text(s, "long", text, LONG, &n) < 0);
	assert_int_equal(setrlimit(RLIMIT_FSIZE, &was), 0);
	assert_int_equal(state_in(s, "long"), JOB_NSTATES);
	assert_int_equal(store_text_bytes(s), 0);
	assert_int_equal(add_text(s, "long", text, LONG, &n), 0);
	assert_int_equal(fetch(s, n), 0);
	store_close(s);
	free(text);
}

/* A file stays as long as a job has it.  What a service that was killed left
 * goes at the next start. */
static void a_long_text_goes_with_its_last_job(void **state)
{
	char path[STORE_TEXT_PATH_MAX], other[STORE_TEXT_PATH_MAX];
	struct store *s;
	uint32_t n;

	(void)state;
	s = long_job(&n, path);
	store_text_path(s, "00", other);
	assert_int_equal(store_text_keep(other, "G1", 2), 0);
	in_dir("touch %s/m.text-00.a1b2c3");
	store_close(s);
	s = open_store();
	assert_int_equal(access(other, F_OK), -1);
	in_dir("! ls %s/m.text-00.*");
	assert_int_equal(fetch(s, n), 0);
	store_close(s);
	by_hand("DELETE FROM job");
	s = open_store();
	assert_int_equal(access(path, F_OK), -1);
	store_close(s);
}

/* A database that was set aside may have the job of it. */
static void a_long_text_stays_beside_a_damaged_database(void **state)
{
	char path[STORE_TEXT_PATH_MAX];
	struct store *s;
	uint32_t n;

	(void)state;
	s = long_job(&n, path);
	store_close(s);
	in_dir("rm -f %s/m.db*");
	in_dir("touch %s/m.db.damaged-20260101-000000");
	store_close(open_store());
	assert_int_equal(access(path, F_OK), 0);
	in_dir("rm %s/m.db.damaged-*");
	store_close(open_store());
	assert_int_equal(access(path, F_OK), -1);
}

static void retain_often(struct store *s, int64_t jobs)
{
	for (int64_t i = 1; i < 10; i++)
		store_retain(s, jobs, 0, 400 * INT64_C(86400000000) +
			     (i + jobs) * 20000000);
}

/* Two jobs have it, and the first to go leaves it to the other. */
static void two_jobs_of_the_same_long_text_share_it(void **state)
{
	char path[STORE_TEXT_PATH_MAX], *text = calloc(1, LONG);
	struct store *s;
	uint32_t n, other;

	(void)state;
	s = long_job(&n, path);
	end(s, n, JOB_DONE);
	many_jobs(s, 10);
	memset(text, ' ', LONG);
	assert_int_equal(add_text(s, "too", text, LONG, &other), 0);
	free(text);
	end(s, other, JOB_DONE);
	add(s, "queued", &n);
	for (int i = 0; i < 25; i++) {
		char id[32];

		snprintf(id, sizeof(id), "later-%d", i);
		assert_int_equal(add(s, id, &n), 0);
		end(s, n, JOB_DONE);
	}
	retain_often(s, 30);
	assert_int_equal(state_in(s, "long"), JOB_NSTATES);
	assert_int_equal(state_in(s, "too"), JOB_DONE);
	assert_int_equal(fetch(s, other), 0);
	retain_often(s, 20);
	assert_int_equal(state_in(s, "too"), JOB_NSTATES);
	assert_int_equal(access(path, F_OK), -1);
	store_close(s);
}

#define KILLS		20

/* The bytes of text @i, and the path that its hash says. */
static void text_of(struct store *s, int i, char *text,
		    char path[STORE_TEXT_PATH_MAX])
{
	unsigned char hash[32];
	char hex[65];

	memset(text, 'a' + i, LONG);
	crypto_hash_sha256(hash, (const unsigned char *)text, LONG);
	sodium_bin2hex(hex, sizeof(hex), hash, sizeof(hash));
	store_text_path(s, hex, path);
}

/* Which is killed while it writes, at any place. */
static void write_until_killed(struct store *s, char *text, int kill_us)
{
	char path[STORE_TEXT_PATH_MAX];
	const pid_t pid = fork();
	int status;

	if (pid == 0)
		for (int i = 0; ; i = (i + 1) % 3) {
			text_of(s, i, text, path);
			store_text_keep(path, text, LONG);
		}
	assert_true(pid > 0);
	usleep((useconds_t)kill_us);
	kill(pid, SIGKILL);
	assert_int_equal(waitpid(pid, &status, 0), pid);
}

static void a_long_text_is_there_as_a_whole_or_not_at_all(void **state)
{
	char path[STORE_TEXT_PATH_MAX], *text = malloc(LONG), *got;
	struct store *s = open_store();
	size_t bytes;

	(void)state;
	assert_non_null(text);
	for (int k = 0; k < KILLS; k++) {
		write_until_killed(s, text, 1 + k * 700);
		for (int i = 0; i < 3; i++) {
			text_of(s, i, text, path);
			if (access(path, F_OK) < 0)
				continue;
			assert_int_equal(store_text_fetch(path, &got, &bytes),
					 0);
			assert_int_equal(bytes, LONG);
			assert_memory_equal(got, text, LONG);
			free(got);
			unlink(path);
		}
	}
	store_close(s);
	free(text);
}

static void what_is_old_goes_but_never_the_last(void **state)
{
	const int64_t day_us = 86400ll * 1000000, t0 = 400 * day_us;
	struct store *s = open_store();
	struct store_size size;
	uint32_t n;

	(void)state;
	many_jobs(s, 100);
	assert_int_equal(add(s, "waits", &n), 0);
	for (int64_t i = 0; i < 20; i++)
		store_retain(s, 50, 0, t0 + i * 20000000);
	store_measure(s, &size);
	assert_int_equal(size.jobs, 51);
	assert_int_equal(state_in(s, "job-49"), JOB_NSTATES);
	assert_int_equal(state_in(s, "job-50"), JOB_DONE);
	/* The clock jumps by a year. */
	for (int64_t i = 0; i < 20; i++)
		store_retain(s, 50, 30, t0 + 365 * day_us + i * 20000000);
	store_measure(s, &size);
	assert_int_equal(size.jobs, 20);
	assert_int_equal(state_in(s, "waits"), JOB_QUEUED);
	assert_int_equal(state_in(s, "job-99"), JOB_DONE);
	store_close(s);
}

static void a_key_that_cannot_be_stored_is_not_kept(void **state)
{
	const struct trust_key k = { .name = "k", .role = ROLE_OPERATOR };
	struct store *s = open_store();

	(void)state;
	disk.n = 0;
	disk.fail_from = 0;
	disk.fail_rc = SQLITE_FULL;
	assert_int_equal(store_key_add(s, &k, 1), -ENOSPC);
	assert_int_equal(store_key_add(s, &k, 1), -ENOSPC);
	disk.fail_from = -1;
	assert_true(store_tick(s, 1));
	assert_int_equal(store_key_add(s, &k, 1), 0);
	assert_int_equal(store_key_add(s, &k, 1), -EEXIST);
	assert_string_equal(store_why(s), "");
	store_close(s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
#define T(f)	cmocka_unit_test_setup_teardown(f, setup, teardown)
		T(a_disk_that_fails_at_any_write_loses_no_truth),
		T(a_host_that_dies_at_any_write_leaves_a_store),
		T(a_long_text_costs_the_database_nothing),
		T(a_cut_that_never_ends_writes_little),
		T(the_list_in_memory_is_bounded_and_keeps_what_counts),
		T(a_full_disk_drops_nothing),
		T(many_events_of_a_full_disk_are_counted_and_left_out),
		T(many_events_of_a_copy_are_counted_and_left_out),
		T(what_is_written_over_a_full_disk_is_seen_by_us_alone),
		T(a_disk_that_is_full_again_loses_nothing),
		T(where_there_is_room_again_the_log_begins_anew),
		T(the_log_of_one_that_was_killed_begins_anew),
		T(a_full_disk_that_cannot_be_read_in_the_end_loses_nothing),
		T(a_disk_that_is_full_from_the_start_is_not_called_read_only),
		T(what_was_kept_comes_in_pieces_and_at_once),
		T(what_is_written_between_the_pieces_comes_with_them),
		T(a_disk_that_fails_between_the_pieces_loses_nothing),
		T(a_service_that_ends_between_the_pieces_brings_them_all),
		T(a_store_of_0_1_0_is_brought_up),
		T(a_store_without_sums_by_condition_is_brought_up),
		T(what_a_job_came_to_goes_with_it),
		T(a_long_list_comes_in_pages),
		T(a_page_costs_what_is_in_it),
		T(a_job_costs_the_same_beside_ten_times_as_many),
		T(a_damaged_page_costs_what_is_in_it),
		T(a_database_that_is_gone_is_told),
		T(a_log_that_lost_its_end_is_told),
		T(a_log_that_is_whole_is_no_loss),
		T(a_new_folder_is_no_loss),
		T(links_and_fifos_are_not_opened),
		T(what_is_no_database_is_set_aside),
		T(the_first_page_torn_is_no_end),
		T(a_text_of_other_bytes_is_not_cut),
		T(a_long_text_that_was_damaged_is_not_cut),
		T(a_long_text_that_does_not_fit_is_no_job),
		T(a_long_text_goes_with_its_last_job),
		T(a_long_text_stays_beside_a_damaged_database),
		T(two_jobs_of_the_same_long_text_share_it),
		T(a_long_text_is_there_as_a_whole_or_not_at_all),
		T(what_is_old_goes_but_never_the_last),
		T(a_key_that_cannot_be_stored_is_not_kept),
	};

	if (sodium_init() < 0)
		return 1;
	disk_install();
	return cmocka_run_group_tests(tests, NULL, NULL);
}
