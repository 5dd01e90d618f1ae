/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tree.c - any number of axes, one at a time, by pairs of pairs
 *
 * Every tick goes from the root of the tree to one leaf, each pair on the way
 * choosing by its rule; back, each pair tells which of its inputs came last.
 * Two axes are one pair, one axis is a leaf alone.
 *
 * A helix is led by its circle: the other axes are one such tree, and one of
 * their pulses is due whenever their share of the way falls half a pulse
 * behind the circle's, measured by swept area so that it follows the arc's
 * length.  What is due depends on the circle's place alone, so the last pulse
 * was the tree's if more have been sent than were due one circle pulse ago.
 *
 * A pulse of the circle may sweep as much as hundreds of the tree's are due
 * behind it.  If it took that much of the way by itself, these would come in a
 * burst, and the axes of the tree would be much faster than they may.  So a
 * pulse and what is due behind it are a group, and its ticks are spread evenly
 * over what the group takes.
 */
#include "pulse/couple.h"
#include "pulse/pulse.h"

#include <stdlib.h>

uint32_t pulse_inputs(struct interp_cursor *c, uint32_t except,
		      struct couple_input *in)
{
	uint32_t n = 0;

	for (uint32_t j = 0; j < c->p.head->naxes; j++) {
		const uint32_t axis = c->p.head->column[j];
		const int64_t d = interp_round_sub(pulse_node(c, j, true)) -
				  interp_round_sub(pulse_node(c, j, false));

		if (d == 0 || except & 1u << axis)
			continue;
		c->sign[axis] = d > 0 ? 1 : -1;
		c->pulse[axis] = (uint16_t)pulse_move(axis, d < 0);
		c->pulse_back[axis] = (uint16_t)pulse_move(axis, d > 0);
		in[n++] = (struct couple_input) { (int8_t)axis, llabs(d) };
	}
	return n;
}

struct couple_rule pulse_rule(const struct interp_cursor *c)
{
	const struct interp_program_head *h = c->p.head;

	return (struct couple_rule) {
		.strategy = (enum interp_strategy)h->strategy,
		.coupling = (enum interp_coupling)h->coupling,
		.tube = { h->tolerance_milli, h->perpendicular },
	};
}

bool pulse_bits(struct interp_cursor *c, uint32_t npairs)
{
	const uint64_t room = c->p.head->nbits;
	uint64_t at = c->seg.arg;

	if (c->seg.kind != INTERP_LINE || at == 0)
		return true;
	at--;
	for (uint32_t i = 0; i < npairs; i++) {
		const uint64_t words = pair_words(&c->pair[i]);

		if (at > room || words > room - at)
			return false;
		pair_set_bits(&c->pair[i], c->p.bits + at);
		at += words;
	}
	return true;
}

/* Aim the tree at all axes except @except.  Return: the sum of their pulses. */
static int64_t tree_set(struct interp_cursor *c, uint32_t except, bool at_end)
{
	const struct couple_rule rule = pulse_rule(c);
	struct couple_input in[INTERP_NAXES], root;
	const uint32_t n = pulse_inputs(c, except, in);

	if (n == 0)
		return 0;
	for (uint32_t i = 0; i < n; i++) {
		/* No builder makes this; the block is damaged. */
		if (in[i].pulses > INTERP_PULSES_MAX)
			return -1;
	}
	root = couple_tree(c->pair, in, n);
	if (root.pulses > INTERP_PULSES_MAX)
		return -1;
	couple_set(c->pair, n - 1, &rule, at_end);
	c->root = root.code;
	return pulse_bits(c, n - 1) ? root.pulses : -1;
}

static bool tree_enter(struct interp_cursor *c, bool at_end)
{
	return pulse_stand(c, at_end) && tree_set(c, 0, at_end) == c->seg.ticks;
}

static inline uint32_t tree_tick(struct interp_cursor *c)
{
	int8_t code = c->root;

	while (code < 0) {
		struct interp_pair *p = &c->pair[~code];

		code = pair_forward(p) ? p->in_a : p->in_b;
	}
	c->tick++;
	c->measure++;
	c->pos[code] += c->sign[code];
	return c->pulse[code];
}

