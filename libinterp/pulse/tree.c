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
 * A helix is led by its circle: the other axes are one such tree, and one of
 * their pulses is due whenever their share of the way falls half a pulse
 * behind the circle's, measured by swept area so that it follows the arc's
 * length.  What is due depends on the circle's place alone, so the last pulse
 * was the tree's if more have been sent than were due one circle pulse ago.
 */
#include "pulse/walk.h"

#include <stdlib.h>

struct input {
	int8_t code;			/* axis, or ~pair */
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

/* Aim the tree at all axes but @except; the sum of their pulses. */
static int64_t tree_set(struct interp_cursor *c, uint32_t except)
{
	struct input in[INTERP_NAXES];
	const uint32_t n = tree_leaves(c, except, in);

	return n == 0 ? 0 : tree_build(c, in, n);
}

static bool tree_enter(struct interp_cursor *c, bool at_end)
{
	return walk_stand(c, at_end) && tree_set(c, 0) == c->seg.ticks;
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

static uint32_t tree_forward(struct interp_cursor *c)
{
	const int8_t axis = tree_next(c);

	c->tick++;
	c->measure++;
	c->pos[axis] += c->sign[axis];
	return 1u << axis;
}

static uint32_t tree_back(struct interp_cursor *c)
{
	const int8_t axis = tree_last(c);

	c->tick--;
	c->measure--;
	c->pos[axis] -= c->sign[axis];
	return 1u << axis;
}

const struct interp_walk walk_tree = {
	.enter = tree_enter,
	.forward = tree_forward,
	.back = tree_back,
	.last = walk_last_tick,
};

/* -- Helices ---------------------------------------------------------------- */

static bool helix_enter(struct interp_cursor *c, bool at_end)
{
	if (!walk_stand(c, at_end) || !walk_circle_set(c, at_end))
		return false;
	c->others = tree_set(c, 1u << c->arc.axis_a | 1u << c->arc.axis_b);
	c->circle_at = at_end ? c->arc.measure : 0;
	c->whole = c->arc.measure + c->others;
	c->measure = at_end ? c->whole : 0;
	return c->seg.ticks == c->circle.ticks + c->others &&
	       (c->circle.ticks == 0) == (c->arc.measure == 0);
}

/* The tree's pulses due when the circle is at measure @m. */
static int64_t helix_due(const struct interp_cursor *c, int64_t m)
{
	const walk_wide whole = c->arc.measure;

	if (whole == 0)
		return c->others;
	return (int64_t)((2 * (walk_wide)m * c->others + whole) / (2 * whole));
}

static int64_t helix_sent(const struct interp_cursor *c)
{
	return c->measure - c->circle_at;
}

static uint32_t helix_forward(struct interp_cursor *c)
{
	uint32_t moved;

	if (helix_sent(c) < helix_due(c, c->circle_at))
		return tree_forward(c);
	if (c->circle.tick >= c->circle.ticks)
		return WALK_BAD;
	moved = walk_circle_pulse(c, 1);
	c->tick++;
	c->circle_at += circle_last(&c->circle);
	c->measure += circle_last(&c->circle);
	return moved;
}

/* Was the last pulse the tree's? */
static bool helix_last_tree(const struct interp_cursor *c)
{
	return c->circle.tick == 0 ||
	       helix_sent(c) >
	       helix_due(c, c->circle_at - circle_last(&c->circle));
}

static uint32_t helix_back(struct interp_cursor *c)
{
	int64_t last;

	if (c->tick == 0)
		return WALK_BAD;
	if (helix_last_tree(c))
		return tree_back(c);
	last = circle_last(&c->circle);
	c->tick--;
	c->circle_at -= last;
	c->measure -= last;
	return walk_circle_pulse(c, -1);
}

static int64_t helix_last(const struct interp_cursor *c)
{
	return helix_last_tree(c) ? 1 : circle_last(&c->circle);
}

const struct interp_walk walk_helix = {
	.enter = helix_enter,
	.forward = helix_forward,
	.back = helix_back,
	.last = helix_last,
};
