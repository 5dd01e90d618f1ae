/* SPDX-License-Identifier: Apache-2.0 */
/*
 * dda.c - digital differential analysers: an accumulator for each axis
 *
 * Line.  A clock of 2^n ticks, the least that is not under the longest axis's
 * pulses; every tick adds an axis's total to its accumulator, and each time
 * that overflows 2^n the axis pulses.  Accumulators start half full, so after
 * k ticks an axis stands at its total*k/2^n rounded: within half a pulse on
 * every axis, |e| <= (a + b)/2 between any two.  It is the walk of line.c
 * with another number of ticks, and as exactly undone.
 *
 * Arc.  Two accumulators of modulus R = 2^n above the radius feed each other,
 * counter-clockwise:
 *
 *	x gets -y/R, then y gets the new x/R
 *
 * Each half of a tick changes one coordinate by the other one, which stays;
 * so the halves are undone in the opposite order, exactly.  Using the new x
 * keeps x*x + y*y - x*y/R constant, where the old one would let the circle
 * open by pi pulses a turn; what is left is a quarter of a pulse of
 * ellipticity and the rounding of both coordinates, and the radius stays
 * within 3/2 pulses.  The clock stops when the angle is done, up to two
 * pulses from the end; those few, the tail, are forced, both axes at once.
 * The builder runs the arc once to learn where its tail begins.
 */
#include "pulse/pulse.h"

#include <math.h>
#include <stdlib.h>

#define DDA_SHIFT_MAX	28
#define SPIN		32		/* ticks */

/* The program keeps the accumulators each time so many ticks are made, so that
 * no place of a long arc is farther than half of them from a known one. */
#define MARK_TICKS	1024
#define MARK_RUNS	4		/* x, y, and their rests */

/* -- Lines ---------------------------------------------------------------- */

int64_t pulse_dda_ticks(int64_t longest)
{
	int64_t ticks = 1;

	while (ticks < longest && ticks < INTERP_PULSES_MAX)
		ticks *= 2;
	return longest > INTERP_PULSES_MAX ? 0 : ticks;
}

static bool dda_line_enter(struct interp_cursor *c, bool at_end)
{
	return c->seg.ticks > 0 && pulse_dda_enter(c, at_end, 0) &&
	       c->seg.ticks == pulse_dda_ticks(pulse_longest(c, 0));
}

const struct interp_walk pulse_dda_line = {
	.enter = dda_line_enter,
	.forward = pulse_dda_forward,
	.back = pulse_dda_back,
	.seek = pulse_dda_seek,
};

/* -- Arcs ----------------------------------------------------------------- */

/* A coordinate and what is left of it as one number.  Those above the shift are
 * the coordinate. */
struct sums {
	int64_t first, second;		/* in the order of a tick */
};

static struct sums sums_of(const struct interp_rotor *k, bool back)
{
	const int64_t modulus = INT64_C(1) << k->shift;
	const int64_t x = k->x * modulus + k->rest_x;
	const int64_t y = k->y * modulus + k->rest_y;

	return back ? (struct sums) { y, x } : (struct sums) { x, y };
}

static void sums_keep(const struct sums *s, struct interp_rotor *k, bool back)
{
	const int64_t mask = (INT64_C(1) << k->shift) - 1;
	const int64_t x = back ? s->second : s->first;
	const int64_t y = back ? s->first : s->second;

	k->x = x >> k->shift;
	k->y = y >> k->shift;
	k->rest_x = x & mask;
	k->rest_y = y & mask;
}

/* To go back is to go forward with the coordinates exchanged. */
INLINE void sums_tick(struct sums *s, uint32_t shift, int64_t ccw)
{
	s->first -= ccw * (s->second >> shift);
	s->second += ccw * (s->first >> shift);
}

INLINE bool sums_in_range(const struct sums *s, uint32_t shift)
{
	const int64_t most = INT64_C(1) << 2 * shift;
	const uint64_t range = (uint64_t)(2 * most + (INT64_C(1) << shift));

	return (uint64_t)(s->first + most) < range &&
	       (uint64_t)(s->second + most) < range;
}

/* Many ticks without a place for their pulses.  Sums in their range are so far
 * from an overflow that several ticks pass before they are looked at again. */
INLINE bool spin(struct sums *at, uint32_t shift, uint32_t ticks, int64_t ccw)
{
	struct sums s = *at;

	for (; ticks >= SPIN && sums_in_range(&s, shift); ticks -= SPIN) {
		for (int i = 0; i < SPIN; i++)
			sums_tick(&s, shift, ccw);
	}
	for (; ticks > 0 && sums_in_range(&s, shift); ticks--)
		sums_tick(&s, shift, ccw);
	*at = s;
	return sums_in_range(&s, shift);
}

