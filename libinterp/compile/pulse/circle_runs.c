/* SPDX-License-Identifier: Apache-2.0 */
/*
 * circle_runs.c - circles with few changes of axis, in a tube of +-mu
 *
 * As on a line, an axis goes on while its next pulse stays in the tube,
 *
 *	(R - mu)^2 <= x*x + y*y <= (R + mu)^2
 *
 * else the other one does.  Such a path cannot be walked back from its place
 * alone, so the builder plans it once and keeps its runs in the program: a
 * count with a sign for each, alternating between the plane's axes.  Inside a
 * quadrant one coordinate shrinks and the other grows, and some pulse is
 * always legal if the tube has as many values of x*x + y*y as an inward and
 * an outward pulse change it by: mu = 0.7072 is enough for a large circle.
 * A tube never reaches farther in than half the radius.
 */
#include "pulse/pulse.h"

#include "pulse/pair.h"

#include <stdlib.h>

struct tube {
	int64_t lo, hi;			/* of F = x*x + y*y - R*R */
};

/* The floor of 2*mu*R, and so of mu*mu +- 2*mu*R, in exact integers. */
static struct tube tube_of(int64_t r2, uint32_t milli)
{
	const int64_t square = (int64_t)milli * milli;
	const int64_t half = r2 - (r2 + 3) / 4;
	const int64_t twice = pair_isqrt(2 * UINT64_C(1000) * milli,
					 (uint64_t)r2);
	struct tube t = {
		.lo = -((twice - square) / 1000000),
		.hi = (twice + square) / 1000000,
	};

	if (twice - square < 0 || t.lo < -half)
		t.lo = -half;
	return t;
}

/* An inward and an outward pulse together change F by 2*(in + out), at most
 * this. */
static bool tube_ok(int64_t r2, struct tube t)
{
	return t.hi - t.lo + 1 >= pair_isqrt(2, 2 * (uint64_t)(r2 + t.hi));
}

uint32_t circle_smallest_milli(int64_t r2, uint32_t milli)
{
	const uint32_t most = 2000;

	while (milli < most && !tube_ok(r2, tube_of(r2, milli)))
		milli++;
	return milli;
}

/* Where the runs are written; without room they are only counted. */
struct list {
	int32_t *run;
	uint32_t n, room;
	int8_t axis;			/* of the run that is being made */
	int64_t pulses;
	bool turned;			/* an axis came back on itself */
};

static void list_close(struct list *l)
{
	if (l->pulses == 0)
		return;
	if (l->n < l->room)
		l->run[l->n] = (int32_t)l->pulses;
	l->n++;
	l->pulses = 0;
}

static void list_add(struct list *l, const int8_t pulse[2])
{
	const int8_t axis = pulse[1] != 0;

	if (axis != l->axis)
		list_close(l);
	if (l->pulses * pulse[axis] < 0)
		l->turned = true;
	l->axis = axis;
	l->pulses += pulse[axis];
}

/* May axis @axis pulse?  It is the axis of the shrinking or of the growing
 * coordinate. */
static bool legal(const struct interp_circle *k, struct tube t, int8_t axis)
{
	if (circle_inward_axis(k) == axis)
		return k->dev - 2 * circle_in(k) + 1 >= t.lo;
	return k->dev + 2 * circle_out(k) + 1 <= t.hi;
}

/* The tail is straight; the axis of the present run goes first. */
static void plan_tail(struct interp_circle *k, struct interp_arc *arc,
		      struct list *l)
{
	for (int i = 0; i < 2; i++) {
		const int8_t axis = (int8_t)(l->axis ^ i);

		while ((axis ? k->ye - k->y : k->xe - k->x) != 0) {
			int8_t pulse[2] = { 0, 0 };

			pulse[axis] = (axis ? k->ye > k->y : k->xe > k->x) ?
				      1 : -1;
			circle_move(k, pulse);
			arc->measure += circle_measure_of(k, pulse);
			list_add(l, pulse);
		}
	}
}

/* Plan from @k on; begin with axis @first if it may pulse. */
static bool plan(struct interp_circle *k, struct interp_arc *arc,
		 struct tube t, struct list *l)
{
	while (!circle_home(k)) {
		const bool keep = legal(k, t, l->axis);
		const int8_t axis = (int8_t)(keep ? l->axis : !l->axis);
		int8_t pulse[2];

		if (!keep && !legal(k, t, axis))
			return false;
		circle_toward(k, axis == circle_inward_axis(k), pulse);
		circle_move(k, pulse);
		circle_cross(k);
		arc->measure += circle_measure_of(k, pulse);
		list_add(l, pulse);
	}
	plan_tail(k, arc, l);
	list_close(l);
	return !l->turned;
}

bool circle_plan_runs(struct interp_arc *arc, const struct circle_plan *p,
		      int32_t *runs, uint32_t room)
{
	const int64_t r2 = p->start[0] * p->start[0] +
			   p->start[1] * p->start[1];
	struct list l = { .run = runs, .room = room, .axis = p->first };
	struct interp_circle k;
	int8_t first;

	arc->circle_ticks = arc->tail = UINT32_MAX;
	arc->tail_a = arc->tail_b = 0;
	arc->measure = 0;
	if (!circle_enter(&k, arc, p->start, p->end, false) ||
	    !plan(&k, arc, tube_of(r2, p->milli), &l))
		return false;
	first = (int8_t)(l.n % 2 ? l.axis : !l.axis);
	arc->run_first = (uint8_t)first;
	arc->nruns = l.n;
	arc->circle_ticks = arc->tail = k.tick;
	return true;
}
