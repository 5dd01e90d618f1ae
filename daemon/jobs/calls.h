/* SPDX-License-Identifier: Apache-2.0 */
/*
 * calls.h - conditions that a job has called, on their way into the history
 *
 * A program may call one each second.  Each alone would cost the disk some
 * pages, so they wait here until the sums of the job are written, at most three
 * minutes.  After a crash of the service edmd tells them again; a power cut
 * takes those that waited.
 *
 * Threads: one, that of the event loop.
 */
#ifndef JOBS_CALLS_H
#define JOBS_CALLS_H

#include <stdint.h>

struct jobs;

#define CALLS_MAX	256

struct call {
	char condition[16];
	double place_mm;
	int64_t time_ns;
};

struct calls {
	uint32_t job;			/* n, of all of them */
	uint32_t n;
	struct call call[CALLS_MAX];
};

/** calls_add() - job @n has called a condition. */
void calls_add(struct jobs *j, uint32_t n, const struct call *c);

/** calls_write() - give all to the store. */
void calls_write(struct jobs *j);

#endif /* JOBS_CALLS_H */
