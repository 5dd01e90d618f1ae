/* SPDX-License-Identifier: Apache-2.0 */
/*
 * left.h - how long the job that runs will take yet
 *
 * What is cut takes the time, and positioning next to none of it, however long
 * its way is: so what has been cut is told from what has been positioned.
 *
 * Threads: one, that of the event loop.
 */
#ifndef JOBS_LEFT_H
#define JOBS_LEFT_H

#include "interp/program.h"

#include <stddef.h>

/* From here on the path is cut, or positioned; before it so much was cut. */
struct left_part {
	double s_mm, cut_mm;
	bool cut;
};

/* Fields are private; all 0 at first. */
struct left {
	uint32_t n;			/* the program it is of; 0: none */
	struct left_part *part;
	size_t nparts;
	double cut_mm;			/* of the whole path */
};

/** left_take() - program @n of @machine, if it is not the one it has. */
void left_take(struct left *l, const char *machine, uint32_t n);

/** left_measure() - the parts of @p. Return: 0 or -ENOMEM, then none. */
int left_measure(struct left *l, const struct interp_program *p);

/**
 * left_s() - estimate, s, when @far_mm of the path took @job_s.
 *
 * Return: -1 if there is none: nothing is cut yet.
 */
double left_s(const struct left *l, double far_mm, double job_s);

/** left_fini() - forget all. */
void left_fini(struct left *l);

#endif /* JOBS_LEFT_H */
