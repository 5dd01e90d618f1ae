/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_shm_command.c - command ring and program blocks of daemon/shm/shm.h
 */
#include "shm.h"

#include <errno.h>
#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

static char machine[SHM_NAME_MAX];

/* The thread takes them from the socket; it may be held up. */
static void take(struct shm_commands *r, struct shm_command *ret)
{
	while (!shm_command_take(r, ret))
		usleep(100);
}

/* Not answered at once: the same. */
static int connect_to(int *ret, uint32_t *ret_instance)
{
	int err;

	do
		err = shm_command_open(ret, machine, ret_instance);
	while (err == -EAGAIN);
	return err;
}

/* Until no more fit, once the other thread has taken what it may keep.  Return:
 * the last id that was sent; the first is 1. */
static uint64_t fill(int fd, struct shm_command *c)
{
	int err = 0;

	for (c->id = 1; err == 0 || c->id < SHM_COMMAND_SLOTS;) {
		err = shm_command_put(fd, c);
		if (err == 0)
			c->id++;
		else
			usleep(100);
		assert_true(err == 0 || err == -EAGAIN);
	}
	return c->id - 1;
}

static void
commands_come_in_order_and_one_that_waits_does_not_block(void **state)
{
	struct shm_command c = { .verb = SHM_LOAD, .instance = 9 };
	struct shm_commands *r;
	uint32_t instance;
	uint64_t sent;
	int fd;

	(void)state;
	assert_int_equal(shm_command_create(&r, machine, 9), 0);
	assert_int_equal(connect_to(&fd, &instance), 0);
	assert_int_equal(instance, 9);
	assert_false(shm_command_take(r, &c));
	for (int round = 0; round < 3; round++) {
		sent = fill(fd, &c);
		for (uint64_t id = 1; id <= sent; id++) {
			take(r, &c);
			assert_int_equal(c.id, id);
			assert_int_equal(c.verb, SHM_LOAD);
			assert_int_equal(c.instance, 9);
		}
		assert_false(shm_command_take(r, &c));
	}
	close(fd);
	shm_command_destroy(r);
	assert_int_equal(connect_to(&fd, &instance), -ENOENT);
}

static void who_sends_no_command_is_cut_off(void **state)
{
	struct shm_commands *r;
	struct shm_command c = { .id = 7 };
	uint32_t instance;
	int fd, other;

	(void)state;
	assert_int_equal(shm_command_create(&r, machine, 9), 0);
	assert_int_equal(connect_to(&fd, &instance), 0);
	assert_int_equal(send(fd, "hello", 5, 0), 5);
	while (shm_command_put(fd, &c) == 0)
		usleep(100);
	assert_int_equal(shm_command_put(fd, &c), -ENOTCONN);
	assert_false(shm_command_take(r, &c));
	assert_int_equal(connect_to(&other, &instance), 0);
	assert_int_equal(shm_command_put(other, &c), 0);
	take(r, &c);
	assert_int_equal(c.id, 7);
	close(fd);
	close(other);
	shm_command_destroy(r);
}

/* An edmd that is killed: it took all ids, and answered the odd ones. */
static void edmd_killed(void)
{
	struct shm_snapshot before;
	struct shm_status *s;

	if (shm_status_create(&s, machine, &before) < 0)
		_exit(1);
	for (uint64_t id = 1; id <= SHM_DONE_SLOTS + 10; id++) {
		shm_done_begin(s, id);
		if (id % 2)
			shm_done_end(s, id, SHM_AT_LIMIT);
	}
	_exit(0);
}

static void the_last_ids_are_remembered_through_a_restart(void **state)
{
	struct shm_snapshot before;
	struct shm_status *s;
	struct shm_done d;
	pid_t child = fork();
	int status;

	(void)state;
	if (child == 0)
		edmd_killed();
	assert_int_equal(waitpid(child, &status, 0), child);
	assert_int_equal(status, 0);
	assert_int_equal(shm_status_create(&s, machine, &before), 0);
	assert_true(s->born != 0);
	assert_false(shm_done(s, 10, &d));
	for (uint64_t id = 11; id <= SHM_DONE_SLOTS + 10; id++) {
		assert_true(shm_done(s, id, &d));
		assert_int_equal(d.code, id % 2 ? SHM_AT_LIMIT : SHM_TAKEN);
		assert_true(d.instance != s->head.instance);
	}
	shm_done_end(s, 11, SHM_DONE);
	assert_true(shm_done(s, 11, &d));
	assert_int_equal(d.code, SHM_AT_LIMIT);
	shm_status_destroy(s, machine);
}

