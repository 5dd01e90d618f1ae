/* SPDX-License-Identifier: Apache-2.0 */
/*
 * can402_stop.c - drives that brake together, and go back together
 *
 * Where one has a fault, the others could each stop as fast as they can; then
 * all leave the path.  So they run out along its tangent instead, each by the
 * same part of its speed, in the time that the slowest of them needs.  The one
 * that has the fault stops by itself, as it must.
 *
 * On the way back each goes the same part of what it is off, so that all go
 * along one line and arrive in the same period.
 */
#include "can402_bus.h"

#include <math.h>
#include <stdlib.h>

static double speed_of(const struct drive *d, const struct can402_stop *t)
{
	return (double)(int32_t)((uint32_t)d->target - (uint32_t)t->was);
}

/* Periods the slowest needs; what each may be off its place at the end. */
static void begin(struct can402 *s)
{
	double most = 0;

	for (uint32_t i = 0; i < s->n; i++) {
		struct can402_stop *t = &s->stop[i];
		const struct drive *d = &s->drive[i];

		t->speed = d->arrived ? speed_of(d, t) : 0;
		t->at = d->target;
		most = fmax(most, fabs(t->speed) / t->a);
	}
	s->stop_of = (uint32_t)fmin(most, 1e6);
	s->stopping = s->stop_of;
	for (uint32_t i = 0; i < s->n; i++) {
		struct can402_stop *t = &s->stop[i];
		const struct drive *d = &s->drive[i];
		const double way = fabs(t->speed) * most + d->lag;

		t->coast = (int32_t)(way * d->c.pulses / abs(d->c.increments));
	}
}

bool can402_stop_step(struct can402 *s, bool on)
{
	if (on) {
		s->stopping = 0;
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
		if (on && s->drive[i].arrived)
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

void can402_stop_pace(struct can402 *s)
{
	double periods = 1;
	bool ready = true;

	for (uint32_t i = 0; i < s->n; i++)
		ready = ready && s->drive[i].led;
	for (uint32_t i = 0; i < s->n && ready; i++) {
		const struct drive *d = &s->drive[i];
		const int32_t want = drive_wanted(d, s->out.target[s->axis[i]]);
		const double off = (int32_t)((uint32_t)want -
					     (uint32_t)d->target);

		if (!d->arrived)
			periods = fmax(periods, ceil(fabs(off) /
						     d->c.slew_increments));
	}
	for (uint32_t i = 0; i < s->n; i++) {
		struct drive *d = &s->drive[i];
		const int32_t want = drive_wanted(d, s->out.target[s->axis[i]]);
		const double off = (int32_t)((uint32_t)want -
					     (uint32_t)d->target);

		d->slew = ready ? (int32_t)ceil(fabs(off) / periods) : 0;
	}
}
