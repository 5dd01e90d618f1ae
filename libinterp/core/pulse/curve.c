/* SPDX-License-Identifier: Apache-2.0 */
/*
 * curve.c - parts of NURBS, every axis at once or one at a time
 *
 * A part of a curve is cut into places of equal length along it, so many that
 * no axis moves more than a pulse from one to the next; the builder has looked
 * at each.  A table of stops leads from a place to the curve's parameter, so
 * the lattice point of place k is C(u(k * place_mm)) rounded: a function of k
 * alone, the same going either way, within half a pulse of the curve on every
 * axis.  At both ends it is the node's.
 *
 * One axis at a time, a place has as many ticks as the curve has axes: in tick
 * t the axis t mod turns goes to the next place, the others stand.  A tick
 * without a pulse is no point.
 *
 * A damaged block may have any numbers in it; its walk ends when an axis would
 * leap.
 */
#include "pulse/strategy.h"

#include <math.h>

/* No builder gives more places than this for a pulse of the way. */
#define PLACES_MAX	4096.0

static bool pieces_ok(const struct interp_program *p,
		      const struct interp_piece *piece)
{
	return piece->nstops >= 2 && piece->stops_at <= p->head->nstops &&
	       piece->nstops <= p->head->nstops - piece->stops_at;
}

static bool axes_ok(const struct interp_cursor *c, const uint8_t *axis,
		    uint32_t n)
{
	uint32_t there = 0, named = 0;

	for (uint32_t j = 0; j < c->p.head->naxes; j++)
		there |= 1u << c->p.head->column[j];
	for (uint32_t j = 0; j < n; j++) {
		if (axis[j] >= INTERP_NAXES || named & 1u << axis[j])
			return false;
		named |= 1u << axis[j];
	}
	return (named & ~there) == 0;
}

static bool ticks_ok(const struct interp_cursor *c, uint32_t turns)
{
	double pulses_mm = 0;

	for (uint32_t j = 0; j < c->p.head->naxes; j++)
		pulses_mm = fmax(pulses_mm,
				 c->pulses_mm[c->p.head->column[j]]);
	return c->seg.ticks >= turns && c->seg.ticks % turns == 0 &&
	       c->seg.ticks <= PLACES_MAX * turns *
			       (c->seg.length_mm * pulses_mm + 1);
}

/* At both ends, the pulses of the node itself. */
static void node_pos(struct interp_cursor *c, bool at_end,
		     int32_t pos[INTERP_NAXES])
{
	for (uint32_t j = 0; j < c->p.head->naxes; j++) {
		for (uint32_t i = 0; i < c->curve.eval.c.naxes; i++) {
			if (c->curve.axis[i] == c->p.head->column[j])
				pos[i] = interp_round_sub(pulse_node(c, j,
								     at_end));
		}
	}
}

static double parameter(struct interp_curve_walk *k, double s_mm)
{
	if (!(s_mm >= k->between.from_mm && s_mm < k->between.to_mm))
		interp_nurbs_between(k->stops +
				     interp_nurbs_stop_of(k->stops, k->nstops,
							  s_mm), &k->between);
	return interp_nurbs_between_at(&k->between, s_mm);
}

/* floor(x + 0.5); values beyond every axis become a place far away. */
static int32_t nearest(double x)
{
	int32_t i;

	if (!(fabs(x) < INTERP_PULSES_MAX))
		return INT32_MAX;
	i = (int32_t)(x + 0.5);
	return i - ((double)i > x + 0.5);
}

void pulse_curve_place(struct interp_curve_walk *k, const double *pulses_mm,
		       uint32_t place)
{
	struct interp_nurbs_point p;

	interp_nurbs_at(&k->eval, parameter(k, k->place_mm * place), 0, &p);
	for (uint32_t i = 0; i < k->eval.c.naxes; i++)
		k->pos[i] = nearest(p.d[0][i] * pulses_mm[k->axis[i]]);
}

void pulse_curve_aim(struct interp_curve_walk *k,
		     const struct interp_nurbs_stop *stops, uint32_t nstops,
		     uint32_t places, double length_mm)
{
	k->stops = stops;
	k->nstops = nstops;
	k->between = (struct interp_nurbs_between) { .to_mm = -1 };
	k->places = places;
	k->place_mm = length_mm / places;
	k->at = UINT32_MAX;
}