static inline uint32_t tree_tick_back(struct interp_cursor *c)
{
	int8_t code = c->root;

	while (code < 0) {
		struct interp_pair *p = &c->pair[~code];

		code = pair_back(p) ? p->in_a : p->in_b;
	}
	c->tick--;
	c->measure--;
	c->pos[code] -= c->sign[code];
	return c->pulse_back[code];
}

/*
 * Many ticks at once are made level by level.  For each tick, a pair says which
 * input gives it; then each input makes its own ticks, and they are put in
 * order.  Three levels hold eight axes.
 */
#define RUN_MAX		64
#define RUN_ROOM	(RUN_MAX + PULSE_AT_ONCE)

static void leaf_run(struct interp_cursor *c, int8_t axis, int ticks,
		     uint16_t *ret)
{
	const uint16_t pulse = c->backward ? c->pulse_back[axis] :
					     c->pulse[axis];

	pulse_row(ret, RUN_ROOM, pulse, (uint32_t)ticks);
	c->pos[axis] += (c->backward ? -ticks : ticks) * c->sign[axis];
}

/* Both inputs are axes, so there is no order to restore. */
static void leaves_run(struct interp_cursor *c, const struct interp_pair *p,
		       const uint8_t *second, uint32_t ticks, uint16_t *ret)
{
	const uint16_t *pulse = c->backward ? c->pulse_back : c->pulse;
	const uint32_t a = pulse[p->in_a], turn = a ^ pulse[p->in_b];

	for (uint32_t k = 0; k < ticks; k++)
		ret[k] = (uint16_t)(a ^ (turn & -(uint32_t)second[k]));
}

static void pair_ticks(struct interp_cursor *c, struct interp_pair *p,
		       uint32_t ticks, uint8_t *second)
{
	if (c->backward)
		pair_run_back(p, ticks, second);
	else
		pair_run(p, ticks, second);
}

static void tree_run(struct interp_cursor *c, int8_t code, uint32_t ticks,
		     uint16_t *ret);

/* With bursts, an input gives many pulses in a row. */
static void rows_run(struct interp_cursor *c, struct interp_pair *p,
		     uint32_t ticks, uint16_t *ret)
{
	uint16_t pulse[2][RUN_ROOM];
	const uint16_t *a = pulse[0], *b = pulse[1];
	uint8_t row[PAIR_ROWS(RUN_MAX)];
	const int64_t m = p->m;
	const uint32_t n = c->backward ? pair_rows_back(p, ticks, row) :
					 pair_rows(p, ticks, row);
	const uint32_t by_a = (uint32_t)llabs(p->m - m);

	tree_run(c, p->in_a, by_a, pulse[0]);
	tree_run(c, p->in_b, ticks - by_a, pulse[1]);
	for (uint32_t k = 0; k < n; k += 2) {
		pulse_copy(ret, a, row[k]);
		a += row[k];
		ret += row[k];
		pulse_copy(ret, b, row[k + 1]);
		b += row[k + 1];
		ret += row[k + 1];
	}
}

static void tree_run(struct interp_cursor *c, int8_t code, uint32_t ticks,
		     uint16_t *ret)
{
	struct interp_pair *p;
	uint16_t pulse[2][RUN_ROOM];
	uint8_t second[RUN_MAX];
	uint32_t n = 0;
	int64_t m, s;

	if (code >= 0) {
		leaf_run(c, code, (int)ticks, ret);
		return;
	}
	p = &c->pair[~code];
	if (p->bursts) {
		rows_run(c, p, ticks, ret);
		return;
	}
	m = p->m;
	s = p->s;
	pair_ticks(c, p, ticks, second);
	if (p->in_a >= 0 && p->in_b >= 0) {
		c->pos[p->in_a] += (int32_t)(p->m - m) * c->sign[p->in_a];
		c->pos[p->in_b] += (int32_t)(p->s - s) * c->sign[p->in_b];
		leaves_run(c, p, second, ticks, ret);
		return;
	}
	for (uint32_t k = 0; k < ticks; k++)
		n += second[k];
	tree_run(c, p->in_a, ticks - n, pulse[0]);
	tree_run(c, p->in_b, n, pulse[1]);
	n = 0;
	for (uint32_t k = 0; k < ticks; k++) {
		ret[k] = *(second[k] ? &pulse[1][n] : &pulse[0][k - n]);
		n += second[k];
	}
}

