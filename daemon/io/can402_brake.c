/* SPDX-License-Identifier: Apache-2.0 */
/*
 * can402_brake.c - brakes that GPIO lines of this host open
 *
 * First the drive holds its axis, then the brake opens, and nothing moves
 * before the brake is open.  In a stop the brake closes first, and the drive
 * holds the axis until the brake is closed.  If a drive is in trouble, its
 * brake closes at once, because the drive may have no torque any more.
 */
#include "can402_bus.h"

#include <errno.h>
#include <time.h>

static bool holds(const struct drive *d)
{
	return (d->led || drive_is_homing(d)) && d->state == DRIVE_ENABLED &&
	       d->trouble == DRIVE_WELL;
}

static void put(struct can402 *s, uint32_t open)
{
	s->open = open;
	if (!s->brake(s->brake_arg, open))
		s->brakes_lost = true;
}

bool can402_brake_step(struct can402 *s, bool on)
{
	uint32_t open = 0;

	if (!s->braked)
		return on;
	for (uint32_t i = 0; i < s->n; i++) {
		const uint32_t bit = 1u << s->axis[i];

		if (s->braked & bit && on && holds(&s->drive[i]))
			open |= bit;
		if (!(open & bit))
			s->opening[i] = s->brake_periods;
		else if (s->opening[i] > 0)
			s->opening[i]--;
	}
	if (on)
		s->closing = s->brake_periods;
	else if (s->closing > 0)
		s->closing--;
	if (s->stopped)
		s->closing = 0;
	put(s, open);
	return on || s->closing > 0;
}

bool can402_brake_opens(const struct can402 *s)
{
	for (uint32_t i = 0; i < s->n; i++)
		if (s->braked >> s->axis[i] & 1 && s->opening[i] > 0)
			return true;
	return false;
}

void can402_brake_close(struct can402 *s)
{
	const struct timespec period = {
		.tv_sec = s->period_ns / 1000000000,
		.tv_nsec = s->period_ns % 1000000000,
	};
	struct io_outputs out = s->out;
	const bool any = s->open != 0;
	struct io_inputs in;

	out.enable = out.power = out.pump = out.reset = false;
	for (uint32_t i = 0; any && i <= s->brake_periods; i++) {
		can402_write(s, &out);
		nanosleep(&period, NULL);
		can402_read(s, &in);
	}
}
