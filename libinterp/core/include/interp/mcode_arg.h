/* SPDX-License-Identifier: Apache-2.0 */
/*
 * mcode_arg.h - M codes that a PLC carries out
 *
 * A machine has a table of them.  The reader of NC code takes those that are
 * in it and makes actions of them, INTERP_MCODE, whose argument says all that
 * the walk needs to know.
 *
 * Threads: any; RT-safe.
 */
#ifndef INTERP_MCODE_ARG_H
#define INTERP_MCODE_ARG_H

#include <stdbool.h>
#include <stdint.h>

#define INTERP_NMCODES	256		/* M1 ... M255 */

/* When it is told to the PLC, and what waits until that is done. */
enum interp_mcode_sync {
	INTERP_MCODE_NONE,		/* not one of the machine's */
	INTERP_MCODE_BEFORE,		/* before its line's motion, which
					 * waits */
	INTERP_MCODE_AFTER,		/* after it; what follows waits */
	INTERP_MCODE_FREE,		/* before it; nothing waits but the next
					 * M code */
	INTERP_MCODE_NSYNC
};

/* What walking back over it means. */
enum interp_mcode_back {
	INTERP_MCODE_SKIP,		/* nothing, either way */
	INTERP_MCODE_REDO,		/* told again on the way forward, but
					 * after a flushing lift */
	INTERP_MCODE_STOP,		/* the way back ends at it */
	INTERP_MCODE_NBACK
};

struct interp_mcode {
	uint8_t sync;			/* enum interp_mcode_sync */
	uint8_t back;			/* enum interp_mcode_back */
};

/* The argument of an action. */
static inline uint32_t interp_mcode_arg(uint8_t number, struct interp_mcode m)
{
	return number | (uint32_t)m.sync << 8 | (uint32_t)m.back << 16;
}

static inline uint8_t interp_mcode_number(uint32_t arg)
{
	return (uint8_t)arg;
}

static inline enum interp_mcode_sync interp_mcode_sync(uint32_t arg)
{
	return (enum interp_mcode_sync)(arg >> 8 & 0xff);
}

static inline enum interp_mcode_back interp_mcode_back(uint32_t arg)
{
	return (enum interp_mcode_back)(arg >> 16 & 0xff);
}

static inline bool interp_mcode_ok(uint32_t arg)
{
	return interp_mcode_number(arg) > 0 && arg >> 24 == 0 &&
	       interp_mcode_sync(arg) > INTERP_MCODE_NONE &&
	       interp_mcode_sync(arg) < INTERP_MCODE_NSYNC &&
	       interp_mcode_back(arg) < INTERP_MCODE_NBACK;
}

#endif /* INTERP_MCODE_ARG_H */
