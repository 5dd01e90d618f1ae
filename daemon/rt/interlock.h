/* SPDX-License-Identifier: Apache-2.0 */
/*
 * interlock.h - what a PLC permits and asks for
 *
 * Sparks and motion need a PLC that is there, gives its permit, and has its
 * interlocks closed.  Losing one of them while anything moves is a fault:
 * sparks are off in the same period, and the motion ends on the path.  A
 * machine that stands needs none of them, but cannot begin to move without
 * them.
 *
 * What a PLC asks for - start, hold, reset, override - does the same as the
 * commands.  A machine without a PLC notices nothing of this.
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
