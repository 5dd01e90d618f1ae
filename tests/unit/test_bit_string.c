/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_bit_string.c - ones and zeros are found as by counting one by one,
 * wherever they are; in a damaged string they are in their range
 */
#include "random_compile.h"
#include "seed.h"

#include "pulse/bit_string.h"

#define BITS_MAX	5000

static uint64_t seed;

static bool bit(const uint64_t *bits, int64_t k)
{
	return bits[k / 64] >> k % 64 & 1;
}

/* @kind: none, all, or a random share of ones. */
static uint64_t *make_string(int64_t n, uint64_t kind)
{
	const uint64_t words = pulse_string_words((uint64_t)n);
	uint64_t *bits = calloc(words + 1, sizeof(*bits));

	assert_non_null(bits);
	for (int64_t k = 0; k < n; k++)
		bits[k / 64] |= (uint64_t)(rnd(&seed) % 8 < kind) << k % 64;
	bits[words] = 0xabcd;
	pulse_string_count(bits, (uint64_t)n);
	assert_int_equal(bits[words], 0xabcd);
	return bits;
}

static void ones_and_zeros_are_those_that_are_counted(void **state)
{
	(void)state;
	seed = seed_take();
	for (int i = 0; i < SEED_ROUNDS(200); i++) {
		const int64_t n = i < 20 ? 1024 * (i % 4) + i / 4 :
				  (int64_t)(rnd(&seed) % BITS_MAX);
		uint64_t *bits = make_string(n, rnd(&seed) % 9);
		int64_t ones = 0, zeros = 0;

		for (int64_t k = 0; k < n; k++) {
			assert_int_equal(pulse_string_ones(bits, n, k), ones);
			if (!bit(bits, k))
				assert_int_equal(pulse_string_zero(bits, n,
								   zeros++), k);
			ones += bit(bits, k);
		}
		assert_int_equal(pulse_string_ones(bits, n, n), ones);
		assert_int_equal(pulse_string_zero(bits, n, zeros), n);
		free(bits);
	}
}

static void damaged_counts_stay_in_range(void **state)
{
	(void)state;
	seed = seed_take();
	for (int i = 0; i < SEED_ROUNDS(2000); i++) {
		const int64_t n = (int64_t)(rnd(&seed) % BITS_MAX);
		const int64_t k = (int64_t)(rnd(&seed) % ((uint64_t)n + 1));
		uint64_t *bits = make_string(n, rnd(&seed) % 9);
		int64_t ones, zero;

		bits[rnd(&seed) % (pulse_string_words((uint64_t)n) + 1)] =
			rnd(&seed) % 2 ? rnd(&seed) : UINT64_MAX;
		ones = pulse_string_ones(bits, n, k);
		zero = pulse_string_zero(bits, n, k);
		assert_true(ones >= 0 && ones <= k);
		assert_true(zero >= 0 && zero <= n);
		free(bits);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(ones_and_zeros_are_those_that_are_counted),
		cmocka_unit_test(damaged_counts_stay_in_range),
	};

	return cmocka_run_group_tests_name("pulse/bit_string", tests, NULL,
					   NULL);
}
