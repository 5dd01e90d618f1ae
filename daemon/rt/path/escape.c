/* SPDX-License-Identifier: Apache-2.0 */
/*
 * escape.c - out of the cut and back, beside the path
 *
 * Tick k of n of a leg is at from + k * (to - from) / n, with each axis rounded
 * to the nearest pulse. No axis has more than n pulses to go, so none makes
 * more than one pulse in a tick.
 */
#include "path/place.h"

#include <math.h>
#include <string.h>


/* This keeps 2 * ticks * pulses inside int64_t. */
#define TICKS_MAX	(INT64_C(1) << 30)

static const uint32_t linear = 1u << INTERP_X | 1u << INTERP_Y |
			       1u << INTERP_Z | 1u << INTERP_U | 1u << INTERP_V;

/* -- Its legs -------------------------------------------------------------- */

static double pulse_mm(const struct cycle *c, int axis)
{
	return c->cursor.p.head->pulse_mm[axis];
}

/* The lattice point at @mm. Return: false if it is outside the travel, or if
 * @mm is not a number. */
static bool pulses_at(const struct cycle *c, int axis, double mm, int32_t *ret)
{
	const double at = mm / pulse_mm(c, axis);

	if (!(fabs(at) <= INTERP_PULSES_MAX))
		return false;
	*ret = (int32_t)llround(at);
	return place_in_travel(c, axis, *ret);
}

static double leg_length(const struct cycle *c, const struct escape_leg *l)
{
	double sum = 0;

	for (int i = 0; i < INTERP_NAXES; i++) {
		const double d = ((double)l->to[i] - l->from[i]) *
				 pulse_mm(c, i);

		sum += linear & 1u << i ? d * d : 0;
	}
	return sqrt(sum);
}

/* A leg without a length is left out. */
static bool leg_add(struct cycle *c, const int32_t to[INTERP_NAXES])
{
	struct escape *e = &c->escape;
	struct escape_leg *l = &e->leg[e->nlegs];
	double length;

	memcpy(l->from, e->pos, sizeof(l->from));
	memcpy(l->to, to, sizeof(l->to));
	l->ticks = 0;
	for (int i = 0; i < INTERP_NAXES; i++) {
		const int64_t d = (int64_t)l->to[i] - l->from[i];
		const int64_t n = d < 0 ? -d : d;

		l->ticks = n > l->ticks ? n : l->ticks;
	}
	length = leg_length(c, l);
	if (l->ticks > TICKS_MAX || (l->ticks > 0 && length == 0))
		return false;
	if (l->ticks == 0)
		return true;
	l->start_mm = e->length_mm;
	l->end_mm = e->length_mm += length;
	memcpy(e->pos, to, sizeof(e->pos));
	e->nlegs++;
	return true;
}

/* Move the axes in @axes toward @mm, by the share @share of the distance. */
static bool leg_to(struct cycle *c, uint32_t axes,
		   const double mm[INTERP_NAXES], double share)
{
	int32_t to[INTERP_NAXES];

	memcpy(to, c->escape.pos, sizeof(to));
	for (int i = 0; i < INTERP_NAXES; i++) {
		const double from = to[i] * pulse_mm(c, i);

		if (axes & 1u << i &&
		    !pulses_at(c, i, from + share * (mm[i] - from), &to[i]))
			return false;
	}
	return leg_add(c, to);
}

/* The share of the way to out_mm that the rise takes. */
static double rise_share(const struct cycle *c, const struct interp_escape *x)
{
	double sum = 0;

	for (int i = 0; i < INTERP_NAXES; i++) {
		const double d = x->out_mm[i] -
				 c->escape.pos[i] * pulse_mm(c, i);

		sum += x->out & linear & 1u << i ? d * d : 0;
	}
	return x->rise_mm * x->rise_mm < sum ? x->rise_mm / sqrt(sum) : 1;
}

static bool legs(struct cycle *c, const struct interp_escape *x)
{
	if (!(x->rise_mm >= 0))
		return false;
	return leg_to(c, x->rise_mm > 0 ? x->out : 0, x->out_mm,
		      rise_share(c, x)) &&
	       leg_to(c, x->home, x->home_mm, 1) &&
	       leg_to(c, x->out, x->out_mm, 1);
}

bool escape_begin(struct cycle *c)
{
	const struct interp_escape *x =
		&c->cursor.p.escapes[c->cursor.seg.escape];
	struct escape *e = &c->escape;

	*e = (struct escape) {
		.v_max_mm_s = x->v_max_mm_s, .a_max_mm_s2 = x->a_max_mm_s2,
		.j_max_mm_s3 = x->j_max_mm_s3,
	};
	memcpy(e->pos, c->cursor.pos, sizeof(e->pos));
	if (!(x->v_max_mm_s > 0 && x->a_max_mm_s2 > 0 && x->j_max_mm_s3 > 0) ||
	    !legs(c, x))
		e->nlegs = 0;
	memcpy(e->pos, c->cursor.pos, sizeof(e->pos));
	return e->nlegs > 0;
}

/* -- Walking --------------------------------------------------------------- */

static int32_t at_tick(const struct escape_leg *l, int axis, int64_t tick)
{
	const int64_t d = (int64_t)l->to[axis] - l->from[axis];
	const int64_t up = 2 * (d < 0 ? -d : d) * tick + l->ticks;
	const int64_t n = up / (2 * l->ticks);

	return (int32_t)(l->from[axis] + (d < 0 ? -n : n));
}