/* Only a pair with a limit writes no more than it is asked for. */
static void tree_some(struct interp_cursor *c, uint32_t ticks, uint16_t *ret)
{
	uint16_t some[RUN_ROOM];

	if (c->root < 0 && !c->pair[~c->root].bursts) {
		tree_run(c, c->root, ticks, ret);
		return;
	}
	tree_run(c, c->root, ticks, some);
	memcpy(ret, some, ticks * sizeof(*ret));
}

/* Every tick makes a pulse. */
static uint32_t tree_ticks(struct interp_cursor *c, uint32_t ticks,
			   uint16_t *ret)
{
	const int dir = c->backward ? -1 : 1;

	for (uint32_t done = 0, n; done < ticks; done += n) {
		n = ticks - done < RUN_MAX ? ticks - done : RUN_MAX;
		tree_some(c, n, ret + done);
	}
	c->tick += (uint32_t)dir * ticks;
	c->measure += dir * (int64_t)ticks;
	return ticks;
}

static uint32_t tree_forward(struct interp_cursor *c, uint32_t ticks,
			     uint16_t *ret)
{
	return ticks == 1 ? pulse_ticks(c, tree_tick, 1, ret) :
			    tree_ticks(c, ticks, ret);
}

static uint32_t tree_back(struct interp_cursor *c, uint32_t ticks,
			  uint16_t *ret)
{
	return ticks == 1 ? pulse_ticks(c, tree_tick_back, 1, ret) :
			    tree_ticks(c, ticks, ret);
}

/* From the start, @ticks of it. */
static void tree_give(struct interp_cursor *c, int8_t code, int64_t ticks)
{
	struct interp_pair *p;

	if (code >= 0) {
		c->pos[code] += (int32_t)ticks * c->sign[code];
		return;
	}
	p = &c->pair[~code];
	pair_seek(p, ticks);
	tree_give(c, p->in_a, p->m);
	tree_give(c, p->in_b, p->s);
}

static bool tree_seek(struct interp_cursor *c, uint32_t tick)
{
	tree_give(c, c->root, tick);
	c->tick = tick;
	c->measure = tick;
	return true;
}

const struct interp_walk pulse_tree = {
	.enter = tree_enter,
	.forward = tree_forward,
	.back = tree_back,
	.seek = tree_seek,
};

/* -- Helices -------------------------------------------------------------- */

/* The pulses of the tree that are due when the circle is at measure @m; a
 * damaged block never has more than there are. */
static int64_t helix_due(const struct interp_cursor *c, int64_t m)
{
	const pulse_wide whole = c->arc.measure;
	pulse_wide due;

	if (whole == 0)
		return c->others;
	due = (2 * (pulse_wide)m * c->others + whole) / (2 * whole);
	return due > c->others ? c->others : due < 0 ? 0 : (int64_t)due;
}

static int64_t helix_sent(const struct interp_cursor *c)
{
	return (int64_t)c->tick - c->circle.tick;
}

/* The circle is somewhere else now. */
static void helix_group_set(struct interp_cursor *c)
{
	const bool any = c->circle.tick > 0;
	const int64_t last = any ? circle_last(&c->circle) : 0;
	const int64_t before = c->circle_at - last;
	const int64_t due = helix_due(c, c->circle_at);

	c->group.sent = any ? helix_due(c, before) : 0;
	c->group.at = before + c->group.sent;
	c->group.measure = last + due - c->group.sent;
	c->group.tree = due - c->group.sent;
	c->group.circle = any;
}

/* Ticks of the group. */
static int64_t group_ticks(const struct interp_cursor *c)
{
	return helix_sent(c) - c->group.sent + c->group.circle;
}

