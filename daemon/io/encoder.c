/* SPDX-License-Identifier: Apache-2.0 */
/*
 * encoder.c - where an axis truly is
 */
#include "encoder.h"

#include <math.h>
#include <stdlib.h>

static int32_t minus(int32_t a, int32_t b)
{
	return (int32_t)((uint32_t)a - (uint32_t)b);
}

static int64_t floor_div(int64_t a, int64_t b)
{
	const int64_t q = a / b;

	return q - (a % b != 0 && (a < 0) != (b < 0));
}

/* The nearest pulse. */
static int32_t pulses_of(const struct encoder *e, int64_t counts)
{
	return (int32_t)(uint32_t)floor_div(2 * counts * e->c.pulses +
					    e->c.counts, 2 * e->c.counts);
}

static int64_t counts_of(const struct encoder *e, int32_t pulses)
{
	return floor_div(pulses * e->c.counts, e->c.pulses);
}

void encoder_init(struct encoder *e, const struct encoder_config *c)
{
	*e = (struct encoder) { .c = *c };
}

static void stand_at(struct encoder *e, int32_t place)
{
	e->zero = e->count - counts_of(e, place);
	e->at = place;
	e->stands = true;
}

/* As with a drive: the lag goes away as slowly as it came. */
static void watch(struct encoder *e, int32_t put)
{
	const int32_t way = abs(minus(put, e->put));
	const double k = e->c.lag_cycles;
	const double left = k > 0 ? e->lag * k / (k + 1) : 0;
	const int32_t off = abs(minus(put, e->at));

	/* Counts are two cycles older than pulses: allow the way of two. */
	e->lag = fmax(left, (k + 2) * way);
	if (e->c.following_max > 0 && off > e->c.following_max + e->lag)
		e->too_far = true;
}

void encoder_look(struct encoder *e, int64_t count, bool ok, int32_t put,
		  bool follows)
{
	e->count = count;
	if (!e->stands) {
		e->put = put;
		stand_at(e, put);
	}
	e->at = pulses_of(e, e->count - e->zero);
	e->ill = e->ill || !ok;
	e->too_far = e->too_far || e->ill;
	if (follows)
		watch(e, put);
	e->put = put;
}

void encoder_shift(struct encoder *e, int32_t by)
{
	if (!e->stands)
		return;
	e->put = (int32_t)((uint32_t)e->put + (uint32_t)by);
	e->at = (int32_t)((uint32_t)e->at + (uint32_t)by);
	e->zero -= counts_of(e, by);
}

bool encoder_reset(struct encoder *e)
{
	const bool gone = e->ill;

	e->too_far = e->ill = false;
	e->lag = 0;
	if (gone)
		stand_at(e, e->put);
	return gone;
}
