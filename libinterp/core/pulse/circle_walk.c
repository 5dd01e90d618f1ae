/* SPDX-License-Identifier: Apache-2.0 */
/*
 * circle_walk.c - circles by one axis at a time, as a walk
 *
 * The measure is the swept area.  A pulse of one axis sweeps twice as much as
 * the other coordinate is long, and one is added for the pulse itself.  So
 * within a quadrant, or within a stored run, the pulses, the deviation and the
 * measure follow from two lengths that only grow or shrink: they are made in a
 * loop of their own.  Where a quadrant ends, and in the tail, pulses are made
 * one by one.
 */
#include "interp/smaller.h"
#include "pulse/pulse.h"

#include <math.h>
#include <stdlib.h>

/*
 * Node @at_end of the plane's two axes, from the centre, in pulses.  The centre
 * is rounded exactly as the builder rounded it: mm / pulse_mm.
 */
void pulse_circle_node(const struct interp_cursor *c, bool at_end,
		       int64_t ret[2])
{
	const struct interp_arc *arc = &c->arc;
	const double *pulse_mm = c->p.head->pulse_mm;

	for (uint32_t j = 0; j < c->p.head->naxes; j++) {
		const int64_t at = interp_round_sub(pulse_node(c, j, at_end));

		if (c->p.head->column[j] == arc->axis_a)
			ret[0] = at - llround(arc->a_mm /
					      pulse_mm[arc->axis_a]);
		if (c->p.head->column[j] == arc->axis_b)
			ret[1] = at - llround(arc->b_mm /
					      pulse_mm[arc->axis_b]);
	}
}

/* Stand before the first or after the last of the arc's stored runs. */
static bool circle_runs_set(struct interp_cursor *c, bool at_end)
{
	const struct interp_arc *arc = &c->arc;
	struct interp_circle *k = &c->circle;

	if (circle_kept(arc->nruns) > c->p.head->nruns ||
	    arc->run_at > c->p.head->nruns - circle_kept(arc->nruns) ||
	    arc->circle_ticks >= INTERP_PULSES_MAX)
		return false;
	k->runs = c->p.runs + arc->run_at;
	k->nruns = arc->nruns;
	k->run_first = arc->run_first & 1;
	k->run = at_end ? k->nruns - 1 : 0;
	k->sent = at_end ? llabs((int64_t)k->runs[k->run]) : 0;
	return k->runs[k->run] != 0;
}

bool pulse_circle_places(const struct interp_cursor *c,
			 const struct interp_arc *arc, struct interp_circle *k)
{
	const uint64_t n = (uint64_t)circle_places(arc) * CIRCLE_PLACE;
	const uint32_t all = c->p.head->nruns;

	if (n > 0 && (n > all || arc->run_at > all - n))
		return false;
	k->places = n > 0 ? c->p.runs + arc->run_at : NULL;
	k->nplaces = circle_places(arc);
	return true;
}

bool pulse_circle_set(struct interp_cursor *c, bool at_end)
{
	const struct interp_arc *arc = &c->arc;
	int64_t start[2] = { 0, 0 }, end[2] = { 0, 0 };

	if (!pulse_plane_ok(c))
		return false;
	pulse_circle_node(c, false, start);
	pulse_circle_node(c, true, end);
	return circle_enter(&c->circle, arc, start, end, at_end) &&
	       (arc->nruns ? circle_runs_set(c, at_end) :
			     pulse_circle_places(c, arc, &c->circle));
}

static bool pulse_circle_enter(struct interp_cursor *c, bool at_end)
{
	if (!pulse_stand(c, at_end) || !pulse_circle_set(c, at_end) ||
	    c->seg.ticks != c->arc.circle_ticks)
		return false;
	c->whole = c->arc.measure;
	c->measure = at_end ? c->whole : 0;
	return true;
}

/* The circle gave @pulse: the axes follow. */
static uint32_t plane_follow(struct interp_cursor *c, const int8_t pulse[2])
{
	if (pulse[0] == 0 && pulse[1] == 0)
		return PULSE_BAD;
	c->pos[c->arc.axis_a] += pulse[0];
	c->pos[c->arc.axis_b] += pulse[1];
	return pulse_plane_move(c, pulse[0], pulse[1]);
}

uint32_t pulse_circle_move(struct interp_cursor *c, int dir)
{
	int8_t pulse[2];

	if (dir > 0)
		circle_forward(&c->circle, pulse);
	else
		circle_back(&c->circle, pulse);
	return plane_follow(c, pulse);
}

static uint32_t one_forward(struct interp_cursor *c)
{
	struct interp_circle *k = &c->circle;
	uint32_t moved;

	if (k->tick >= k->ticks)
		return PULSE_BAD;
	moved = pulse_circle_move(c, 1);
	if (moved == PULSE_BAD)
		return PULSE_BAD;
	c->measure += circle_last(k);
	return moved;
}

static uint32_t one_back(struct interp_cursor *c)
{
	struct interp_circle *k = &c->circle;

	if (k->tick == 0)
		return PULSE_BAD;
	c->measure -= circle_last(k);
	return pulse_circle_move(c, -1);
}