static bool rotor_turn(struct interp_rotor *k, uint32_t ticks, bool back)
{
	struct sums s = sums_of(k, back);
	const bool ok = k->ccw > 0 ? spin(&s, k->shift, ticks, 1) :
				     spin(&s, k->shift, ticks, -1);

	sums_keep(&s, k, back);
	return ok;
}

static bool rotor_in_range(const struct interp_rotor *k)
{
	const int64_t most = INT64_C(1) << k->shift;

	return (uint64_t)(k->x + most) <= (uint64_t)(2 * most) &&
	       (uint64_t)(k->y + most) <= (uint64_t)(2 * most);
}

/* Tick @u of the tail, counted from 1: does an axis with @forced pulses to go
 * make one? */
static int64_t tail_pulse(int64_t forced, int64_t u)
{
	return u > llabs(forced) ? 0 : forced > 0 ? 1 : -1;
}

static void rotor_set(struct interp_rotor *k, const struct interp_arc *arc,
		      const int64_t at[2])
{
	const int64_t half = (INT64_C(1) << arc->shift) / 2;

	*k = (struct interp_rotor) {
		.x = at[0], .y = at[1], .rest_x = half, .rest_y = half,
		.shift = arc->shift, .ccw = arc->sweep > 0 ? 1 : -1,
	};
}

bool dda_measure(struct interp_arc *arc, const int64_t start[2],
		 const int64_t end[2], int64_t others)
{
	const double r = hypot((double)start[0], (double)start[1]);
	const double turn = fabs(arc->sweep);
	const double least = fmax(r + 2, (double)(others + 1) / turn);
	struct interp_rotor k;
	double modulus = 4, ticks;

	arc->shift = 2;
	while (arc->shift < DDA_SHIFT_MAX && modulus < least) {
		arc->shift++;
		modulus *= 2;
	}
	ticks = turn / (2 * asin(0.5 / modulus));
	if (modulus < least || ticks > INTERP_PULSES_MAX / 2.0)
		return false;
	rotor_set(&k, arc, start);
	arc->tail = (uint32_t)llround(ticks);
	if (!rotor_turn(&k, arc->tail, false))
		return false;
	arc->tail_a = (int32_t)(end[0] - k.x);
	arc->tail_b = (int32_t)(end[1] - k.y);
	arc->rest_a = k.rest_x;
	arc->rest_b = k.rest_y;
	arc->nruns = arc->tail / MARK_TICKS * MARK_RUNS;
	arc->circle_ticks = arc->tail +
		(uint32_t)fmax(abs(arc->tail_a), abs(arc->tail_b));
	return arc->circle_ticks >= others;
}

void dda_marks(const struct interp_arc *arc, const int64_t start[2],
	       int32_t *ret)
{
	struct interp_rotor k;

	rotor_set(&k, arc, start);
	for (uint32_t i = 0; i < arc->nruns; i += MARK_RUNS) {
		rotor_turn(&k, MARK_TICKS, false);
		ret[i] = (int32_t)k.x;
		ret[i + 1] = (int32_t)k.y;
		ret[i + 2] = (int32_t)k.rest_x;
		ret[i + 3] = (int32_t)k.rest_y;
	}
}

static bool marks_ok(const struct interp_cursor *c)
{
	const struct interp_arc *arc = &c->arc;
	const uint32_t nruns = c->p.head->nruns;

	return arc->nruns == arc->tail / MARK_TICKS * MARK_RUNS &&
	       arc->nruns <= nruns && arc->run_at <= nruns - arc->nruns;
}

static bool arc_ok(const struct interp_cursor *c)
{
	const struct interp_arc *arc = &c->arc;
	const int64_t forced = (int64_t)arc->circle_ticks - arc->tail;
	int64_t most;

	if (arc->shift < 2 || arc->shift > DDA_SHIFT_MAX ||
	    arc->circle_ticks != c->seg.ticks ||
	    arc->circle_ticks >= INTERP_PULSES_MAX || !marks_ok(c))
		return false;
	most = INT64_C(1) << arc->shift;
	return arc->rest_a >= 0 && arc->rest_a < most &&
	       arc->rest_b >= 0 && arc->rest_b < most && forced >= 0 &&
	       llabs(arc->tail_a) <= forced && llabs(arc->tail_b) <= forced;
}

/* As the tail left it, from the end; walking back begins with the tail. */
static void rotor_set_tail(struct interp_rotor *k, const struct interp_arc *arc)
{
	k->rest_x = arc->rest_a;
	k->rest_y = arc->rest_b;
	k->x -= arc->tail_a;
	k->y -= arc->tail_b;
}

