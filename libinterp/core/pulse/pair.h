/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pair.h - one pulse at a time: which of two inputs gives the next one
 *
 * A pair has two inputs.  The main input has a pulses to give, the secondary
 * input has b, and b <= a.  After m pulses of the main input and s of the
 * secondary one the pair lies beside its line by
 *
 *	e = b*m - a*s
 *
 * This is e/a pulses along the secondary axis, and e/sqrt(a*a + b*b) pulses
 * square to the line.  At the start and at the end e is 0, under every rule.
 * At every place the pair can tell which input gave the last pulse.  So a walk
 * is undone without a record of it.  M is the half width of the tube of the
 * tolerance mu, in the unit of e: floor(mu*a), or floor(mu*sqrt(a*a + b*b)) if
 * mu is measured square to the line.
 *
 *	rule			secondary is next if	e stays in
 *	point-by-point		e > 0			[1 - a, b]
 *	centred			2*e > a - b		+-floor((a + b)/2)
 *	main-direction		e + b > M		[M + 1 - a - b, M]
 *	min-switch		a burst is due		+-M
 *
 * The first three rules are one rule: the secondary input is next if e > T.  A
 * pulse of the main input adds b to e, and one of the secondary input takes a
 * from it.  This turns the window (T - a, T + b], which has a + b values, round
 * by b.  So the part of the window that e is in tells which input gave the last
 * pulse: it was the secondary one if e <= T + b - a.  For T = 0 and for
 * T = floor((a - b)/2) the start and the end lie in the window, and nothing
 * else is needed.
 *
 * The paper on the main-direction rule lets the main axis run until the point
 * after its next pulse is farther than mu from the line: T = M - b, and e keeps
 * its sign.  Two places are then outside the window.  At the start e may lie
 * below it, in a first run of the main axis; there s = 0.  And the main axis
 * may have given all its pulses before the line ends; e then falls from
 * a*floor(M/a) to 0, by a at a time.  The same comparison still holds there,
 * because a*floor(M/a) > M - a.
 *
 * No path that moves one axis at a time keeps every |e| below
 * g*floor((a + b)/(2*g)), where g = gcd(a, b).  So the centred rule is the best
 * that there is, and a tube has no path unless 2*floor(M/g) + 1 >= (a + b)/g.
 * In a wider tube min-switch sends the secondary pulses in n even bursts, each
 * of B at most:
 *
 *	B = floor((2*floor(M/g) + 1 - b/g) / (a/g))	n = ceil(b/B)
 *	Y(j) = floor(j*b/n)				the secondary's count
 *	X(j) = floor(((Y(j) + Y(j+1))*a + b) / (2*b))	the main axis's place
 *
 * Burst j leads from Y(j) to Y(j+1) at X(j), one half before the line and one
 * half behind it.  Both the next input and the last one follow from m and s
 * alone.  If mu is measured along the axis and is a multiple of a half, bursts
 * have 0.2 to 1.1 % more changes of input than the fewest possible.  With
 * another mu, or with mu square to the line, they have up to 80 % more.  The
 * program then holds the fewest, as one bit for each pulse of the pair: 1 is a
 * pulse of the secondary input (path/build_bits.h).
 *
 * Threads: RT-safe.
 */
#ifndef PULSE_PAIR_H
#define PULSE_PAIR_H

#include "interp/cursor.h"
#include "pulse/bit_string.h"

#define PAIR_NEVER	INT64_MAX

/* How far a path may stray. */
struct pair_tube {
	uint32_t milli;			/* mu in 1/1000 pulse */
	bool perpendicular;		/* else along the secondary axis */
};

/** pair_isqrt() - floor of the square root of @n * @n * @m, below 2^126. */
int64_t pair_isqrt(uint64_t n, uint64_t m);

/** pair_half_width() - M; at most a*b, because |e| is never greater. */
int64_t pair_half_width(int64_t a, int64_t b, struct pair_tube t);

/** pair_tube_ok() - can any path of one axis at a time keep to the tube? */
bool pair_tube_ok(int64_t a, int64_t b, struct pair_tube t);

/**
 * pair_set() - put the pair at its start or its end.  p->a >= p->b >= 0 are
 * set already.
 *
 * @rule is one of the four above; any other counts as point-by-point.
 */
void pair_set(struct interp_pair *p, enum interp_strategy rule,
	      struct pair_tube t, bool at_end);

/* The rules other than point-by-point, for the table of strategies. */
void pair_set_centred(struct interp_pair *p, int64_t half, bool at_end);
void pair_set_main_direction(struct interp_pair *p, int64_t half, bool at_end);
void pair_set_min_switch(struct interp_pair *p, int64_t half, bool at_end);

