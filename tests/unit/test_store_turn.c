/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_store_turn.c - what is done to one job costs the same in a long queue
 */
#include "folder_help.h"
#include "store.h"
#include "store_sql.h"
#include "store_turn.h"

#include <errno.h>
#include <setjmp.h>
#include <sodium.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

static struct store *open_store(void)
{
	struct store *s = NULL;

	assert_int_equal(store_open(&s, folder, "m"), 0);
	return s;
}

/* Jobs that have ended, and as many that wait; each had an event, and the first
 * twenty an alarm. */
static const char fill[] =
	"DELETE FROM job; DELETE FROM event; DELETE FROM sqlite_sequence;"
	"WITH RECURSIVE i(k) AS (SELECT 1 UNION ALL SELECT k + 1 FROM i WHERE "
	"k < 2 * %d) INSERT INTO job(id, name, sha256, lines, hold, "
	"submitted_us, state, ended_us) SELECT 'job-' || k, 'part', k, 1, 0, 1,"
	" iif(k <= %d, 'done', 'queued'), iif(k <= %d, k, 0) FROM i;"
	"INSERT INTO event SELECT n, iif(n <= 20, 'alarm', 'note'), id, '', 0, "
	"'' FROM job;";

/* By SQLite itself, while no store is open: @count jobs of each. */
static struct store *open_with(int count)
{
	char path[64], sql[700];
	sqlite3 *db = NULL;

	store_close(open_store());
	snprintf(path, sizeof(path), "%s/m.db", folder);
	snprintf(sql, sizeof(sql), fill, count, count, count);
	assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
	assert_int_equal(sqlite3_exec(db, sql, NULL, NULL, NULL), SQLITE_OK);
	sqlite3_close(db);
	return open_store();
}

/* Job @n waits in the middle of the queue. */
static void move_ahead(struct store *s, uint32_t n)
{
	assert_int_equal(store_move(s, n, true), 0);
}

static void move_back(struct store *s, uint32_t n)
{
	assert_int_equal(store_move(s, n, false), 0);
}

static void head(struct store *s, uint32_t n)
{
	struct store_job job;

	(void)n;
	assert_int_equal(store_head(s, &job), 0);
}

static void remove_one(struct store *s, uint32_t n)
{
	assert_int_equal(store_end(s, n, &(struct store_end) {
		.state = JOB_STOPPED, .reason = "removed", .now_us = 5000,
	}), 0);
}

static void count(struct store *s, uint32_t n)
{
	(void)n;
	assert_int_not_equal(store_waiting(s), 0);
}

static void loaded(struct store *s, uint32_t n)
{
	struct store_job job;

	(void)n;
	assert_int_equal(store_loaded(s, &job), -ENOENT);
}

static void interrupted(struct store *s, uint32_t n)
{
	struct store_job job;

	(void)n;
	assert_int_equal(store_interrupted(s, &job), -ENOENT);
}

/* Ten may go at once. */
static void retain(struct store *s, int64_t jobs, int64_t days)
{
	struct store_size before, after;

	store_measure(s, &before);
	store_retain(s, jobs, days, 5000 + INT64_C(86400000000));
	store_measure(s, &after);
	assert_int_equal(before.jobs - after.jobs, 10);
}

static void retain_jobs(struct store *s, uint32_t n)
{
	(void)n;
	retain(s, 10, 0);
}

static void retain_days(struct store *s, uint32_t n)
{
	(void)n;
	retain(s, 0, 1);
}

static void list(struct store *s, enum store_list what, uint32_t first)
{
	char *text = store_json(s, what, "", 20), wanted[32];

	snprintf(wanted, sizeof(wanted), "\"job-%u\"", first);
	assert_non_null(text);
	assert_ptr_equal(strstr(text, "\"job-"), strstr(text, wanted));
	free(text);
}

static void alarms(struct store *s, uint32_t n)
{
	(void)n;
	list(s, STORE_ALARMS, 20);
}

/* The last job had the last one; @n is in the middle of those that wait. */
static void events(struct store *s, uint32_t n)
{
	list(s, STORE_EVENTS, n / 3 * 4);
}

static void load(struct store *s, uint32_t n)
{
	assert_int_equal(store_set_loaded(s, n, true), 0);
}

static const struct deed {
	const char *name;
	void (*do_it)(struct store *s, uint32_t n);
} deeds[] = {
	{ "a move ahead", move_ahead },
	{ "a move back", move_back },
	{ "a removal", remove_one },
	{ "the next one", head },
	{ "the count of those that wait", count },
	{ "the one that is loaded", loaded },
	{ "the one that was interrupted", interrupted },
	{ "loading", load },
	{ "what may go from the history, by number", retain_jobs },
	{ "what may go from the history, by days", retain_days },
	{ "the last alarms", alarms },
	{ "the last events", events },
};

