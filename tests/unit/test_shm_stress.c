/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_shm_stress.c - the crossings between threads, with a writer and a reader
 * at full speed
 *
 * They are far faster than the cycle of any machine, so that readers are
 * overtaken.  The thread sanitizer finds nothing; it sees everything but the
 * sequence counter of a snapshot, which is inline assembly of ConcurrencyKit.
 * What that counter guards is compared here word by word.
 */
#include "shm.h"

#include <pthread.h>
#include <sched.h>
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

/*
 * Counts, not times: on a busy machine the writer may get no processor for
 * longer than any time that a test would like to wait.
 */
#define SNAPSHOTS	200000u		/* written, while some are read */
#define READS		20000u		/* of snapshots, at least */
#define BEHIND_EVERY	5000u		/* records read, then fall behind */
#define BEHIND_TIMES	3u
#define COMMANDS	200000u

static char machine[SHM_NAME_MAX];

struct stress {
	struct shm_status *status;
	struct shm_commands *commands;
	int fd;
	bool end;
	uint64_t written;
};

/* Every word tells of @n, so a torn one shows. */
static struct shm_snapshot snapshot_of(uint64_t n)
{
	struct shm_snapshot s = { .cycle = n };
	double d = (double)n;

	s.time_ns = (int64_t)(n * 3);
	s.line = (uint32_t)n;
	s.seg = s.tick = (uint32_t)~n;
	for (int a = 0; a < SHM_NAXES; a++) {
		s.pos[a] = (int32_t)(n + (uint64_t)a);
		s.pulse_mm[a] = d;
	}
	s.place_mm = s.far_mm = s.length_mm = d;
	s.feed_mm_s = s.gap_v = s.depth_mm = -d;
	s.job_cycles = s.erode_cycles = s.jump_cycles = n;
	s.retract_mm_max = d;
	s.took_ns = s.took_max_ns = (int64_t)n;
	return s;
}

static void *write_status(void *arg)
{
	struct stress *st = arg;

	while (!__atomic_load_n(&st->end, __ATOMIC_RELAXED)) {
		struct shm_snapshot s = snapshot_of(++st->written);

		shm_publish(st->status, &s);
	}
	return NULL;
}

static struct stress stress_status(void)
{
	struct stress st = { .status = NULL };
	struct shm_snapshot before;

	assert_int_equal(shm_status_create(&st.status, machine, &before), 0);
	return st;
}

/* From here on there is something to read. */
static void stress_start(struct stress *st, pthread_t *t)
{
	struct shm_snapshot s;

	assert_int_equal(pthread_create(t, NULL, write_status, st), 0);
	while (!shm_snapshot(st->status, &s))
		sched_yield();
}

/* A reader that does something else until it is behind by a whole ring. */
static void fall_behind(const struct stress *st, const struct shm_follow *f)
{
	const uint64_t *next = &st->status->trace_next;

	while (__atomic_load_n(next, __ATOMIC_RELAXED) <=
	       f->next + SHM_TRACE_SLOTS)
		sched_yield();
}

static void stress_end(struct stress *st, pthread_t t)
{
	__atomic_store_n(&st->end, true, __ATOMIC_RELAXED);
	pthread_join(t, NULL);
}

static void no_snapshot_is_ever_torn_or_older_than_the_last(void **state)
{
	pthread_t t;
	struct stress st = stress_status();
	uint64_t got = 0, none = 0, last = 0;

	(void)state;
	stress_start(&st, &t);
	while (got < READS || last < SNAPSHOTS) {
		struct shm_snapshot s, want;

		/* This writer never rests, so every try may be overtaken. */
		if (!shm_snapshot(st.status, &s)) {
			none++;
			continue;
		}
		want = snapshot_of(s.cycle);
		assert_memory_equal(&s, &want, sizeof(s));
		assert_true(s.cycle >= last);
		last = s.cycle;
		got++;
	}
	stress_end(&st, t);
	print_message("snapshots: %llu written, %llu read, %llu not there\n",
		      (unsigned long long)st.written, (unsigned long long)got,
		      (unsigned long long)none);
	shm_status_destroy(st.status, machine);
}

