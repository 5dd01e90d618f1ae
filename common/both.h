/* SPDX-License-Identifier: Apache-2.0 */
/*
 * both.h - a thread for a while, and who may have one
 *
 * A thread has the processors and the priority of who starts it.  Signals are
 * not its own: it blocks all of them.
 */
#ifndef COMMON_BOTH_H
#define COMMON_BOTH_H

#include <pthread.h>
#include <stdint.h>

/** both_processors() - on how many processors may this thread run?  One that is
 *  kept for a cycle in real time is not among them. */
uint32_t both_processors(void);

/** both_start() - as pthread_create().  Return: 0, or an errno. */
int both_start(pthread_t *ret, void *(*run)(void *), void *arg);

/** both() - call @one and @other, which do not disturb each other, at the same
 *  time; one after the other if there can be no thread. */
void both(void (*one)(void *), void (*other)(void *), void *arg);

#endif /* COMMON_BOTH_H */
