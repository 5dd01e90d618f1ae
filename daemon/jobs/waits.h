/* SPDX-License-Identifier: Apache-2.0 */
/*
 * waits.h - what a job waits for, and what ends the waiting
 *
 * Threads: one, that of the event loop.
 */
#ifndef JOBS_WAITS_H
#define JOBS_WAITS_H

#include "jobs.h"

#include <stddef.h>

/**
 * waits_why() - why job @n does not run now, and what has to be done about it,
 * in words.
 *
 * Return: @to; "" if the job runs, or begins in a moment.
 */
const char *waits_why(struct jobs *j, const struct store_job *job,
		      char *to, size_t size);

#endif /* JOBS_WAITS_H */
