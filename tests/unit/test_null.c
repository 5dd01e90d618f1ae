/* SPDX-License-Identifier: Apache-2.0 */
/* test_null.c - backend null, which is no machine */
#include "io.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

static int open_null(void **state)
{
	static struct io_machine m;

	*state = &m;
	return io_null_open(&m, NULL, NULL);
}

static int close_null(void **state)
{
	struct io_machine *m = *state;

	m->close(m->self);
	return 0;
}

static void axes_stand_where_they_were_last_sent(void **state)
{
	struct io_machine *m = *state;
	struct io_outputs out = { .power = true };
	struct io_inputs in;

	for (int i = 0; i < IO_NAXES; i++)
		out.target[i] = i % 2 ? -1000 * i : INT32_MAX - i;
	m->write(m->self, &out);
	memset(&in, 0x5a, sizeof(in));
	m->read(m->self, &in);
	assert_memory_equal(in.actual, out.target, sizeof(in.actual));
}

static void there_is_no_gap_and_nothing_wrong(void **state)
{
	struct io_machine *m = *state;
	struct io_inputs in;

	memset(&in, 0x5a, sizeof(in));
	m->read(m->self, &in);
	assert_false(in.gap_valid);
	assert_true(in.gap_v == 0);
	assert_false(in.estop);
	assert_false(in.lost);
}

static void it_takes_any_number_of_pulses_in_a_cycle(void **state)
{
	struct io_machine *m = *state;

	assert_int_equal(m->edges_per_cycle, 0);
	assert_string_equal(m->name, "null");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(axes_stand_where_they_were_last_sent),
		cmocka_unit_test(there_is_no_gap_and_nothing_wrong),
		cmocka_unit_test(it_takes_any_number_of_pulses_in_a_cycle),
	};

	return cmocka_run_group_tests_name("io/null", tests, open_null,
					   close_null);
}
