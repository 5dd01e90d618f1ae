/* SPDX-License-Identifier: Apache-2.0 */
/*
 * eta.h - how long the job that runs will take yet
 *
 * What is cut takes the time, and positioning next to none of it, however long
 * its way is: so what has been cut is told from what has been positioned.
 *
 * Threads: one, that of the event loop.
 */
#ifndef JOBS_ETA_H
#define JOBS_ETA_H

#include "interp/program.h"

#include <stddef.h>

/* From here on the path is cut, or positioned; before it so much was cut. */
struct eta_part {
	double s_mm, cut_mm;
	bool cut;
};

/* Fields are private; all 0 at first. */
struct eta {
	uint32_t n;			/* the program it is of; 0: none */
	struct eta_part *part;
	size_t nparts;
	double cut_mm;			/* of the whole path */
	int32_t start[INTERP_NAXES];	/* where it begins, pulses */
};

/** eta_take() - program @n of @machine, if it is not the one it has. */
void eta_take(struct eta *l, const char *machine, uint32_t n);

/** eta_measure() - the parts of @p. Return: 0 or -ENOMEM, then none. */
int eta_measure(struct eta *l, const struct interp_program *p);

/**
 * eta_s() - estimate, s, when @far_mm of the path took @job_s.
 *
 * Return: -1 if there is none: nothing is cut yet.
 */
double eta_s(const struct eta *l, double far_mm, double job_s);

/** eta_fini() - forget all. */
void eta_fini(struct eta *l);

#endif /* JOBS_ETA_H */
