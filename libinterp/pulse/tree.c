/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tree.c - any number of axes by point-by-point comparison
 *
 * Two axes are one comparison; more are coupled step by step, as the paper on
 * main-direction interpolation has it (section 1.3): pairs make inputs of
 * pairs, (((X,Y),(Z,A)),(B,C)), and every tick goes from the root to one leaf.
 * A pair with a and b pulses to give, a >= b, has
 *
 *	F = m_b*a - m_a*b
 *	F >= 0:  input a,  F - b
 *	F <  0:  input b,  F + a
 *
 * F stays in [-b, a), where the rule is a rotation by -b modulo (a + b); so
 * the last pulse was a's if and only if F < a - b.  At both ends F is 0.
 *
 * A helix is the same tree with the circle as one of the inputs.
 */
#include "pulse/walk.h"

#include <stdlib.h>

#define CIRCLE_INPUT	64

struct input {
	int8_t code;			/* axis, CIRCLE_INPUT, or ~pair */
	int64_t pulses;
};

/* The leaves: every axis with a pulse to give, in order. */
static uint32_t tree_leaves(struct interp_cursor *c, uint32_t except,
			    struct input *in)
{
	uint32_t n = 0;

	for (uint32_t j = 0; j < c->p.head->naxes; j++) {
		const uint32_t axis = c->p.head->column[j];
		const int64_t d = interp_round_sub(walk_node(c, j, true)) -
				  interp_round_sub(walk_node(c, j, false));

		if (d == 0 || except & 1u << axis)
			continue;
		c->sign[axis] = d > 0 ? 1 : -1;
		in[n++] = (struct input) { (int8_t)axis, llabs(d) };
	}
	return n;
}

/* Couple two inputs; the one with more pulses is a, of equals the first. */
static struct input tree_couple(struct interp_cursor *c, uint32_t i,
				struct input p, struct input q)
{
	const bool swap = q.pulses > p.pulses;
	const struct input a = swap ? q : p, b = swap ? p : q;

	c->pair[i] = (struct interp_pair) {
		.a = a.pulses, .b = b.pulses, .dev = 0,
		.in_a = a.code, .in_b = b.code,
	};
	return (struct input) { (int8_t)~i, a.pulses + b.pulses };
}

/* Couple level by level; the root's total. */
static int64_t tree_build(struct interp_cursor *c, struct input *in, uint32_t n)
{
	uint32_t pairs = 0;

	while (n > 1) {
		uint32_t m = 0;

		for (uint32_t i = 0; i + 1 < n; i += 2, pairs++)
			in[m++] = tree_couple(c, pairs, in[i], in[i + 1]);
		if (n % 2)
			in[m++] = in[n - 1];
		n = m;
	}
	c->root = in[0].code;
	return in[0].pulses;
}

static bool tree_enter(struct interp_cursor *c, bool at_end)
{
	struct input in[INTERP_NAXES + 1];
	uint32_t except = 0, n = 0;

	if (!walk_stand(c, at_end))
		return false;
	if (c->seg.kind == INTERP_ARC) {
		if (!walk_circle_set(c, at_end))
			return false;
		except = 1u << c->arc.axis_a | 1u << c->arc.axis_b;
		if (c->circle.ticks > 0)
			in[n++] = (struct input) { CIRCLE_INPUT,
						   c->circle.ticks };
	}
	n += tree_leaves(c, except, in + n);
	return n == 0 ? c->seg.ticks == 0 :
			tree_build(c, in, n) == c->seg.ticks;
}

/* The leaf whose pulse comes next, from the root. */
static int8_t tree_next(struct interp_cursor *c)
{
	int8_t code = c->root;

	while (code < 0) {
		struct interp_pair *p = &c->pair[~code];

		if (p->dev >= 0) {
			p->dev -= p->b;
			code = p->in_a;
		} else {
			p->dev += p->a;
			code = p->in_b;
		}
	}
	return code;
}

/* The leaf whose pulse came last; its comparisons are undone. */
static int8_t tree_last(struct interp_cursor *c)
{
	int8_t code = c->root;

	while (code < 0) {
		struct interp_pair *p = &c->pair[~code];

		if (p->dev < p->a - p->b) {
			p->dev += p->b;
			code = p->in_a;
		} else {
			p->dev -= p->a;
			code = p->in_b;
		}
	}
	return code;
}

/* One pulse of leaf @code, @dir +1 or -1. */
static uint32_t tree_pulse(struct interp_cursor *c, int8_t code, int dir)
{
	int8_t was[2];

	if (code != CIRCLE_INPUT) {
		c->pos[code] += dir * c->sign[code];
		return 1u << code;
	}
	if (dir > 0 ? c->circle.tick >= c->circle.ticks : c->circle.tick == 0)
		return WALK_BAD;
	if (dir > 0)
		circle_forward(&c->circle, was);
	else
		circle_back(&c->circle, was);
	c->pos[c->arc.axis_a] += was[0];
	c->pos[c->arc.axis_b] += was[1];
	return (uint32_t)(was[0] != 0) << c->arc.axis_a |
	       (uint32_t)(was[1] != 0) << c->arc.axis_b;
}

static uint32_t tree_forward(struct interp_cursor *c)
{
	c->tick++;
	c->measure++;
	return tree_pulse(c, tree_next(c), 1);
}

static uint32_t tree_back(struct interp_cursor *c)
{
	c->tick--;
	c->measure--;
	return tree_pulse(c, tree_last(c), -1);
}

const struct interp_walk walk_tree = {
	.enter = tree_enter,
	.forward = tree_forward,
	.back = tree_back,
	.last = walk_last_tick,
};
