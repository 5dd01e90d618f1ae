/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sides.c - two contours together, one axis at a time
 *
 * Each contour is a line or a circle by point-by-point comparison, with an end
 * point of its own; which of the two has the next pulse is one stored bit.
 * The bits come from the builder (path/build_pair.c): from the following
 * discriminant of Duan, Liu and Lin, "A New Control Way of Taper WEDM", or
 * from the two shares of length.  The discriminant has no inverse: of the two
 * states before, both look possible, so a memory of one bit a pulse is the
 * least there can be.  Kept in the program it costs the walk nothing, reaches
 * back to the start, and is the same both ways.
 *
 * The contours themselves are undone without memory: the circle as circle.c
 * says, the line by its deviation's range.
 *
 * The measure is the share that each contour has of its own, so many times as
 * it has pulses.  The two shares keep together, so a contour goes evenly along
 * the path, within a pulse, however many pulses the other one has.  If only X Y
 * counted, hundreds of U V behind one of its pulses would come in a burst.
 * Every tick adds one besides, and so makes the measure grow.
 */
#include "pulse/bit_string.h"
#include "pulse/pulse.h"

#include <stdlib.h>

/* In the measure, for a pulse of either contour. */
#define FINE	1024

/* Keeps the measure of a line, the square of its length, in range. */
#define SIDE_MAX	(INT64_C(1) << 28)

static bool line_enter(struct interp_side *s, const int64_t start[2],
		       const int64_t end[2])
{
	const int64_t d[2] = { end[0] - start[0], end[1] - start[1] };
	const int64_t n[2] = { llabs(d[0]), llabs(d[1]) };
	const int8_t a = n[1] > n[0];

	if (n[0] >= SIDE_MAX || n[1] >= SIDE_MAX)
		return false;
	for (int i = 0; i < 2; i++)
		s->sign[i] = d[i] > 0 ? 1 : -1;
	s->longer = a;
	s->a = n[a];
	s->b = n[!a];
	return n[0] + n[1] == s->ticks;
}

bool side_enter(struct interp_side *s, const struct interp_arc *arc,
		const int64_t start[2], const int64_t end[2], bool at_end)
{
	*s = (struct interp_side) {
		.arc = arc->r_mm > 0, .ticks = arc->circle_ticks,
		.tick = at_end ? arc->circle_ticks : 0,
	};
	return s->arc ? circle_enter(&s->circle, arc, start, end, at_end) :
			line_enter(s, start, end);
}

/*
 * dev >= 0 pulses the longer axis, below 0 the shorter; it stays in [-b, a),
 * where that is a rotation by -b modulo a + b.  So the last pulse was the
 * longer axis's if and only if dev < a - b.
 */
static bool line_last_longer(const struct interp_side *s)
{
	return s->dev < s->a - s->b;
}

static void line_forward(struct interp_side *s, int8_t ret[2])
{
	const bool longer = s->dev >= 0;
	const int in = longer ? s->longer : !s->longer;

	s->dev += longer ? -s->b : s->a;
	ret[in] = s->sign[in];
	ret[!in] = 0;
}

static void line_back(struct interp_side *s, int8_t ret[2])
{
	const bool longer = line_last_longer(s);
	const int in = longer ? s->longer : !s->longer;

	s->dev -= longer ? -s->b : s->a;
	ret[in] = (int8_t)-s->sign[in];
	ret[!in] = 0;
}

bool side_forward(struct interp_side *s, int8_t ret[2])
{
	if (s->tick >= s->ticks)
		return false;
	if (s->arc)
		circle_forward(&s->circle, ret);
	else
		line_forward(s, ret);
	s->tick++;
	/* At its own end point; otherwise the block was changed. */
	return s->tick < s->ticks || !s->arc ||
	       (s->circle.x == s->circle.xe && s->circle.y == s->circle.ye);
}

bool side_back(struct interp_side *s, int8_t ret[2])
{
	if (s->tick == 0)
		return false;
	if (s->arc)
		circle_back(&s->circle, ret);
	else
		line_back(s, ret);
	s->tick--;
	return true;
}

/* Of k pulses, m of the longer axis: dev = a*k - (a + b)*m is in its range. */
static int64_t line_seek(struct interp_side *s, int64_t ticks)
{
	const int64_t longer = s->a + s->b ?
			       (s->a * ticks + s->b) / (s->a + s->b) : 0;

	s->dev = s->a * ticks - (s->a + s->b) * longer;
	return s->a * longer + s->b * (ticks - longer);
}