static void no_trace_record_is_torn_and_none_lost_uncounted(void **state)
{
	pthread_t t;
	struct stress st = stress_status();
	struct shm_follow f = { 0 };
	struct shm_trace r;
	uint64_t got = 0, last = 0, behind = 0;
	bool more = true;

	(void)state;
	stress_start(&st, &t);
	while (more || !st.end) {
		if (!st.end && behind == BEHIND_TIMES)
			stress_end(&st, t);
		more = shm_trace_next(st.status, &f, &r);
		if (!more)
			continue;
		assert_true(r.cycle > last);
		assert_true(r.place_mm == (double)r.cycle);
		assert_true(r.gap_v == -(double)r.cycle);
		assert_int_equal(r.line, (uint32_t)r.cycle);
		assert_int_equal(r.pos[7], (int32_t)(r.cycle + 7));
		last = r.cycle;
		if (++got % BEHIND_EVERY == 0 && !st.end) {
			fall_behind(&st, &f);
			behind++;
		}
	}
	print_message("trace: %llu written, %llu read, %llu lost\n",
		      (unsigned long long)st.written, (unsigned long long)got,
		      (unsigned long long)f.lost);
	assert_int_equal(last, st.written);
	assert_int_equal(got + f.lost, st.written);
	assert_true(f.lost > 0);
	shm_status_destroy(st.status, machine);
}

static void *write_commands(void *arg)
{
	struct stress *st = arg;

	for (uint32_t id = 1; id <= COMMANDS; id++) {
		struct shm_command c = {
			.id = id, .verb = ~id, .arg = id * 3,
			.arg_mm = (double)id,
		};

		while (shm_command_put(st->fd, &c) < 0)
			sched_yield();
	}
	return NULL;
}

static void every_command_comes_once_in_order_and_whole(void **state)
{
	struct stress st = { .status = NULL };
	uint64_t empty = 0;
	uint32_t instance;
	pthread_t t;
	int err;

	(void)state;
	assert_int_equal(shm_command_create(&st.commands, machine, 1), 0);
	/* The thread that answers may be held up. */
	do
		err = shm_command_open(&st.fd, machine, &instance);
	while (err == -EAGAIN);
	assert_int_equal(err, 0);
	assert_int_equal(instance, 1);
	assert_int_equal(pthread_create(&t, NULL, write_commands, &st), 0);
	for (uint32_t id = 1; id <= COMMANDS; id++) {
		struct shm_command c;

		while (!shm_command_take(st.commands, &c)) {
			empty++;
			sched_yield();
		}
		assert_int_equal(c.id, id);
		assert_int_equal(c.verb, ~id);
		assert_int_equal(c.arg, id * 3);
		assert_true(c.arg_mm == (double)id);
	}
	pthread_join(t, NULL);
	print_message("commands: %u, found none %llu times\n",
		      COMMANDS, (unsigned long long)empty);
	close(st.fd);
	shm_command_destroy(st.commands);
}

/* A test that fails leaves its objects: nobody else knows their names. */
static int remove_objects(void **state)
{
	static const char *const what[] = { "status", "command" };
	char path[sizeof("/dev/shm/edmd..command") + SHM_NAME_MAX];

	(void)state;
	for (size_t i = 0; i < sizeof(what) / sizeof(what[0]); i++) {
		snprintf(path, sizeof(path), "/dev/shm/edmd.%s.%s", machine,
			 what[i]);
		unlink(path);
	}
	return 0;
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(no_snapshot_is_ever_torn_or_older_than_the_last),
		cmocka_unit_test(no_trace_record_is_torn_and_none_lost_uncounted),
		cmocka_unit_test(every_command_comes_once_in_order_and_whole),
	};

	snprintf(machine, sizeof(machine), "stress-%d", (int)getpid());
	return cmocka_run_group_tests_name("shm_stress", tests, NULL,
					   remove_objects);
}