static bool dda_arc_enter(struct interp_cursor *c, bool at_end)
{
	const struct interp_arc *arc = &c->arc;
	struct interp_rotor *k = &c->rotor;
	int64_t at[2] = { 0, 0 };

	if (!pulse_plane_ok(c) || !arc_ok(c) ||
	    !pulse_dda_enter(c, at_end, 1u << arc->axis_a | 1u << arc->axis_b))
		return false;
	pulse_circle_node(c, at_end, at);
	rotor_set(k, arc, at);
	if (at_end)
		rotor_set_tail(k, arc);
	return rotor_in_range(k);
}

/* A row of ticks: the pulses of the other axes at @others, in its place. */
struct row {
	const uint16_t *others;
	uint16_t *to;			/* not behind @others */
	uint32_t ticks;
	bool back;
};

/* A rotor that turns; @first and @second are 1 << axis of its sums.  To
 * multiply by that is cheaper than to shift by the axis: the one register for
 * shifts has @shift. */
struct turning {
	struct sums s;
	uint32_t shift, first, second;
	int64_t ccw;
};

/* Are both coordinates so far inside their range that none leaves it in @ticks
 * ticks?  One goes by a pulse a tick at most. */
INLINE bool is_inside(const struct turning *t, int64_t ticks)
{
	const int64_t most = (INT64_C(1) << t->shift) - ticks;
	const int64_t x = t->s.first >> t->shift, y = t->s.second >> t->shift;

	return most >= 0 && (uint64_t)(x + most) <= (uint64_t)(2 * most) &&
	       (uint64_t)(y + most) <= (uint64_t)(2 * most);
}

/* @n ticks of @row from its @k on.  Return: the points in @to. */
INLINE uint32_t some_ticks(struct turning *t, const struct row *row, uint32_t k,
			   uint32_t n, uint16_t *to)
{
	struct sums s = t->s;
	const uint32_t first = t->first, second = t->second, shift = t->shift;
	int64_t x = s.first >> shift, y = s.second >> shift;
	size_t points = 0;

	for (size_t i = 0; i < n; i++) {
		const int64_t was_x = x, was_y = y;

		/* As sums_tick(), with what is known of the tick before. */
		s.first -= t->ccw * y;
		x = s.first >> shift;
		s.second += t->ccw * x;
		y = s.second >> shift;
		to[points] = (uint16_t)(row->others[k + i] |
			pulse_step((uint32_t)(x - was_x), 0) * first |
			pulse_step((uint32_t)(y - was_y), 0) * second);
		points += to[points] != 0;
	}
	t->s = s;
	return (uint32_t)points;
}

/* Return: the points in row->to, or PULSE_BAD. */
INLINE uint32_t turn(struct interp_cursor *c, const struct row *row,
		     int64_t ccw)
{
	const uint32_t a = c->arc.axis_a, b = c->arc.axis_b;
	struct turning t = {
		sums_of(&c->rotor, row->back), c->rotor.shift,
		1u << (row->back ? b : a), 1u << (row->back ? a : b), ccw,
	};
	uint32_t points = 0, n;

	for (uint32_t k = 0; k < row->ticks; k += n) {
		n = is_inside(&t, SPIN) ? pulse_fewer(row->ticks - k, SPIN) :
					  1;
		points += some_ticks(&t, row, k, n, row->to + points);
		if (!is_inside(&t, 0))
			return PULSE_BAD;
	}
	sums_keep(&t.s, &c->rotor, row->back);
	return points;
}

static uint32_t arc_turn(struct interp_cursor *c, const struct row *row)
{
	const int64_t x = c->rotor.x, y = c->rotor.y;
	const uint32_t points = c->rotor.ccw > 0 ? turn(c, row, 1) :
						   turn(c, row, -1);

	c->pos[c->arc.axis_a] += (int32_t)(c->rotor.x - x);
	c->pos[c->arc.axis_b] += (int32_t)(c->rotor.y - y);
	return points;
}

/* Tick u of the tail, forward or back; the rotor stays where it stopped. */
static uint32_t tail_tick(struct interp_cursor *c, int64_t u, int dir)
{
	const int64_t dx = tail_pulse(c->arc.tail_a, u) * dir;
	const int64_t dy = tail_pulse(c->arc.tail_b, u) * dir;

	c->pos[c->arc.axis_a] += (int32_t)dx;
	c->pos[c->arc.axis_b] += (int32_t)dy;
	return pulse_plane_move(c, (int32_t)dx, (int32_t)dy);
}