static int count_step(void *arg)
{
	++*(long *)arg;
	return 0;
}

static long steps_of(const struct deed *d, int count)
{
	struct store *s = open_with(count);
	long steps = 0;

	sqlite3_progress_handler(s->db, 1, count_step, &steps);
	d->do_it(s, (uint32_t)(count + count / 2));
	sqlite3_progress_handler(s->db, 0, NULL, NULL);
	store_close(s);
	return steps;
}

static void what_is_done_to_one_job_costs_the_same_in_a_long_queue(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof(deeds) / sizeof(deeds[0]); i++) {
		const long few = steps_of(&deeds[i], 20);
		const long many = steps_of(&deeds[i], 20000);

		print_message("%s: %ld steps beside 20 jobs, %ld beside "
			      "20,000\n", deeds[i].name, few, many);
		assert_in_range(many, 1, 2 * few);
	}
}

static uint32_t add(struct store *s, const char *id)
{
	uint32_t n;

	assert_int_equal(store_add(s, &(struct store_new) {
		.id = id, .name = id, .sha256 = "", .tech_sha256 = "",
		.text = "M2\n", .bytes = 3, .lines = 1, .now_us = 1000,
	}, &n), 0);
	return n;
}

static void assert_queue(struct store *s, const char *order)
{
	char *text = store_json(s, STORE_QUEUE, "", 0), *at = text;

	assert_non_null(text);
	for (; (at = strstr(at, "\"job\":\"")); order++) {
		at += 7;
		assert_int_equal(*at, *order);
	}
	assert_int_equal(*order, '\0');
	free(text);
}

static void a_move_passes_what_does_not_wait(void **state)
{
	struct store *s = open_store();
	uint32_t n[5];

	(void)state;
	for (size_t i = 0; i < 5; i++)
		n[i] = add(s, (const char *[]){ "a", "b", "c", "d", "e" }[i]);
	assert_int_equal(store_set_loaded(s, n[0], true), 0);
	assert_int_equal(store_set_state(s, n[0], JOB_READY), 0);
	assert_int_equal(store_set_state(s, n[2], JOB_INTERRUPTED), 0);
	assert_int_equal(store_move(s, n[3], true), 0);
	assert_queue(s, "adcbe");
	assert_int_equal(store_move(s, n[3], true), -ENOENT);
	assert_int_equal(store_move(s, n[3], false), 0);
	assert_int_equal(store_move(s, n[3], false), 0);
	assert_int_equal(store_move(s, n[3], false), -ENOENT);
	assert_queue(s, "abced");
	store_close(s);
}

static void a_job_goes_before_or_behind_all_that_wait(void **state)
{
	struct store *s = open_store();
	uint32_t n[5];

	(void)state;
	for (size_t i = 0; i < 5; i++)
		n[i] = add(s, (const char *[]){ "a", "b", "c", "d", "e" }[i]);
	assert_int_equal(store_set_loaded(s, n[0], true), 0);
	assert_int_equal(store_set_state(s, n[0], JOB_READY), 0);
	assert_int_equal(store_set_state(s, n[2], JOB_INTERRUPTED), 0);
	assert_int_equal(store_move_all(s, n[4], true), 0);
	assert_queue(s, "aecbd");
	assert_int_equal(store_move_all(s, n[4], false), 0);
	assert_queue(s, "abcde");
	/* The next one comes behind it all the same. */
	assert_int_equal(store_move_all(s, n[1], false), 0);
	add(s, "f");
	assert_queue(s, "adcebf");
	store_close(s);
}

static int64_t number(struct store *s, const char *sql)
{
	sqlite3_stmt *q = NULL;
	int64_t n;

	assert_int_equal(sqlite3_prepare_v2(s->db, sql, -1, &q, NULL), 0);
	assert_int_equal(sqlite3_step(q), SQLITE_ROW);
	n = sqlite3_column_int64(q, 0);
	sqlite3_finalize(q);
	return n;
}

static int64_t counted(struct store *s, const char *which)
{
	char sql[100];

	snprintf(sql, sizeof(sql), "SELECT count(*) FROM job WHERE %s", which);
	return number(s, sql);
}

static void assert_counts(struct store *s)
{
	assert_int_equal(store_waiting(s),
			 counted(s, "state='queued' AND loaded=0"));
	assert_int_equal(store_number_of(s, -1, "SELECT ended FROM job_count",
					 ""),
			 counted(s, "state IN (" STORE_ENDED ")"));
}

