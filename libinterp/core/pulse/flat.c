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
	couple_set_flat(c->pair, c->npairs, &rule, at_end);
	return pulse_bits(c, c->npairs);
}

static inline uint32_t flat_move(struct interp_cursor *c, int8_t axis, int dir)
{
	c->tick += (uint32_t)dir;
	c->measure += dir;
	c->pos[axis] += dir * c->sign[axis];
	return dir > 0 ? c->pulse[axis] : c->pulse_back[axis];
}

static inline uint32_t flat_main(struct interp_cursor *c, int dir)
{
	for (uint32_t i = 0; i < c->npairs; i++)
		pair_main(&c->pair[i], dir);
	return flat_move(c, c->root, dir);
}

static inline uint32_t flat_tick(struct interp_cursor *c)
{
	for (uint32_t i = 0; i < c->npairs; i++) {
		struct interp_pair *p = &c->pair[i];

		if (pair_due(p)) {
			pair_second(p, 1);
			return flat_move(c, p->in_b, 1);
		}
	}
	return flat_main(c, 1);
}

static inline uint32_t flat_tick_back(struct interp_cursor *c)
{
	for (uint32_t i = c->npairs; i-- > 0; ) {
		struct interp_pair *p = &c->pair[i];

		if (pair_was_due(p)) {
			pair_second(p, -1);
			return flat_move(c, p->in_b, -1);
		}
	}
	return flat_main(c, -1);
}

static uint32_t flat_forward(struct interp_cursor *c, uint32_t ticks,
			     uint16_t *ret)
{
	return pulse_ticks(c, flat_tick, ticks, ret);
}

static uint32_t flat_back(struct interp_cursor *c, uint32_t ticks,
			  uint16_t *ret)
{
	return pulse_ticks(c, flat_tick_back, ticks, ret);
}

const struct interp_walk pulse_flat = {
	.enter = flat_enter,
	.forward = flat_forward,
	.back = flat_back,
};