static void stand_at(struct escape *e, int64_t tick)
{
	const struct escape_leg *l = &e->leg[e->at];

	e->tick = tick;
	e->moved = 0;
	for (int i = 0; i < INTERP_NAXES; i++) {
		const int32_t at = at_tick(l, i, tick);

		e->moved |= (uint32_t)(at != e->pos[i]) << i;
		e->pos[i] = at;
	}
}

static void count(struct cycle *c)
{
	for (uint32_t m = c->escape.moved; m; m &= m - 1)
		c->totals.pulses[__builtin_ctz(m)]++;
	if (c->on_point)
		c->on_point(c->on_point_arg, c);
}

/* At a corner the walk goes on in the next leg. */
static const struct escape_leg *turn_corner(struct escape *e, double ds_mm)
{
	const struct escape_leg *l = &e->leg[e->at];

	if (ds_mm < 0 && e->way_mm >= l->end_mm && e->at + 1 < e->nlegs) {
		e->at++;
		e->tick = 0;
	} else if (ds_mm > 0 && e->way_mm <= l->start_mm && e->at > 0) {
		e->at--;
		e->tick = e->leg[e->at].ticks;
	}
	return &e->leg[e->at];
}

static double onto(double way_mm, const struct escape_leg *l)
{
	if (way_mm <= l->start_mm + MOVER_ONTO_MM)
		return l->start_mm;
	return way_mm >= l->end_mm - MOVER_ONTO_MM ? l->end_mm : way_mm;
}

/* Go point by point to @tick. Return: false if that is more than one cycle may
 * do. */
static bool walk_to(struct cycle *c, int64_t tick)
{
	struct escape *e = &c->escape;

	for (uint32_t n = 0; n < c->config.points_max; n++) {
		if (e->tick == tick)
			return true;
		stand_at(e, e->tick + (tick > e->tick ? 1 : -1));
		count(c);
	}
	return e->tick == tick;
}

bool escape_by(struct cycle *c, double ds_mm)
{
	struct escape *e = &c->escape;
	const double period_s = (double)c->config.period_ns * 1e-9;
	const double most = e->v_max_mm_s * period_s, was = e->way_mm;
	const struct escape_leg *l = turn_corner(e, ds_mm);
	const double length = l->end_mm - l->start_mm;
	bool more = true;

	ds_mm = fmax(-most, fmin(most, ds_mm));
	e->way_mm = onto(was - ds_mm, l);
	if (!walk_to(c, llround((e->way_mm - l->start_mm) / length *
				(double)l->ticks)))
		e->way_mm = l->start_mm + length * (double)e->tick /
					  (double)l->ticks;
	place_target(c, e->pos);
	c->feed_mm_s = (was - e->way_mm) / period_s;
	if (ds_mm < 0)
		more = e->way_mm < e->length_mm;
	else if (ds_mm > 0 && e->way_mm <= 0)
		e->nlegs = 0;
	return more;
}

bool escape_scout(struct escape *e, int toward)
{
	const struct escape_leg *l;
	int64_t tick = e->tick - toward;

	if (tick < 0 && e->at > 0)
		tick = e->leg[--e->at].ticks - 1;
	if (tick > e->leg[e->at].ticks && e->at + 1 < e->nlegs) {
		e->at++;
		tick = 1;
	}
	l = &e->leg[e->at];
	if (tick < 0 || tick > l->ticks)
		return false;
	stand_at(e, tick);
	e->way_mm = l->start_mm + (l->end_mm - l->start_mm) * (double)tick /
				  (double)l->ticks;
	return true;
}

double escape_stop_mm(const struct cycle *c, double to_mm)
{
	const struct escape *e = &c->escape;
	const double path = interp_cursor_place_mm(&c->cursor);
	double to = path - to_mm;

	for (uint32_t i = 0; i < e->nlegs; i++) {
		const double corner = e->leg[i].end_mm;

		if (corner > e->way_mm && corner < to)
			return path - corner;
	}
	for (uint32_t i = e->nlegs; i-- > 0; ) {
		const double corner = e->leg[i].start_mm;

		if (corner < e->way_mm && corner > to)
			return path - corner;
	}
	return to_mm;
}

/* -- After a crash --------------------------------------------------------- */

/* The longest axis has a pulse in each tick, so its place tells which tick it
 * is. */
static bool leg_find(struct escape *e, const int32_t pos[INTERP_NAXES])
{
	const struct escape_leg *l = &e->leg[e->at];

	for (int i = 0; i < INTERP_NAXES; i++) {
		const int64_t d = (int64_t)l->to[i] - l->from[i];
		const int64_t tick = d < 0 ? (int64_t)l->from[i] - pos[i] :
					     (int64_t)pos[i] - l->from[i];

		if ((d < 0 ? -d : d) != l->ticks)
			continue;
		if (tick < 0 || tick > l->ticks)
			return false;
		stand_at(e, tick);
		return memcmp(e->pos, pos, sizeof(e->pos)) == 0;
	}
	return false;
}

bool escape_find(struct cycle *c, const int32_t pos[INTERP_NAXES])
{
	struct escape *e = &c->escape;

	if (!escape_begin(c))
		return false;
	for (e->at = 0; e->at < e->nlegs; e->at++) {
		const struct escape_leg *l = &e->leg[e->at];

		if (!leg_find(e, pos))
			continue;
		e->way_mm = l->start_mm + (l->end_mm - l->start_mm) *
			    (double)e->tick / (double)l->ticks;
		place_target(c, e->pos);
		return true;
	}
	e->nlegs = 0;
	return false;
}
