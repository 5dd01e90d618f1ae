/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_shm.c - the shared objects, as daemon/shm/shm.h promises them
 *
 * Status, trace and events; the machine is named by the test's process.
 * Commands and programs are in test_shm_command.c, all of it under load in
 * test_shm_stress.c.
 */
#include "cycle.h"
#include "shm.h"

#include <errno.h>
#include <fcntl.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

static char machine[SHM_NAME_MAX];

static struct shm_snapshot snapshot_of(uint64_t n)
{
	struct shm_snapshot s = { .cycle = n, .state = SHM_ERODE };

	s.place_mm = (double)n * 0.5;
	s.line = (uint32_t)n;
	s.took_max_ns = (int64_t)n * 3;
	s.pos[SHM_NAXES - 1] = -(int32_t)n;
	return s;
}

static struct shm_status *status_new(void)
{
	struct shm_snapshot before;
	struct shm_status *s;

	assert_int_equal(shm_status_create(&s, machine, &before), 0);
	return s;
}

static const struct shm_status *status_open(void)
{
	const struct shm_status *s;

	assert_int_equal(shm_status_open(&s, machine), 0);
	return s;
}

/* A process that owns the status, does @work on it and stays. */
static pid_t owner_start(void (*work)(struct shm_status *s))
{
	int ready[2];
	char byte;
	pid_t pid;

	assert_int_equal(pipe(ready), 0);
	pid = fork();
	assert_true(pid >= 0);
	if (pid == 0) {
		struct shm_snapshot before;
		struct shm_status *s;

		if (shm_status_create(&s, machine, &before) < 0)
			_exit(1);
		work(s);
		if (write(ready[1], "", 1) != 1)
			_exit(1);
		for (;;)
			pause();
	}
	close(ready[1]);
	assert_int_equal(read(ready[0], &byte, 1), 1);
	close(ready[0]);
	return pid;
}

static void owner_kill(pid_t pid)
{
	kill(pid, SIGKILL);
	assert_int_equal(waitpid(pid, NULL, 0), pid);
}

static void object_name(char name[64], const char *what)
{
	snprintf(name, 64, "/edmd.%s.%s", machine, what);
}

static int object_fd(const char *what)
{
	char name[64];
	int fd;

	object_name(name, what);
	fd = shm_open(name, O_RDWR, 0);
	assert_true(fd >= 0);
	return fd;
}

static mode_t object_mode(const char *what)
{
	char path[96];
	struct stat st;

	snprintf(path, sizeof(path), "/dev/shm/edmd.%s.%s", machine, what);
	assert_int_equal(stat(path, &st), 0);
	return st.st_mode & 07777;
}

static void shared_structs_keep_their_size(void **state)
{
	(void)state;
	assert_int_equal(sizeof(struct shm_head), 56);
	assert_int_equal(sizeof(struct shm_snapshot), 1064);
	assert_int_equal(sizeof(struct shm_trace), 136);
	assert_int_equal(sizeof(struct shm_trace_slot), 144);
	assert_int_equal(sizeof(struct shm_event), 64);
	assert_int_equal(sizeof(struct shm_event_slot), 72);
	assert_int_equal(sizeof(struct shm_snap), 1072);
	assert_int_equal(sizeof(struct shm_sets_slot), 1048);
	assert_int_equal(sizeof(struct shm_drives), 1272);
	assert_int_equal(sizeof(struct shm_command), 40);
	assert_int_equal(sizeof(struct shm_done_slot), 24);
	assert_int_equal(sizeof(struct shm_ended_slot), 136);
	assert_int_equal(offsetof(struct shm_status, trace),
			 8952 + 256 * 24 + 64 * 136);
	assert_int_equal(sizeof(struct shm_status),
			 8952 + 256 * 24 + 64 * 136 + 16384 * 144 + 1024 * 72);
}

static void names_are_those_of_the_cycle(void **state)
{
	(void)state;
	for (unsigned int i = STATE_IDLE; i < CYCLE_NSTATES; i++)
		assert_string_equal(shm_state_name(i), state_duty[i].name);
	assert_string_equal(shm_state_name(0), "?");
	assert_string_equal(shm_state_name(CYCLE_NSTATES), "?");
}

