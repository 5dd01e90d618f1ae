/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pair.c - set-up of a pair, and its bursts
 *
 * Totals are at most 2^30 and mu at most 1000 pulses, so e, M and the
 * products of a burst stay within 2^62; only the square of M needs 128 bits.
 */
#include "interp/smaller.h"
#include "pulse/strategy.h"

/* Bit by bit: without a division, and always in the same time. */
int64_t pair_isqrt(uint64_t n, uint64_t m)
{
	const pulse_uwide x = (pulse_uwide)n * n * m;
	uint64_t root = 0;

	for (int bit = 62; bit >= 0; bit--) {
		const uint64_t try = root | UINT64_C(1) << bit;

		if ((pulse_uwide)try * try <= x)
			root = try;
	}
	return (int64_t)root;
}

int64_t pair_half_width(int64_t a, int64_t b, struct pair_tube t)
{
	const int64_t most = a * b;
	const int64_t m = t.perpendicular ?
		pair_isqrt(t.milli, (uint64_t)(a * a + b * b)) / 1000 :
		t.milli * a / 1000;

	return m < most ? m : most;
}

static int64_t gcd(int64_t a, int64_t b)
{
	while (b > 0) {
		const int64_t rest = a % b;

		a = b;
		b = rest;
	}
	return a;
}

bool pair_tube_ok(int64_t a, int64_t b, struct pair_tube t)
{
	int64_t g;

	if (b == 0)
		return true;
	g = gcd(a, b);
	return 2 * (pair_half_width(a, b, t) / g) + 1 >= (a + b) / g;
}

/* B, at least 1. */
static int64_t pair_burst(int64_t a, int64_t b, int64_t half_width)
{
	const int64_t g = gcd(a, b);
	const int64_t burst = (2 * (half_width / g) + 1 - b / g) / (a / g);

	return burst > 1 ? burst : 1;
}

static void pair_stand(struct interp_pair *p, bool at_end)
{
	p->m = at_end ? p->a : 0;
	p->s = at_end ? p->b : 0;
	p->dev = 0;
	p->bursts = 0;
	p->bits = NULL;
}

void pair_set_limit(struct interp_pair *p, int64_t limit, bool at_end)
{
	pair_stand(p, at_end);
	p->limit = limit;
}

/* -- Bursts ---------------------------------------------------------------- */

/*
 * The neighbours of a burst are found from what is known of it, because
 * divisions are what bursts cost: X follows from the two Y beside it.
 */

/* X(j), from Y(j) and Y(j + 1); there is none before the first burst and after
 * the last. */
INLINE int64_t burst_stop(const struct interp_pair *p, int64_t j, int64_t from,
			int64_t to)
{
	if (j < 0)
		return -1;
	if (j >= p->bursts)
		return PAIR_NEVER;
	return ((from + to) * p->a + p->b) / (2 * p->b);
}

/* Y(j). */
INLINE int64_t burst_from(const struct interp_pair *p, int64_t j)
{
	if (j <= 0)
		return 0;
	return j >= p->bursts ? p->b : j * p->b / p->bursts;
}

/* Look at burst j from its beginning. */
static void burst_look(struct interp_pair *p)
{
	p->from = burst_from(p, p->burst);
	p->to = burst_from(p, p->burst + 1);
	p->due = burst_stop(p, p->burst, p->from, p->to);
}

INLINE void burst_find_prior(struct interp_pair *p)
{
	p->prior_from = burst_from(p, p->burst - 1);
	p->done = burst_stop(p, p->burst - 1, p->prior_from, p->from);
}

INLINE void burst_next(struct interp_pair *p)
{
	p->burst++;
	p->prior_from = p->from;
	p->done = p->due;
	p->from = p->to;
	p->to = burst_from(p, p->burst + 1);
	p->due = burst_stop(p, p->burst, p->from, p->to);
}

INLINE void burst_back(struct interp_pair *p)
{
	p->burst--;
	p->to = p->from;
	p->from = p->prior_from;
	p->due = p->done;
	burst_find_prior(p);
}

void pair_burst_next(struct interp_pair *p)
{
	burst_next(p);
}

void pair_burst_back(struct interp_pair *p)
{
	burst_back(p);
}

int64_t pair_burst_changes(const struct interp_pair *p)
{
	const int64_t n = p->bursts;
	const int64_t first = burst_stop(p, 0, 0, burst_from(p, 1));
	const int64_t last = burst_stop(p, n - 1, burst_from(p, n - 1), p->b);

	return 2 * n - (first == 0) - (last == p->a);
}

/* -- Stored bits ---------------------------------------------------------- */

void pair_set_bits(struct interp_pair *p, const uint64_t *bits)
{
	p->bursts = 0;
	p->bits = bits;
}

/* -- At once --------------------------------------------------------------- */

static int64_t within(int64_t v, int64_t low, int64_t high)
{
	return v < low ? low : v > high ? high : v;
}

/* Upward, for @by > 0. */
static int64_t divided(int64_t v, int64_t by)
{
	return v > 0 ? (v + by - 1) / by : -(-v / by);
}

/* Look at the first burst that is not over when @n pulses are given: of the
 * secondary input, or of both. */