/* Behind @ticks of the group.  Each adds one at least. */
static int64_t group_measure(const struct interp_cursor *c, int64_t ticks)
{
	const int64_t all = c->group.tree + c->group.circle;

	return c->group.at + (all > 0 ? c->group.measure * ticks / all : 0);
}

static bool helix_enter(struct interp_cursor *c, bool at_end)
{
	if (!pulse_stand(c, at_end) || !pulse_circle_set(c, at_end))
		return false;
	c->others = tree_set(c, 1u << c->arc.axis_a | 1u << c->arc.axis_b,
			     at_end);
	if (c->others < 0)
		return false;
	c->circle_at = at_end ? c->arc.measure : 0;
	c->whole = c->arc.measure + c->others;
	c->measure = at_end ? c->whole : 0;
	helix_group_set(c);
	return c->seg.ticks == c->circle.ticks + c->others &&
	       (c->circle.ticks == 0) == (c->arc.measure == 0);
}

static uint32_t helix_circle_tick(struct interp_cursor *c, int dir)
{
	uint32_t moved;

	if (dir < 0)
		c->circle_at -= circle_last(&c->circle);
	moved = pulse_circle_move(c, dir);
	if (dir > 0)
		c->circle_at += circle_last(&c->circle);
	c->tick += (uint32_t)dir;
	helix_group_set(c);
	return moved;
}

static uint32_t helix_tick(struct interp_cursor *c)
{
	uint32_t moved;

	if (helix_sent(c) < c->group.sent + c->group.tree)
		moved = tree_tick(c);
	else if (c->circle.tick < c->circle.ticks)
		moved = helix_circle_tick(c, 1);
	else
		return PULSE_BAD;
	c->measure = group_measure(c, group_ticks(c));
	return moved;
}

static uint32_t helix_tick_back(struct interp_cursor *c)
{
	uint32_t moved;

	if (c->tick == 0)
		return PULSE_BAD;
	/* Did the tree make the last pulse? */
	moved = c->group.circle && helix_sent(c) <= c->group.sent ?
		helix_circle_tick(c, -1) : tree_tick_back(c);
	c->measure = group_measure(c, group_ticks(c));
	return moved;
}

static uint32_t helix_forward(struct interp_cursor *c, uint32_t ticks,
			      uint16_t *ret)
{
	return pulse_uneven(c, helix_tick, ticks, ret);
}

static uint32_t helix_back(struct interp_cursor *c, uint32_t ticks,
			   uint16_t *ret)
{
	return pulse_uneven(c, helix_tick_back, ticks, ret);
}

static int64_t helix_last(const struct interp_cursor *c)
{
	return c->measure - group_measure(c, group_ticks(c) - 1);
}

/*
 * @ticks are over.  Pulse j of the circle is followed by what is due of the
 * tree, and by nothing before.  Stand at the circle's last pulse.
 */
static bool helix_circle(struct interp_cursor *c, uint32_t tick)
{
	const struct interp_circle start = c->circle;
	uint32_t low = 0, high = tick < start.ticks ? tick : start.ticks;

	while (low < high) {
		const uint32_t mid = high - (high - low) / 2;
		const int64_t before = circle_seek(&c->circle, mid - 1);

		c->circle = start;
		if (before < 0)
			return false;
		if (mid + helix_due(c, before) <= tick)
			low = mid;
		else
			high = mid - 1;
	}
	c->circle_at = circle_seek(&c->circle, low);
	return c->circle_at >= 0;
}

static bool helix_seek(struct interp_cursor *c, uint32_t tick)
{
	int64_t sent;

	if (!helix_circle(c, tick))
		return false;
	sent = tick - c->circle.tick;
	if (sent > helix_due(c, c->circle_at) || sent > c->others)
		return false;
	if (sent > 0)
		tree_give(c, c->root, sent);
	pulse_plane_set(c);
	c->tick = tick;
	helix_group_set(c);
	c->measure = group_measure(c, group_ticks(c));
	return true;
}

const struct interp_walk pulse_helix = {
	.enter = helix_enter,
	.forward = helix_forward,
	.back = helix_back,
	.seek = helix_seek,
	.last = helix_last,
};