static bool curve_enter(struct interp_cursor *c, bool at_end)
{
	const struct interp_piece piece = c->p.pieces[c->seg.arg];
	struct interp_curve_walk *k = &c->curve;
	struct interp_nurbs nurbs;

	if (!pieces_ok(&c->p, &piece) ||
	    !interp_program_curve(&c->p, piece.curve, &nurbs))
		return false;
	for (uint32_t i = 0; i < INTERP_NAXES; i++)
		k->axis[i] = c->p.curves[piece.curve].axis[i];
	k->turns = pulse_curve_turns(c->p.head->strategy, nurbs.naxes);
	if (!axes_ok(c, k->axis, nurbs.naxes) || !ticks_ok(c, k->turns) ||
	    !pulse_stand(c, at_end))
		return false;
	interp_nurbs_open(&k->eval, &nurbs);
	pulse_curve_aim(k, c->p.stops + piece.stops_at, piece.nstops,
			c->seg.ticks / k->turns, c->seg.length_mm);
	return true;
}

/* Column @i goes to @to; PULSE_BAD if that is a jump. */
static uint32_t go(struct interp_cursor *c, uint32_t i, int32_t to)
{
	const uint32_t axis = c->curve.axis[i];
	const int64_t d = (int64_t)to - c->pos[axis];

	if (d > 1 || d < -1)
		return PULSE_BAD;
	c->pos[axis] = to;
	return d == 0 ? 0 : pulse_move(axis, d < 0);
}

/* Set k->pos for @place. */
static void place_look(struct interp_cursor *c, uint32_t place)
{
	struct interp_curve_walk *k = &c->curve;

	if (k->at == place)
		return;
	if (place == 0 || place == k->places)
		node_pos(c, place > 0, k->pos);
	else
		pulse_curve_place(k, c->pulses_mm, place);
	k->at = place;
}

/* Tick @tick, counted from 0, on the way to place @place. */
static uint32_t go_to(struct interp_cursor *c, uint32_t tick, uint32_t place)
{
	struct interp_curve_walk *k = &c->curve;
	uint32_t pulses = 0;

	place_look(c, place);
	if (k->turns > 1)
		return go(c, tick % k->turns, k->pos[tick % k->turns]);
	for (uint32_t i = 0; i < k->eval.c.naxes; i++) {
		const uint32_t one = go(c, i, k->pos[i]);

		if (one == PULSE_BAD)
			return PULSE_BAD;
		pulses |= one;
	}
	return pulses;
}

static uint32_t curve_tick(struct interp_cursor *c)
{
	const uint32_t tick = c->tick++;

	c->measure++;
	return go_to(c, tick, tick / c->curve.turns + 1);
}

static uint32_t curve_tick_back(struct interp_cursor *c)
{
	const uint32_t tick = --c->tick;

	c->measure--;
	return go_to(c, tick, tick / c->curve.turns);
}

/* In tick t the axis t mod turns goes on: those before it are at the next
 * place, it and the others at the last. */
static bool curve_seek(struct interp_cursor *c, uint32_t tick)
{
	struct interp_curve_walk *k = &c->curve;
	const uint32_t place = tick / k->turns, ahead = tick % k->turns;

	for (uint32_t next = 0; next <= (ahead > 0); next++) {
		place_look(c, place + next);
		for (uint32_t i = 0; i < k->eval.c.naxes; i++)
			if (!next || i < ahead)
				c->pos[k->axis[i]] = k->pos[i];
	}
	c->tick = tick;
	c->measure = tick;
	return true;
}

static uint32_t curve_forward(struct interp_cursor *c, uint32_t ticks,
			      uint16_t *ret)
{
	return pulse_ticks(c, curve_tick, ticks, ret);
}

static uint32_t curve_back(struct interp_cursor *c, uint32_t ticks,
			   uint16_t *ret)
{
	return pulse_ticks(c, curve_tick_back, ticks, ret);
}

const struct interp_walk pulse_curve = {
	.enter = curve_enter,
	.forward = curve_forward,
	.back = curve_back,
	.seek = curve_seek,
};

double pulse_curve_gap2(const struct interp_cursor *c,
			struct interp_curve_walk *k, uint32_t axes,
			double s_mm)
{
	const double end_mm = k->stops[k->nstops - 1].s_mm;
	struct interp_nurbs_point p;
	double gap2 = 0;

	s_mm = fmin(fmax(s_mm, 0), end_mm);
	interp_nurbs_at(&k->eval, parameter(k, s_mm), 0, &p);
	for (uint32_t i = 0; i < k->eval.c.naxes; i++) {
		const uint32_t axis = k->axis[i];
		const double d = c->pos[axis] * c->p.head->pulse_mm[axis] -
				 p.d[0][i];

		if (axes & 1u << axis)
			gap2 += d * d;
	}
	return gap2;
}
