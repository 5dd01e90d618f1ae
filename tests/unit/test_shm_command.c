/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_shm_command.c - command ring and program blocks of daemon/shm/shm.h
 */
#include "shm.h"

#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static char machine[SHM_NAME_MAX];

static void commands_come_in_order_and_a_full_ring_says_so(void **state)
{
	struct shm_command_ring *r, *jobs;
	struct shm_command c = { .verb = SHM_LOAD, .instance = 9 };

	(void)state;
	assert_int_equal(shm_command_create(&r, machine, 9), 0);
	assert_int_equal(shm_command_open(&jobs, machine), 0);
	assert_int_equal(jobs->head.instance, 9);
	assert_false(shm_command_take(r, &c));
	for (int round = 0; round < 3; round++) {
		for (c.id = 1; shm_command_put(jobs, &c) == 0; c.id++)
			;
		assert_int_equal(c.id, SHM_COMMAND_SLOTS);
		assert_int_equal(shm_command_put(jobs, &c), -EAGAIN);
		for (uint32_t id = 1; id < SHM_COMMAND_SLOTS; id++) {
			assert_true(shm_command_take(r, &c));
			assert_int_equal(c.id, id);
			assert_int_equal(c.verb, SHM_LOAD);
			assert_int_equal(c.instance, 9);
		}
		assert_false(shm_command_take(r, &c));
	}
	shm_close(jobs, sizeof(*jobs));
	shm_command_destroy(r, machine);
	assert_int_equal(shm_command_open(&r, machine), -ENOENT);
}

static void a_spoilt_command_ring_is_read_inside_its_bounds(void **state)
{
	struct shm_command_ring *r;
	struct shm_command c;

	(void)state;
	assert_int_equal(shm_command_create(&r, machine, 9), 0);
	r->ring.size = UINT32_MAX;
	r->ring.mask = UINT32_MAX;
	r->ring.p_tail = 0x7fffff00u;
	r->ring.c_head = 0x12345678u;
	for (int i = 0; i < 1000; i++)
		assert_true(shm_command_take(r, &c));
	r->ring.p_tail = r->ring.c_head;
	assert_false(shm_command_take(r, &c));
	shm_command_destroy(r, machine);
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

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(
			commands_come_in_order_and_a_full_ring_says_so),
		cmocka_unit_test(
			a_spoilt_command_ring_is_read_inside_its_bounds),
		cmocka_unit_test(
			a_program_is_read_as_written_and_kept_while_mapped),
	};

	snprintf(machine, sizeof(machine), "command-%d", (int)getpid());
	return cmocka_run_group_tests_name("shm_command", tests, NULL, NULL);
}