/* -- Within a quadrant ---------------------------------------------------- */

/* Its pulses, and how long the coordinates are that they change. */
struct quadrant {
	int8_t inward[2], outward[2];
	int64_t in, out;
	uint16_t pulse[2];		/* going forward: outward, inward */
};

static struct quadrant quadrant_of(const struct interp_cursor *c)
{
	const struct interp_circle *k = &c->circle;
	struct quadrant q;

	circle_toward(k, true, q.inward);
	circle_toward(k, false, q.outward);
	q.in = -k->x * q.inward[0] - k->y * q.inward[1];
	q.out = k->x * q.outward[0] + k->y * q.outward[1];
	q.pulse[0] = (uint16_t)pulse_plane_move(c, q.outward[0], q.outward[1]);
	q.pulse[1] = (uint16_t)pulse_plane_move(c, q.inward[0], q.inward[1]);
	return q;
}

/* The circle and the axes go to where @q is. */
static void quadrant_keep(struct interp_cursor *c, const struct quadrant *q)
{
	struct interp_circle *k = &c->circle;
	const int64_t x = q->out * q->outward[0] - q->in * q->inward[0];
	const int64_t y = q->out * q->outward[1] - q->in * q->inward[1];

	c->pos[c->arc.axis_a] += (int32_t)(x - k->x);
	c->pos[c->arc.axis_b] += (int32_t)(y - k->y);
	k->x = x;
	k->y = y;
}

static int64_t swept(int64_t coordinate)
{
	return (coordinate > 0 ? coordinate : 0) + 1;
}

/* Until the quadrant or the part before the tail ends.  Return: ticks. */
static uint32_t quadrant_forward(struct interp_cursor *c, uint32_t most,
				 uint16_t *ret)
{
	struct interp_circle *k = &c->circle;
	struct quadrant q = quadrant_of(c);
	int64_t dev = k->dev, measure = c->measure;
	uint32_t n = 0;

	while (n < most && measure < c->want) {
		const bool inward = dev >= 0;

		dev += (inward ? -2 * q.in : 2 * q.out) + 1;
		measure += swept(inward ? q.out : q.in);
		q.in -= inward;
		q.out += !inward;
		ret[n++] = q.pulse[inward];
		if (q.in == 0)
			break;
	}
	k->dev = dev;
	c->measure = measure;
	quadrant_keep(c, &q);
	k->tick += n;
	circle_cross(k);
	return n;
}

/*
 * Until the quadrant or the aim.  Return: ticks; 0: at its border.  The last
 * pulse was inward if dev <= 2 out - 2 in - 3; @over is dev less that, as then
 * the next place is asked for by one sum.
 */
static uint32_t quadrant_back(struct interp_cursor *c, uint32_t most,
			      uint16_t *ret)
{
	struct interp_circle *k = &c->circle;
	struct quadrant q = quadrant_of(c);
	const uint16_t pulse[2] = {
		pulse_turned(q.pulse[0]), pulse_turned(q.pulse[1])
	};
	int64_t over = k->dev - 2 * q.out + 2 * q.in + 3, measure = c->measure;
	uint32_t n = 0;

	while (n < most && q.out > 0) {
		const bool inward = over <= 0;
		const int64_t last = swept(inward ? q.out : q.in);

		if (measure - last < c->want)
			break;
		measure -= last;
		over += (inward ? 2 * q.in : -2 * q.out) + 3;
		q.in += inward;
		q.out -= !inward;
		ret[n++] = pulse[inward];
	}
	k->dev = over + 2 * q.out - 2 * q.in - 3;
	c->measure = measure;
	quadrant_keep(c, &q);
	k->tick -= n;
	return n;
}

/* -- Along stored runs ----------------------------------------------------- */

/* A run: its axis, its pulse along that, and what each adds to the measure.
 * Only the other coordinate counts, and it stays. */
struct run {
	int axis;
	int64_t step, sweeps;
};

static struct run run_of(const struct interp_circle *k)
{
	const int axis = (int)((k->run + k->run_first) & 1);
	const int64_t step = k->runs[k->run] > 0 ? 1 : -1;

	return (struct run) {
		axis, step, swept(k->ccw * step * (axis ? k->x : -k->y)),
	};
}

static int64_t run_length(const struct interp_circle *k)
{
	return llabs((int64_t)k->runs[k->run]);
}

static uint16_t run_pulse(const struct interp_cursor *c, const struct run *r,
			  bool back)
{
	return (uint16_t)pulse_move(r->axis ? c->arc.axis_b : c->arc.axis_a,
				    (r->step < 0) != back);
}

/* @n pulses along the run, or back if @n < 0. */
static void run_keep(struct interp_cursor *c, const struct run *r, int64_t n)
{
	struct interp_circle *k = &c->circle;
	int64_t *at = r->axis ? &k->y : &k->x;
	const int64_t by = n * r->step;

	k->dev += (2 * *at + by) * by;
	*at += by;
	k->sent += n;
	k->tick += (uint32_t)n;
	c->measure += n * r->sweeps;
	c->pos[r->axis ? c->arc.axis_b : c->arc.axis_a] += (int32_t)by;
}

