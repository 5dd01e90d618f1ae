/* SPDX-License-Identifier: Apache-2.0 */
/*
 * inside.h - a job whose cut does not begin at the start of its text
 *
 * The job was interrupted and goes on, or its sender named a line or a place.
 * The text is read again, and a new program begins at that place, or at the
 * place of the last checkpoint (interp/build_from.h).  STATUS gives places on
 * the new program.  The store keeps places on the whole program, and the sums
 * of all parts of the job.  So a job can be interrupted any number of times.
 *
 * Threads: one, that of the event loop.
 */
#ifndef JOBS_INSIDE_H
#define JOBS_INSIDE_H

#include "inside_kept.h"
#include "compiler.h"
#include "verb.h"

/**
 * inside_read() - read what the store keeps about the beginning of job @n.
 *
 * Return: 0; -ENOENT: the job begins at the start of its text; -EBADMSG: it
 * does not, but the record is damaged or of another version.  Then @ret is
 * zeros.
 */
int inside_read(struct jobs *j, uint32_t n, struct inside *ret);
/** inside_is_named() - did the sender name the place? */
bool inside_is_named(const struct inside *a);
/** inside_named() - what the store is to keep about a new job, valid until the
 *  next call; NULL: the job begins at the start of its text. */
const char *inside_named(uint32_t line, double place_mm);
/** inside_write() - 0, STORE_KEPT or -errno. */
int inside_write(struct jobs *j, uint32_t n, const struct inside *a);

/** inside_interrupted() - what is to be kept about job @n, whose last
 *  checkpoint is @last. */
void inside_interrupted(struct jobs *j, uint32_t n,
			const struct checkpoint_base *last, struct inside *ret);

/** inside_resume() - carry out the verb "resume" for a job. */
void inside_resume(struct jobs *j, const struct jobs_lcm_command *c,
		   const struct store_job *job);

/**
 * inside_check() - may @job be loaded?
 *
 * Return: 0; -ESTALE: the axes are not where they were answered for, or what
 * is kept of the job cannot be read; the job is interrupted again.
 */
int inside_check(struct jobs *j, const struct store_job *job);

/** inside_request() - fill in @ret->from if @job does not begin at its
 *  beginning.  Return: 0; -EBADMSG: what is kept of it cannot be read. */
int inside_request(struct jobs *j, const struct store_job *job,
		   struct compiler_request *ret);

/** inside_begin_at() - a job whose axes stand at @ret->start_mm begins at
 *  @line or, if that is 0, at @place_mm. */
void inside_begin_at(const struct jobs *j, uint32_t line, double place_mm,
		     struct compiler_request *ret);

/** inside_refuse() - @job cannot go on and stays interrupted; say @why. */
void inside_refuse(struct jobs *j, const struct store_job *job,
		   const char *why);

/** inside_loaded() - the job was compiled: remember where it goes on, and say
 *  it.  Return: NULL; or why it cannot go on, in words. */
const char *inside_loaded(struct jobs *j, const struct compiler_result *r);

#endif /* JOBS_INSIDE_H */
