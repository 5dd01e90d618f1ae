/* SPDX-License-Identifier: Apache-2.0 */
/*
 * interrupt.h - a job that the power, or edmd's death, cut short
 *
 * Nobody who saw its end is left.  The last checkpoint says where it was: the
 * job is then "interrupted", waits, and keeps that checkpoint in the store.
 *
 * Threads: one, that of the event loop.
 */
#ifndef JOBS_INTERRUPT_H
#define JOBS_INTERRUPT_H

#include "checkpoint.h"

#include <stdint.h>

struct jobs;

/** checkpoint_tick() - every 20 ms: a checkpoint, if one is due. */
void checkpoint_tick(struct jobs *j, int64_t now_us);

/** interrupt_init() - find the one that waits.  Startup only. */
void interrupt_init(struct jobs *j);

/**
 * interrupt_saw_begin() - the last checkpoint has the job loaded, under way.
 */
bool interrupt_saw_begin(const struct jobs *j);

/**
 * interrupt_take() - the job loaded has begun, and edmd has not got it: say
 * what is known of it, and drop it.
 */
void interrupt_take(struct jobs *j);

/** interrupt_lost() - the axes whose places are not certain, as letters. */
const char *interrupt_lost(const struct jobs *j);

#endif /* JOBS_INTERRUPT_H */