static void burst_seek(struct interp_pair *p, int64_t n, bool both)
{
	int64_t low = 0, high = p->bursts;

	while (low < high) {
		p->burst = low + (high - low) / 2;
		burst_look(p);
		if ((both ? p->due : 0) + p->to > n)
			high = p->burst;
		else
			low = p->burst + 1;
	}
	p->burst = low;
	burst_look(p);
}

void pair_put(struct interp_pair *p, int64_t m, int64_t s)
{
	p->m = m;
	p->s = s;
	p->dev = p->b * m - p->a * s;
	if (!p->bursts)
		return;
	burst_seek(p, s, false);
	burst_find_prior(p);
}

/* Of the first @n pulses, those of the secondary input. */
static int64_t seconds(struct interp_pair *p, int64_t n)
{
	if (p->bits)
		return pulse_string_ones(p->bits, p->a + p->b, n);
	/* e = b*n - (a + b)*s is in its window. */
	if (!p->bursts)
		return divided(p->b * n - p->limit - p->b, p->a + p->b);
	burst_seek(p, n, true);
	return within(n - p->due, p->from, p->to);
}

void pair_seek(struct interp_pair *p, int64_t n)
{
	const int64_t least_s = n > p->a ? n - p->a : 0;
	const int64_t most_s = n < p->b ? n : p->b;
	const int64_t s = within(seconds(p, n), least_s, most_s);

	pair_put(p, n - s, s);
}

int64_t pair_sent(const struct interp_pair *p, int64_t m)
{
	struct interp_pair at = *p;
	int64_t low = 0, high = p->bursts;

	if (m >= p->a)
		return p->b;
	if (p->bits)
		return within(pulse_string_zero(p->bits, p->a + p->b, m) - m,
			      0, p->b);
	if (!p->bursts)
		return within(divided(p->b * m - p->limit, p->a), 0, p->b);
	while (low < high) {
		at.burst = low + (high - low) / 2;
		burst_look(&at);
		if (at.due > m)
			high = at.burst;
		else
			low = at.burst + 1;
	}
	at.burst = low;
	burst_look(&at);
	return at.from;
}

/* -- In rows --------------------------------------------------------------- */

/* What is left of @n is less than the burst: a row of @main at most, and then
 * the others. */
static void row_last(int64_t main, int64_t n, uint8_t *row)
{
	row[0] = (uint8_t)fewer(main, n);
	row[1] = (uint8_t)(n - row[0]);
}

uint32_t pair_rows(struct interp_pair *p, uint32_t n, uint8_t *restrict row)
{
	const int64_t was = p->s;
	int64_t left = n, m = p->m;
	uint32_t k = 0;

	/* Behind the last burst, due is as far as a number goes. */
	for (; p->due - m <= left - (p->to - p->s); k += 2) {
		row[k] = (uint8_t)(p->due - m);
		row[k + 1] = (uint8_t)(p->to - p->s);
		left -= p->due - m + p->to - p->s;
		m = p->due;
		p->s = p->to;
		burst_next(p);
	}
	row_last(p->due - m, left, row + k);
	m += row[k];
	p->s += row[k + 1];
	p->dev += p->b * (m - p->m) - p->a * (p->s - was);
	p->m = m;
	return k + 2;
}

uint32_t pair_rows_back(struct interp_pair *p, uint32_t n,
			uint8_t *restrict row)
{
	const int64_t was = p->s;
	int64_t left = n, m = p->m;
	uint32_t k = 2;

	row[0] = 0;
	row[1] = (uint8_t)fewer(left, p->s - p->from);
	left -= row[1];
	p->s -= row[1];
	for (; p->burst > 0 && m - p->done + p->from - p->prior_from <= left;
	     k += 2) {
		row[k] = (uint8_t)(m - p->done);
		row[k + 1] = (uint8_t)(p->from - p->prior_from);
		left -= m - p->done + p->from - p->prior_from;
		m = p->done;
		burst_back(p);
		p->s = p->from;
	}
	row_last(m - p->done, left, row + k);
	if (row[k + 1] > 0)
		burst_back(p);
	m -= row[k];
	p->s -= row[k + 1];
	p->dev += p->b * (m - p->m) - p->a * (p->s - was);
	p->m = m;
	return k + 2;
}

/* -- By name --------------------------------------------------------------- */

void pair_set_centred(struct interp_pair *p, int64_t half, bool at_end)
{
	(void)half;
	pair_set_limit(p, (p->a - p->b) / 2, at_end);
}

void pair_set_main_direction(struct interp_pair *p, int64_t half, bool at_end)
{
	pair_set_limit(p, half - p->b, at_end);
}

void pair_set_min_switch(struct interp_pair *p, int64_t half, bool at_end)
{
	int64_t burst;

	if (p->b == 0)
		return;
	burst = pair_burst(p->a, p->b, half);
	pair_stand(p, at_end);
	p->bursts = (p->b + burst - 1) / burst;
	p->burst = at_end ? p->bursts : 0;
	burst_look(p);
	burst_find_prior(p);
}

void pair_set(struct interp_pair *p, enum interp_strategy rule,
	      struct pair_tube t, bool at_end)
{
	const struct pulse_strategy *s = pulse_strategy(rule);

	pair_set_limit(p, 0, at_end);
	if (s->set)
		s->set(p, pair_half_width(p->a, p->b, t), at_end);
}
