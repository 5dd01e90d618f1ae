/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pair.h - one pulse at a time: which of two inputs gives the next one
 *
 * A pair has a pulses of its main input to give and b <= a of its secondary
 * one.  After m and s of them it lies off its line by
 *
 *	e = b*m - a*s
 *
 * that is e/a pulses along the secondary axis and e/sqrt(a*a + b*b) square to
 * the line.  The start, e = 0, and the end, e = 0 again, are exact under every
 * rule, and a pair at any place tells which input came last, so a walk is
 * undone with no history.  M is the half width of the tube of the tolerance
 * mu, in the same unit as e: floor(mu*a), or floor(mu*sqrt(a*a + b*b)) when mu
 * is measured square to the line.
 *
 *	rule			secondary is next if	e stays in
 *	point-by-point		e > 0			[1 - a, b]
 *	centred			2*e > a - b		+-floor((a + b)/2)
 *	main-direction		e + b > M		[M + 1 - a - b, M]
 *	min-switch		a burst is due		+-M
 *
 * The first three are one: secondary is next if e > T.  Main adds b to e and
 * secondary takes a from it, which turns the window (T - a, T + b] of a + b
 * values round by b; so what came last is told by which part of it e is in:
 * secondary if e <= T + b - a.  For T = 0 and T = floor((a - b)/2) the start
 * and the end lie in the window and nothing else is needed.  The paper on the
 * main-direction rule lets the main axis run until the point after its next
 * pulse is farther than mu from the line: T = M - b, the sign of e kept.  The
 * start may lie below that window, in a first run of the main axis, which is
 * where s = 0; and the main axis may be home before the line ends, after
 * which e falls from a*floor(M/a) to 0 by a at a time and is told apart by the
 * same comparison, for a*floor(M/a) > M - a.
 *
 * No path of one axis at a time has a least greatest |e| under
 * g*floor((a + b)/(2*g)), g = gcd(a, b): the centred rule is the best there is
 * and a tube is empty unless 2*floor(M/g) + 1 >= (a + b)/g.  In a wider one
 * min-switch sends the secondary pulses in n even bursts of at most B,
 *
 *	B = floor((2*floor(M/g) + 1 - b/g) / (a/g))	n = ceil(b/B)
 *	Y(j) = floor(j*b/n)				the secondary's count
 *	X(j) = floor(((Y(j) + Y(j+1))*a + b) / (2*b))	the main axis's place
 *
 * burst j leading from Y(j) to Y(j+1) at X(j), half a burst before the line and
 * half behind it.  What is next and what was last are functions of m and s
 * alone.  Bursts have 0.2 to 1.1 % more changes than there must be where mu is
 * a multiple of a half along the axis, and up to 80 % more where it is not, or
 * is square to the line.  There the program keeps the fewest, as a bit for each
 * pulse of the pair: 1 is the secondary's (path/build_bits.h).
 *
 * Threads: RT-safe.
 */
#ifndef PULSE_PAIR_H
#define PULSE_PAIR_H

#include "interp/cursor.h"

#define PAIR_NEVER	INT64_MAX

/* How far a path may stray. */
struct pair_tube {
	uint32_t milli;			/* mu in 1/1000 pulse */
	bool perpendicular;		/* else along the secondary axis */
};

/** pair_isqrt() - floor of the square root of @n * @n * @m, below 2^126. */
int64_t pair_isqrt(uint64_t n, uint64_t m);

/** pair_half_width() - M; no more than a*b, which no place exceeds. */
int64_t pair_half_width(int64_t a, int64_t b, struct pair_tube t);

/** pair_tube_ok() - can any path of one axis at a time keep to the tube? */
bool pair_tube_ok(int64_t a, int64_t b, struct pair_tube t);

/** pair_burst() - B, at least 1. */
int64_t pair_burst(int64_t a, int64_t b, int64_t half_width);

/**
 * pair_set() - stand at the start or the end; p->a >= p->b >= 0 are set.
 *
 * @rule is one of the four above; any other counts as point-by-point.
 */
void pair_set(struct interp_pair *p, enum interp_strategy rule,
	      struct pair_tube t, bool at_end);