static void a_machine_name_with_other_characters_is_refused(void **state)
{
	static const char *const bad[] = {
		"", "a/b", "..", "a.b", "a b", "\303\244",
		"12345678901234567890123456789012",
	};

	(void)state;
	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
		struct shm_commands *r;
		uint32_t instance;
		int fd;
		const struct shm_status *c;
		struct shm_snapshot before;
		struct shm_status *s;
		void *block;

		assert_int_equal(shm_status_create(&s, bad[i], &before),
				 -EINVAL);
		assert_int_equal(shm_status_open(&c, bad[i]), -EINVAL);
		assert_int_equal(shm_command_create(&r, bad[i], 1), -EINVAL);
		assert_int_equal(shm_command_open(&fd, bad[i], &instance),
				 -EINVAL);
		assert_int_equal(shm_program_create(&block, bad[i], 1, 8),
				 -EINVAL);
	}
}

static void objects_are_for_owner_and_group_alone(void **state)
{
	mode_t before = umask(0077);
	struct shm_status *s = status_new();
	struct shm_commands *r;
	void *block;

	(void)state;
	assert_int_equal(shm_command_create(&r, machine, 1), 0);
	assert_int_equal(shm_program_create(&block, machine, 1, 8), 0);
	umask(before);
	assert_int_equal(object_mode("status"), 0640);
	assert_int_equal(object_mode("command"), 0660);
	assert_int_equal(object_mode("program.1"), 0640);
	shm_program_unmap(block, 8);
	shm_program_remove(machine, 1);
	shm_command_destroy(r);
	shm_status_destroy(s, machine);
}

static void a_snapshot_is_read_as_it_was_published(void **state)
{
	struct shm_status *s = status_new();
	const struct shm_status *seen = status_open();
	struct shm_snapshot got;

	(void)state;
	assert_false(shm_snapshot(seen, &got));
	for (uint64_t n = 1; n < 10; n++) {
		struct shm_snapshot put = snapshot_of(n);

		shm_publish(s, &put);
		assert_true(shm_snapshot(seen, &got));
		assert_memory_equal(&got, &put, sizeof(got));
	}
	shm_close(seen, sizeof(*seen));
	shm_status_destroy(s, machine);
	assert_int_equal(shm_status_open(&seen, machine), -ENOENT);
}

static void publish_seven(struct shm_status *s)
{
	for (uint64_t n = 1; n <= 7; n++) {
		struct shm_snapshot put = snapshot_of(n);

		shm_publish(s, &put);
	}
}

/* As if killed while cycle 8 was half in its slot. */
static void publish_seven_and_a_half(struct shm_status *s)
{
	publish_seven(s);
	s->snap[1].stamp = 2 * 7 + 1;
	memset(&s->snap[1].record, 0xff, sizeof(s->snap[1].record) / 2);
}

static void a_living_owner_is_not_displaced(void **state)
{
	pid_t pid = owner_start(publish_seven);
	struct shm_snapshot before;
	struct shm_status *s;

	(void)state;
	assert_int_equal(shm_status_create(&s, machine, &before), -EBUSY);
	owner_kill(pid);
	assert_int_equal(shm_status_create(&s, machine, &before), 0);
	shm_status_destroy(s, machine);
}

static void a_killed_owner_leaves_its_last_snapshot(void **state)
{
	pid_t pid = owner_start(publish_seven);
	const struct shm_status *seen = status_open();
	uint32_t instance = seen->head.instance;
	struct shm_snapshot before, want = snapshot_of(7);
	struct shm_status *s;

	(void)state;
	owner_kill(pid);
	assert_int_equal(shm_status_create(&s, machine, &before), 0);
	assert_memory_equal(&before, &want, sizeof(want));
	/* The reader's mapping is still the object; the rings go on. */
	assert_int_not_equal(seen->head.instance, instance);
	assert_int_equal(seen->head.pid, getpid());
	assert_int_equal(seen->trace_next, 7);
	/* Still there for whoever comes after one killed before its first. */
	assert_true(shm_snapshot(seen, &before));
	assert_memory_equal(&before, &want, sizeof(want));
	/* A lower cycle of the new owner is the newer one. */
	want = snapshot_of(1);
	shm_publish(s, &want);
	assert_true(shm_snapshot(seen, &before));
	assert_memory_equal(&before, &want, sizeof(want));
	shm_close(seen, sizeof(*seen));
	shm_status_destroy(s, machine);
}

