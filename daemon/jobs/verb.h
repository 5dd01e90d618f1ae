/* SPDX-License-Identifier: Apache-2.0 */
/*
 * verb.h - a row of the table of verbs
 *
 * Threads: one, that of the event loop.
 */
#ifndef JOBS_VERB_H
#define JOBS_VERB_H

#include "jobs.h"

#define REFUSED		1		/* understood, and the answer is no */

struct verb {
	const char *name;
	enum trust_role role;		/* the least that may ask for it */
	void (*run)(struct jobs *j, const struct verb *v,
		    const struct jobs_lcm_command *c);
	uint32_t machine;		/* enum shm_verb, for verb_machine() */
	const char *wants;		/* the state it wants */
};

/** verbs_answer() - @code and @reason, to who asked. */
void verbs_answer(struct jobs *j, const struct jobs_lcm_command *c, int code,
		 const char *reason);

#endif /* JOBS_VERB_H */
