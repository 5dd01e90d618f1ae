/* SPDX-License-Identifier: Apache-2.0 */
/* number.c - numbers of more than a few digits */
#include "code/number.h"

const double nc_pow10[NC_POW10_MAX + 1] = {
	1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
	1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
};

/* Behind the point, digits that do not change a double any more are dropped.
 * In front of it, they make the number too large for every word. */
static double many_digits(const uint8_t *p, const uint8_t *end)
{
	uint64_t mantissa = 0;
	int fraction = 0;
	bool behind = false;

	for (; p < end; p++) {
		const bool full = mantissa >= UINT64_C(100000000000000000);

		if (*p == '.') {
			behind = true;
		} else if (full && !behind) {
			return HUGE_VAL;
		} else if (!full && fraction < NC_POW10_MAX) {
			mantissa = mantissa * 10 + (uint64_t)(*p - '0');
			fraction += behind;
		}
	}
	return (double)(int64_t)mantissa / nc_pow10[fraction];
}

static const uint8_t *no_sign(const uint8_t *p, const uint8_t *end,
			       double *ret)
{
	const uint8_t *first = p, *point = NULL;
	uint64_t mantissa = 0;

	p = nc_digits(p, end, &mantissa);
	if (p < end && *p == '.') {
		point = p + 1;
		p = nc_digits(point, end, &mantissa);
	}
	if (p - first == (point != NULL))
		return NULL;
	if (p - first > NC_DIGITS_MAX)
		*ret = many_digits(first, p);
	else
		*ret = (double)(int64_t)mantissa /
		       nc_pow10[point ? p - point : 0];
	return p;
}

const uint8_t *nc_number_any(const uint8_t *p, const uint8_t *end, double *ret)
{
	bool negative = false;

	p = nc_skip_blanks(p, end);
	if (p < end && (*p == '-' || *p == '+')) {
		negative = *p == '-';
		p = nc_skip_blanks(p + 1, end);
	}
	p = no_sign(p, end, ret);
	if (p && negative)
		*ret = -*ret;
	return p;
}