static void a_program_is_read_as_written_and_kept_while_mapped(void **state)
{
	const void *old, *new;
	void *block;
	size_t bytes;

	(void)state;
	assert_int_equal(shm_program_open(&old, &bytes, machine, 5), -ENOENT);
	assert_int_equal(shm_program_create(&block, machine, 0, 8), -EINVAL);
	assert_int_equal(shm_program_create(&block, machine, 5, 0), -EINVAL);
	assert_int_equal(shm_program_create(&block, machine, 5, 5000), 0);
	memset(block, 0xa5, 5000);
	shm_program_unmap(block, 5000);
	assert_int_equal(shm_program_open(&old, &bytes, machine, 5), 0);
	assert_int_equal(bytes, 5000);

	assert_int_equal(shm_program_create(&block, machine, 5, 16), 0);
	shm_program_unmap(block, 16);
	assert_int_equal(((const uint8_t *)old)[4999], 0xa5);
	assert_int_equal(shm_program_open(&new, &bytes, machine, 5), 0);
	assert_int_equal(bytes, 16);
	assert_int_equal(((const uint8_t *)new)[0], 0);
	shm_program_remove(machine, 5);
	shm_program_unmap(old, 5000);
	shm_program_unmap(new, bytes);
	assert_int_equal(shm_program_open(&old, &bytes, machine, 5), -ENOENT);
}

static void who_made_a_program_looks_at_it_without_a_copy(void **state)
{
	const void *seen, *copy;
	uint8_t *block;
	size_t bytes;

	(void)state;
	assert_int_equal(shm_program_create((void **)&block, machine, 5, 16),
			 0);
	assert_int_equal(shm_program_read(&seen, &bytes, machine, 5), 0);
	assert_int_equal(shm_program_open(&copy, &bytes, machine, 5), 0);
	block[3] = 7;
	assert_int_equal(((const uint8_t *)seen)[3], 7);
	assert_int_equal(((const uint8_t *)copy)[3], 0);
	shm_program_remove(machine, 5);
	shm_program_unmap(seen, bytes);
	shm_program_unmap(copy, bytes);
	shm_program_unmap(block, bytes);
}

static void a_program_is_there_when_it_is_named(void **state)
{
	const void *at;
	void *block;
	size_t bytes;
	int fd;

	(void)state;
	assert_int_equal(shm_program_begin(&fd, &block, machine, 0), -EINVAL);
	assert_int_equal(shm_program_begin(&fd, &block, machine,
					   SHM_PROGRAM_MAX + 1), -EFBIG);
	assert_int_equal(shm_program_begin(&fd, &block, machine, 5000), 0);
	memset(block, 0xa5, 5000);
	shm_program_unmap(block, 5000);
	assert_int_equal(shm_program_open(&at, &bytes, machine, 7), -ENOENT);
	assert_int_equal(shm_program_name(fd, machine, 0), -EINVAL);
	assert_int_equal(shm_program_name(fd, machine, 7), 0);
	close(fd);
	assert_int_equal(shm_program_open(&at, &bytes, machine, 7), 0);
	assert_int_equal(bytes, 5000);
	assert_int_equal(((const uint8_t *)at)[4999], 0xa5);
	shm_program_unmap(at, bytes);
	shm_program_remove(machine, 7);
}

