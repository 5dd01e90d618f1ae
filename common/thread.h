/* SPDX-License-Identifier: Apache-2.0 */
/*
 * thread.h - start a thread
 *
 * A thread has the processors and the priority of who starts it.  Signals are
 * not its own: it blocks all of them.
 */
#ifndef COMMON_THREAD_H
#define COMMON_THREAD_H

#include <pthread.h>
#include <stddef.h>

struct thread {
	const char *name;		/* as ps and top show it: up to 15
					 * characters */
	void *(*run)(void *arg);
	void *arg;
	size_t stack_bytes;		/* 0: what a thread gets */
};

/** thread_start() - as pthread_create().  Return: 0 or -errno. */
int thread_start(pthread_t *ret, const struct thread *t);

#endif /* COMMON_THREAD_H */
