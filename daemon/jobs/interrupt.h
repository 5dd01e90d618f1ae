/* SPDX-License-Identifier: Apache-2.0 */
/*
 * interrupt.h - a job that a power cut, or the death of edmd, ended early
 *
 * Nobody is left who saw its end.  The last checkpoint says where it was.  The
 * job is then "interrupted": it waits, and keeps that checkpoint in the store.
 *
 * Threads: one, that of the event loop.
 */
#ifndef JOBS_INTERRUPT_H
#define JOBS_INTERRUPT_H

#include "checkpoint.h"

#include <stdint.h>

struct jobs;

/**
 * interrupt_unseen() - why nothing begins until a person has seen something:
 * NULL, or what to see.
 */
const char *interrupt_unseen(const struct jobs *j);

/**
 * checkpoint_tick() - write a checkpoint if one is due; to be called every 20
 * ms.
 */
void checkpoint_tick(struct jobs *j, int64_t now_us);

/** interrupt_init() - find the job that waits.  Startup only. */
void interrupt_init(struct jobs *j);

/**
 * interrupt_saw_begin() - does the last checkpoint show that the loaded job was
 * under way?
 */
bool interrupt_saw_begin(struct jobs *j);

/**
 * interrupt_take() - the loaded job has begun, and edmd does not have it any
 * more: say what is known of it, and drop it.
 */
void interrupt_take(struct jobs *j);

/**
 * interrupt_attach() - edmd was started anew: does it show the axes where they
 * were last seen?  To be called before the next checkpoint_tick().
 */
void interrupt_attach(struct jobs *j);

/** interrupt_answered() - a person has seen what is `unseen`. */
void interrupt_answered(struct jobs *j);

/** interrupt_lost() - the letters of the axes whose places are not certain. */
const char *interrupt_lost(const struct jobs *j);

/**
 * interrupt_as_seen() - where @axis, which nothing homes, stands if it was not
 * moved since it was seen last.
 *
 * Return: NULL and @ret_mm; or why nobody knows.
 */
const char *interrupt_as_seen(struct jobs *j, int axis, double *ret_mm);

/** interrupt_placed() - edmd shows @axis at @mm from now on.  Return: that, and
 *  where it was shown, in words. */
const char *interrupt_placed(struct jobs *j, int axis, double mm);

/** interrupt_told() - does the drive of one of @axes, which nothing homes, tell
 *  another place than is shown, or is it not up?  Return: NULL, or that. */
const char *interrupt_told(struct jobs *j, uint32_t axes);

/** interrupt_tick() - when the drives of a new edmd are up, ask that of all. */
void interrupt_tick(struct jobs *j);

#endif /* JOBS_INTERRUPT_H */