/* Job 1 has the oldest event; then come 250 of no job. */
static void an_event_without_a_job_is_not_kept_for_ever(void **state)
{
	struct store *s = open_with(30);

	(void)state;
	assert_int_equal(sqlite3_exec(s->db,
		"DELETE FROM event WHERE rowid > 1;"
		"WITH RECURSIVE i(k) AS (SELECT 1 UNION ALL SELECT k + 1 FROM "
		"i WHERE k < 100200) INSERT INTO event SELECT k, 'note', "
		"iif(k <= 250, '', 'job-2'), '', 0, '' FROM i",
		NULL, NULL, NULL), SQLITE_OK);
	for (int64_t turn = 1; turn <= 4; turn++)
		store_retain(s, 0, 0, turn * 20000000);
	assert_int_equal(number(s, "SELECT count(*) FROM event WHERE job=''"),
			 50);
	assert_int_equal(number(s, "SELECT count(*) FROM event"), 100001);
	store_close(s);
}

/* Through every state, also where it is not written in the end. */
static void the_counts_follow_the_jobs(void **state)
{
	struct store *s = open_with(30);

	(void)state;
	assert_counts(s);
	for (uint32_t n = 1; n <= 60; n++) {
		const bool together = n % 3 == 0;

		if (together)
			store_together(s, true);
		store_set_state(s, n, (enum job_state)(n % JOB_NSTATES));
		store_set_loaded(s, n, n % 5 == 0);
		assert_counts(s);
		if (together)
			store_undo(s);
		assert_counts(s);
		if (n == 40)
			store_degrade(s, -ENOSPC);
	}
	store_close(s);
}

static int statements;

static int note_statement(unsigned int what, void *arg, void *p, void *x)
{
	(void)what, (void)arg, (void)p, (void)x;
	statements++;
	return 0;
}

static int note_statements(sqlite3 *db)
{
	return sqlite3_trace_v2(db, SQLITE_TRACE_STMT, note_statement, NULL);
}

/* Row by row, 10,000 jobs with their history would keep the loop for 0.8 s. */
static void all_is_taken_into_memory_by_tables(void **state)
{
	struct store *s = open_with(1000);
	struct store_size before, after;

	(void)state;
	store_measure(s, &before);
	statements = 0;
	sqlite3_auto_extension((void (*)(void))note_statements);
	store_degrade(s, -EROFS);
	sqlite3_reset_auto_extension();
	assert_in_range(statements, 1, 500);
	store_measure(s, &after);
	assert_int_equal(after.jobs, before.jobs);
	assert_int_equal(store_waiting(s), 1000);
	store_close(s);
}

struct over {
	long steps;			/* of SQLite */
	int64_t bytes;			/* of memory */
};

/* The disk becomes full beside so many jobs, and is full no more. */
static struct over go_over_beside(int count)
{
	struct store *s = open_with(count);
	const sqlite3 *db = s->db;
	struct over o = { .steps = 0 };

	o.bytes = -sqlite3_memory_used();
	sqlite3_progress_handler(s->db, 1, count_step, &o.steps);
	store_degrade(s, -ENOSPC);
	store_set_number(s, "n", 1);
	assert_int_equal(store_waiting(s), count);
	o.bytes += sqlite3_memory_used();
	assert_ptr_equal(s->db, db);
	assert_true(store_tick(s, 10000000));
	sqlite3_progress_handler(s->db, 0, NULL, NULL);
	assert_int_equal(store_number(s, "n", 0), 1);
	store_close(s);
	return o;
}

static void over_a_full_disk_no_row_is_copied(void **state)
{
	const struct over few = go_over_beside(20);
	const struct over many = go_over_beside(20000);

	(void)state;
	print_message("a full disk: %ld steps beside 20 jobs, %ld beside "
		      "20,000\n", few.steps, many.steps);
	assert_in_range(many.steps, 1, few.steps + 10);
	assert_true(many.bytes < 65536);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
#define T(f)	cmocka_unit_test_setup_teardown(f, folder_make, folder_remove)
		T(what_is_done_to_one_job_costs_the_same_in_a_long_queue),
		T(a_move_passes_what_does_not_wait),
		T(a_job_goes_before_or_behind_all_that_wait),
		T(an_event_without_a_job_is_not_kept_for_ever),
		T(the_counts_follow_the_jobs),
		T(all_is_taken_into_memory_by_tables),
		T(over_a_full_disk_no_row_is_copied),
	};

	if (sodium_init() < 0)
		return 1;
	return cmocka_run_group_tests(tests, NULL, NULL);
}
