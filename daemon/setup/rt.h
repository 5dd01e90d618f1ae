/* SPDX-License-Identifier: Apache-2.0 */
/*
 * rt.h - what a real-time thread asks of its host, and what it got
 *
 * Nothing here is fatal. What the host refuses is reported, with the reason and
 * the command that mends it, and the cycle runs anyway.
 *
 * Threads: startup only.
 */
#ifndef SETUP_RT_H
#define SETUP_RT_H

#include <stdbool.h>

enum setup_what {
	SETUP_MEMORY,			/* locked, now and later */
	SETUP_STACK,			/* touched, so no fault in the cycle */
	SETUP_CPU,			/* pinned to one core */
	SETUP_PRIORITY,			/* SCHED_FIFO */
	SETUP_SLEEP,			/* no deep sleep of the processor */
	SETUP_NITEMS
};

struct setup_item {
	const char *what;		/* "memory lock", ... */
	bool wanted;
	bool got;
	char why[96];			/* if not got: the reason in words */
	const char *mend;		/* if not got: the command that does */
};

struct setup_report {
	struct setup_item item[SETUP_NITEMS];
};

struct setup_wanted {
	int cpu;			/* -1: any */
	int priority;			/* SCHED_FIFO; 0: none */
};

/* The stack of the real-time thread, and the part of it that is touched in
 * advance. */
#define SETUP_STACK_BYTES	(512 * 1024)
#define SETUP_STACK_TOUCHED	(256 * 1024)

/**
 * setup_process() - lock the memory and keep the processor awake. Fills its
 * items of @r.
 *
 * It holds /dev/cpu_dma_latency open as long as the process lives.
 */
void setup_process(struct setup_report *r);

/** setup_thread() - the real-time thread calls this first of all. */
void setup_thread(struct setup_report *r, const struct setup_wanted *w);

#endif /* SETUP_RT_H */
