/* SPDX-License-Identifier: Apache-2.0 */
/*
 * begun.h - motions that clients asked for, and how they ended
 *
 * A motion is answered when it begins: "begun".  Who asked for it may ask how
 * it ended, by the verb "moved".  edmd knows (shm.h: moved); this service knows
 * whose motion it was.
 *
 * Threads: one, that of the event loop.
 */
#ifndef JOBS_BEGUN_H
#define JOBS_BEGUN_H

#include "reply.h"

#include <stdbool.h>

struct jobs;
struct verb;
struct jobs_lcm_command;

/* The motion that was begun last. */
struct begun {
	struct asker by;
	uint64_t before;		/* snapshot's moved_by until then */
};

/** begun_is() - does @v begin a motion, and is answered then? */
bool begun_is(const struct verb *v);

/** begun_keep() - @by asked for it, and edmd has taken it. */
void begun_keep(struct jobs *j, const struct asker *by);

/** begun_tell() - the verb "moved". */
void begun_tell(struct jobs *j, const struct verb *v,
		const struct jobs_lcm_command *c);

#endif /* JOBS_BEGUN_H */
