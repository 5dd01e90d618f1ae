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
#define FRAME_BYTES	8		/* gap, generator */

double can402_load(const struct can402_bus *b, double period_us)
{
	const uint32_t pdos = b->axes * (can_bits(RPDO_BYTES) +
					 can_bits(TPDO_BYTES));
	const uint32_t others = (uint32_t)(b->gap + b->generator) *
				can_bits(FRAME_BYTES);
	const double beats = (b->axes + 1) * can_bits(1) * period_us /
			     (b->heartbeat_ms * 1e3);

	return (can_bits(0) + pdos + others + beats) /
	       (b->bitrate * period_us * 1e-6);
}

double can402_period_us(const struct can402_bus *b)
{
	double us = 100;

	while (can402_load(b, us) > CAN402_LOAD_MAX && us < 1e6)
		us += 100;
	return us;
}
