/* SPDX-License-Identifier: Apache-2.0 */
/*
 * can402_load.c - how full the bus is
 *
 * Each frame is counted at its longest, with all the stuff bits it can have.
 */
#include "can402.h"

#include <math.h>

#define RPDO_BYTES	6		/* controlword, position */
#define TPDO_BYTES	7		/* statusword, position, mode */
#define INPUT_BYTES	4		/* digital inputs */
#define FRAME_BYTES	8		/* gap, generator, a PLC's frames */
#define PLC_SET		4		/* frames of edmd, one in a period */
#define PLC_BEAT_MS	100		/* edmd's to the PLC, and the PLC's */

/* In a period; it is assumed that the PLC asks as often as it is told. */
static double plc_bits(const struct can402_bus *b, double period_us)
{
	const double sets = b->plc_us > 0 ? period_us / b->plc_us : 0;

	if (sets <= 0)
		return 0;
	return (fmin(PLC_SET * sets, 1) + sets) * can_bits(FRAME_BYTES) +
	       2 * can_bits(1) * period_us / (PLC_BEAT_MS * 1e3);
}

double can402_load(const struct can402_bus *b, double period_us)
{
	const uint32_t pdos = b->axes * (can_bits(RPDO_BYTES) +
					 can_bits(TPDO_BYTES)) +
			      b->inputs * can_bits(INPUT_BYTES);
	const uint32_t others = (b->gap + b->generator) *
				can_bits(FRAME_BYTES);
	const double beats = (b->axes + 1) * can_bits(1) * period_us /
			     (b->heartbeat_ms * 1e3);

	return (can_bits(0) + pdos + others + beats + plc_bits(b, period_us)) /
	       (b->bitrate * period_us * 1e-6);
}

double can402_period_us(const struct can402_bus *b)
{
	double us = 100;

	while (can402_load(b, us) > CAN402_LOAD_MAX && us < 1e6)
		us += 100;
	return us;
}
