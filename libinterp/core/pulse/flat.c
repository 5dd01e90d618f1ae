/* SPDX-License-Identifier: Apache-2.0 */
/*
 * flat.c - any number of axes, one at a time, each against the longest
 *
 * At every place of the main axis the others' due pulses go out in the fixed
 * order of the axes, each axis all of its own, before the main axis goes on.
 * Which pulses are due at a place is its pair's alone to say; so the last
 * pulse was that of the last axis in the order whose pair has one behind it
 * at this place, else the main axis's.
 */
#include "interp/smaller.h"
#include "pulse/couple.h"
#include "pulse/pulse.h"

static bool flat_enter(struct interp_cursor *c, bool at_end)
{
	const struct couple_rule rule = pulse_rule(c);
	struct couple_input in[INTERP_NAXES];
	const uint32_t n = pulse_stand(c, at_end) ? pulse_inputs(c, 0, in) : 0;
	int64_t sum = 0;

	for (uint32_t i = 0; i < n; i++)
		sum += in[i].pulses;
	if (n == 0 || sum > INTERP_PULSES_MAX || sum != c->seg.ticks)
		return false;
	c->root = in[couple_star(c->pair, in, n)].code;
	c->npairs = n - 1;
	couple_set_star(c->pair, c->npairs, &rule, at_end);
	if (!pulse_bits(c, c->npairs))
		return false;
	c->by_limit = true;
	for (uint32_t i = 0; i < c->npairs; i++)
		c->by_limit &= pair_is_by_limit(&c->pair[i]);
	return true;
}

/* Forward, a pulse of @axis and the bits of it. */
INLINE uint16_t flat_give(struct interp_cursor *c, int8_t axis)
{
	c->pos[axis] += c->sign[axis];
	return c->pulse[axis];
}

INLINE uint16_t flat_take(struct interp_cursor *c, int8_t axis)
{
	c->pos[axis] -= c->sign[axis];
	return c->pulse_back[axis];
}

/*
 * A pair that has nothing due at a place has nothing due there later.  So the
 * others are not looked at again until the main axis goes on.
 */
INLINE void flat_on(struct interp_cursor *c, uint32_t ticks, uint16_t *ret,
		    bool by_limit)
{
	uint32_t n = 0, i = 0;

	while (n < ticks) {
		struct interp_pair *p = &c->pair[i];

		if (i == c->npairs) {
			for (i = 0; i < c->npairs; i++)
				pair_main(&c->pair[i], 1);
			ret[n++] = flat_give(c, c->root);
			i = 0;
		} else if (by_limit ? pair_due_limit(p) : pair_due(p)) {
			if (by_limit)
				pair_second_limit(p, 1);
			else
				pair_second(p, 1);
			ret[n++] = flat_give(c, p->in_b);
		} else {
			i++;
		}
	}
	c->tick += ticks;
	c->measure += ticks;
}

/* The same in the other order. */
INLINE void flat_off(struct interp_cursor *c, uint32_t ticks, uint16_t *ret,
		     bool by_limit)
{
	uint32_t n = 0, i = c->npairs;

	while (n < ticks) {
		struct interp_pair *p;

		if (i == 0) {
			for (; i < c->npairs; i++)
				pair_main(&c->pair[i], -1);
			ret[n++] = flat_take(c, c->root);
			continue;
		}
		p = &c->pair[i - 1];
		if (by_limit ? pair_was_due_limit(p) : pair_was_due(p)) {
			if (by_limit)
				pair_second_limit(p, -1);
			else
				pair_second(p, -1);
			ret[n++] = flat_take(c, p->in_b);
		} else {
			i--;
		}
	}
	c->tick -= ticks;
	c->measure -= ticks;
}

/* -- By bursts ------------------------------------------------------------- */

/*
 * The main axis goes on to where the next burst is, and that burst is a row.
 * Which axis has it is hard to predict.  So it is looked for without a branch,
 * as the least of the keys of the pairs: the place of a burst, and then the
 * order of the axes.
 */
#define NEVER	(INT64_C(1) << 40)	/* a place behind every line */

/* The place -1 is before the first burst of an axis. */
INLINE uint64_t key_of(int64_t place, uint32_t i)
{
	return (uint64_t)(fewer(place, NEVER) + 1) * INTERP_NAXES + i;
}

INLINE int64_t key_place(uint64_t key)
{
	return (int64_t)(key / INTERP_NAXES) - 1;
}

/* Of the burst that pair @i gives next, or gave last. */
INLINE uint64_t key_on(const struct interp_cursor *c, uint32_t i)
{
	return key_of(c->pair[i].due, i);
}

INLINE uint64_t key_off(const struct interp_cursor *c, uint32_t i)
{
	const struct interp_pair *p = &c->pair[i];

	return key_of(p->s > p->from ? p->due : p->done, i);
}

/* Where the next row goes, and how many points are wanted. */
struct row_at {
	uint16_t *ret;
	uint32_t left;
};

/* Return: @n, or what was left. */
INLINE uint32_t row_give(struct row_at *at, uint16_t pulse, int64_t n)
{
	const uint32_t some = (uint32_t)fewer(n, at->left);

	pulse_row(at->ret, at->left, pulse, some);
	at->ret += some;
	at->left -= some;
	return some;
}

