/* SPDX-License-Identifier: Apache-2.0 */
/*
 * can402_stop.c - drives that brake together
 *
 * A drive that has a fault stops by itself, and the cycle brakes the others on
 * the path before it takes their power.  When power is taken from drives that
 * move, as in an e-stop, they would leave the path at any angle if each stopped
 * as fast as it can.  So they brake along the tangent of the path: in a period
 * each loses the same part of its speed, and all need the time of the slowest.
 */
#include "can402_bus.h"

#include <math.h>
#include <stdlib.h>

static int32_t minus(int32_t a, int32_t b)
{
	return (int32_t)((uint32_t)a - (uint32_t)b);
}

static double speed_of(const struct drive *d, const struct can402_stop *t)
{
	return (double)minus(d->target, t->was);
}

/* How many periods the slowest drive needs to stop. */
static double measure(struct can402 *s)
{
	double most = 0;

	for (uint32_t i = 0; i < s->n; i++) {
		struct can402_stop *t = &s->stop[i];
		const struct drive *d = &s->drive[i];

		t->speed = d->joined && !drive_is_homing(d) ?
			   speed_of(d, t) : 0;
		t->at = d->target;
		most = fmax(most, fabs(t->speed) / t->a);
	}
	return most;
}

/* After the stop drive @i may be so much farther off its place. */
static void allow(struct can402 *s, uint32_t i, double periods)
{
	struct can402_stop *t = &s->stop[i];
	const struct drive *d = &s->drive[i];
	const double way = fabs(t->speed) * periods + d->lag;

	t->coast += (int32_t)(way * d->c.pulses / abs(d->c.increments));
}

static void begin(struct can402 *s)
{
	const double most = measure(s);

	s->stop_of = (uint32_t)fmin(most, 1e6);
	s->stopping = s->stop_of;
	for (uint32_t i = 0; i < s->n; i++)
		allow(s, i, most);
}

/* Note the drives that came into trouble in this period. */
static void part(struct can402 *s)
{
	for (uint32_t i = 0; i < s->n; i++) {
		struct can402_stop *t = &s->stop[i];
		const bool ill = s->drive[i].trouble != DRIVE_WELL;

		if (ill && !t->ill)
			allow(s, i, measure(s));
		t->ill = ill;
	}
}

bool can402_stop_step(struct can402 *s, bool on)
{
	if (on) {
		s->stopping = 0;
		part(s);
	} else if (s->were_on) {
		begin(s);
	} else if (s->stopping > 0) {
		s->stopping--;
	}
	if (s->stopped)
		s->stopping = 0;
	s->were_on = on;
	for (uint32_t i = 0; i < s->n; i++) {
		s->stop[i].was = s->drive[i].target;
		if (on && s->drive[i].joined && !s->stop[i].ill)
			s->stop[i].coast = 0;
	}
	return on || s->stopping > 0;
}

int32_t can402_stop_target(struct can402 *s, uint32_t i)
{
	struct can402_stop *t = &s->stop[i];
	const struct drive *d = &s->drive[i];
	const double part = (double)s->stopping / (s->stop_of + 1);
	int64_t from;

	t->at += t->speed * part;
	from = (int32_t)((uint32_t)llround(t->at) - (uint32_t)d->zero);
	return (int32_t)(from * d->c.pulses / d->c.increments);
}
