/* SPDX-License-Identifier: Apache-2.0 */
/*
 * bit_string.h - many bits in the program, and how many of them are 1
 *
 * A string of bits is kept in whole words.  Behind them is a word for each
 * PULSE_STRING_BITS of them: how many ones there are up to the end of these.
 * So a count needs no more of a long string than of a short one.
 *
 * A damaged program says anything there; the counts stay in their range.
 *
 * Threads: RT-safe, but for pulse_string_count().
 */
#ifndef PULSE_BIT_STRING_H
#define PULSE_BIT_STRING_H

#include <stdint.h>

#define PULSE_STRING_BITS	1024

/** pulse_string_words() - words of 64 bits that @n bits take. */
static inline uint64_t pulse_string_words(uint64_t n)
{
	return (n + 63) / 64 + n / PULSE_STRING_BITS;
}

/** pulse_string_count() - write the words behind @n bits, for the builder. */
void pulse_string_count(uint64_t *bits, uint64_t n);

/** pulse_string_ones() - how many of the first @n of @all bits are 1. */
int64_t pulse_string_ones(const uint64_t *bits, int64_t all, int64_t n);

/**
 * pulse_string_zero() - bits in front of the 0 that has @zeros others in front
 * of it; @all if there are not so many.
 */
int64_t pulse_string_zero(const uint64_t *bits, int64_t all, int64_t zeros);

#endif /* PULSE_BIT_STRING_H */
