/* SPDX-License-Identifier: Apache-2.0 */
/* test_standard.c - what is printed is plain, however it is cut into pieces */
#include "plain.h"
#include "seed.h"
#include "standard.h"

#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define TEXT_MAX	20000

static const char *const part[] = {
	"a", "word ", "\n", "\t", "\r\n", "\xc3\xbc", "\xe6\x94\xbe",
	"\xf0\x9f\x99\x82", "\xe2\x82\xac", "0123456789abcdef",
};

static const char *const foreign[] = {
	"\x1b", "\x1b[2J", "\r", "\x07", "\xc2\x9b", "\x9b", "\xe2\x80\xae",
	"\xc3", "\xe6\x94", "\xf0\x9f\x99", "\xff", "\x80", "\x7f", "\xc0\xaf",
};

/* In pieces of any length to stdout, which is a file.  Return: its bytes. */
static size_t print(const char *text, size_t n, char *ret)
{
	char path[] = "/tmp/edmd-standard.XXXXXX";
	const int file = mkstemp(path), was = dup(STDOUT_FILENO);
	ssize_t got;

	assert_true(file >= 0 && was >= 0);
	dup2(file, STDOUT_FILENO);
	for (size_t i = 0; i < n;) {
		size_t piece = 1 + (size_t)rand() % (rand() % 2 ? 4 : 6000);

		piece = piece < n - i ? piece : n - i;
		fwrite(text + i, 1, piece, stdout);
		if (rand() % 3 == 0)
			fflush(stdout);
		i += piece;
	}
	fputc('\n', stdout);
	fflush(stdout);
	dup2(was, STDOUT_FILENO);
	got = pread(file, ret, 2 * TEXT_MAX, 0);
	close(was);
	close(file);
	unlink(path);
	assert_true(got > 0);
	ret[got] = '\0';
	return (size_t)got;
}

static void fill(char *to, bool hostile)
{
	size_t n = 0;

	to[0] = '\0';
	for (int k = rand() % 3000; k > 0 && n < TEXT_MAX - 20; k--) {
		const char *p = hostile && rand() % 4 == 0 ?
			foreign[(size_t)rand() % (sizeof(foreign) /
						  sizeof(foreign[0]))] :
			part[(size_t)rand() % (sizeof(part) /
					       sizeof(part[0]))];

		memcpy(to + n, p, strlen(p) + 1);
		n += strlen(p);
	}
}

static void plain_text_is_printed_as_it_is(void **state)
{
	static char text[TEXT_MAX], got[2 * TEXT_MAX + 1];

	(void)state;
	for (int i = 0; i < SEED_ROUNDS(500); i++) {
		fill(text, false);
		print(text, strlen(text), got);
		got[strlen(got) - 1] = '\0';
		assert_string_equal(got, text);
	}
}

static void nothing_else_is_printed(void **state)
{
	static char text[TEXT_MAX], got[2 * TEXT_MAX + 1];

	(void)state;
	for (int i = 0; i < SEED_ROUNDS(500); i++) {
		size_t n;

		fill(text, true);
		n = print(text, strlen(text), got);
		for (char *at = got; *at; at++)
			if (*at == '\n' || *at == '\t' ||
			    (at[0] == '\r' && at[1] == '\n'))
				*at = ' ';
		assert_true(plain_is(got));
		/* Each byte of it leaves one, good or not. */
		assert_int_equal(n, strlen(text) + 1);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(plain_text_is_printed_as_it_is),
		cmocka_unit_test(nothing_else_is_printed),
	};

	srand((unsigned int)seed_take());
	standard_guard("test_standard");
	return cmocka_run_group_tests_name("common/standard", tests, NULL,
					   NULL);
}
