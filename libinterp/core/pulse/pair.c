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

int64_t pair_burst(int64_t a, int64_t b, int64_t half_width)
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

int64_t pair_stop(int64_t a, int64_t b, int64_t n, int64_t j)
{
	return ((j * b / n + (j + 1) * b / n) * a + b) / (2 * b);
}

/*
 * The neighbours of a burst are found from what is known of it, because
 * divisions are what bursts cost.  At stops of its own, a stop follows from the
 * two Y beside it; where another pair sets the stops, a Y follows from the two
 * X beside it.
 */

/* X(j), from Y(j) and Y(j + 1); there is none before the first burst and after
 * the last. */
INLINE int64_t own_stop(const struct interp_pair *p, int64_t j, int64_t from,
			int64_t to)
{
	if (j < 0)
		return -1;
	if (j >= p->bursts)
		return PAIR_NEVER;
	return ((from + to) * p->a + p->b) / (2 * p->b);
}

/* Y(j). */
INLINE int64_t own_from(const struct interp_pair *p, int64_t j)
{
	if (j <= 0)
		return 0;
	return j >= p->bursts ? p->b : j * p->b / p->bursts;
}

static int64_t led_stop(const struct interp_pair *p, int64_t j)
{
	if (j < 0)
		return -1;
	if (j >= p->bursts)
		return PAIR_NEVER;
	return pair_stop(p->a, p->lead, p->stops,
			 pair_stop_shared(p->stops, p->bursts, j));
}

/* Half way between X(j - 1) and X(j). */
static int64_t led_from(const struct interp_pair *p, int64_t j, int64_t before,
			int64_t at)
{
	if (j <= 0)
		return 0;
	if (j >= p->bursts)
		return p->b;
	return (p->b * (before + at) + p->a) / (2 * p->a);
}

/* Look at burst j from its beginning. */
static void burst_look(struct interp_pair *p)
{
	const int64_t j = p->burst;

	if (!p->stops) {
		p->from = own_from(p, j);
		p->to = own_from(p, j + 1);
		p->due = own_stop(p, j, p->from, p->to);
		return;
	}
	p->before = led_stop(p, j - 1);
	p->due = led_stop(p, j);
	p->behind = led_stop(p, j + 1);
	p->from = led_from(p, j, p->before, p->due);
	p->to = led_from(p, j + 1, p->due, p->behind);
}

/* The same of the next burst, at the stops of another pair. */
static void led_on(struct interp_pair *p)
{
	const int64_t j = ++p->burst;

	p->from = p->to;
	p->before = p->due;
	p->due = p->behind;
	p->behind = led_stop(p, j + 1);
	p->to = led_from(p, j + 1, p->due, p->behind);
}

/* Two stops may be so near to each other that nothing is due at the second. */
static bool burst_is_empty(const struct interp_pair *p)
{
	return p->to == p->from;
}

/* Find the last burst before this one that is not empty, or -1. */
static void led_find_prior(struct interp_pair *p)
{
	const int64_t to = p->from;
	int64_t j = p->burst, from, at = p->before;

	do {
		j--;
		p->done = at;
		at = led_stop(p, j - 1);
		from = led_from(p, j, at, p->done);
	} while (j >= 0 && from == to);
	p->prior = j;
	p->prior_from = from;
	p->prior_before = at;
}

/* At stops of its own, no burst is empty. */
INLINE void own_find_prior(struct interp_pair *p)
{
	p->prior = p->burst - 1;
	p->prior_from = own_from(p, p->prior);
	p->done = own_stop(p, p->prior, p->prior_from, p->from);
}

static void burst_find_prior(struct interp_pair *p)
{
	if (p->stops)
		led_find_prior(p);
	else
		own_find_prior(p);
}

INLINE void own_next(struct interp_pair *p)
{
	p->prior = p->burst++;
	p->prior_from = p->from;
	p->done = p->due;
	p->from = p->to;
	p->to = own_from(p, p->burst + 1);
	p->due = own_stop(p, p->burst, p->from, p->to);
}

INLINE void own_back(struct interp_pair *p)
{
	p->burst = p->prior;
	p->to = p->from;
	p->from = p->prior_from;
	p->due = p->done;
	own_find_prior(p);
}

void pair_burst_next(struct interp_pair *p)
{
	if (!p->stops) {
		own_next(p);
		return;
	}
	p->prior = p->burst;
	p->prior_from = p->from;
	p->prior_before = p->before;
	p->done = p->due;
	do
		led_on(p);
	while (p->burst < p->bursts && burst_is_empty(p));
}

void pair_burst_back(struct interp_pair *p)
{
	if (!p->stops) {
		own_back(p);
		return;
	}
	p->behind = p->prior + 1 == p->burst ? p->due :
		    led_stop(p, p->prior + 1);
	p->burst = p->prior;
	p->to = p->from;
	p->from = p->prior_from;
	p->due = p->done;
	p->before = p->prior_before;
	led_find_prior(p);
}

static int64_t burst_stop(const struct interp_pair *p, int64_t j)
{
	return p->stops ? led_stop(p, j) :
			  own_stop(p, j, own_from(p, j), own_from(p, j + 1));
}

int64_t pair_burst_changes(const struct interp_pair *p)
{
	return 2 * p->bursts - (burst_stop(p, 0) == 0) -
	       (burst_stop(p, p->bursts - 1) == p->a);
}

void pair_set_bursts(struct interp_pair *p, int64_t n,
		     const struct interp_pair *lead, bool at_end)
{
	pair_stand(p, at_end);
	p->bursts = n;
	p->lead = lead ? lead->b : 0;
	p->stops = lead ? lead->bursts : 0;
	p->burst = at_end ? n : 0;
	burst_look(p);
	while (p->stops && p->burst < n && burst_is_empty(p))
		led_on(p);
	burst_find_prior(p);
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
		own_next(p);
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
	for (; p->prior >= 0 && m - p->done + p->from - p->prior_from <= left;
	     k += 2) {
		row[k] = (uint8_t)(m - p->done);
		row[k + 1] = (uint8_t)(p->from - p->prior_from);
		left -= m - p->done + p->from - p->prior_from;
		m = p->done;
		own_back(p);
		p->s = p->from;
	}
	row_last(m - p->done, left, row + k);
	if (row[k + 1] > 0)
		own_back(p);
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
	pair_set_bursts(p, (p->b + burst - 1) / burst, NULL, at_end);
}

void pair_set(struct interp_pair *p, enum interp_strategy rule,
	      struct pair_tube t, bool at_end)
{
	const struct pulse_strategy *s = pulse_strategy(rule);

	pair_set_limit(p, 0, at_end);
	if (s->set)
		s->set(p, pair_half_width(p->a, p->b, t), at_end);
}
