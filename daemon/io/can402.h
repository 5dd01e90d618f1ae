/* SPDX-License-Identifier: Apache-2.0 */
/*
 * can402.h - the master of up to eight CiA 402 drives on one bus
 *
 * A period: SYNC as its first act, then what has come since the last one,
 * then the cycle, then one target for each drive.  A target is taken with the
 * next SYNC and reached with the one after.
 *
 * The bus may carry two frames more.  The gap: voltage in 0.01 V as two bytes
 * and, if it has six, the shares of open, spark, arc and short pulses in
 * 1/255.  The generator: a byte of flags (1 power, 2 pump, 4 negative), a byte
 * that counts, then peak current in 0.1 A, on and off time in 0.1 us as two
 * bytes each, 0xffff for its own setting.
 *
 * Threads: can402_load() and can402_period_us() any; the rest as io.h.
 */
#ifndef IO_CAN402_H
#define IO_CAN402_H

#include "drive.h"
#include "io.h"

/* The largest share of the bus that is taken. */
#define CAN402_LOAD_MAX		0.8

struct can402_bus {
	uint32_t bitrate;		/* bit/s */
	uint32_t axes;
	uint32_t heartbeat_ms;
	bool gap, generator;		/* their frames are on it too */
};

/** can402_load() - share of the bus at this period: 1 is all of it. */
double can402_load(const struct can402_bus *b, double period_us);

/** can402_period_us() - the shortest period, whole 0.1 ms, that it can bear. */
double can402_period_us(const struct can402_bus *b);

#endif /* IO_CAN402_H */