/* In steps that are no pages, up and down. */
static void a_program_grows_while_it_has_no_name(void **state)
{
	static const size_t sizes[] = { 3000000, 5001, 70000 };
	size_t was = 5000, bytes;
	const void *at;
	void *block;
	int fd;

	(void)state;
	assert_int_equal(shm_program_begin(&fd, &block, machine, was), 0);
	memset(block, 0xa5, was);
	assert_int_equal(shm_program_resize(fd, &block, was, 0), -EINVAL);
	assert_int_equal(shm_program_resize(fd, &block, was,
					    SHM_PROGRAM_MAX + 1), -EFBIG);
	for (int i = 0; i < 3; i++) {
		assert_int_equal(shm_program_resize(fd, &block, was, sizes[i]),
				 0);
		was = sizes[i];
		assert_int_equal(((uint8_t *)block)[4999], 0xa5);
		assert_int_equal(((uint8_t *)block)[was - 1], 0);
	}
	shm_program_unmap(block, was);
	assert_int_equal(shm_program_name(fd, machine, 7), 0);
	close(fd);
	assert_int_equal(shm_program_open(&at, &bytes, machine, 7), 0);
	assert_int_equal(bytes, was);
	assert_int_equal(((const uint8_t *)at)[4999], 0xa5);
	shm_program_unmap(at, bytes);
	shm_program_remove(machine, 7);
}

/* A few bytes of a folder's own, which would be gigabytes of edmd's memory. */
static void a_program_with_holes_is_not_read(void **state)
{
	char path[96];
	const void *at;
	void *block;
	size_t bytes;

	(void)state;
	assert_int_equal(shm_program_create(&block, machine, 6, 4096), 0);
	shm_program_unmap(block, 4096);
	snprintf(path, sizeof(path), "/dev/shm/edmd.%s.program.6", machine);
	assert_int_equal(truncate(path, 1 << 20), 0);
	assert_int_equal(shm_program_open(&at, &bytes, machine, 6), -EPROTO);
	assert_int_equal(truncate(path, SHM_PROGRAM_MAX + 1), 0);
	assert_int_equal(shm_program_open(&at, &bytes, machine, 6), -EFBIG);
	shm_program_remove(machine, 6);
	assert_int_equal(shm_program_create(&block, machine, 6,
					    SHM_PROGRAM_MAX + 1), -EFBIG);
}

static struct shm_stamp stamp_at(uint32_t n, int64_t s)
{
	const struct timespec times[2] = { { .tv_sec = s }, { .tv_sec = s } };
	char path[96];
	void *block;

	assert_int_equal(shm_program_create(&block, machine, n, 8), 0);
	shm_program_unmap(block, 8);
	snprintf(path, sizeof(path), "/dev/shm/edmd.%s.program.%u", machine, n);
	assert_int_equal(utimensat(AT_FDCWD, path, times, 0), 0);
	return shm_program_stamp(machine, n);
}

/* Inodes and seconds both go up: their sum or difference says nothing. */
static void a_file_of_another_inode_or_time_is_another(void **state)
{
	const struct shm_stamp old = stamp_at(8, 4000);
	struct shm_stamp now;

	(void)state;
	assert_true(shm_is_stamp(&old, machine, 8));
	assert_false(shm_is_stamp(&old, machine, 9));
	now = stamp_at(9, 0);
	stamp_at(9, (int64_t)(1000 ^ old.inode ^ now.inode) << 2);
	assert_false(shm_is_stamp(&old, machine, 9));
	for (int64_t s = 3900; s < 4100; s++) {
		stamp_at(9, s);
		assert_false(shm_is_stamp(&old, machine, 9));
	}
	shm_program_remove(machine, 8);
	assert_false(shm_is_stamp(&old, machine, 8));
	shm_program_remove(machine, 9);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(commands_come_in_order_and_one_that_waits_does_not_block),
		cmocka_unit_test(who_sends_no_command_is_cut_off),
		cmocka_unit_test(the_last_ids_are_remembered_through_a_restart),
		cmocka_unit_test(a_program_is_read_as_written_and_kept_while_mapped),
		cmocka_unit_test(a_file_of_another_inode_or_time_is_another),
		cmocka_unit_test(who_made_a_program_looks_at_it_without_a_copy),
		cmocka_unit_test(a_program_is_there_when_it_is_named),
		cmocka_unit_test(a_program_grows_while_it_has_no_name),
		cmocka_unit_test(a_program_with_holes_is_not_read),
	};

	snprintf(machine, sizeof(machine), "command-%d", (int)getpid());
	return cmocka_run_group_tests_name("shm_command", tests, NULL, NULL);
}