int64_t side_seek(struct interp_side *s, uint32_t tick)
{
	if (tick > s->ticks)
		return -1;
	s->tick = tick;
	return s->arc ? circle_seek(&s->circle, tick) : line_seek(s, tick);
}

int64_t side_last(const struct interp_side *s)
{
	if (s->arc)
		return circle_last(&s->circle);
	return line_last_longer(s) ? s->a : s->b;
}

int64_t side_measure_of(const struct interp_side *s, const int8_t was[2])
{
	if (s->arc)
		return circle_measure_of(&s->circle, was);
	return was[s->longer] ? s->a : s->b;
}

/* -- As a walk ---------------------------------------------------------- */

/* The axes beside the two contours stand still. */
static bool others_stand(const struct interp_cursor *c)
{
	const uint32_t four = 1u << INTERP_X | 1u << INTERP_Y | 1u << INTERP_U |
			      1u << INTERP_V;

	for (uint32_t j = 0; j < c->p.head->naxes; j++) {
		if (!(four & 1u << c->p.head->column[j]) &&
		    pulse_node(c, j, false) != pulse_node(c, j, true))
			return false;
	}
	return true;
}

static bool couple_ok(struct interp_cursor *c)
{
	const struct interp_couple *p = &c->couple;
	const uint64_t words = pulse_string_words(c->seg.ticks);
	const uint64_t ticks = (uint64_t)p->side[0].circle_ticks +
			       p->side[1].circle_ticks;

	for (int i = 0; i < 2; i++) {
		c->arc = p->side[i];
		if (!pulse_plane_ok(c) || p->side[i].measure < 0 ||
		    p->side[i].measure > INT64_MAX / 2)
			return false;
	}
	return p->side[0].axis_a == INTERP_X && p->side[0].axis_b == INTERP_Y &&
	       p->side[1].axis_a == INTERP_U && p->side[1].axis_b == INTERP_V &&
	       ticks == c->seg.ticks && words <= c->p.head->nbits &&
	       p->bits_at <= c->p.head->nbits - words;
}

/* Of contour @i in the pair's measure, behind @gone of its own. */
static int64_t share_of(const struct interp_cursor *c, int i, int64_t gone)
{
	const int64_t whole = c->couple.side[i].measure;
	const int64_t in = gone < 0 ? 0 : gone > whole ? whole : gone;

	return whole > 0 ? (int64_t)((double)in / (double)whole * FINE *
				     (double)c->side[i].ticks) : 0;
}

/* Where contour @i was before its last pulse.  A damaged one may stand at its
 * start and still have a pulse to undo. */
static void side_look_back(struct interp_cursor *c, int i)
{
	struct interp_side *s = &c->side[i];

	s->gone_before = s->tick ? s->gone - side_last(s) : 0;
	s->share_before = s->tick ? share_of(c, i, s->gone_before) : s->share;
}

static void side_stand(struct interp_cursor *c, int i, int64_t gone)
{
	c->side[i].gone = gone;
	c->side[i].share = share_of(c, i, gone);
	side_look_back(c, i);
}

static void pair_stand(struct interp_cursor *c, uint32_t tick)
{
	c->tick = tick;
	c->measure = tick + c->side[0].share + c->side[1].share;
}

static bool pair_enter(struct interp_cursor *c, bool at_end)
{
	if (!pulse_stand(c, at_end) || !couple_ok(c) || !others_stand(c))
		return false;
	c->whole = c->seg.ticks;
	for (int i = 0; i < 2; i++) {
		const struct interp_arc *arc = &c->couple.side[i];
		int64_t start[2] = { 0, 0 }, end[2] = { 0, 0 };

		c->arc = *arc;
		pulse_circle_node(c, false, start);
		pulse_circle_node(c, true, end);
		if (!side_enter(&c->side[i], arc, start, end, at_end) ||
		    !pulse_circle_places(c, arc, &c->side[i].circle))
			return false;
		side_stand(c, i, at_end ? arc->measure : 0);
		c->whole += share_of(c, i, arc->measure);
	}
	pair_stand(c, c->tick);
	return true;
}

