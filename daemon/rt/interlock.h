/* SPDX-License-Identifier: Apache-2.0 */
/*
 * interlock.h - what a PLC permits, locks and asks for
 *
 * Sparks and motion need a PLC that is there, its permit and its interlocks.
 * Losing one of them while a job runs, or while it is walked back by command,
 * is a fault: sparks are off in the same period, the motion ends on the path.
 * A stand needs nothing; it cannot be left without them.
 *
 * What it asks for - start, hold, reset, override - is what the commands do.
 * A machine without a PLC notices none of this.
 *
 * Threads: RT-safe.
 */
#ifndef RT_INTERLOCK_H
#define RT_INTERLOCK_H

#include "io.h"

struct cycle;

/** interlock_note() - what the PLC says, once a period, among the guards. */
void interlock_note(struct cycle *c, const struct io_inputs *in);

/** interlock_obey() - do what it asks for, after the guards. */
void interlock_obey(struct cycle *c);

#endif /* RT_INTERLOCK_H */