static void a_half_written_snapshot_is_never_returned(void **state)
{
	pid_t pid = owner_start(publish_seven_and_a_half);
	struct shm_snapshot before, want = snapshot_of(7);
	struct shm_status *s;

	(void)state;
	owner_kill(pid);
	assert_int_equal(shm_status_create(&s, machine, &before), 0);
	assert_memory_equal(&before, &want, sizeof(want));
	for (uint64_t n = 1; n < 5; n++) {
		want = snapshot_of(n);
		shm_publish(s, &want);
		assert_true(shm_snapshot(s, &before));
		assert_memory_equal(&before, &want, sizeof(want));
	}
	shm_status_destroy(s, machine);
}

static void a_status_that_finds_no_room_leaves_nothing(void **state)
{
	const struct rlimit none = { 0, RLIM_INFINITY };
	struct rlimit was;
	struct shm_snapshot before;
	struct shm_status *s;
	char name[64];

	(void)state;
	assert_int_equal(getrlimit(RLIMIT_FSIZE, &was), 0);
	signal(SIGXFSZ, SIG_IGN);
	assert_int_equal(setrlimit(RLIMIT_FSIZE, &none), 0);
	assert_int_equal(shm_status_create(&s, machine, &before), -EFBIG);
	assert_int_equal(setrlimit(RLIMIT_FSIZE, &was), 0);
	snprintf(name, sizeof(name), "/dev/shm/edmd.%s.status", machine);
	assert_int_equal(access(name, F_OK), -1);
}

static void put_sets(struct shm_status *s, uint64_t n)
{
	const struct shm_sets sets = {
		.program_key = 99, .n = n, .set[0] = { 1.5, 2, 3 },
	};

	shm_sets_put(s, &sets);
}

/* Killed in the middle of the third. */
static void put_two_sets_and_a_half(struct shm_status *s)
{
	put_sets(s, 1);
	put_sets(s, 2);
	put_sets(s, 3);
	s->sets_next = 2;
	s->sets[0].stamp = 5;
}

static void half_written_sets_leave_those_before(void **state)
{
	pid_t pid = owner_start(put_two_sets_and_a_half);
	struct shm_snapshot before;
	struct shm_status *s;
	struct shm_sets got;

	(void)state;
	owner_kill(pid);
	assert_int_equal(shm_status_create(&s, machine, &before), 0);
	assert_true(shm_sets(s, &got));
	assert_int_equal(got.n, 2);
	assert_int_equal(got.program_key, 99);
	assert_int_equal(got.set[0].field, 3);
	put_sets(s, 4);
	assert_true(shm_sets(s, &got));
	assert_int_equal(got.n, 4);
	shm_status_destroy(s, machine);
}

static void alive_means_the_writer_of_this_object(void **state)
{
	pid_t pid = owner_start(publish_seven);
	const struct shm_status *seen = status_open();
	char name[64];

	(void)state;
	assert_true(shm_alive(seen));
	owner_kill(pid);
	assert_false(shm_alive(seen));

	/* One that was made anew is another object with another writer. */
	object_name(name, "status");
	shm_unlink(name);
	pid = owner_start(publish_seven);
	assert_false(shm_alive(seen));
	shm_close(seen, sizeof(*seen));
	seen = status_open();
	assert_true(shm_alive(seen));
	owner_kill(pid);
	shm_close(seen, sizeof(*seen));
	shm_unlink(name);
}

static void another_layout_size_or_magic_is_refused(void **state)
{
	struct shm_status *s = status_new();
	const struct shm_status *seen;
	int fd = object_fd("status");

	(void)state;
	s->head.layout++;
	assert_int_equal(shm_status_open(&seen, machine), -EPROTO);
	s->head.layout--;
	s->head.magic ^= 1;
	assert_int_equal(shm_status_open(&seen, machine), -EPROTO);
	s->head.magic ^= 1;
	s->head.bytes++;
	assert_int_equal(shm_status_open(&seen, machine), -EPROTO);
	s->head.bytes--;
	assert_int_equal(shm_status_open(&seen, machine), 0);
	shm_close(seen, sizeof(*seen));
	assert_int_equal(ftruncate(fd, (off_t)sizeof(*s) + 4096), 0);
	assert_int_equal(shm_status_open(&seen, machine), -EPROTO);
	close(fd);
	shm_status_destroy(s, machine);
}

static void spoil_layout(struct shm_status *s)
{
	publish_seven(s);
	s->head.layout++;
}

static void an_object_of_another_layout_is_replaced(void **state)
{
	pid_t pid = owner_start(spoil_layout);
	struct shm_snapshot before;
	struct shm_status *s;

	(void)state;
	owner_kill(pid);
	assert_int_equal(shm_status_create(&s, machine, &before), 0);
	assert_int_equal(before.cycle, 0);
	assert_int_equal(s->trace_next, 0);
	shm_status_destroy(s, machine);
}

