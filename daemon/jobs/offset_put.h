/* SPDX-License-Identifier: Apache-2.0 */
/*
 * offset_put.h - what was felt goes into an offset or an electrode
 *
 * Threads: one, that of the event loop.
 */
#ifndef JOBS_OFFSET_PUT_H
#define JOBS_OFFSET_PUT_H

#include "jobs.h"
#include "store_work.h"
#include "touch.h"

#include "interp/turn.h"

struct interp_origin;

/** offset_name() - "G54" of 0. */
const char *offset_name(int work);

/**
 * offset_read() - the systems that job @n has; 0: those in force.
 *
 * @set: a bit for each row that was touched off, by system; NULL is fine.
 * Return: 0; -EIO: they cannot be known.
 */
int offset_read(struct jobs *j, uint32_t n,
		double mm[INTERP_NC_NWORK][WORK_NROWS],
		uint32_t set[INTERP_NC_NWORK]);

/** offset_origin() - where programs of system @work, which is @row, count from
 *  with the electrode that is in the holder. */
void offset_origin(struct jobs *j, int work, const double row[WORK_NROWS],
		   struct interp_origin *ret);

/** offset_has_c() - does the machine have C, and does C turn the electrode and
 *  not the work? */
bool offset_has_c(const struct jobs *j);

/**
 * offset_put() - write down what @t says of the contacts of @s.
 * @told: what was, and what is.  Return: 0; -errno of the store.
 */
int offset_put(struct jobs *j, const struct touch *t,
	       const struct shm_snapshot *s, char told[TOUCH_WHY_MAX]);

#endif /* JOBS_OFFSET_PUT_H */
