/* SPDX-License-Identifier: Apache-2.0 */
/*
 * again.h - an interrupted job goes on
 *
 * Its text is read again, and the program begins at the place of the last
 * checkpoint (interp/build_from.h).  Of such a program STATUS tells the places.
 * The store keeps those of the whole program, and the sums of all its parts, so
 * that it can be interrupted any number of times.
 *
 * Threads: one, that of the event loop.
 */
#ifndef JOBS_AGAIN_H
#define JOBS_AGAIN_H

#include "checkpoint.h"
#include "compiler.h"
#include "verb.h"

/* Where a job goes on; kept in the store. */
struct again {
	struct checkpoint_base base;	/* places in mm of the whole program */
	double from_mm, way_mm;		/* as in interp/build_from.h; the
					 * program of this job; 0, 0: not
					 * made */
	uint32_t instance;		/* of the edmd whose axes an operator
					 * answered for; 0: nobody did */
};

/** again_read() - of job @n.  0; -ENOENT: it begins at its beginning. */
int again_read(struct jobs *j, uint32_t n, struct again *ret);
/** again_write() - 0, STORE_KEPT or -errno. */
int again_write(struct jobs *j, uint32_t n, const struct again *a);

/** again_interrupted() - what is to be kept of job @n, whose last checkpoint is
 *  @last. */
void again_interrupted(struct jobs *j, uint32_t n,
		       const struct checkpoint_base *last, struct again *ret);

/** again_whole() - @s of a job that goes on as @a says, as if it had never been
 *  interrupted: place, length and sums. */
void again_whole(const struct again *a, struct shm_snapshot *s);

/** again_resume() - the verb "resume" with a job. */
void again_resume(struct jobs *j, const struct jobs_lcm_command *c,
		  const struct store_job *job);

/**
 * again_request() - fill in @ret->from if @job does not begin at its
 * beginning.
 *
 * Return: 0; -ESTALE: the axes are not where they were answered for, and the
 * job is interrupted again.
 */
int again_request(struct jobs *j, const struct store_job *job,
		  struct compiler_request *ret);

/** again_refuse() - it cannot go on, so @job is interrupted as before; tell
 *  @why. */
void again_refuse(struct jobs *j, const struct store_job *job,
		  const char *why);

/** again_loaded() - what was made of it: remember and tell.
 *  Return: NULL; else why it cannot go on, in words. */
const char *again_loaded(struct jobs *j, const struct compiler_result *r);

#endif /* JOBS_AGAIN_H */