static void a_reader_gets_every_trace_record_in_order(void **state)
{
	struct shm_status *s = status_new();
	struct shm_follow f = { 0 }, late = { 0 };
	struct shm_trace t;

	(void)state;
	for (uint64_t n = 1; n <= 100; n++) {
		struct shm_snapshot put = snapshot_of(n);

		shm_publish(s, &put);
	}
	for (uint64_t n = 1; n <= 100; n++) {
		assert_true(shm_trace_next(s, &f, &t));
		assert_int_equal(t.cycle, n);
		assert_int_equal(t.line, n);
		assert_int_equal(t.pos[SHM_NAXES - 1], -(int64_t)n);
	}
	assert_false(shm_trace_next(s, &f, &t));
	assert_int_equal(f.lost, 0);
	late.next = s->trace_next;
	assert_false(shm_trace_next(s, &late, &t));
	shm_status_destroy(s, machine);
}

static void a_slow_reader_is_told_how_many_it_lost(void **state)
{
	struct shm_status *s = status_new();
	struct shm_follow f = { 0 };
	uint64_t got = 0, last = 0;
	struct shm_event e = { .kind = SHM_EV_STATE };

	(void)state;
	for (uint32_t n = 0; n < 3 * SHM_EVENT_SLOTS; n++) {
		e.id = n;
		shm_event(s, &e);
	}
	while (shm_event_next(s, &f, &e)) {
		assert_true(got == 0 || e.id == last + 1);
		last = e.id;
		got++;
	}
	assert_int_equal(last, 3 * SHM_EVENT_SLOTS - 1);
	assert_int_equal(got + f.lost, 3 * SHM_EVENT_SLOTS);
	assert_true(got > SHM_EVENT_SLOTS / 2);
	shm_status_destroy(s, machine);
}

/* Who made it may cut it short under its readers. */
static void a_status_of_another_user_is_not_read(void **state)
{
	const struct shm_status *seen;
	struct shm_snapshot before;
	struct shm_status *s;
	char path[96];

	(void)state;
	if (geteuid() != 0)
		skip();
	snprintf(path, sizeof(path), "/dev/shm/edmd.%s.status", machine);
	assert_int_equal(shm_status_create(&s, machine, &before), 0);
	assert_int_equal(chown(path, 65534, 65534), 0);
	assert_int_equal(shm_status_open(&seen, machine), -EPERM);
	assert_int_equal(chown(path, 0, 0), 0);
	assert_int_equal(shm_status_open(&seen, machine), 0);
	shm_close(seen, sizeof(*seen));
	shm_status_destroy(s, machine);
}

/* One that was removed while the other waited for its lock is not theirs. */
static void two_writers_there_are_never(void **state)
{
	int one = shm_writer_claim(machine), two;

	(void)state;
	assert_true(one >= 0);
	assert_int_equal(shm_writer_claim(machine), -EBUSY);
	shm_writer_leave(one, machine);
	two = shm_writer_claim(machine);
	assert_true(two >= 0);
	shm_writer_leave(two, machine);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(shared_structs_keep_their_size),
		cmocka_unit_test(names_are_those_of_the_cycle),
		cmocka_unit_test(a_machine_name_with_other_characters_is_refused),
		cmocka_unit_test(objects_are_for_owner_and_group_alone),
		cmocka_unit_test(a_snapshot_is_read_as_it_was_published),
		cmocka_unit_test(a_living_owner_is_not_displaced),
		cmocka_unit_test(a_killed_owner_leaves_its_last_snapshot),
		cmocka_unit_test(a_half_written_snapshot_is_never_returned),
		cmocka_unit_test(half_written_sets_leave_those_before),
		cmocka_unit_test(a_status_that_finds_no_room_leaves_nothing),
		cmocka_unit_test(alive_means_the_writer_of_this_object),
		cmocka_unit_test(another_layout_size_or_magic_is_refused),
		cmocka_unit_test(an_object_of_another_layout_is_replaced),
		cmocka_unit_test(a_reader_gets_every_trace_record_in_order),
		cmocka_unit_test(a_slow_reader_is_told_how_many_it_lost),
		cmocka_unit_test(a_status_of_another_user_is_not_read),
		cmocka_unit_test(two_writers_there_are_never),
	};

	snprintf(machine, sizeof(machine), "unit-%d", (int)getpid());
	return cmocka_run_group_tests_name("shm", tests, NULL, NULL);
}
