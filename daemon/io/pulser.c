/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pulser.c - from targets in pulses to levels on step and direction lines
 */
#include "pulser.h"

#include <string.h>

void pulser_init(struct pulser *p, const struct pulser_config *c)
{
	*p = (struct pulser) { .c = *c };
}

void pulser_stand_at(struct pulser *p, const int32_t *at)
{
	memcpy(p->put, at, sizeof(p->put));
	p->behind = false;
}

uint32_t pulser_periods(const struct pulser_config *c)
{
	return c->quadrature ? c->high : c->high + c->low;
}

bool pulser_busy(const struct pulser *p)
{
	if (p->behind || p->phase == PULSER_SETUP || p->phase == PULSER_HIGH)
		return true;
	return p->phase == PULSER_LOW && p->left > 1;
}

/* Axes that are not there yet; *ret_down: those of them that go down. */
static uint32_t wanting(const struct pulser *p, const int32_t *target,
			uint32_t *ret_down)
{
	uint32_t want = 0, down = 0;

	for (int i = 0; i < IO_NAXES; i++) {
		want |= (uint32_t)(target[i] != p->put[i]) << i;
		down |= (uint32_t)(target[i] < p->put[i]) << i;
	}
	*ret_down = down;
	return want;
}

static void count(struct pulser *p, uint32_t want, uint32_t down)
{
	for (; want; want &= want - 1) {
		const int i = __builtin_ctz(want);
		const bool back = down >> i & 1;

		p->put[i] += back ? -1 : 1;
		p->turn[i] = (uint8_t)((p->turn[i] + (back ? 3 : 1)) & 3);
	}
}

/* A of a quarter turn is high in 1 and 2, B in 2 and 3. */
static void turn(struct pulser *p, uint32_t want, uint32_t down)
{
	count(p, want, down);
	p->step = p->dir = 0;
	for (int i = 0; i < IO_NAXES; i++) {
		const uint32_t t = p->turn[i];

		p->step |= (t == 1 || t == 2 ? UINT32_C(1) : 0) << i;
		p->dir |= (t >> 1) << i;
	}
	p->phase = PULSER_LOW;
	p->left = p->c.high;
}

static void rise(struct pulser *p, uint32_t want, uint32_t down)
{
	count(p, want, down);
	p->step = want;
	p->phase = PULSER_HIGH;
	p->left = p->c.high;
}

/* If no direction changes, the steps begin at once; else they begin after the
 * set-up time of the direction lines. */
static void begin(struct pulser *p, const int32_t *target)
{
	uint32_t down;
	const uint32_t want = wanting(p, target, &down);
	const uint32_t dir = (p->dir & ~want) | (~down & want);

	p->phase = PULSER_READY;
	if (!want)
		return;
	if (p->c.quadrature) {
		turn(p, want, down);
	} else if (dir == p->dir) {
		rise(p, want, down);
	} else if (p->hold == 0) {
		p->dir = dir;
		p->phase = PULSER_SETUP;
		p->left = p->c.dir_setup;
	}
}

static void fall(struct pulser *p)
{
	p->step = 0;
	p->phase = PULSER_LOW;
	p->left = p->c.low;
	p->hold = p->c.dir_hold;
}

int64_t pulser_level_ns(const struct pulser *p)
{
	switch (p->phase) {
	case PULSER_SETUP:
		return p->c.setup_ns;
	case PULSER_HIGH:
		return p->c.high_ns;
	case PULSER_LOW:
		return p->c.quadrature ? p->c.high_ns : p->c.low_ns;
	default:
		return 0;
	}
}

void pulser_wait(struct pulser *p, const int32_t *target)
{
	uint32_t down;

	p->behind = wanting(p, target, &down) != 0;
}

void pulser_period(struct pulser *p, const int32_t *target)
{
	uint32_t down;

	if (p->hold > 0)
		p->hold--;
	if (p->left > 0)
		p->left--;
	if (p->left == 0) {
		if (p->phase == PULSER_HIGH)
			fall(p);
		else
			begin(p, target);
	}
	p->behind = wanting(p, target, &down) != 0;
}
