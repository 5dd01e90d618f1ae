/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pair.c - set-up of a pair, and its bursts
 *
 * Totals are at most 2^30 and mu at most 1000 pulses, so e, M and the
 * products of a burst stay within 2^62; only the square of M needs 128 bits.
 */
#include "pulse/pair.h"
#include "pulse/walk.h"

/* Bit by bit: no division, the same time always. */
int64_t pair_isqrt(uint64_t n, uint64_t m)
{
	const walk_uwide x = (walk_uwide)n * n * m;
	uint64_t root = 0;

	for (int bit = 62; bit >= 0; bit--) {
		const uint64_t try = root | UINT64_C(1) << bit;

		if ((walk_uwide)try * try <= x)
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

/* X(j); before the first and after the last there is none. */
static int64_t burst_at(const struct interp_pair *p, int64_t j)
{
	if (j < 0)
		return -1;
	if (j >= p->bursts)
		return PAIR_NEVER;
	if (!p->stops)
		return pair_stop(p->a, p->b, p->bursts, j);
	return pair_stop(p->a, p->lead, p->stops,
			 pair_stop_shared(p->stops, p->bursts, j));
}

/* Y(j).  Where another pair sets the stops: half way between two of them. */
static int64_t burst_from(const struct interp_pair *p, int64_t j)
{
	if (j <= 0)
		return 0;
	if (j >= p->bursts)
		return p->b;
	if (!p->stops)
		return j * p->b / p->bursts;
	return (p->b * (burst_at(p, j - 1) + burst_at(p, j)) + p->a) /
	       (2 * p->a);
}

/* Look at burst j from its beginning. */
static void burst_look(struct interp_pair *p)
{
	p->from = burst_from(p, p->burst);
	p->to = burst_from(p, p->burst + 1);
	p->due = burst_at(p, p->burst);
}

/* Two stops may be so near each other that nothing is due at the second. */
static void burst_skip_empty(struct interp_pair *p)
{
	while (p->burst < p->bursts && p->to == p->from) {
		p->burst++;
		burst_look(p);
	}
}

void pair_burst_next(struct interp_pair *p)
{
	p->done = p->due;
	p->burst++;
	burst_look(p);
	burst_skip_empty(p);
}

/* The last burst that is not empty before @j, or -1. */
static int64_t burst_before(const struct interp_pair *p, int64_t j)
{
	do
		j--;
	while (j >= 0 && burst_from(p, j) == burst_from(p, j + 1));
	return j;
}

void pair_burst_back(struct interp_pair *p)
{
	p->burst = burst_before(p, p->burst);
	burst_look(p);
	p->done = burst_at(p, burst_before(p, p->burst));
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
	burst_skip_empty(p);
	p->done = burst_at(p, burst_before(p, p->burst));
}

/* -- By name --------------------------------------------------------------- */

void pair_set(struct interp_pair *p, enum interp_strategy rule,
	      struct pair_tube t, bool at_end)
{
	const int64_t half = pair_half_width(p->a, p->b, t);
	int64_t burst;

	pair_set_limit(p, 0, at_end);
	switch (rule) {
	case INTERP_CENTRED:
		pair_set_limit(p, (p->a - p->b) / 2, at_end);
		break;
	case INTERP_MAIN_DIRECTION:
		pair_set_limit(p, half - p->b, at_end);
		break;
	case INTERP_MIN_SWITCH:
		if (p->b == 0)
			break;
		burst = pair_burst(p->a, p->b, half);
		pair_set_bursts(p, (p->b + burst - 1) / burst, NULL, at_end);
		break;
	default:
		break;
	}
}
