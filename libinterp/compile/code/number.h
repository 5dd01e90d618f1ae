/* SPDX-License-Identifier: Apache-2.0 */
/*
 * number.h - decimal numbers: sign, digits, one point, no exponent
 */
#ifndef CODE_NUMBER_H
#define CODE_NUMBER_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* A double holds these powers of ten exactly. */
#define NC_POW10_MAX	22
extern const double nc_pow10[NC_POW10_MAX + 1];

/* So many digits certainly fit a mantissa of 63 bits. */
#define NC_DIGITS_MAX	18

static inline const uint8_t *nc_skip_blanks(const uint8_t *p,
					    const uint8_t *end)
{
	while (p < end && (*p == ' ' || *p == '\t'))
		p++;
	return p;
}

static inline const uint8_t *nc_digits(const uint8_t *p, const uint8_t *end,
				       uint64_t *mantissa)
{
	for (unsigned int d; p < end && (d = *p - (unsigned int)'0') <= 9; p++)
		*mantissa = *mantissa * 10 + d;
	return p;
}

/* Of eight bytes: those that are above 9.  The first one is the lowest. */
static inline uint64_t nc_no_digits(uint64_t w)
{
	const uint64_t below_top = UINT64_C(0x7f7f7f7f7f7f7f7f);
	const uint64_t above_9 = UINT64_C(0x7676767676767676);

	return (((w & below_top) + above_9) | w) & ~below_top;
}

/* A word of eight such bytes. */
#define NC_ALL(byte)	(UINT64_C(0x0101010101010101) * (byte))

/* Eight bytes with a digit in each; the first one, which is the lowest, counts
 * most.  Neighbours are put together: bytes, then pairs, then fours. */
static inline uint32_t nc_eight_digits(uint64_t w)
{
	const uint64_t every_fourth = UINT64_C(0x000000ff000000ff);

	w = w * 10 + (w >> 8);
	return (uint32_t)(((w & every_fourth) *
			   (100 + (UINT64_C(1000000) << 32)) +
			   (w >> 16 & every_fourth) *
			   (1 + (UINT64_C(10000) << 32))) >> 32);
}

/**
 * nc_number_short() - a number without a sign, of at most seven digits and a
 * point, which is most numbers; all of its bytes are looked at together.
 *
 * Return: the place behind it; NULL if it is not so short, or no number.
 */
static inline const uint8_t *nc_number_short(const uint8_t *p,
					     const uint8_t *end, double *ret)
{
	unsigned int whole, bits;	/* in front of the point; behind the
					 * number: the top bit of a byte */
	uint64_t w, no_digits;

	if (__BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__ || end - p < 8)
		return NULL;
	memcpy(&w, p, sizeof(w));
	w ^= NC_ALL('0');
	no_digits = nc_no_digits(w);
	if (!no_digits)
		return NULL;
	whole = bits = (unsigned int)__builtin_ctzll(no_digits);
	if (p[whole / 8] == '.') {
		const uint64_t point = no_digits & -no_digits;
		const uint64_t before = (point >> 7) - 1;

		w = (((w >> 8) ^ w) & before) ^ (w >> 8);
		no_digits ^= point;
		if (!no_digits)
			return NULL;
		bits = (unsigned int)__builtin_ctzll(no_digits) - 8;
		p++;
	}
	if (bits < 8)
		return NULL;
	*ret = nc_eight_digits(w << (71 - bits)) / nc_pow10[(bits - whole) / 8];
	return p + bits / 8;
}

/** nc_is_whole() - @v is far below 2^63. */
static inline bool nc_is_whole(double v)
{
	return v == (double)(int64_t)v;
}

/** nc_number_any() - nc_number() of any length, and with blanks or a +. */
const uint8_t *nc_number_any(const uint8_t *p, const uint8_t *end, double *ret);

/**
 * nc_number() - the number at @p.  Blanks are allowed before it, and before its
 * digits.
 *
 * A mantissa below 2^53 and a power of ten up to 22 are both exact, so their
 * quotient is the nearest double: every number of 15 digits is rounded
 * correctly.
 *
 * Return: the place behind the number; NULL if there is none.
 */
static inline const uint8_t *nc_number(const uint8_t *p, const uint8_t *end,
				       double *ret)
{
	const bool negative = p < end && *p == '-';
	const uint8_t *behind = nc_number_short(p + negative, end, ret);

	if (!behind)
		return nc_number_any(p, end, ret);
	if (negative)
		*ret = -*ret;
	return behind;
}

#endif /* CODE_NUMBER_H */
