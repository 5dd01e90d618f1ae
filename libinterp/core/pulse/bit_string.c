/* SPDX-License-Identifier: Apache-2.0 */
/* bit_string.c - counts the bits of a string that are 1 */
#include "pulse/bit_string.h"

#define STRING_WORDS	(PULSE_STRING_BITS / 64)

static int64_t ones_in(const uint64_t *bits, int64_t n)
{
	int64_t ones = 0;

	for (int64_t at = 0; at < n; at += 64) {
		uint64_t w = bits[at / 64];

		if (n - at < 64)
			w &= (UINT64_C(1) << (n - at)) - 1;
		w -= w >> 1 & UINT64_C(0x5555555555555555);
		w = (w & UINT64_C(0x3333333333333333)) +
		    (w >> 2 & UINT64_C(0x3333333333333333));
		w = (w + (w >> 4)) & UINT64_C(0x0f0f0f0f0f0f0f0f);
		ones += (int64_t)(w * UINT64_C(0x0101010101010101) >> 56);
	}
	return ones;
}

/* Among the first @i times PULSE_STRING_BITS. */
static int64_t ones_before(const uint64_t *bits, int64_t all, int64_t i)
{
	const uint64_t most = (uint64_t)i * PULSE_STRING_BITS;
	uint64_t ones;

	if (i == 0)
		return 0;
	ones = bits[(all + 63) / 64 + i - 1];
	return (int64_t)(ones < most ? ones : most);
}

int64_t pulse_string_ones(const uint64_t *bits, int64_t all, int64_t n)
{
	const int64_t i = n / PULSE_STRING_BITS;

	return ones_before(bits, all, i) +
	       ones_in(bits + i * STRING_WORDS, n % PULSE_STRING_BITS);
}

void pulse_string_count(uint64_t *bits, uint64_t n)
{
	uint64_t *counts = bits + (n + 63) / 64;
	int64_t ones = 0;

	for (uint64_t i = 0; i < n / PULSE_STRING_BITS; i++) {
		ones += ones_in(bits + i * STRING_WORDS, PULSE_STRING_BITS);
		counts[i] = (uint64_t)ones;
	}
}

int64_t pulse_string_zero(const uint64_t *bits, int64_t all, int64_t zeros)
{
	int64_t low = 0, high = all / PULSE_STRING_BITS, at;

	while (low < high) {
		const int64_t i = low + (high - low + 1) / 2;

		if (i * PULSE_STRING_BITS - ones_before(bits, all, i) <= zeros)
			low = i;
		else
			high = i - 1;
	}
	at = low * PULSE_STRING_BITS;
	zeros -= at - ones_before(bits, all, low);
	for (; at + 64 <= all; at += 64) {
		const int64_t some = 64 - ones_in(bits + at / 64, 64);

		if (some > zeros)
			break;
		zeros -= some;
	}
	for (; at < all; at++)
		if (!(bits[at / 64] >> at % 64 & 1) && zeros-- == 0)
			break;
	return at;
}
