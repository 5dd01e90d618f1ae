/* SPDX-License-Identifier: Apache-2.0 */
/*
 * cursor.c - stands on a path, and is walked by a signed distance
 *
 * A place s in a segment belongs to the tick nearest to it.  So how far the
 * walk has come does not depend on the steps by which it came.
 */
#include "interp/cursor.h"
#include "pulse/strategy.h"

#include <errno.h>
#include <math.h>
#include <string.h>

/* -- Actions: no length, no points ----------------------------------------- */

static uint32_t none_run(struct interp_cursor *c, uint32_t ticks,
			 uint16_t *ret)
{
	(void)c;
	(void)ticks;
	(void)ret;
	return PULSE_BAD;
}

static const struct interp_walk pulse_action = {
	.enter = pulse_stand,
	.forward = none_run,
	.back = none_run,
};

static uint32_t axes_moving(const struct interp_cursor *c)
{
	uint32_t n = 0;

	for (uint32_t j = 0; j < c->p.head->naxes; j++)
		n += interp_round_sub(pulse_node(c, j, false)) !=
		     interp_round_sub(pulse_node(c, j, true));
	return n;
}

static const struct interp_walk *pulse_of_line(const struct interp_cursor *c)
{
	const struct interp_program_head *h = c->p.head;
	const struct pulse_strategy *s = pulse_strategy(h->strategy);

	return s->flat == s->line || h->coupling == INTERP_TREE ||
	       axes_moving(c) < 3 ? s->line : s->flat;
}

static const struct interp_walk *pulse_of_arc(const struct interp_cursor *c)
{
	const struct pulse_strategy *s = pulse_strategy(c->p.head->strategy);

	if (s->arc)
		return s->arc;
	return c->seg.ticks == c->arc.circle_ticks ? &pulse_circle :
						     &pulse_helix;
}

static const struct interp_walk *pulse_of(const struct interp_cursor *c)
{
	if (c->seg.kind >= INTERP_BEGIN)
		return &pulse_action;
	if (c->seg.kind == INTERP_PAIR)
		return pulse_strategy(c->p.head->strategy)->pair;
	if (c->seg.kind == INTERP_CURVE)
		return &pulse_curve;
	return c->seg.kind == INTERP_ARC ? pulse_of_arc(c) : pulse_of_line(c);
}

/*
 * Stand at the start or the end of segment @i, if the segment is valid.  A
 * cursor that meets an invalid one has no walk any more and never moves again.
 */
static bool cursor_enter(struct interp_cursor *c, uint32_t i, bool at_end)
{
	const struct interp_seg seg = c->p.segs[i];
	const struct interp_walk *walk;

	c->walk = NULL;
	if (!interp_program_seg_ok(&c->p, i, &seg))
		return false;
	c->seg = seg;
	c->index = i;
	if (c->seg.kind == INTERP_ARC)
		c->arc = c->p.arcs[c->seg.arg];
	if (c->seg.kind == INTERP_PAIR)
		c->couple = c->p.couples[c->seg.arg];
	walk = pulse_of(c);
	if (!walk->enter(c, at_end))
		return false;
	c->walk = walk;
	c->s_mm = at_end ? c->seg.length_mm : 0;
	return true;
}

/* The target place in the measure of this segment. */
static void cursor_want(struct interp_cursor *c)
{
	const double len = c->seg.length_mm;

	if (c->want_mm >= len)
		c->want = c->whole;
	else if (c->want_mm <= 0)
		c->want = 0;
	else
		c->want = (int64_t)(c->want_mm / len * (double)c->whole + 0.5);
}

int interp_cursor_init(struct interp_cursor *c, const struct interp_program *p)
{
	*c = (struct interp_cursor) { .p = *p };
	for (int i = 0; i < INTERP_NAXES; i++) {
		c->pos[i] = p->head->start_pulses[i];
		c->pulses_mm[i] = 1 / p->head->pulse_mm[i];
	}
	return cursor_enter(c, 0, false) ? 0 : -EBADMSG;
}

int interp_cursor_seek(struct interp_cursor *c, uint32_t index, uint32_t tick)
{
	if (index >= c->p.head->nsegs)
		return -ERANGE;
	if (!cursor_enter(c, index, false))
		return -EBADMSG;
	if (tick > c->seg.ticks)
		return -ERANGE;
	if (tick > 0 && !c->walk->seek(c, tick)) {
		c->walk = NULL;
		return -EBADMSG;
	}
	interp_cursor_stop(c);
	return 0;
}

int interp_cursor_seek_end(struct interp_cursor *c, uint32_t index)
{
	if (index >= c->p.head->nsegs)
		return -ERANGE;
	if (!cursor_enter(c, index, true))
		return -EBADMSG;
	interp_cursor_stop(c);
	return 0;
}

void interp_cursor_aim(struct interp_cursor *c, double ds_mm)
{
	c->want_mm = c->s_mm + ds_mm;
	c->backward = ds_mm < 0;
	cursor_want(c);
}

void interp_cursor_stop(struct interp_cursor *c)
{
	if (c->whole > 0)
		c->s_mm = c->seg.length_mm * (double)c->measure /
			  (double)c->whole;
	c->want_mm = c->s_mm;
	c->want = c->measure;
}

/* A place that is less than half a tick away still belongs to its tick. */
#define SLIDE_TICKS	0.499