/** pair_set_limit() - the same, with T given; T >= -b.  For experiments. */
void pair_set_limit(struct interp_pair *p, int64_t limit, bool at_end);

/** pair_burst_changes() - how often the input changes, with bursts. */
int64_t pair_burst_changes(const struct interp_pair *p);

/**
 * pair_set_bits() - the same, with a + b stored bits.
 *
 * Whatever the bits are, no input gives more pulses than it has.  So the pair
 * ends where it must, forward and back.
 */
void pair_set_bits(struct interp_pair *p, const uint64_t *bits);

/** pair_words() - words of 64 bits that it takes to store them. */
static inline uint64_t pair_words(const struct interp_pair *p)
{
	return pulse_string_words((uint64_t)(p->a + p->b));
}

/* Is pulse @k, counted from 0, one of the secondary input? */
static inline bool pair_bit(const struct interp_pair *p, int64_t k)
{
	return p->bits[k / 64] >> k % 64 & 1;
}

/* A burst is over, or will be undone now: go to the next one, or back to the
 * one before. */
void pair_burst_next(struct interp_pair *p);
void pair_burst_back(struct interp_pair *p);

/** pair_is_by_limit() - does it run by T, without bursts and bits? */
static inline bool pair_is_by_limit(const struct interp_pair *p)
{
	return !p->bursts && !p->bits;
}

/** pair_due_limit() - pair_due() for a pair that runs by T. */
static inline bool pair_due_limit(const struct interp_pair *p)
{
	return (p->dev > p->limit || p->m == p->a) && p->s < p->b;
}

/** pair_was_due_limit() - pair_was_due() for a pair that runs by T. */
static inline bool pair_was_due_limit(const struct interp_pair *p)
{
	return p->s > 0 && p->dev <= p->limit + p->b - p->a;
}

/** pair_due() - does the secondary input give the next pulse? */
static inline bool pair_due(const struct interp_pair *p)
{
	if (p->bursts)
		return p->m >= p->due;
	if (p->bits)
		return p->s < p->b &&
		       (p->m == p->a || pair_bit(p, p->m + p->s));
	return pair_due_limit(p);
}

/** pair_was_due() - did the secondary input give the last pulse? */
static inline bool pair_was_due(const struct interp_pair *p)
{
	if (p->bursts)
		return p->s > p->from || p->m == p->done;
	if (p->bits)
		return p->s > 0 &&
		       (p->m == 0 || pair_bit(p, p->m + p->s - 1));
	return pair_was_due_limit(p);
}

/** pair_main() - the main input gives a pulse; with @dir -1 it takes one
 *  back. */
static inline void pair_main(struct interp_pair *p, int dir)
{
	p->m += dir;
	p->dev += dir > 0 ? p->b : -p->b;
}

/* The same for the secondary input of a pair that runs by T. */
static inline void pair_second_limit(struct interp_pair *p, int dir)
{
	p->s += dir;
	p->dev -= dir > 0 ? p->a : -p->a;
}

static inline void pair_second(struct interp_pair *p, int dir)
{
	if (p->bursts && dir < 0 && p->s == p->from)
		pair_burst_back(p);
	pair_second_limit(p, dir);
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

/** pair_put() - stand where @m and @s pulses are given, both of this path. */
void pair_put(struct interp_pair *p, int64_t m, int64_t s);

/** pair_seek() - give the first @n pulses, from the start. */
void pair_seek(struct interp_pair *p, int64_t n);

/** pair_sent() - how many pulses of the secondary input are sent before pulse
 *  @m + 1 of the main input. */
int64_t pair_sent(const struct interp_pair *p, int64_t m);

/**
 * pair_rows() - of a pair with bursts, give the next @n pulses, 255 at most;
 * pair_rows_back() takes the last @n back.
 *
 * @row: how many the main input gave, then the secondary, the main input again,
 * and so on; some are 0.  Return: how many, at most PAIR_ROWS(@n).
 */
#define PAIR_ROWS(n)	(2 * (n) + 4)
uint32_t pair_rows(struct interp_pair *p, uint32_t n, uint8_t *restrict row);
uint32_t pair_rows_back(struct interp_pair *p, uint32_t n,
			uint8_t *restrict row);

/**
 * pair_run() - the same for a pair without bursts.
 *
 * @second: for each pulse, in the order of the walk, 1 if the secondary input
 * gave it.  The pair must have @n pulses in this direction.
 */
void pair_run(struct interp_pair *p, uint32_t n, uint8_t *second);
void pair_run_back(struct interp_pair *p, uint32_t n, uint8_t *second);

#endif /* PULSE_PAIR_H */
