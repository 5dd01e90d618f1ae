/* SPDX-License-Identifier: Apache-2.0 */
/*
 * circle_seek.c - stands on a circle after any number of pulses
 *
 * In a quadrant each pulse goes to the next anti-diagonal d = out - in, so the
 * pulse tells the anti-diagonal.  With n(d) for the least `in` on it that is
 * not inside the circle, F(in, in + d) >= 0, the walk stands on n(d) or on the
 * point before it; from either it goes to in = n(d) - 1 on the next one.  It
 * leaves a quadrant at out = meet.
 *
 * The measure is the swept area.  An outward pulse adds the `in` at which it is
 * made, an inward one the `out`.  Their difference is that of the product
 * in*out, and `in` in a row is the greatest inside the circle: so the area is
 * twice the sum over the rows (circle_rows.c), less that difference.  The rows
 * from the start are many, so the program keeps the measure at some places.
 */
#include "interp/smaller.h"
#include "pulse/pair.h"
#include "pulse/pulse.h"

#include <stdlib.h>

#define SMALL	4			/* meets the axis nearer: walked */

struct seek {
	struct interp_circle *k;
	int64_t r2;
	int64_t in, out;		/* in the quadrant */
	int64_t area;			/* twice the one swept so far */
	bool measures;			/* it is asked for */
};

/* Go to this place in the same quadrant. */
static void stretch(struct seek *s, int64_t in, int64_t out)
{
	if (s->measures)
		s->area += 2 * circle_rows(s->r2, s->out, out) -
			   (in * out - s->in * s->out);
	s->in = in;
	s->out = out;
}

/* n(d) */
static int64_t least_outside(int64_t r2, int64_t d)
{
	const int64_t low = d < 0 ? -d : 0, rest = 2 * r2 - d * d;
	int64_t n = rest > 0 ? (pair_isqrt(1, (uint64_t)rest) - d) / 2 : low;

	n = n < low ? low : n;
	while (n > low && (n - 1) * (n - 1) + (n - 1 + d) * (n - 1 + d) >= r2)
		n--;
	while (n * n + (n + d) * (n + d) < r2)
		n++;
	return n;
}

/* Go over the border at which it stands, and over as many more as @ticks
 * allow.  Return: what is left of them. */
static int64_t cross(struct seek *s, int64_t ticks)
{
	struct interp_circle *k = s->k;
	const int64_t all = 2 * k->meet;
	int64_t n = ticks / all;

	n = n < k->left - 1 ? n : k->left - 1;
	if (n > 0 && s->measures)
		s->area += n * 2 * circle_rows(s->r2, 0, k->meet);
	k->left -= (uint32_t)n + 1;
	k->quad = (int8_t)((k->quad + k->ccw * ((n + 1) & 3)) & 3);
	s->in = k->meet;
	s->out = 0;
	return ticks - n * all;
}

/* In the quadrant in which it stands, to its border at most. */
static bool along(struct seek *s, int64_t ticks)
{
	const int64_t d = s->out - s->in + ticks;
	int64_t in;

	if (d > s->k->meet)
		return false;
	if (ticks == 0)
		return true;
	in = least_outside(s->r2, d - 1) - 1;
	stretch(s, in, in + d);
	return in >= 0;
}

static void take_place(struct seek *s)
{
	struct interp_circle *k = s->k;
	int8_t in[2], out[2];

	circle_toward(k, true, in);
	circle_toward(k, false, out);
	k->x = out[0] * s->out - in[0] * s->in;
	k->y = out[1] * s->out - in[1] * s->in;
	k->dev = k->x * k->x + k->y * k->y - s->r2;
}

static int64_t by_comparison(struct interp_circle *k, int64_t ticks,
			     bool measures)
{
	struct seek s = {
		.k = k, .r2 = k->x * k->x + k->y * k->y - k->dev,
		.in = circle_in(k), .out = circle_out(k), .measures = measures,
	};
	const int64_t border = k->meet - (s.out - s.in);

	k->tick += (uint32_t)ticks;
	if (k->left > 0 && ticks >= border) {
		stretch(&s, 0, k->meet);
		ticks = cross(&s, ticks - border);
		if (k->left > 0 && ticks >= 2 * k->meet)
			return -1;
	}
	if (!along(&s, ticks))
		return -1;
	take_place(&s);
	return s.area;
}

/* The measure behind so many places of the program. */
static int64_t kept(const struct interp_circle *k, int64_t places)
{
	const int32_t *at = k->places + (places - 1) * CIRCLE_PLACE;

	return (int64_t)((uint64_t)(uint32_t)at[1] << 32 | (uint32_t)at[0]);
}

/* From the last place that the program keeps.  Return: the measure. */
static int64_t by_places(struct interp_circle *k, int64_t ticks)
{
	const int64_t n = fewer(ticks / CIRCLE_PLACE_TICKS, k->nplaces);
	const int64_t before = n * CIRCLE_PLACE_TICKS;
	const int64_t measure = n > 0 ? kept(k, n) : 0;
	int64_t area;

	if (measure < 0 || measure > INT64_MAX / 2 ||
	    (n > 0 && by_comparison(k, before, false) < 0))
		return -1;
	area = by_comparison(k, ticks - before, true);
	return area < 0 ? -1 : measure + area + ticks - before;
}

void circle_keep_places(const struct interp_arc *arc, const int64_t start[2],
			const int64_t end[2], int32_t *ret)
{
	struct interp_circle k;
	int64_t measure = 0;

	circle_enter(&k, arc, start, end, false);
	for (uint32_t i = circle_places(arc); i > 0; i--) {
		measure += by_comparison(&k, CIRCLE_PLACE_TICKS, true) +
			   CIRCLE_PLACE_TICKS;
		ret[0] = (int32_t)(uint32_t)measure;
		ret[1] = (int32_t)(measure >> 32);
		ret += CIRCLE_PLACE;
	}
}

