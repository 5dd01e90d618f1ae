/* SPDX-License-Identifier: Apache-2.0 */
/*
 * line.c - straight lines, every axis at once
 *
 * A line of N ticks is at d*k/N on each axis after k of them; N is the
 * longest axis's pulses, rounded up, so no axis moves more than one pulse a
 * tick and each is within half a pulse of the true line.  From a node f
 * subpulses above the middle between two pulses, an axis stands after k ticks
 * at the whole pulses of
 *
 *	(f*N + |d|*k) / F,	F = N << INTERP_SUB_BITS
 *
 * and one tick adds |d| <= F to the remainder, and a pulse whenever that
 * passes F.  An axis that goes down does the same in a mirror.  The remainder
 * is an integer, kept less F so that its sign tells; back is the exact inverse
 * of forward and the end is met exactly, wherever in a pulse the two nodes lie.
 */
#include "pulse/pulse.h"

#include <stdlib.h>
#include <string.h>

/* Stand at @node, on a way of length @len, in subpulses. */
static void dda_set(struct interp_dda *d, int64_t node, int64_t len,
		    int64_t ticks)
{
	const int64_t full = ticks << INTERP_SUB_BITS;
	const int64_t up = ((node + INTERP_SUB / 2) & (INTERP_SUB - 1)) * ticks;

	d->step = llabs(len);
	d->dir = len > 0 ? 1 : -1;
	d->err = len > 0 ? up - full : -1 - up;
}

bool pulse_stand(struct interp_cursor *c, bool at_end)
{
	for (uint32_t j = 0; j < c->p.head->naxes; j++) {
		const int64_t at = pulse_node(c, j, at_end);

		if (!pulse_in_range(at) ||
		    !pulse_in_range(pulse_node(c, j, !at_end)))
			return false;
		c->pos[c->p.head->column[j]] = interp_round_sub(at);
	}
	c->tick = at_end ? c->seg.ticks : 0;
	c->whole = c->seg.ticks;
	c->measure = c->tick;
	return true;
}

bool pulse_dda_enter(struct interp_cursor *c, bool at_end, uint32_t except)
{
	const int64_t ticks = c->seg.ticks;

	if (!pulse_stand(c, at_end))
		return false;
	c->ndda = 0;
	c->dda_full = ticks << INTERP_SUB_BITS;
	for (uint32_t j = 0; j < c->p.head->naxes; j++) {
		const uint32_t axis = c->p.head->column[j];
		const int64_t from = pulse_node(c, j, false);
		const int64_t to = pulse_node(c, j, true);
		struct interp_dda *d = &c->dda[c->ndda];

		if (from == to || except & 1u << axis)
			continue;
		if (llabs(to - from) > c->dda_full)
			return false;
		dda_set(d, at_end ? to : from, to - from, ticks);
		d->axis = axis;
		d->pulse = pulse_move(axis, d->dir < 0);
		d->pulse_back = pulse_move(axis, d->dir > 0);
		d->given = 0;
		c->ndda++;
	}
	/* The axes run in pairs: the last one may have an axis that stands
	 * still beside it. */
	for (uint32_t i = c->ndda; i < INTERP_NAXES; i++)
		c->dda[i] = (struct interp_dda) { .err = -1 };
	return true;
}

/* One tick of one axis.  Its pulse is returned and counted. */
static inline uint32_t dda_forward(struct interp_dda *d, int64_t full)
{
	const int64_t next = d->err + d->step;
	const int32_t over = next >= 0;

	d->err = next < 0 ? next : next - full;
	d->given += over;
	return d->pulse & (uint32_t)-over;
}

static inline uint32_t dda_back(struct interp_dda *d, int64_t full)
{
	const int64_t next = d->err - d->step;
	const int32_t under = next < -full;

	d->err = next < -full ? next + full : next;
	d->given -= under;
	return d->pulse_back & (uint32_t)-under;
}

typedef uint32_t dda_fn(struct interp_dda *d, int64_t full);

/* Store the state of @d, and its pulses in the place of its axis. */
static inline void dda_keep(struct interp_cursor *c, struct interp_dda *at,
			    const struct interp_dda *d)
{
	at->err = d->err;
	c->pos[d->axis] += d->dir * d->given;
}

/*
 * Many ticks of two axes at once.  One axis alone would be half as fast; more
 * than two do not fit the registers.  If the number is odd, the last axis runs
 * with one that stands still.
 */
