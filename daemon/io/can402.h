/* SPDX-License-Identifier: Apache-2.0 */
/*
 * can402.h - the master of up to eight CiA 402 drives on one bus
 *
 * A period begins with SYNC.  Then the master reads the frames that have come
 * since the last SYNC, the cycle runs, and each drive is sent its target.  A
 * drive takes this target at the next SYNC and reaches it at the one after.
 *
 * The gap's frames may be on the bus too: two bytes are the voltage in 0.01 V.
 * If there are six bytes, the other four are the shares of open, spark, arc and
 * short pulses in 1/255.
 *
 * Threads: can402_load() and can402_period_us() may be called by any thread;
 * for the rest see io.h.
 */
#ifndef IO_CAN402_H
#define IO_CAN402_H

#include "drive.h"
#include "io.h"

/* edmd refuses to start if it needs a larger share of the bus. */
#define CAN402_LOAD_MAX		0.8

struct can402_bus {
	uint32_t bitrate;		/* bit/s */
	uint32_t axes;
	uint32_t inputs;		/* so many of them send theirs */
	uint32_t heartbeat_ms;
	bool gap;			/* its frames are on it too */
	uint32_t generator;		/* frames to it and from it */
	double plc_us;			/* a PLC on this bus: time between two
					 * sets of frames; 0: there is none */
};

/** can402_load() - share of the bus at this period: 1 is all of it. */
double can402_load(const struct can402_bus *b, double period_us);

/** can402_period_us() - the shortest period that fits, in whole 0.1 ms. */
double can402_period_us(const struct can402_bus *b);

#endif /* IO_CAN402_H */