/* The main axis has come to @m, in @ticks. */
static void bursts_stand(struct interp_cursor *c, int64_t m, int64_t ticks)
{
	c->tick += (uint32_t)ticks;
	c->measure += ticks;
	c->pos[c->root] += (int32_t)(m - c->pair[0].m) * c->sign[c->root];
	for (uint32_t i = 0; i < c->npairs; i++) {
		struct interp_pair *p = &c->pair[i];

		p->m = m;
		p->dev = p->b * m - p->a * p->s;
	}
}

static void bursts_on(struct interp_cursor *c, struct row_at at)
{
	const int64_t ticks = at.left;
	uint64_t key[INTERP_NAXES];
	int64_t m = c->pair[0].m;

	for (uint32_t i = 0; i < c->npairs; i++)
		key[i] = key_on(c, i);
	while (at.left > 0) {
		uint64_t next = key[0];
		struct interp_pair *p;
		int64_t n;

		for (uint32_t i = 1; i < c->npairs; i++)
			next = key[i] < next ? key[i] : next;
		m += row_give(&at, c->pulse[c->root], key_place(next) - m);
		p = &c->pair[next % INTERP_NAXES];
		n = row_give(&at, c->pulse[p->in_b], p->to - p->s);
		c->pos[p->in_b] += (int32_t)n * c->sign[p->in_b];
		p->s += n;
		if (n > 0 && p->s == p->to) {
			pair_burst_next(p);
			key[next % INTERP_NAXES] =
				key_on(c, next % INTERP_NAXES);
		}
	}
	bursts_stand(c, m, ticks);
}

/* The same in the other order. */
static void bursts_off(struct interp_cursor *c, struct row_at at)
{
	const int64_t ticks = at.left;
	uint64_t key[INTERP_NAXES];
	int64_t m = c->pair[0].m;

	for (uint32_t i = 0; i < c->npairs; i++)
		key[i] = key_off(c, i);
	while (at.left > 0) {
		uint64_t last = key[0];
		struct interp_pair *p;
		int64_t n;

		for (uint32_t i = 1; i < c->npairs; i++)
			last = key[i] > last ? key[i] : last;
		n = key_place(last);
		m -= row_give(&at, c->pulse_back[c->root],
			      n < 0 ? at.left : m - n);
		if (at.left == 0)
			break;
		p = &c->pair[last % INTERP_NAXES];
		if (p->s == p->from)
			pair_burst_back(p);
		n = row_give(&at, c->pulse_back[p->in_b], p->s - p->from);
		c->pos[p->in_b] -= (int32_t)n * c->sign[p->in_b];
		p->s -= n;
		key[last % INTERP_NAXES] = key_off(c, last % INTERP_NAXES);
	}
	bursts_stand(c, m, -ticks);
}

/* -- The walk -------------------------------------------------------------- */

static uint32_t flat_forward(struct interp_cursor *c, uint32_t ticks,
			     uint16_t *ret)
{
	if (c->by_limit)
		flat_on(c, ticks, ret, true);
	else if (c->pair[0].bursts)
		bursts_on(c, (struct row_at) { ret, ticks });
	else
		flat_on(c, ticks, ret, false);
	return ticks;
}

static uint32_t flat_back(struct interp_cursor *c, uint32_t ticks,
			  uint16_t *ret)
{
	if (c->by_limit)
		flat_off(c, ticks, ret, true);
	else if (c->pair[0].bursts)
		bursts_off(c, (struct row_at) { ret, ticks });
	else
		flat_off(c, ticks, ret, false);
	return ticks;
}

/* The tick in which the main axis comes to place @m. */
static int64_t flat_tick_of(const struct interp_cursor *c, int64_t m)
{
	int64_t ticks = m;

	for (uint32_t i = 0; m > 0 && i < c->npairs; i++)
		ticks += pair_sent(&c->pair[i], m - 1);
	return ticks;
}

/* The last place to which the main axis has come by @tick. */
static int64_t flat_place(const struct interp_cursor *c, int64_t tick)
{
	int64_t low = 0, high = c->pair[0].a;

	while (low < high) {
		const int64_t mid = low + (high - low + 1) / 2;

		if (flat_tick_of(c, mid) <= tick)
			low = mid;
		else
			high = mid - 1;
	}
	return low;
}

/* What is left of @tick at that place is given in the order of the axes. */
static bool flat_seek(struct interp_cursor *c, uint32_t tick)
{
	const int64_t m = c->npairs ? flat_place(c, tick) : tick;
	int64_t left = tick - flat_tick_of(c, m);

	for (uint32_t i = 0; i < c->npairs; i++) {
		struct interp_pair *p = &c->pair[i];
		const int64_t was = m > 0 ? pair_sent(p, m - 1) : 0;
		const int64_t due = pair_sent(p, m) - was;
		const int64_t given = due < left ? due : left;

		pair_put(p, m, was + given);
		left -= given;
		c->pos[p->in_b] += (int32_t)(was + given) * c->sign[p->in_b];
	}
	c->pos[c->root] += (int32_t)m * c->sign[c->root];
	c->tick = tick;
	c->measure = tick;
	return left == 0;
}

const struct interp_walk pulse_flat = {
	.enter = flat_enter,
	.forward = flat_forward,
	.back = flat_back,
	.seek = flat_seek,
};