/* @u: the tick of the tail that is made first, counted from 1. */
static uint32_t arc_tail(struct interp_cursor *c, const struct row *row,
			 int64_t u)
{
	const int dir = row->back ? -1 : 1;
	uint32_t points = 0;

	for (uint32_t k = 0; k < row->ticks; k++, u += dir) {
		row->to[points] = (uint16_t)(row->others[k] |
					     tail_tick(c, u, dir));
		points += row->to[points] != 0;
	}
	return points;
}

static uint32_t dda_arc_forward(struct interp_cursor *c, uint32_t ticks,
				uint16_t *ret)
{
	const uint32_t tick = c->tick, tail = c->arc.tail;
	const uint32_t turns = tick >= tail ? 0 :
			       pulse_fewer(ticks, tail - tick);
	uint32_t points;

	pulse_dda_all_forward(c, ticks, ret);
	points = arc_turn(c, &(struct row) { ret, ret, turns, false });
	if (points == PULSE_BAD)
		return PULSE_BAD;
	return points + arc_tail(c, &(struct row) {
		ret + turns, ret + points, ticks - turns, false
	}, (int64_t)tick + turns - tail + 1);
}

static uint32_t dda_arc_back(struct interp_cursor *c, uint32_t ticks,
			     uint16_t *ret)
{
	const uint32_t tick = c->tick, tail = c->arc.tail;
	const uint32_t forced = tick <= tail ? 0 :
				pulse_fewer(ticks, tick - tail);
	uint32_t points, turned;

	pulse_dda_all_back(c, ticks, ret);
	points = arc_tail(c, &(struct row) { ret, ret, forced, true },
			  (int64_t)tick - tail);
	turned = arc_turn(c, &(struct row) {
		ret + forced, ret + points, ticks - forced, true
	});
	return turned == PULSE_BAD ? PULSE_BAD : points + turned;
}

bool dda_turn(struct interp_rotor *k, uint32_t ticks)
{
	return rotor_turn(k, ticks, false);
}

/* Behind @n times MARK_TICKS; false: the program is damaged. */
static bool rotor_at_mark(struct interp_cursor *c, uint32_t n)
{
	const int32_t *mark = c->p.runs + c->arc.run_at + (n - 1) * MARK_RUNS;
	const int64_t modulus = INT64_C(1) << c->arc.shift;
	struct interp_rotor *k = &c->rotor;

	k->x = mark[0];
	k->y = mark[1];
	k->rest_x = mark[2];
	k->rest_y = mark[3];
	return rotor_in_range(k) && k->rest_x >= 0 && k->rest_x < modulus &&
	       k->rest_y >= 0 && k->rest_y < modulus;
}

/*
 * A rotor's rounding follows from all of its ticks, so there is no way to it
 * but these, one by one: from the start, the nearest mark, or the tail.
 */
static bool rotor_seek(struct interp_cursor *c, uint32_t tick)
{
	const struct interp_arc *arc = &c->arc;
	const uint32_t to = tick < arc->tail ? tick : arc->tail;
	const uint32_t mark = (to + MARK_TICKS / 2) / MARK_TICKS;
	const uint32_t at = mark * MARK_TICKS;
	struct interp_rotor *k = &c->rotor;
	int64_t node[2] = { 0, 0 };

	if (at > arc->tail || arc->tail - to < MARK_TICKS / 2) {
		pulse_circle_node(c, true, node);
		rotor_set(k, arc, node);
		rotor_set_tail(k, arc);
		return rotor_turn(k, arc->tail - to, true);
	}
	if (mark > 0 && !rotor_at_mark(c, mark))
		return false;
	return to >= at ? rotor_turn(k, to - at, false) :
			  rotor_turn(k, at - to, true);
}

static int64_t tail_pulses(int64_t forced, int64_t u)
{
	return forced > 0 ? (u < forced ? u : forced) :
			    (-u > forced ? -u : forced);
}

static bool dda_arc_seek(struct interp_cursor *c, uint32_t tick)
{
	const struct interp_arc *arc = &c->arc;
	const int64_t u = tick > arc->tail ? tick - arc->tail : 0;
	const struct interp_rotor *k = &c->rotor;
	int64_t x = k->x, y = k->y;

	if (!rotor_seek(c, tick))
		return false;
	x = k->x - x + tail_pulses(arc->tail_a, u);
	y = k->y - y + tail_pulses(arc->tail_b, u);
	c->pos[arc->axis_a] += (int32_t)x;
	c->pos[arc->axis_b] += (int32_t)y;
	return pulse_dda_seek(c, tick);
}

const struct interp_walk pulse_dda_arc = {
	.enter = dda_arc_enter,
	.forward = dda_arc_forward,
	.back = dda_arc_back,
	.seek = dda_arc_seek,
};