INLINE void two_run(struct interp_cursor *c, uint32_t i, dda_fn *tick,
		    uint32_t ticks, uint16_t *ret)
{
	const int64_t full = c->dda_full;
	struct interp_dda a = c->dda[i], b = c->dda[i + 1];

	for (uint32_t k = 0; k < ticks; k++) {
		uint32_t pulses = i > 0 ? ret[k] : 0;

		pulses |= tick(&a, full);
		pulses |= tick(&b, full);
		ret[k] = (uint16_t)pulses;
	}
	dda_keep(c, &c->dda[i], &a);
	dda_keep(c, &c->dda[i + 1], &b);
}

/* A tick without a pulse is not a point. */
static uint32_t points_of(uint16_t *ret, uint32_t ticks)
{
	uint32_t points = 0;

	for (uint32_t k = 0; k < ticks; k++) {
		ret[points] = ret[k];
		points += ret[k] != 0;
	}
	return points;
}

INLINE void all_run(struct interp_cursor *c, dda_fn *tick, uint32_t ticks,
		    uint16_t *ret)
{
	if (c->ndda == 0)
		memset(ret, 0, ticks * sizeof(*ret));
	else
		two_run(c, 0, tick, ticks, ret);
	for (uint32_t i = 2; i < c->ndda; i += 2)
		two_run(c, i, tick, ticks, ret);
}

void pulse_dda_all_forward(struct interp_cursor *c, uint32_t ticks,
			   uint16_t *ret)
{
	all_run(c, dda_forward, ticks, ret);
	c->tick += ticks;
	c->measure += ticks;
}

void pulse_dda_all_back(struct interp_cursor *c, uint32_t ticks, uint16_t *ret)
{
	all_run(c, dda_back, ticks, ret);
	c->tick -= ticks;
	c->measure -= ticks;
}

uint32_t pulse_dda_forward(struct interp_cursor *c, uint32_t ticks,
			   uint16_t *ret)
{
	pulse_dda_all_forward(c, ticks, ret);
	return points_of(ret, ticks);
}

uint32_t pulse_dda_back(struct interp_cursor *c, uint32_t ticks, uint16_t *ret)
{
	pulse_dda_all_back(c, ticks, ret);
	return points_of(ret, ticks);
}

bool pulse_dda_seek(struct interp_cursor *c, uint32_t tick)
{
	const int64_t full = c->dda_full;

	for (uint32_t i = 0; i < c->ndda; i++) {
		struct interp_dda *d = &c->dda[i];
		const pulse_wide sum = (pulse_wide)d->step * tick + d->err +
				       full;
		const int64_t given = (int64_t)(sum / full);

		d->err = (int64_t)(sum - (pulse_wide)given * full) - full;
		c->pos[d->axis] += d->dir * (int32_t)given;
	}
	c->tick += tick;
	c->measure += tick;
	return true;
}

INLINE uint32_t
one_tick(struct interp_cursor *c, dda_fn *tick)
{
	uint32_t pulses = 0;

	for (uint32_t i = 0; i < c->ndda; i++) {
		struct interp_dda d = c->dda[i];

		pulses |= tick(&d, c->dda_full);
		dda_keep(c, &c->dda[i], &d);
	}
	return pulses;
}

uint32_t pulse_dda_tick(struct interp_cursor *c)
{
	c->tick++;
	c->measure++;
	return one_tick(c, dda_forward);
}

uint32_t pulse_dda_tick_back(struct interp_cursor *c)
{
	c->tick--;
	c->measure--;
	return one_tick(c, dda_back);
}

int64_t pulse_longest(const struct interp_cursor *c, uint32_t except)
{
	int64_t longest = 0;

	for (uint32_t j = 0; j < c->p.head->naxes; j++) {
		const int64_t d = llabs(pulse_node(c, j, true) -
					pulse_node(c, j, false));

		if (!(except & 1u << c->p.head->column[j]) && d > longest)
			longest = d;
	}
	return (longest + INTERP_SUB - 1) >> INTERP_SUB_BITS;
}

/* More ticks than pulses would be a walk on the spot. */
static bool line_enter(struct interp_cursor *c, bool at_end)
{
	return pulse_dda_enter(c, at_end, 0) &&
	       c->seg.ticks == pulse_longest(c, 0);
}

const struct interp_walk pulse_line = {
	.enter = line_enter,
	.forward = pulse_dda_forward,
	.back = pulse_dda_back,
	.seek = pulse_dda_seek,
};