/* Which contour has tick number @k + 1. */
static int bit_at(const struct interp_cursor *c, uint32_t k)
{
	return c->p.bits[c->couple.bits_at + k / 64] >> k % 64 & 1;
}

static uint32_t pair_move(struct interp_cursor *c, int i, const int8_t d[2])
{
	const struct interp_arc *arc = &c->couple.side[i];

	c->pos[arc->axis_a] += d[0];
	c->pos[arc->axis_b] += d[1];
	return (d[0] ? pulse_move(arc->axis_a, d[0] < 0) : 0) |
	       (d[1] ? pulse_move(arc->axis_b, d[1] < 0) : 0);
}

static void side_went(struct interp_cursor *c, int i, const int8_t by[2])
{
	struct interp_side *s = &c->side[i];

	s->gone_before = s->gone;
	s->share_before = s->share;
	s->gone += side_measure_of(s, by);
	s->share = share_of(c, i, s->gone);
}

static void side_came(struct interp_cursor *c, int i)
{
	struct interp_side *s = &c->side[i];

	s->gone = s->gone_before;
	s->share = s->share_before;
	side_look_back(c, i);
}

static uint32_t pair_tick(struct interp_cursor *c)
{
	int8_t d[2];
	int i;

	if (c->tick >= c->seg.ticks)
		return PULSE_BAD;
	i = bit_at(c, c->tick);
	if (!side_forward(&c->side[i], d))
		return PULSE_BAD;
	side_went(c, i, d);
	pair_stand(c, c->tick + 1);
	return pair_move(c, i, d);
}

static uint32_t pair_tick_back(struct interp_cursor *c)
{
	int8_t d[2];
	int i;

	if (c->tick == 0)
		return PULSE_BAD;
	i = bit_at(c, c->tick - 1);
	if (!side_back(&c->side[i], d))
		return PULSE_BAD;
	side_came(c, i);
	pair_stand(c, c->tick - 1);
	return pair_move(c, i, d);
}

static uint32_t pair_forward(struct interp_cursor *c, uint32_t ticks,
			     uint16_t *ret)
{
	return pulse_uneven(c, pair_tick, ticks, ret);
}

static uint32_t pair_back(struct interp_cursor *c, uint32_t ticks,
			  uint16_t *ret)
{
	return pulse_uneven(c, pair_tick_back, ticks, ret);
}

static int64_t pair_last(const struct interp_cursor *c)
{
	const struct interp_side *s;

	/* A damaged pair may try to go back from its start. */
	if (c->tick == 0)
		return 1;
	s = &c->side[bit_at(c, c->tick - 1)];
	return 1 + s->share - s->share_before;
}

/* Where a side stands, from its start. */
static void side_way(const struct interp_side *s, int64_t ret[2])
{
	const int64_t sum = s->a + s->b;
	const int64_t longer = sum ? (s->a * s->tick - s->dev) / sum : 0;

	ret[0] = s->circle.x;
	ret[1] = s->circle.y;
	if (s->arc)
		return;
	ret[s->longer] = longer * s->sign[s->longer];
	ret[!s->longer] = (s->tick - longer) * s->sign[!s->longer];
}

static bool pair_side_seek(struct interp_cursor *c, int i, uint32_t tick)
{
	const struct interp_arc *arc = &c->couple.side[i];
	int64_t from[2], to[2];
	int64_t measure;

	side_way(&c->side[i], from);
	measure = side_seek(&c->side[i], tick);
	if (measure < 0)
		return false;
	side_way(&c->side[i], to);
	c->pos[arc->axis_a] += (int32_t)(to[0] - from[0]);
	c->pos[arc->axis_b] += (int32_t)(to[1] - from[1]);
	side_stand(c, i, measure);
	return true;
}

static bool pair_seek(struct interp_cursor *c, uint32_t tick)
{
	const uint32_t second = (uint32_t)
		pulse_string_ones(c->p.bits + c->couple.bits_at, c->seg.ticks,
				  tick);

	if (!pair_side_seek(c, 0, tick - second) ||
	    !pair_side_seek(c, 1, second))
		return false;
	pair_stand(c, tick);
	return true;
}

const struct interp_walk pulse_pair = {
	.enter = pair_enter,
	.forward = pair_forward,
	.back = pair_back,
	.seek = pair_seek,
	.last = pair_last,
};
