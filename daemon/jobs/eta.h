/* SPDX-License-Identifier: Apache-2.0 */
/*
 * eta.h - estimate how long the running job will still take
 *
 * Nearly all of the time goes into cutting, and almost none into positioning,
 * however long its way is. So the path is divided into parts that are cut and
 * parts that are positioned.
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

/** eta_give() - use @of for program @n; @of has nothing any more. */
void eta_give(struct eta *l, struct eta *of, uint32_t n);

/** eta_take() - use program @n of @machine, if it is not the one in use. */
void eta_take(struct eta *l, const char *machine, uint32_t n);

/**
 * eta_measure() - divide @p into its parts. Return: 0; or -ENOMEM, and then it
 * has none.
 */
int eta_measure(struct eta *l, const struct interp_program *p);

/**
 * eta_s() - the estimate in s, if @far_mm of the path took @job_s.
 *
 * Return: -1 if there is none, because nothing has been cut yet.
 */
double eta_s(const struct eta *l, double far_mm, double job_s);

/** eta_fini() - free everything. */
void eta_fini(struct eta *l);

#endif /* JOBS_ETA_H */
