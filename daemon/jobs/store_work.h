/* SPDX-License-Identifier: Apache-2.0 */
/*
 * store_work.h - origins of work coordinate systems that an operator touched
 * off
 *
 * They go before those of the machine file.  Job 0 stands for the table in
 * force.  A job keeps the rows that were in force when it was loaded, so that
 * it goes on with them after an interruption.
 *
 * A system has rows for its axes, and for how its work lies: its turn, which
 * programs obey, and how far its face was found to tilt, which is only told.
 *
 * Units: mm, machine coordinates; degrees.
 * Threads: one.  Calls return the same values as those of store.h.
 */
#ifndef JOBS_STORE_WORK_H
#define JOBS_STORE_WORK_H

#include "store.h"

#include "interp/axis.h"
#include "interp/build.h"
#include "interp/nc.h"

enum store_work_row {
	WORK_TURN = INTERP_NAXES,	/* from X toward Y */
	WORK_TILT_X, WORK_TILT_Y,	/* the face rises along X, Y */
	WORK_NROWS
};

/** store_work_put() - these @rows of system @work, origins of axes or others,
 *  of @value: all on the disk, or all refused. */
int store_work_put(struct store *s, int work, uint32_t rows,
		   const double value[WORK_NROWS]);

/** store_work_clear() - system @work is that of the machine file again. */
int store_work_clear(struct store *s, int work);

/**
 * store_work_read() - put those of job @n over @mm.
 *
 * @ret_set: a bit for each row that was touched off, by system; NULL is fine.
 * Return: 0 or -EIO: they cannot be known.
 */
int store_work_read(struct store *s, uint32_t n,
		    double mm[INTERP_NC_NWORK][WORK_NROWS],
		    uint32_t ret_set[INTERP_NC_NWORK]);

/** store_work_keep() - job @n begins with those in force; on the disk, or
 *  refused. */
int store_work_keep(struct store *s, uint32_t n);

#endif /* JOBS_STORE_WORK_H */