/* The three that are not point-by-point; for the table of strategies. */
void pair_set_centred(struct interp_pair *p, int64_t half, bool at_end);
void pair_set_main_direction(struct interp_pair *p, int64_t half, bool at_end);
void pair_set_min_switch(struct interp_pair *p, int64_t half, bool at_end);

/** pair_set_limit() - the same by T itself, at least -b: for experiments. */
void pair_set_limit(struct interp_pair *p, int64_t limit, bool at_end);

/**
 * pair_set_bursts() - the same by @n bursts; b > 0.
 * @lead: NULL, or a pair of as many main pulses that runs by bursts: bursts
 * then come only where it has one.
 */
void pair_set_bursts(struct interp_pair *p, int64_t n,
		     const struct interp_pair *lead, bool at_end);

/** pair_burst_changes() - of input, by bursts at stops of its own. */
int64_t pair_burst_changes(const struct interp_pair *p);

/** pair_stop() - X(j) of @n bursts of a pair of @a and @b pulses. */
int64_t pair_stop(int64_t a, int64_t b, int64_t n, int64_t j);

/** pair_stop_shared() - of @n stops, the one that burst @j of @count uses. */
static inline int64_t pair_stop_shared(int64_t n, int64_t count, int64_t j)
{
	return (2 * j + 1) * n / (2 * count);
}

/**
 * pair_set_bits() - the same by stored bits, a + b of them.
 *
 * Whatever they are, no input gives more than its total: forward or back, a
 * pair ends where it must.
 */
void pair_set_bits(struct interp_pair *p, const uint64_t *bits);

/** pair_words() - words of 64 bits that it takes to store them. */
static inline uint64_t pair_words(const struct interp_pair *p)
{
	return ((uint64_t)(p->a + p->b) + 63) / 64;
}

/* Is pulse @k, counted from 0, the secondary's? */
static inline bool pair_bit(const struct interp_pair *p, int64_t k)
{
	return p->bits[k / 64] >> k % 64 & 1;
}

/* A burst is over, or about to be undone: on to its neighbour. */
void pair_burst_next(struct interp_pair *p);
void pair_burst_back(struct interp_pair *p);

/** pair_due() - is the next pulse the secondary's? */
static inline bool pair_due(const struct interp_pair *p)
{
	if (p->bursts)
		return p->m >= p->due;
	if (p->bits)
		return p->s < p->b &&
		       (p->m == p->a || pair_bit(p, p->m + p->s));
	return (p->dev > p->limit || p->m == p->a) && p->s < p->b;
}

/** pair_was_due() - was the last one? */
static inline bool pair_was_due(const struct interp_pair *p)
{
	if (p->bursts)
		return p->s > p->from || p->m == p->done;
	if (p->bits)
		return p->s > 0 &&
		       (p->m == 0 || pair_bit(p, p->m + p->s - 1));
	return p->s > 0 && p->dev <= p->limit + p->b - p->a;
}

/** pair_main() - the main input gives a pulse, or takes it back: @dir -1. */
static inline void pair_main(struct interp_pair *p, int dir)
{
	p->m += dir;
	p->dev += dir > 0 ? p->b : -p->b;
}

static inline void pair_second(struct interp_pair *p, int dir)
{
	if (p->bursts && dir < 0 && p->s == p->from)
		pair_burst_back(p);
	p->s += dir;
	p->dev -= dir > 0 ? p->a : -p->a;
	if (p->bursts && dir > 0 && p->s == p->to)
		pair_burst_next(p);
}

/** pair_forward() - one pulse on: true if it is the main input's. */
static inline bool pair_forward(struct interp_pair *p)
{
	if (pair_due(p)) {
		pair_second(p, 1);
		return false;
	}
	pair_main(p, 1);
	return true;
}

/** pair_back() - undo the last pulse: true if it was the main input's. */
static inline bool pair_back(struct interp_pair *p)
{
	if (pair_was_due(p)) {
		pair_second(p, -1);
		return false;
	}
	pair_main(p, -1);
	return true;
}

/**
 * pair_run() - @n pulses on, pair_run_back() undoes the last @n: of each, in
 * the order walked, 1 if it was the secondary's.  There are as many.
 */
void pair_run(struct interp_pair *p, uint32_t n, uint8_t *second);
void pair_run_back(struct interp_pair *p, uint32_t n, uint8_t *second);

#endif /* PULSE_PAIR_H */