bool interp_cursor_slide(struct interp_cursor *c)
{
	const double want_mm = c->want_mm;
	const double tick_mm = c->whole > 0 ?
			       c->seg.length_mm / (double)c->whole : 0;
	const double at_mm = tick_mm * (double)c->measure;
	const double low = fmax(0, at_mm - SLIDE_TICKS * tick_mm);
	const double high = fmin(c->seg.length_mm,
				 at_mm + SLIDE_TICKS * tick_mm);

	/* Never go past the target place, and never the other way. */
	c->s_mm = c->backward ? fmax(c->want_mm, fmin(low, c->s_mm)) :
				fmin(c->want_mm, fmax(high, c->s_mm));
	c->want_mm = c->s_mm;
	c->want = c->measure;
	return c->s_mm == want_mm;
}

/* -- Crossing from one segment into the next ------------------------------- */

/*
 * Go to the segment beside this one.  Both say where they meet.  A block in
 * which they differ is damaged, and would cause a jump.
 */
static bool cursor_follow(struct interp_cursor *c, uint32_t i, bool at_end)
{
	int32_t here[INTERP_NAXES];

	memcpy(here, c->pos, sizeof(here));
	if (cursor_enter(c, i, at_end) &&
	    memcmp(here, c->pos, sizeof(here)) == 0)
		return true;
	memcpy(c->pos, here, sizeof(here));
	c->walk = NULL;
	return false;
}

/* MOVED means here: a segment was crossed, look again. */
static enum interp_step cross_forward(struct interp_cursor *c)
{
	const double over_mm = c->want_mm - c->seg.length_mm;
	const uint32_t next = c->index + 1;

	if (next >= c->p.head->nsegs)
		return INTERP_BAD_SEGMENT;
	if (c->p.segs[next].kind >= INTERP_BEGIN) {
		const bool end = c->p.segs[next].kind == INTERP_END;

		c->s_mm = c->want_mm = c->seg.length_mm;
		return end ? INTERP_AT_END : INTERP_AT_ACTION;
	}
	if (!cursor_follow(c, next, false))
		return INTERP_BAD_SEGMENT;
	c->want_mm = over_mm;
	cursor_want(c);
	return INTERP_MOVED;
}

static enum interp_step cross_back(struct interp_cursor *c)
{
	if (c->index == 0) {
		c->s_mm = c->want_mm = 0;
		return INTERP_AT_START;
	}
	if (!cursor_follow(c, c->index - 1, true))
		return INTERP_BAD_SEGMENT;
	c->want_mm += c->seg.length_mm;
	cursor_want(c);
	return INTERP_MOVED;
}

/* If the cursor stands exactly on the end of a segment, it is still in it,
 * unless something is to be done there. */
static bool must_cross(const struct interp_cursor *c)
{
	if (c->backward || c->want_mm < c->seg.length_mm)
		return c->want_mm < 0;
	return c->want_mm > c->seg.length_mm ||
	       (c->index + 1 < c->p.head->nsegs &&
		c->p.segs[c->index + 1].kind >= INTERP_BEGIN);
}

/* It may have come some points on from @here, of which nobody is told. */
static enum interp_step cursor_bad(struct interp_cursor *c,
				   const int32_t here[INTERP_NAXES])
{
	memcpy(c->pos, here, sizeof(c->pos));
	c->walk = NULL;
	return INTERP_BAD_SEGMENT;
}

static uint32_t cursor_ticks(struct interp_cursor *c, uint32_t ticks,
			     uint16_t *ret)
{
	return c->backward ? c->walk->back(c, ticks, ret) :
			     c->walk->forward(c, ticks, ret);
}

/* Ticks of measure one: their number is known. */
static uint32_t run_even(struct interp_cursor *c, uint16_t *ret, uint32_t max)
{
	const int64_t left = c->backward ? c->measure - c->want :
					   c->want - c->measure;

	if (left <= 0)
		return 0;
	return cursor_ticks(c, left < max ? (uint32_t)left : max, ret);
}

uint32_t interp_cursor_run(struct interp_cursor *c, uint16_t *ret,
			   uint32_t max)
{
	int32_t here[INTERP_NAXES];
	uint32_t n;

	if (!c->walk)
		return 0;
	memcpy(here, c->pos, sizeof(here));
	n = c->walk->last ? cursor_ticks(c, max, ret) : run_even(c, ret, max);
	if (n == PULSE_BAD) {
		cursor_bad(c, here);
		return 0;
	}
	if (n > 0)
		c->moved = INTERP_PULSE_MOVED(ret[n - 1]);
	return n;
}

enum interp_step interp_cursor_step(struct interp_cursor *c)
{
	int32_t here[INTERP_NAXES];

	if (!c->walk)
		return INTERP_BAD_SEGMENT;
	memcpy(here, c->pos, sizeof(here));
	for (int crossed = 0; ; crossed++) {
		enum interp_step s;

		while (pulse_may_go_on(c)) {
			uint16_t pulses;
			const uint32_t n = cursor_ticks(c, 1, &pulses);

			if (n == PULSE_BAD)
				return cursor_bad(c, here);
			if (n > 0) {
				c->moved = INTERP_PULSE_MOVED(pulses);
				return INTERP_MOVED;
			}
		}
		if (!must_cross(c)) {
			c->s_mm = c->want_mm;
			return INTERP_ARRIVED;
		}
		if (crossed == INTERP_CROSS_MAX) {
			interp_cursor_stop(c);
			return INTERP_ARRIVED;
		}
		s = c->backward ? cross_back(c) : cross_forward(c);
		if (s != INTERP_MOVED)
			return s;
	}
}

enum interp_step interp_cursor_pass(struct interp_cursor *c)
{
	const uint32_t next = c->index + 1;

	if (!c->walk)
		return INTERP_BAD_SEGMENT;
	if (next >= c->p.head->nsegs)
		return INTERP_AT_END;
	if (!cursor_follow(c, next, false))
		return INTERP_BAD_SEGMENT;
	c->want_mm = 0;
	c->want = 0;
	return INTERP_ARRIVED;
}
