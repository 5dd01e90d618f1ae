/* SPDX-License-Identifier: Apache-2.0 */
/*
 * interlock.h - what a PLC permits and asks for
 *
 * Sparks and motion need a PLC that answers, gives its permit, and has its
 * interlocks closed.  If one of these is lost while anything moves, that is a
 * fault: the sparks are off in the same period, and the motion ends on the
 * path.  A machine that stands needs none of them, but it cannot begin to move
 * without them.
 *
 * A PLC may ask for start, hold, reset and override.  These do the same as the
 * commands.  On a machine without a PLC nothing here has an effect.
 *
 * Threads: RT-safe.
 */
#ifndef RT_INTERLOCK_H
#define RT_INTERLOCK_H

#include "io.h"

struct cycle;

/**
 * interlock_note() - note what the PLC says; one of the guards, once a period.
 */
void interlock_note(struct cycle *c, const struct io_inputs *in);

/** interlock_obey() - do what the PLC asks for; after the guards. */
void interlock_obey(struct cycle *c);

#endif /* RT_INTERLOCK_H */