/* In a damaged block the runs may end too early. */
static bool run_next(struct interp_circle *k)
{
	if (k->run + 1 >= k->nruns || k->runs[k->run + 1] == 0)
		return false;
	k->run++;
	k->sent = 0;
	return true;
}

static uint32_t run_forward(struct interp_cursor *c, uint32_t most,
			    uint16_t *ret)
{
	struct interp_circle *k = &c->circle;
	uint32_t n = 0;

	while (n < most && c->measure < c->want) {
		int64_t some;
		struct run r;

		if (k->sent == run_length(k) && !run_next(k))
			break;
		r = run_of(k);
		some = fewer(run_length(k) - k->sent, most - n);
		if (c->measure + (some - 1) * r.sweeps >= c->want)
			some = (c->want - c->measure - 1) / r.sweeps + 1;
		pulse_row(ret + n, most - n, run_pulse(c, &r, false),
			  (uint32_t)some);
		run_keep(c, &r, some);
		n += (uint32_t)some;
	}
	return n;
}

/* A run that is taken back ends where the one before does. */
static void run_prior(struct interp_circle *k)
{
	if (k->sent == 0 && k->run > 0) {
		k->run--;
		k->sent = run_length(k);
	}
}

static uint32_t run_back(struct interp_cursor *c, uint32_t most, uint16_t *ret)
{
	struct interp_circle *k = &c->circle;
	uint32_t n = 0;

	while (n < most) {
		const struct run r = run_of(k);
		int64_t some = fewer(k->sent, most - n);

		if (c->measure - some * r.sweeps < c->want)
			some = (c->measure - c->want) / r.sweeps;
		if (some <= 0)
			break;
		pulse_row(ret + n, most - n, run_pulse(c, &r, true),
			  (uint32_t)some);
		run_keep(c, &r, -some);
		run_prior(k);
		n += (uint32_t)some;
	}
	return n;
}

/* -- The walk -------------------------------------------------------------- */

static uint32_t some_forward(struct interp_cursor *c, uint32_t most,
			     uint16_t *ret)
{
	const struct interp_circle *k = &c->circle;

	if (k->runs)
		return run_forward(c, pulse_fewer(most, k->ticks - k->tick),
				   ret);
	return k->tick >= k->tail ? 0 :
	       quadrant_forward(c, pulse_fewer(most, k->tail - k->tick), ret);
}

static uint32_t some_back(struct interp_cursor *c, uint32_t most, uint16_t *ret)
{
	const struct interp_circle *k = &c->circle;

	most = pulse_fewer(most, k->tick);
	if (k->runs)
		return run_back(c, most, ret);
	return k->tick > k->tail ? 0 : quadrant_back(c, most, ret);
}

/* Pulses until @ticks or the aim: many by @some, or one where that has none. */
INLINE uint32_t circle_run(struct interp_cursor *c, uint32_t ticks,
			   uint16_t *ret, pulse_run_fn *some,
			   uint32_t (*one)(struct interp_cursor *c))
{
	uint32_t points = 0;

	while (points < ticks && pulse_may_go_on(c)) {
		uint32_t n = some(c, ticks - points, ret + points);

		if (n == 0) {
			const uint32_t pulses = one(c);

			if (pulses == PULSE_BAD)
				return PULSE_BAD;
			ret[points] = (uint16_t)pulses;
			n = 1;
		}
		points += n;
		c->tick = c->circle.tick;
	}
	return points;
}

static uint32_t pulse_circle_forward(struct interp_cursor *c, uint32_t ticks,
				     uint16_t *ret)
{
	return circle_run(c, ticks, ret, some_forward, one_forward);
}

static uint32_t pulse_circle_back(struct interp_cursor *c, uint32_t ticks,
				  uint16_t *ret)
{
	return circle_run(c, ticks, ret, some_back, one_back);
}

void pulse_plane_set(struct interp_cursor *c)
{
	int64_t start[2] = { 0, 0 };

	pulse_circle_node(c, false, start);
	c->pos[c->arc.axis_a] += (int32_t)(c->circle.x - start[0]);
	c->pos[c->arc.axis_b] += (int32_t)(c->circle.y - start[1]);
}

static bool pulse_circle_seek(struct interp_cursor *c, uint32_t tick)
{
	c->measure = circle_seek(&c->circle, tick);
	if (c->measure < 0)
		return false;
	pulse_plane_set(c);
	c->tick = tick;
	return true;
}

static int64_t pulse_circle_last(const struct interp_cursor *c)
{
	return circle_last(&c->circle);
}

const struct interp_walk pulse_circle = {
	.enter = pulse_circle_enter,
	.forward = pulse_circle_forward,
	.back = pulse_circle_back,
	.seek = pulse_circle_seek,
	.last = pulse_circle_last,
};
