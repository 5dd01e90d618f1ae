/* SPDX-License-Identifier: Apache-2.0 */
/* inside_kept.h - what is kept of a job that does not begin at its beginning */
#ifndef JOBS_INSIDE_KEPT_H
#define JOBS_INSIDE_KEPT_H

#include "checkpoint.h"

/* Where a job begins or goes on; kept in the store. */
struct inside {
	struct checkpoint_base base;	/* places in mm of the whole program */
	double from_mm, way_mm;		/* as in interp/build_from.h; the
					 * program of this job; 0, 0: not
					 * made */
	uint32_t line;			/* its sender named this line ... */
	double place_mm;		/* ... or this place; 0, 0: none, it
					 * was interrupted */
	uint32_t instance;		/* of the edmd whose axes an operator
					 * answered for; 0: nobody did */
	uint32_t run;			/* as in struct checkpoint_job */
};

/** inside_whole() - @s of a job that goes on as @a says, as if it had never
 *  been interrupted: place, length and sums. */
void inside_whole(const struct inside *a, struct shm_snapshot *s);

#endif /* JOBS_INSIDE_KEPT_H */
