/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pair_run.c - many pulses of a pair at once, by its limit or its stored bits
 */
#include "pulse/pair.h"
#include "interp/smaller.h"

#include <string.h>

static void pair_add(struct interp_pair *p, int64_t m, int64_t s)
{
	p->m += m;
	p->s += s;
	p->dev += p->b * m - p->a * s;
}

/*
 * With a limit, the inputs change all the time, and it is hard to predict which
 * comes next.  So there is no branch.  @over is how far e is below the limit
 * (forward), or above the value that tells the last pulse (back).  In both
 * cases it falls by b with each pulse of the main input and rises by a with
 * each of the secondary.  Return: the number of the latter.
 */
static int64_t limit_run(const struct interp_pair *p, int64_t over, int64_t n,
			 uint8_t *second)
{
	const int64_t a = p->a, b = p->b;
	int64_t given = 0;

	for (int64_t k = 0; k < n; k++) {
		const int64_t due = over >> 63;

		over += ((a + b) & due) - b;
		second[k] = due & 1;
		given -= due;
	}
	return given;
}

/* Until the main input is at its end, the limit alone decides. */
static void limits_run(struct interp_pair *p, int64_t n, uint8_t *second)
{
	while (n > 0) {
		const int64_t some = fewer(n, p->a - p->m);
		int64_t given;

		if (some == 0) {
			memset(second, 1, (size_t)n);
			pair_add(p, 0, n);
			return;
		}
		given = limit_run(p, p->limit - p->dev, some, second);
		pair_add(p, some - given, given);
		second += some;
		n -= some;
	}
}

/* The same until the secondary input is back at its start. */
static void limits_run_back(struct interp_pair *p, int64_t n, uint8_t *second)
{
	while (n > 0) {
		const int64_t some = fewer(n, p->s);
		int64_t given;

		if (some == 0) {
			memset(second, 0, (size_t)n);
			pair_add(p, -n, 0);
			return;
		}
		given = limit_run(p, p->dev - p->limit - p->b + p->a - 1,
				  some, second);
		pair_add(p, given - some, -given);
		second += some;
		n -= some;
	}
}

/* As long as both inputs have pulses, the bits alone decide.  Return: how many
 * of @n are the secondary input's. */
static int64_t bits_read(const struct interp_pair *p, int64_t at, int by,
			 int64_t n, uint8_t *second)
{
	int64_t given = 0;

	for (int64_t k = 0; k < n; k++) {
		second[k] = pair_bit(p, at + by * k);
		given += second[k];
	}
	return given;
}

static void bits_run(struct interp_pair *p, int64_t n, uint8_t *second)
{
	while (n > 0) {
		const int64_t some = fewer(n, fewer(p->a - p->m, p->b - p->s));
		int64_t given;

		if (some == 0) {
			memset(second, p->s < p->b, (size_t)n);
			pair_add(p, p->s < p->b ? 0 : n, p->s < p->b ? n : 0);
			return;
		}
		given = bits_read(p, p->m + p->s, 1, some, second);
		pair_add(p, some - given, given);
		second += some;
		n -= some;
	}
}

static void bits_run_back(struct interp_pair *p, int64_t n, uint8_t *second)
{
	while (n > 0) {
		const int64_t some = fewer(n, fewer(p->m, p->s));
		int64_t given;

		if (some == 0) {
			memset(second, p->s > 0, (size_t)n);
			pair_add(p, p->s > 0 ? 0 : -n, p->s > 0 ? -n : 0);
			return;
		}
		given = bits_read(p, p->m + p->s - 1, -1, some, second);
		pair_add(p, given - some, -given);
		second += some;
		n -= some;
	}
}

void pair_run(struct interp_pair *p, uint32_t n, uint8_t *second)
{
	if (p->bits)
		bits_run(p, n, second);
	else
		limits_run(p, n, second);
}

void pair_run_back(struct interp_pair *p, uint32_t n, uint8_t *second)
{
	if (p->bits)
		bits_run_back(p, n, second);
	else
		limits_run_back(p, n, second);
}
