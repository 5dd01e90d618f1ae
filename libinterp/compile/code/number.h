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

/** nc_number_long() - the value of the digits from @p to @end, however many. */
double nc_number_long(const uint8_t *p, const uint8_t *end);

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
	const uint8_t *first, *point = NULL;
	uint64_t mantissa = 0;
	bool negative = false;
	double value;

	p = nc_skip_blanks(p, end);
	if (p < end && (*p == '-' || *p == '+')) {
		negative = *p == '-';
		p = nc_skip_blanks(p + 1, end);
	}
	first = p;
	p = nc_digits(p, end, &mantissa);
	if (p < end && *p == '.') {
		point = p + 1;
		p = nc_digits(point, end, &mantissa);
	}
	if (p - first == (point != NULL))
		return NULL;
	if (p - first > NC_DIGITS_MAX)
		value = nc_number_long(first, p);
	else
		value = (double)(int64_t)mantissa /
			nc_pow10[point ? p - point : 0];
	*ret = negative ? -value : value;
	return p;
}

#endif /* CODE_NUMBER_H */
