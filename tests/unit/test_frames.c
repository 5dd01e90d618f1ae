/* SPDX-License-Identifier: Apache-2.0 */
/* test_frames.c - a frame that is not masked is found wherever it begins */
#include "frames.h"
#include "seed.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* The RFC's own words for a head.  Return: the bytes of the frame. */
static size_t put_frame(unsigned char *to, uint64_t payload, int long_by,
			bool masked)
{
	const unsigned int more = long_by == 126 ? 2 : long_by == 127 ? 8 : 0;
	size_t n = 2;

	to[0] = 0x81;
	to[1] = (unsigned char)((masked ? 0x80 : 0) |
				(more ? long_by : (int)payload));
	for (unsigned int i = 0; i < more; i++)
		to[n++] = (unsigned char)(payload >> 8 * (more - 1 - i));
	for (int i = 0; masked && i < 4; i++)
		to[n++] = (unsigned char)rand();
	for (uint64_t i = 0; i < payload; i++)
		to[n++] = (unsigned char)rand();
	return n;
}

static size_t put_random(unsigned char *to, bool masked)
{
	const int how = rand() % 3;
	const uint64_t most = how == 0 ? 125 : 700;

	return put_frame(to, (uint64_t)rand() % (most + 1),
			 how == 0 ? 0 : how == 1 ? 126 : 127, masked);
}

/* Look at it in pieces.  Return: the place behind the piece that was refused;
 * 0: all is masked. */
static size_t look(const unsigned char *at, size_t n)
{
	struct frames f = { .head = 0 };

	for (size_t i = 0; i < n;) {
		size_t piece = 1 + (size_t)rand() % (rand() % 2 ? 3 : 400);

		piece = piece < n - i ? piece : n - i;
		i += piece;
		if (!frames_look(&f, at + i - piece, piece))
			return i;
	}
	return 0;
}

static void masked_frames_pass(void **state)
{
	static unsigned char text[20000];

	(void)state;
	for (int i = 0; i < 20000; i++) {
		size_t n = 0;

		for (int k = rand() % 20; k >= 0; k--)
			n += put_random(text + n, true);
		assert_int_equal(look(text, n), 0);
	}
}

static void a_frame_without_a_mask_is_found(void **state)
{
	static unsigned char text[20000];

	(void)state;
	for (int i = 0; i < 20000; i++) {
		size_t n = 0, from, found;

		for (int k = rand() % 10; k > 0; k--)
			n += put_random(text + n, true);
		from = n;
		n += put_random(text + n, false);
		n += put_random(text + n, true);
		found = look(text, n);
		assert_true(found >= from + 2);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(masked_frames_pass),
		cmocka_unit_test(a_frame_without_a_mask_is_found),
	};

	srand((unsigned int)seed_take());
	return cmocka_run_group_tests_name("panel/frames", tests, NULL, NULL);
}