static int64_t one_by_one(struct interp_circle *k, int64_t ticks)
{
	int64_t measure = 0;
	int8_t was[2];

	while (ticks-- > 0) {
		circle_forward(k, was);
		measure += circle_measure_of(k, was);
	}
	return measure;
}

/* @n pulses in a row.  Return: what they add to the measure. */
static int64_t row(struct interp_circle *k, int64_t dx, int64_t dy, int64_t n)
{
	const int64_t area = k->ccw * (k->x * dy - k->y * dx);

	k->x += n * dx;
	k->y += n * dy;
	k->tick += (uint32_t)n;
	return n * ((area > 0 ? area : 0) + 1);
}

static int64_t along_tail(struct interp_circle *k, int64_t ticks)
{
	const int64_t x = k->xe - k->x, y = k->ye - k->y;
	const int64_t in_x = fewer(ticks, llabs(x));
	const int64_t r2 = k->x * k->x + k->y * k->y - k->dev;
	int64_t measure;

	if (ticks - in_x > llabs(y))
		return -1;
	measure = row(k, x < 0 ? -1 : 1, 0, in_x);
	measure += row(k, 0, y < 0 ? -1 : 1, ticks - in_x);
	k->dev = k->x * k->x + k->y * k->y - r2;
	return measure;
}

/* -- Along stored runs ---------------------------------------------------- */

/* Where the walk stands before one run of many: a mark in the program. */
struct mark {
	int64_t tick, x, y, measure;
};

/* Number @i, of the first; behind the runs. */
static struct mark mark_of(const struct interp_circle *k, uint32_t i)
{
	const int32_t *at = k->runs + k->nruns + (size_t)i * CIRCLE_MARK;

	return (struct mark) {
		.tick = at[0], .x = at[1], .y = at[2],
		.measure = (int64_t)((uint64_t)(uint32_t)at[4] << 32 |
				     (uint32_t)at[3]),
	};
}

/* No walk goes farther than its pulses. */
static bool mark_ok(const struct interp_circle *k, const struct mark *m)
{
	return llabs(m->x - k->x) + llabs(m->y - k->y) <= m->tick &&
	       m->measure >= 0 && m->measure <= INT64_MAX / 2;
}

/* Go to the last mark in front of @ticks, if there is one.  Return: the run
 * that comes next. */
static uint32_t to_mark(struct interp_circle *k, int64_t ticks,
			int64_t *ret_measure)
{
	uint32_t low = 0, high = k->nruns / CIRCLE_MARK_RUNS;
	struct mark m;

	while (low < high) {
		const uint32_t i = low + (high - low) / 2;

		if (mark_of(k, i).tick < ticks)
			low = i + 1;
		else
			high = i;
	}
	*ret_measure = 0;
	if (low == 0)
		return 0;
	m = mark_of(k, low - 1);
	if (!mark_ok(k, &m))
		return UINT32_MAX;
	k->x = m.x;
	k->y = m.y;
	k->tick = (uint32_t)m.tick;
	*ret_measure = m.measure;
	return low * CIRCLE_MARK_RUNS;
}

static int64_t along_runs(struct interp_circle *k, int64_t ticks)
{
	const int64_t r2 = k->x * k->x + k->y * k->y - k->dev;
	int64_t measure;
	uint32_t i = to_mark(k, ticks, &measure);

	for (ticks -= k->tick; ticks > 0; i++) {
		const int64_t run = i < k->nruns ? k->runs[i] : 0;
		const int64_t n = fewer(ticks, llabs(run));
		const int64_t dir = run < 0 ? -1 : 1;
		const bool in_y = (i + k->run_first) & 1;

		if (n == 0)
			return -1;
		measure += row(k, in_y ? 0 : dir, in_y ? dir : 0, n);
		k->run = i;
		k->sent = n;
		ticks -= n;
	}
	k->dev = k->x * k->x + k->y * k->y - r2;
	return measure;
}

void circle_marks(struct interp_circle *k, int32_t *ret)
{
	int64_t measure = 0;

	for (uint32_t i = 0; i < k->nruns; i++) {
		const int64_t run = k->runs[i], dir = run < 0 ? -1 : 1;
		const bool in_y = (i + k->run_first) & 1;

		measure += row(k, in_y ? 0 : dir, in_y ? dir : 0, llabs(run));
		if ((i + 1) % CIRCLE_MARK_RUNS != 0)
			continue;
		ret[0] = (int32_t)k->tick;
		ret[1] = (int32_t)k->x;
		ret[2] = (int32_t)k->y;
		ret[3] = (int32_t)(uint32_t)measure;
		ret[4] = (int32_t)(measure >> 32);
		ret += CIRCLE_MARK;
	}
}

/* -- Either --------------------------------------------------------------- */

static int64_t go_to(struct interp_circle *k, uint32_t tick, bool measures)
{
	const int64_t compared = fewer(tick, k->tail);
	int64_t measure, tail;

	if (k->runs)
		return along_runs(k, tick);
	if (k->meet < SMALL)
		return one_by_one(k, tick);
	measure = measures ? by_places(k, compared) :
			     by_comparison(k, compared, false);
	if (measure < 0 || tick == compared)
		return measure;
	tail = along_tail(k, tick - compared);
	return tail < 0 ? -1 : measure + tail;
}

int64_t circle_seek(struct interp_circle *k, uint32_t tick)
{
	return go_to(k, tick, true);
}

bool circle_stand(struct interp_circle *k, uint32_t tick)
{
	return go_to(k, tick, false) >= 0;
}
