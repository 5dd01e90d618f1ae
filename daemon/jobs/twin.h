/* SPDX-License-Identifier: Apache-2.0 */
/*
 * twin.h - models of the axes beside the machine: contour error, measured and
 * predicted
 *
 * The twin reads the ring of trace records.  The loops of its axes are those of
 * the machine file.  There is no twin if no linear axis has a loop_gain_1_s.
 *
 * Threads: one, that of the event loop.
 */
#ifndef JOBS_TWIN_H
#define JOBS_TWIN_H

#include "config.h"
#include "shm.h"

#include "interp/shadow.h"

/* Of the last whole second; -1: not known. */
struct twin_error {
	double measured_mm, predicted_mm;	/* largest contour error */
};

/* Fields are private. */
struct twin {
	int axis[INTERP_NAXES], naxes;
	struct interp_axis_loop loop[INTERP_NAXES];
	struct interp_shadow shadow;
	uint32_t instance;		/* of the edmd whose ring it reads */
	int64_t period_ns;
	struct shm_follow follow;
	uint64_t lost;
	uint64_t since_cycle;
	struct twin_error now, last;
};

/** twin_init() - for the machine of @c. */
void twin_init(struct twin *t, const struct machine_config *c);

/** twin_poll() - take what is new in the ring; @s NULL: edmd is not there. */
void twin_poll(struct twin *t, const struct shm_status *s,
	       const struct shm_snapshot *snap);

#endif /* JOBS_TWIN_H */
