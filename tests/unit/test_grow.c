/* SPDX-License-Identifier: Apache-2.0 */
/* test_grow.c - arrays that grow, and files read as a whole */
#include "grow.h"

#include "folder_help.h"

#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void keeps_what_is_in_it(void **state)
{
	uint32_t *at = NULL;
	size_t room = 0;

	(void)state;
	for (uint32_t n = 0; n < 100000; n++) {
		if (n == room)
			assert_int_equal(grow_array(&at, &room, sizeof(*at)),
					 0);
		assert_true(n < room);
		at[n] = n;
	}
	for (uint32_t n = 0; n < 100000; n++)
		assert_int_equal(at[n], n);
	free(at);
}

static void stays_as_it_was_without_memory(void **state)
{
	char *at = NULL;
	size_t room = 0, full;

	(void)state;
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
	skip();				/* they end a program that asks for so
					 * much */
#endif
	assert_int_equal(grow_array(&at, &room, 1), 0);
	at[room - 1] = 'x';
	full = room;
	assert_int_equal(grow_array(&at, &room, SIZE_MAX / 2), -ENOMEM);
	assert_int_equal(room, full);
	assert_int_equal(at[room - 1], 'x');
	free(at);
}

static int read_file(const char *name, size_t most, char **at, size_t *n)
{
	FILE *f = fopen(name, "rb");
	int err;

	assert_non_null(f);
	*at = NULL;
	*n = 0;
	err = grow_read(f, most, at, n);
	fclose(f);
	return err;
}

/* Lengths around those at which the array grows. */
static void a_file_is_read_whole(void **state)
{
	static const size_t lengths[] = { 0, 1, 63, 64, 65, 4096, 100001 };
	char name[64], text[100001];

	(void)state;
	snprintf(name, sizeof(name), "%s/text", folder);
	for (size_t i = 0; i < sizeof(text); i++)
		text[i] = (char)(i % 251);
	for (size_t i = 0; i < sizeof(lengths) / sizeof(*lengths); i++) {
		FILE *f = fopen(name, "wb");
		char *at;
		size_t n;

		assert_non_null(f);
		assert_int_equal(fwrite(text, 1, lengths[i], f), lengths[i]);
		assert_int_equal(fclose(f), 0);
		assert_int_equal(read_file(name, lengths[i], &at, &n), 0);
		assert_int_equal(n, lengths[i]);
		assert_memory_equal(at, text, n);
		free(at);
		if (lengths[i] == 0)
			continue;
		assert_int_equal(read_file(name, lengths[i] - 1, &at, &n),
				 -EFBIG);
		free(at);
	}
}

static void a_folder_is_no_file(void **state)
{
	char *at;
	size_t n;

	(void)state;
	assert_int_equal(read_file(folder, 100, &at, &n), -EISDIR);
	free(at);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(keeps_what_is_in_it),
		cmocka_unit_test(stays_as_it_was_without_memory),
		cmocka_unit_test(a_file_is_read_whole),
		cmocka_unit_test(a_folder_is_no_file),
	};

	return cmocka_run_group_tests(tests, folder_make, folder_remove);
}
